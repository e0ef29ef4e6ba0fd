#pragma once

#include "apps/exit_code.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own
class App;
}  // namespace CLI

namespace troupe::apps {

/// Options of `troupe replay`.
struct ReplayOptions {
  std::filesystem::path recording;
  std::filesystem::path page;       ///< file to write; empty: the recording's name with .html
  double max_mb = 25;               ///< largest size of the page, 10^6 bytes
  std::vector<std::string> fields;  ///< fields to show in addition to poses; empty: all recorded fields
  bool force = false;               ///< replace an existing page
};

/// Adds the options of `replay`; parsing fills `options`, which must outlive `command`.
void add_replay_options(CLI::App& command, ReplayOptions& options);

/// Writes a self-contained HTML page that plays the recording in a browser. Returns a description of the page
/// (robots, frames, size) as lines of text for the user. Prints warnings on standard error. Throws InputError
/// if the file is not a recording or does not have the data that the page needs, if the page exists (without
/// `force`), or if its folder is not writable; throws OutputError if writing fails.
std::string write_replay_page(const ReplayOptions& options);
/// `troupe replay RECORDING -o FILE.html`: calls write_replay_page() and prints its result. Returns k_failed
/// after printing an OutputError; passes an InputError on.
ExitCode replay(const ReplayOptions& options);

}  // namespace troupe::apps
