#pragma once

#include "worldio/results/recording_reader.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace troupe::worldio {

/// The options of replay_data().
struct ReplayOptions {
  std::size_t most_bytes =
      18000000;                     ///< maximum size of ReplayData::bytes; frames are omitted until it is met
  std::vector<std::string> fields;  ///< fields shown in addition to poses; empty: all recorded fields
};

/// A recording for a replay page: rounded, compressed, and with fewer frames if it would be too large.
struct ReplayData {
  std::string bytes;         ///< the data, in the format of docs/replay.md
  std::size_t robots = 0;    ///< number of bodies with a drive
  std::size_t others = 0;    ///< number of other bodies that can move, sense or decide, or be gripped
  std::size_t recorded = 0;  ///< number of frames in the recording
  std::size_t frames = 0;    ///< number of frames in the page
  std::size_t stride = 1;    ///< the page has every stride-th frame, and always the last
  double every_s = 0;        ///< simulated time from one frame of the page to the next
  bool at_rest = false;  ///< whether moving parts are drawn at rest, because their poses were not recorded
};

/// Makes the data of a replay page from a recording. Throws InputError if the recording has no poses or no
/// frames, if it lacks a field of `options`, or if not even two frames fit into the page. Throws Hdf5Error if
/// the recording cannot be read.
ReplayData replay_data(const RecordingReader& recording, const ReplayOptions& options);

}  // namespace troupe::worldio
