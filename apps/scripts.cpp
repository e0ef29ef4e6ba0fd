#include "apps/scripts.hpp"

#include "apps/options.hpp"
#include "base/diagnostics.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

ReadScript g_read_script;     // NOLINT: one interpreter per process
bool g_wants_python = false;  // NOLINT: an option of the process

/// What Python executes. `-m troupe` would search the working folder first, where a json.py would hide the
/// module json of Python. With `-c`, Python also searches the working folder first, under the name "". This
/// code makes the working folder the last one, so that a script can still import modules from it.
constexpr const char* k_run_package =
    "import sys\n"
    "if sys.path[:1] == ['']: sys.path.append(sys.path.pop(0))\n"
    "from troupe.__main__ import main\n"
    "sys.exit(main())\n";

std::string environment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing writes the environment
  return value ? value : "";
}

/// Makes the Python package that was built or installed with this program importable, through PYTHONPATH.
void add_package_path() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path packages = program.parent_path().parent_path() / "lib/python3/dist-packages";
  if (error || !fs::exists(packages / "troupe" / "__main__.py", error)) return;
  const std::string others = environment("PYTHONPATH");
  const std::string path = packages.string() + (others.empty() ? "" : ":" + others);
  setenv("PYTHONPATH", path.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): before any thread exists
}

}  // namespace

std::string python_interpreter() {
  if (std::string chosen = environment("TROUPE_PYTHON"); !chosen.empty()) return chosen;
  const std::string built_for = TROUPE_PYTHON_INTERPRETER;
  std::error_code error;
  return fs::exists(built_for, error) ? built_for : "python3";
}

void set_script_reader(ReadScript read) { g_read_script = std::move(read); }

void add_controller_option(CLI::App& app, std::vector<std::shared_ptr<const Script>>& scripts) {
  add_values(app, "--controller", "SCRIPT.py",
             "Python script whose classes control the robots (docs/python.md); repeatable",
             [&scripts](const std::string& text) {
               if (text.empty() || text.starts_with('-'))
                 refuse("--controller", text, "the name of a script");
               if (g_read_script)
                 scripts.push_back(g_read_script(text));
               else
                 g_wants_python = true;
             });
}

bool python_is_wanted() { return g_wants_python; }

void refuse_scripts(const Launcher& launcher) {
  throw InputError(
      fmt::format("troupe: error: --controller works only in one process, but {} started {} processes: "
                  "start the program without the launcher",
                  launcher.name, launcher.ranks));
}

void run_in_python(int argc, const char* const* argv) {
  if (const std::optional<Launcher> launcher = find_launcher()) refuse_scripts(*launcher);
  add_package_path();
  const std::string python = python_interpreter();
  std::vector<const char*> arguments{python.c_str(), "-c", k_run_package};
  for (int i = 1; i < argc; ++i) arguments.push_back(argv[i]);
  arguments.push_back(nullptr);
  execvp(python.c_str(), const_cast<char* const*>(arguments.data()));
  throw InputError(
      fmt::format("troupe: error: --controller needs Python, but \"{}\" cannot be executed: {}; "
                  "set TROUPE_PYTHON to a Python "
                  "interpreter",
                  python, std::strerror(errno)));  // NOLINT(concurrency-mt-unsafe): before any thread exists
}

}  // namespace troupe::apps
