#pragma once

#include <cstdint>
#include <filesystem>

namespace troupe::worldio {

/// The result of a repair.
struct Repair {
  /// Whether the file had to be repaired, because its writer was killed or could not go on writing.
  bool needed = false;
  std::uint64_t frames = 0;  ///< number of complete frames, all of which are kept
};

/// Makes a recording that was cut off readable for ordinary HDF5 tools: marks it as closed and cuts every
/// array to the complete frames (recorded states of the world). The function works on a copy next to the file
/// and renames the copy when it is complete, so that the file is always either the old one or the new one. A
/// closed recording without incomplete frames is not changed. Throws Hdf5Error or std::runtime_error, with
/// the name of the file, if the file is not a recording, if nothing was ever flushed to it, if there is no
/// room for the copy, or if a process is still writing the file. A process on another machine, or one that
/// this user may not inspect, is not detected.
Repair repair_recording(const std::filesystem::path& file);

}  // namespace troupe::worldio
