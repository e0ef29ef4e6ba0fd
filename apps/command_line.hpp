#pragma once

#include "apps/command_table.hpp"

#include <any>
#include <functional>
#include <vector>

namespace troupe::apps {

/// The whole program: parses the arguments (argv[0] is the name of the program), runs the command, and prints
/// its output and errors. Returns the exit code (apps/exit_code.hpp); throws nothing. limit: a callback that
/// is called after parsing and before running the command. It receives the options of the command
/// (ProgramCommand::options) and may change them; the fuzz target uses this to shorten runs.
int run_command_line(int argc, const char* const* argv,
                     const std::function<void(std::any& options)>& limit = nullptr);

/// All commands and their options, read from the parser.
std::vector<Command> known_commands();

}  // namespace troupe::apps
