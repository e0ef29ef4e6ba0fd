#pragma once

#include "apps/command_table.hpp"

#include <any>
#include <functional>
#include <vector>

namespace troupe::apps {

/// Runs the program: parses the arguments, runs the command that they name, and prints its output and its
/// errors. Without a command, prints the help on standard error and returns k_bad_input. Returns the exit
/// code of the program (apps/exit_code.hpp), and throws nothing.
///
/// With the option --controller, which names a Python script, the function may replace this process by a
/// Python interpreter (apps/scripts.hpp). It then does not return.
///
/// argc: number of elements of `argv`
/// argv: the name of the program, and then its arguments
/// limit: for tests; called between parsing and running the command. It may change the options of the
/// command, for example to shorten a run. Its argument `options` is ProgramCommand::options() of the command.
int run_command_line(int argc, const char* const* argv,
                     const std::function<void(const std::any& options)>& limit = nullptr);

/// Returns all commands of the program with their options. The first element is the program itself. The
/// manual page and the shell completion are made from this list.
std::vector<Command> known_commands();

}  // namespace troupe::apps
