#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps {

struct LintOptions {
  std::filesystem::path world;                           ///< world file to check
  std::vector<std::pair<std::string, std::string>> set;  ///< JSON pointers to values of the world, new values
  KindSources sources;  ///< plug-ins and scripts with which the world will run
};

/// Adds the options of `lint`; parsing fills `options`, which must outlive `command`.
void add_lint_options(CLI::App& command, LintOptions& options);

/// `troupe lint`: prints each likely mistake in a world as one line, and then the number of mistakes. Returns
/// k_failed if there are any, else k_finished. Throws InputError if the world cannot be loaded.
ExitCode lint_world(const LintOptions& options);

}  // namespace troupe::apps
