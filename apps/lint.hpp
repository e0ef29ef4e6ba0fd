#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace troupe::apps {

/// What the command line of `troupe lint` asks for.
struct LintOptions {
  std::filesystem::path world;
  std::vector<std::filesystem::path> plugin_path;
};

/// Adds `lint` to the program; parsing fills `options`, which must outlive `app`.
CLI::App* add_lint_command(CLI::App& app, LintOptions& options);

/// Prints what is odd about a world, a line each. Throws InputError where it cannot be loaded.
ExitCode lint_world(const LintOptions& options);

}  // namespace troupe::apps
