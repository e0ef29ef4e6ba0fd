#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// An option or positional argument of a command, read from the parser, for the manual page and the
/// completion of shells.
struct CommandOption {
  std::vector<std::string> names;  ///< as typed: "--for"; for a positional argument only its name: "WORLD"
  std::string value;  ///< placeholder of its value: "S", "FILE.h5", "exact|grid"; empty: no value
  std::string help;
  bool positional = false;
};

struct Command {
  std::string name;
  std::string help;
  std::vector<CommandOption> options;  ///< in the order of --help; --help itself is first
  std::string footer;                  ///< text below the options in --help
};

/// Returns the program itself with its own options as the first element, and then all commands.
std::vector<Command> command_table(const CLI::App& app);

}  // namespace troupe::apps
