#pragma once

#include "apps/cli_app.hpp"
#include "apps/exit_code.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe::apps {

/// Options of `troupe replay`, which writes an HTML page that plays a recording (file with the state of a run
/// over time).
struct ReplayOptions {
  std::filesystem::path recording;
  std::filesystem::path page;       ///< file to write; empty: name of the recording, but ending in .html
  double max_mb = 25;               ///< largest size of the page, 10^6 bytes
  std::vector<std::string> fields;  ///< fields to show in addition to poses; empty: all recorded fields
  bool force = false;               ///< replace an existing page
};

/// Adds the options of `replay`; parsing fills `options`, which must outlive `command`.
void add_replay_options(CLI::App& command, ReplayOptions& options);

/// Writes an HTML page that plays the recording in a browser. The page needs no other file. Returns lines of
/// text for the user, which describe the page: robots, frames and size. Prints warnings on standard error.
///
/// Throws InputError, and writes nothing, if the file is not a recording or does not have the data that the
/// page needs. Also throws InputError if the page exists and `force` is false, or if the page cannot be
/// created in its folder. Throws OutputError if writing fails.
std::string write_replay_page(const ReplayOptions& options);
/// `troupe replay RECORDING -o FILE.html`: calls write_replay_page() and prints its result. After an
/// OutputError, prints the error and returns k_failed. Passes an InputError on.
ExitCode replay(const ReplayOptions& options);

}  // namespace troupe::apps
