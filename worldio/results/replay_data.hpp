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
  std::vector<std::string> fields;  ///< entries as for plan_replay(); empty: all recorded fields
};

/// A recording for a replay page: rounded, compressed, and with fewer frames if it would be too large.
struct ReplayData {
  std::string bytes;         ///< the data, in the format of docs/replay.md
  std::size_t robots = 0;    ///< number of bodies with a drive
  std::size_t others = 0;    ///< number of the other bodies in RecordingReader::ids()
  std::size_t recorded = 0;  ///< number of frames in the recording
  std::size_t frames = 0;    ///< number of frames in the page
  std::size_t stride = 1;    ///< the page has every stride-th frame, and always the last frame
  double every_s = 0;        ///< simulated time between the first two frames of the page, s; 0: one frame
  bool at_rest = false;  ///< whether moving parts are drawn at rest, because their poses were not recorded
};

/// Makes the data of a replay page from a recording. Throws InputError if the recording has no poses, no
/// complete frame or no recorded body, if a name in options.fields selects nothing recorded, or if not even
/// two frames fit into options.most_bytes. Throws Hdf5Error if the recording cannot be read.
ReplayData replay_data(const RecordingReader& recording, const ReplayOptions& options);

}  // namespace troupe::worldio
