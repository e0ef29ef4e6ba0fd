#pragma once

#include "apps/diff/diff.hpp"
#include "apps/exit_code.hpp"

#include <filesystem>

namespace troupe::apps {

/// Whether a file starts with the HDF5 signature; false if the file cannot be read.
bool is_hdf5(const std::filesystem::path& file);

/// `troupe diff` for two recordings, which are HDF5 files with fields of the state over time. Compares the
/// ticks (time steps) that both files contain: the hash of the state, and the fields that both files
/// contain. Stops at the first tick that differs, and prints the result.
///
/// Returns k_failed if a tick differs, or if one recording ends too early; else k_finished. For example, a
/// recording of every 10th tick that ends at tick 100 ends too early if the other recording ends at tick 110
/// or later. Throws InputError if the files are not recordings, or if they cannot be compared.
ExitCode diff_recordings(const DiffOptions& options);

}  // namespace troupe::apps
