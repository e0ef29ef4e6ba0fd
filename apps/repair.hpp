#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace troupe::apps {

/// Adds the options of `repair`; parsing fills `recording`, which must outlive `command`.
void add_repair_options(CLI::App& command, std::filesystem::path& recording);

/// `troupe repair`: makes the recording of a killed run readable for standard HDF5 tools, and prints how many
/// frames (recorded states) the recording contains. A recording that is readable already is not changed. If
/// the file is not a recording, is still being written or cannot be repaired, prints an error and returns
/// k_bad_input.
ExitCode repair(const std::filesystem::path& recording);

}  // namespace troupe::apps
