#pragma once

#include "worldio/results/recording_reader.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace troupe::worldio {

struct ReplayOptions {
  std::size_t most_bytes = 18000000;  ///< of ReplayData::bytes: frames are left out until they fit
  std::vector<std::string> fields;    ///< what is shown beside poses; empty: all that was recorded
};

/// A recording as a page plays it: rounded, compressed, and thinned where it would be too large.
struct ReplayData {
  std::string bytes;         ///< docs/replay.md
  std::size_t robots = 0;    ///< bodies that drive
  std::size_t others = 0;    ///< that move, sense or decide, or can be gripped
  std::size_t recorded = 0;  ///< frames of the recording
  std::size_t frames = 0;    ///< of these in the page
  std::size_t stride = 1;    ///< every how many: 1 is all; the last one is always there
  double every_s = 0;        ///< from frame to frame
  bool at_rest = false;      ///< parts that move are drawn at rest: their poses were not recorded
};

/// Throws InputError for a recording without what a page needs, for fields that it does not hold, and where
/// not even two frames fit; Hdf5Error for what cannot be read.
ReplayData replay_data(const RecordingReader& recording, const ReplayOptions& options);

}  // namespace troupe::worldio
