#pragma once

#include "worldio/results/recording_reader.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace troupe::worldio {

struct ReplayOptions {
  /// Maximum size of ReplayData::bytes, bytes. Frames are omitted until the data fit.
  std::size_t most_bytes = 18000000;
  /// Names of the fields or components to show, such as "ranges" or "stall"; plan_replay() describes these
  /// names. Empty: all recorded fields.
  std::vector<std::string> fields;
};

/// A recording as data for a replay page, an HTML file that shows the recording. The numbers are rounded and
/// compressed. If the data would be too large, frames (recorded states of the world) are omitted.
struct ReplayData {
  std::string bytes;         ///< the data, in the format of docs/replay.md
  std::size_t robots = 0;    ///< number of bodies with a drive
  std::size_t others = 0;    ///< number of recorded bodies without a drive
  std::size_t recorded = 0;  ///< number of frames in the recording
  std::size_t frames = 0;    ///< number of frames in the page
  std::size_t stride = 1;    ///< the page has every stride-th frame, and always the last frame
  /// Simulated time between the first two frames of the page, s; 0 if the page has only one frame.
  double every_s = 0;
  /// Whether moving parts of bodies are drawn where the world file places them, because the displacements of
  /// their joints were not recorded.
  bool at_rest = false;
};

/// Makes the data of a replay page from a recording. Throws InputError if the recording has no poses, no
/// complete frame or no recorded body, if a name in options.fields selects nothing recorded, or if not even
/// two frames fit into options.most_bytes. Throws Hdf5Error if the recording cannot be read.
ReplayData replay_data(const RecordingReader& recording, const ReplayOptions& options);

}  // namespace troupe::worldio
