#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// What a command line takes, as the parser that reads it knows it: for the manual page and for shells.
struct CommandOption {
  std::vector<std::string> names;  ///< as typed: "--for"; of a positional argument its name alone: "WORLD"
  std::string value;  ///< what follows it, for people: "S", "FILE.h5", "exact|grid"; empty: nothing
  std::string help;
  bool positional = false;
};

struct Command {
  std::string name;
  std::string help;
  std::vector<CommandOption> options;  ///< in the order of --help, that one first
  std::string footer;                  ///< what --help says below them
};

/// The program itself (its own options, and no footer of a command) and behind it its commands.
std::vector<Command> command_table(const CLI::App& app);

}  // namespace troupe::apps
