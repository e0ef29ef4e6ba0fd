#pragma once

#include "apps/options.hpp"

#include <cstdint>
#include <vector>

namespace troupe::apps {

/// Options of `troupe check`.
struct CheckOptions : WorldOptions {
  std::vector<unsigned> threads{1, 2, 8};  ///< numbers of threads, each of which is a variant
  /// Edge lengths of tiles, m, each of which is a variant; 0: the automatic choice. The default of 1.7 m is
  /// less than the range of most sensors, so that their beams cross several tiles.
  std::vector<double> tile_sizes_m{0, 1.7};
  std::vector<unsigned> ranks{1};  ///< numbers of ranks, each of which is a variant
  /// Also check variants that, in each tick, discard caches, rebuild the world or shuffle the order of the
  /// bodies in the state tables.
  bool amnesia = false;
  bool reach = false;        ///< also check a variant in which devices cannot see bodies beyond their reach
  bool controllers = false;  ///< also repeat each decision of the controllers and compare the results
};

/// Adds the options of `check`; parsing fills `options`, which must outlive `command`.
void add_check_options(CLI::App& command, CheckOptions& options);

}  // namespace troupe::apps
