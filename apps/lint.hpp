#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace troupe::apps {

/// Adds `lint` to the program; parsing fills `world`, which must outlive `app`.
CLI::App* add_lint_command(CLI::App& app, std::filesystem::path& world);

/// Prints what is odd about a world, a line each. Throws InputError where it cannot be loaded.
ExitCode lint_world(const std::filesystem::path& world);

}  // namespace troupe::apps
