#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"

#include <cstdint>
#include <filesystem>

namespace troupe::apps {

/// What the command line of `troupe view` asks for.
struct ViewOptions : WorldOptions {
  std::uint16_t port = 0;
  double rate = 1;               ///< times real time, at most; 0: as fast as possible
  std::filesystem::path folder;  ///< of what is written; empty: the one that it is called in
  bool open = false;             ///< a browser is opened
};

/// Adds the options of `view`; parsing fills `options`, which must outlive `command`.
void add_view_options(CLI::App& command, ViewOptions& options);
/// Shows a world in browsers until Ctrl-C.
ExitCode view_world(const ViewOptions& options);

}  // namespace troupe::apps
