#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace troupe::apps {

/// Adds `repair` to the program; parsing fills `recording`, which must outlive `app`.
CLI::App* add_repair_command(CLI::App& app, std::filesystem::path& recording);

/// `troupe repair`: makes a recording that was cut off readable for plain tools, and says what it kept.
ExitCode repair(const std::filesystem::path& recording);

}  // namespace troupe::apps
