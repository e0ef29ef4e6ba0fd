#pragma once

#include <cstdint>
#include <filesystem>

namespace troupe::worldio {

/// The result of a repair.
struct Repair {
  bool needed = false;       ///< its writer was killed, or could not write any more
  std::uint64_t frames = 0;  ///< complete frames; all of them are kept
};

/// Makes a recording that was cut off readable for plain tools: marks it as closed and cuts every array to
/// the complete frames. Works on a copy next to the file and renames it when it is complete, so that the file
/// is always the old one or the new one. Does not change a closed recording without incomplete frames.
/// Throws Hdf5Error or std::runtime_error, with the file's name, if the file is not a recording, nothing was
/// flushed, there is no room for the copy, or a program is still writing the file.
Repair repair_recording(const std::filesystem::path& file);

}  // namespace troupe::worldio
