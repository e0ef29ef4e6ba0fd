#pragma once

#include "apps/options.hpp"

#include <vector>

namespace troupe::apps {

/// What the command line of `troupe check` asks for.
struct CheckOptions : WorldOptions {
  std::vector<unsigned> threads{1, 2, 8};
  /// m; 0: as the world chooses. 1.7 is smaller than most sensors reach, so that all look into other tiles.
  std::vector<double> tile_sizes_m{0, 1.7};
  bool amnesia = false;
  bool controllers = false;
};

/// Adds the options of `check`; parsing fills `options`, which must outlive `command`.
void add_check_options(CLI::App& command, CheckOptions& options);

}  // namespace troupe::apps
