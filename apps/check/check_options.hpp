#pragma once

#include "apps/options.hpp"

#include <cstdint>
#include <vector>

namespace troupe::apps {

/// Options of `troupe check`, which runs a world in several variants and compares their states. There is one
/// variant for each combination of a number of threads, a tile size and a number of ranks.
struct CheckOptions : WorldOptions {
  std::vector<unsigned> threads{1, 2, 8};  ///< numbers of worker threads to compare
  /// Edge lengths of the tiles (squares of the world that threads process) to compare, m; 0: the automatic
  /// choice. The default of 1.7 m is less than the range of most sensors, so that their beams cross several
  /// tiles.
  std::vector<double> tile_sizes_m{0, 1.7};
  /// Numbers of ranks (groups of threads that divide the robots among themselves) to compare.
  std::vector<unsigned> ranks{1};
  /// Also check variants that, in each tick (simulation step), discard caches, rebuild the world or shuffle
  /// the order of the bodies in the state tables.
  bool amnesia = false;
  /// Also check a variant in which devices cannot see bodies beyond their reach. The reach is the distance up
  /// to which a device needs to see other bodies, according to the code that implements it.
  bool reach = false;
  bool controllers = false;  ///< also repeat each decision of the controllers and compare the results
};

/// Adds the options of `check`; parsing fills `options`, which must outlive `command`.
void add_check_options(CLI::App& command, CheckOptions& options);

}  // namespace troupe::apps
