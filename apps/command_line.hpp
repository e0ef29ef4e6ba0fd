#pragma once

#include "apps/command_table.hpp"

#include <any>
#include <functional>
#include <vector>

namespace troupe::apps {

/// Runs the whole program: parses the arguments (argv[0] is the name of the program), runs the command that
/// they name, and prints the output and the errors of the command. Without a command, prints the help on
/// standard error and returns k_bad_input. Returns the exit code (apps/exit_code.hpp); throws nothing. With
/// --controller, which names a Python script with robot controllers, the function may replace the process by
/// Python (apps/scripts.hpp), and then does not return. limit: a callback that is called between parsing and
/// running the command. It receives the options of the command and may change them; the std::any contains a
/// std::shared_ptr to them (ProgramCommand::options). The fuzz test uses the callback to shorten runs.
int run_command_line(int argc, const char* const* argv,
                     const std::function<void(std::any& options)>& limit = nullptr);

/// Returns the table of commands for the manual page and for shell completion (command_table()): the program
/// itself, and then all its commands with their options.
std::vector<Command> known_commands();

}  // namespace troupe::apps
