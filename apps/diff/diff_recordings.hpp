#pragma once

#include "apps/diff/diff.hpp"
#include "apps/exit_code.hpp"

#include <filesystem>

namespace troupe::apps {

/// Whether a file starts with the HDF5 signature; false for one that cannot be read.
bool is_hdf5(const std::filesystem::path& file);

/// `troupe diff` of two recordings: frame by frame, up to the first that differs. Throws InputError.
ExitCode diff_recordings(const DiffOptions& options);

}  // namespace troupe::apps
