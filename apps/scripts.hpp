#pragma once

#include "troupe/script.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

/// The option --controller, which names a Python script with controllers (classes that decide what the robots
/// do). The program does not link Python. If the option is given, the program replaces itself by a Python
/// interpreter, which runs the Python package `troupe` with the same arguments. The package contains the same
/// commands, and calls set_script_reader() before run_command_line().
namespace troupe::apps {

/// A function that reads the Python script `file` and returns the script. Throws if the script has errors.
using ReadScript = std::function<std::shared_ptr<const Script>(const std::filesystem::path& file)>;

/// Sets the function that reads scripts, for the rest of the process.
void set_script_reader(ReadScript read);

/// Adds --controller, which appends to `scripts`; `scripts` must outlive `app`. If set_script_reader() was
/// not called, parsing the option only makes python_is_wanted() true.
void add_controller_option(CLI::App& app, std::vector<std::shared_ptr<const Script>>& scripts);

/// Whether a parsed command line has --controller, and set_script_reader() was not called, so that only
/// Python can read the script (run_in_python()).
bool python_is_wanted();
/// Replaces this process by the program in the Python package `troupe`, with the arguments argv[1] to
/// argv[argc - 1]. Python searches modules in the working folder last. The interpreter is the one that the
/// environment variable TROUPE_PYTHON names, or else the one for which the Python package was built, or, if
/// that does not exist, the first python3 on PATH. Throws InputError if the interpreter cannot be executed,
/// or if a launcher such as mpirun started several processes.
[[noreturn]] void run_in_python(int argc, const char* const* argv);

}  // namespace troupe::apps
