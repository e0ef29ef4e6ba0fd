#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace troupe::apps {

/// Options of `troupe lint`.
struct LintOptions {
  std::filesystem::path world;
  std::vector<std::filesystem::path> plugin_path;
};

/// Adds the options of `lint`; parsing fills `options`, which must outlive `command`.
void add_lint_options(CLI::App& command, LintOptions& options);

/// `troupe lint`: prints the findings about a world, one line each. Throws InputError if it cannot be loaded.
ExitCode lint_world(const LintOptions& options);

}  // namespace troupe::apps
