#pragma once

#include "apps/exit_code.hpp"

#include <any>
#include <functional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// A command of the program.
struct ProgramCommand {
  std::string name;
  std::string help;
  std::function<void(CLI::App& command)> add_options;  ///< which parsing fills
  std::function<ExitCode()> run;                       ///< does what they ask for
  std::any options;  ///< a std::shared_ptr to them, of the type that the command's own file declares
};

/// The table of the commands, in the order of --help; each call makes options of its own.
std::vector<ProgramCommand> program_commands();

}  // namespace troupe::apps
