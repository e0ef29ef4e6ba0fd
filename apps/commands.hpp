#pragma once

#include "apps/cli_app.hpp"
#include "apps/exit_code.hpp"

#include <any>
#include <functional>
#include <string>
#include <vector>

namespace troupe::apps {

struct ProgramCommand {
  std::string name;                                    ///< as typed: "run"
  std::string help;                                    ///< one line for --help
  std::function<void(CLI::App& command)> add_options;  ///< declares the options; parsing fills them
  std::function<ExitCode()> run;                       ///< runs the command with its options
  std::any options;  ///< std::shared_ptr to the options that parsing fills, such as a RunOptions
};

/// Returns all commands, in the order of --help. The objects in ProgramCommand::options are new in each call.
std::vector<ProgramCommand> program_commands();

}  // namespace troupe::apps
