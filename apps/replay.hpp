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

/// What the command line of `troupe replay` asks for.
struct ReplayOptions {
  std::filesystem::path recording;
  std::filesystem::path page;       ///< empty: as the recording, with .html
  double max_mb = 25;               ///< of the page, in 10^6 bytes
  std::vector<std::string> fields;  ///< beside poses; empty: all that was recorded
  bool force = false;               ///< replace a page that is there already
};

/// Adds the options of `replay`; parsing fills `options`, which must outlive `command`.
void add_replay_options(CLI::App& command, ReplayOptions& options);

/// `troupe replay RECORDING -o FILE.html`: writes a page that plays the recording in a browser, by itself.
/// Throws InputError for a recording that has not what it takes.
ExitCode replay(const ReplayOptions& options);

}  // namespace troupe::apps
