#pragma once

#include <cstdint>
#include <filesystem>

namespace troupe::worldio {

/// What became of a recording.
struct Repair {
  bool needed = false;       ///< its writer had been killed, or could not write any further
  std::uint64_t frames = 0;  ///< whole ones, all of which are kept
};

/// Makes a recording that was cut off one that plain tools read: closed, and every array as long as there are
/// whole frames. Works on a copy beside the file and renames it when it is whole, so that whatever happens
/// meanwhile the file is the old one or the new. One that was closed is left alone.
/// Throws Hdf5Error, or std::runtime_error with the file's name: no recording, nothing flushed, no room for
/// the copy, or a program that is still writing it.
Repair repair_recording(const std::filesystem::path& file);

}  // namespace troupe::worldio
