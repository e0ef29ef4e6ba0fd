#pragma once

#include "apps/exit_code.hpp"

#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}

namespace troupe::apps {

/// Options of `troupe diff`.
struct DiffOptions {
  std::filesystem::path first;   ///< hash log or recording, named A in --help
  std::filesystem::path second;  ///< file of the same type, named B in --help
  bool across_domains = false;   ///< compare even if versions, compilers, flags or instruction sets differ
  bool across_runs = false;      ///< compare even if worlds, seeds or options differ
};

/// Adds the options of `diff`; parsing fills `options`, which must outlive `command`.
void add_diff_options(CLI::App& command, DiffOptions& options);

/// `troupe diff`: compares two hash logs (text files with a hash of the state after each simulation step) or
/// two recordings up to the first step that differs, and prints the result on standard output. Returns
/// k_finished if all compared data are equal bit for bit, k_failed if there is a difference, and k_bad_input
/// after printing an error.
ExitCode diff(const DiffOptions& options);

}  // namespace troupe::apps
