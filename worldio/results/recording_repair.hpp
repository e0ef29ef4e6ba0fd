#pragma once

#include <cstdint>
#include <filesystem>

namespace troupe::worldio {

/// The result of repair_recording().
struct Repair {
  /// Whether the file was repaired. False: the file was closed and had only complete frames.
  bool needed = false;
  std::uint64_t frames = 0;  ///< number of complete frames, all of which are kept
};

/// Makes a recording that was cut off readable for ordinary HDF5 tools. The function marks the file as closed
/// and removes incomplete frames from all arrays. A frame is the recorded state of the world at one time. A
/// closed recording without incomplete frames is not changed.
///
/// The function works on a copy next to the file. When the copy is complete, the function renames it to the
/// name of the file. At every moment, the file is therefore either the old one or the repaired one.
///
/// Throws Hdf5Error or std::runtime_error, with the name of the file, if
/// - the file is not a recording, or is damaged beyond repair,
/// - nothing was ever flushed to the file,
/// - there is no room for the copy, or
/// - a process is still writing the file.
///
/// A process on another machine, or one that this user may not inspect, is not detected.
Repair repair_recording(const std::filesystem::path& file);

}  // namespace troupe::worldio
