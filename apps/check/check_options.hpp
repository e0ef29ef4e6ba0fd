#pragma once

#include "apps/options.hpp"

#include <cstdint>
#include <vector>

namespace troupe::apps {

/// Options of `troupe check`, which simulates a world in several variants and compares their states. There is
/// one variant for each combination of a number of threads, a tile size and a number of ranks. Some of the
/// other options add variants.
///
/// Tiles are squares of the world, by which robots are grouped into tasks for the worker threads. Ranks are
/// groups of threads; each rank computes some of the robots. A tick is a time step.
struct CheckOptions : WorldCommandOptions {
  std::vector<unsigned> threads{1, 2, 8};  ///< numbers of worker threads per rank to compare
  /// Edge lengths of the tiles to compare, m. 0 means that the program chooses the edge length. The default
  /// 1.7 m is less than the range of most sensors, and so tests beams that cross several tiles.
  std::vector<double> tile_sizes_m{0, 1.7};
  /// Numbers of ranks to compare.
  std::vector<unsigned> ranks{1};
  /// Also check three variants. In each tick, the first variant discards all data that are not part of the
  /// state, such as caches. The second variant builds the world again from its state. The third variant moves
  /// the data of each body to another place in memory.
  bool amnesia = false;
  /// Also check a variant in which each device gets no data of bodies beyond its reach. The reach is the
  /// largest distance at which the device may read other bodies; its implementation declares it. Not possible
  /// with --raytracer grid.
  bool reach = false;
  bool controllers = false;  ///< also repeat each decision of the controllers, and compare the results
};

/// Adds the options of `check`; parsing fills `options`, which must outlive `command`.
void add_check_options(CLI::App& command, CheckOptions& options);

}  // namespace troupe::apps
