#pragma once

#include "apps/options.hpp"

#include <vector>

namespace troupe::apps {

/// Options of `troupe check`.
struct CheckOptions : WorldOptions {
  std::vector<unsigned> threads{1, 2, 8};
  /// Edge lengths of tiles, m; 0: the automatic choice. The default of 1.7 m is less than the range of most
  /// sensors, so that their beams cross several tiles.
  std::vector<double> tile_sizes_m{0, 1.7};
  bool amnesia = false;
  bool reach = false;
  bool controllers = false;
};

/// Adds the options of `check`; parsing fills `options`, which must outlive `command`.
void add_check_options(CLI::App& command, CheckOptions& options);

}  // namespace troupe::apps
