#pragma once

#include "apps/cli_app.hpp"
#include "apps/exit_code.hpp"

#include <filesystem>

namespace troupe::apps {

/// Options of `troupe diff`, which compares two files. A hash log is a text file with hashes of the state
/// after each tick (time step). A recording is an HDF5 file with fields of the state over time.
struct DiffOptions {
  std::filesystem::path first;   ///< a hash log or a recording; argument A
  std::filesystem::path second;  ///< another file of the same type; argument B
  bool across_domains = false;   ///< allow different versions, compilers, flags and instruction sets
  bool across_runs = false;      ///< allow different worlds, seeds and options
};

/// Adds the options of `diff`; parsing fills `options`, which must outlive `command`.
void add_diff_options(CLI::App& command, DiffOptions& options);

/// `troupe diff`: compares two hash logs or two recordings tick by tick. Stops at the first tick that
/// differs, and prints the result on standard output. Returns k_finished if all compared data are equal bit
/// for bit, and k_failed if there is a difference. Throws InputError if the files cannot be compared.
ExitCode diff(const DiffOptions& options);

}  // namespace troupe::apps
