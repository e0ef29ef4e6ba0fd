#pragma once

#include "apps/diff/diff.hpp"
#include "apps/exit_code.hpp"

#include <filesystem>

namespace troupe::apps {

/// Whether a file starts with the HDF5 signature; false if the file cannot be read.
bool is_hdf5(const std::filesystem::path& file);

/// `troupe diff` for two recordings: compares them up to the first frame that differs and prints the result.
/// Returns k_finished if the compared ticks and fields, those that both files have, are the same and both
/// recordings have the same end, else k_failed. Throws InputError for files that are not comparable
/// recordings.
ExitCode diff_recordings(const DiffOptions& options);

}  // namespace troupe::apps
