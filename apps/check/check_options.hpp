#pragma once

#include "apps/options.hpp"

#include <cstdint>
#include <vector>

namespace troupe::apps {

/// Options of `troupe check`, which runs a world in several variants and compares their states.
struct CheckOptions : WorldOptions {
  std::vector<unsigned> threads{1, 2, 8};  ///< numbers of threads, each of which is a variant
  /// Edge lengths of tiles, m, each of which is a variant; 0: the automatic choice. The default of 1.7 m is
  /// less than the range of most sensors, so that their beams cross several tiles.
  std::vector<double> tile_sizes_m{0, 1.7};
  /// Numbers of ranks (groups of threads that divide the robots among them), each of which is a variant.
  std::vector<unsigned> ranks{1};
  /// Also check variants that, in each tick, discard caches, rebuild the world or shuffle the order of the
  /// bodies in the state tables.
  bool amnesia = false;
  /// Also check a variant in which devices cannot see bodies beyond their reach, the distance up to which
  /// their kinds declare to read other bodies.
  bool reach = false;
  bool controllers = false;  ///< also repeat each decision of the controllers and compare the results
};

/// Adds the options of `check`; parsing fills `options`, which must outlive `command`.
void add_check_options(CLI::App& command, CheckOptions& options);

}  // namespace troupe::apps
