#pragma once

#include "worldio/results/recording_reader.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace troupe::worldio {

struct ReplayOptions {
  std::size_t most_bytes = 18000000;  ///< limit of ReplayData::bytes: frames are left out until it holds
  std::vector<std::string> fields;    ///< shown in addition to poses; empty: all that were recorded
};

/// A recording for a replay page: rounded, compressed, and with fewer frames if it would be too large.
struct ReplayData {
  std::string bytes;         ///< docs/replay.md
  std::size_t robots = 0;    ///< bodies that drive
  std::size_t others = 0;    ///< other bodies that can move, sense or decide, or be gripped
  std::size_t recorded = 0;  ///< frames of the recording
  std::size_t frames = 0;    ///< frames in the page
  std::size_t stride = 1;    ///< the page has every stride-th frame, and always the last
  double every_s = 0;        ///< time from frame to frame
  bool at_rest = false;      ///< parts that move are drawn at rest: their poses were not recorded
};

/// Throws InputError if the recording lacks what a page needs or a field of `options`, or if not even two
/// frames fit; Hdf5Error if it cannot be read.
ReplayData replay_data(const RecordingReader& recording, const ReplayOptions& options);

}  // namespace troupe::worldio
