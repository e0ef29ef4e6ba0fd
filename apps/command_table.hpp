#pragma once

#include "apps/cli_app.hpp"

#include <string>
#include <vector>

namespace troupe::apps {

/// An option or positional argument of a command, as declared to the command-line parser. The manual page and
/// the shell completion are made from these data.
struct CommandOption {
  std::vector<std::string> names;  ///< as typed: "--for"; for a positional argument only its name: "WORLD"
  std::string value;               ///< placeholder of its value: "S", "FILE.h5", "exact|grid"; empty: none
  std::string help;                ///< description in --help
  bool positional = false;         ///< whether it is a positional argument
};

/// A command, or the program itself, as declared to the command-line parser.
struct Command {
  std::string name;                    ///< as typed: "run"; of the program itself: "troupe"
  std::string help;                    ///< description in --help
  std::vector<CommandOption> options;  ///< in the order of --help; --help itself is first
  std::string footer;                  ///< text below the options in --help
};

/// Returns all commands of the parser `app`. The first element is the program itself with its own options
/// (--help, --version).
std::vector<Command> command_table(const CLI::App& app);

}  // namespace troupe::apps
