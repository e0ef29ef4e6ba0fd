#pragma once

#include "apps/command_table.hpp"

#include <any>
#include <functional>
#include <vector>

namespace troupe::apps {

/// The whole program: parses the arguments (argv[0] is the program's name), runs the command, and prints what
/// it has to say. Returns the exit code (apps/exit_code.hpp); throws nothing. `limit` is called between
/// parsing and running with the command's options (ProgramCommand::options) and may change what is asked for:
/// the fuzz target keeps runs short with it.
int run_command_line(int argc, const char* const* argv,
                     const std::function<void(std::any& options)>& limit = nullptr);

/// The commands and their options as the parser knows them.
std::vector<Command> known_commands();

}  // namespace troupe::apps
