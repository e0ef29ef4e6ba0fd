#pragma once

#include "apps/diff/diff.hpp"
#include "apps/exit_code.hpp"

#include <filesystem>

namespace troupe::apps {

/// Whether a file starts with the HDF5 signature; false if the file cannot be read.
bool is_hdf5(const std::filesystem::path& file);

/// `troupe diff` for two recordings: compares the ticks that both files have, up to the first that differs,
/// and prints the result. Of a tick, compares the state hash and the fields that both files have. Returns
/// k_finished if they are the same and neither recording ends one of its intervals or more before the other,
/// else k_failed. Throws InputError for files that are not comparable recordings.
ExitCode diff_recordings(const DiffOptions& options);

}  // namespace troupe::apps
