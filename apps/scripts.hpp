#pragma once

#include "apps/cli_app.hpp"
#include "troupe/launcher.hpp"
#include "troupe/script.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

/// The option --controller, which names a Python script with controllers (classes that decide what the robots
/// do). The program contains no Python interpreter. If the option is given, the program calls
/// run_in_python(), which replaces the process by a Python interpreter. The interpreter runs the same
/// command, from the Python package `troupe`. The package can read scripts: it calls set_script_reader()
/// first.
namespace troupe::apps {

/// A function that reads the Python script `file` and returns the script. Throws if the script has errors.
using ReadScript = std::function<std::shared_ptr<const Script>(const std::filesystem::path& file)>;

/// Sets the function that reads scripts, for the rest of the process.
void set_script_reader(ReadScript read);

/// Adds the option --controller to `app`. Parsing reads the script and appends it to `scripts`, which must
/// outlive `app`. If set_script_reader() was not called, parsing reads no script, and python_is_wanted()
/// returns true afterwards.
void add_controller_option(CLI::App& app, std::vector<std::shared_ptr<const Script>>& scripts);

/// Whether the parsed command line has --controller but this process cannot read scripts, because
/// set_script_reader() was not called. The caller must then call run_in_python().
bool python_is_wanted();

/// Returns the Python interpreter to execute: the one that the environment variable TROUPE_PYTHON names, else
/// the one for which the package was built, if it exists, else the first python3 on PATH.
std::string python_interpreter();

/// Throws InputError, with a text which says that scripts work only in one process. Call it if a command that
/// one process would run has --controller, and `launcher` started this process.
[[noreturn]] void refuse_scripts(const Launcher& launcher);

/// Replaces this process by python_interpreter(), which runs the Python package `troupe` with the arguments
/// argv[1] to argv[argc - 1]. Python searches modules in the working folder last, so that files there do not
/// hide modules of Python. Throws InputError if the interpreter cannot be executed, or if a launcher such as
/// mpirun started several processes.
[[noreturn]] void run_in_python(int argc, const char* const* argv);

}  // namespace troupe::apps
