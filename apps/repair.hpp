#pragma once

#include "apps/cli_app.hpp"
#include "apps/exit_code.hpp"

#include <filesystem>

namespace troupe::apps {

/// Adds the options of `repair`; parsing fills `recording`, which must outlive `command`.
void add_repair_options(CLI::App& command, std::filesystem::path& recording);

/// `troupe repair`: makes the recording of a killed run readable for standard HDF5 tools, and prints the
/// number of its frames (recorded states). A recording that is readable already is not changed. Prints an
/// error and returns k_bad_input if the file is not a recording, is still being written or cannot be
/// repaired.
ExitCode repair(const std::filesystem::path& recording);

}  // namespace troupe::apps
