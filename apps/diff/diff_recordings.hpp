#pragma once

#include "apps/diff/diff.hpp"
#include "apps/exit_code.hpp"

#include <filesystem>

namespace troupe::apps {

/// Whether a file starts with the HDF5 signature; false if the file cannot be read.
bool is_hdf5(const std::filesystem::path& file);

/// `troupe diff` for two recordings: compares the ticks (simulation steps) that both files have, up to the
/// first tick that differs, and prints the result. Two ticks are compared by their state hashes and by the
/// fields that both files have. Returns k_failed if a tick differs, or if one recording ends earlier than the
/// other by at least one of its recording intervals; else k_finished. Throws InputError for files that are
/// not comparable recordings.
ExitCode diff_recordings(const DiffOptions& options);

}  // namespace troupe::apps
