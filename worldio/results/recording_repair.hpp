#pragma once

#include "worldio/results/hdf5_file.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace troupe::worldio {

/// The result of repair_recording().
struct Repair {
  /// Whether the file was repaired. False: the file was closed, had only complete frames and had little
  /// unused space.
  bool needed = false;
  std::uint64_t frames = 0;  ///< number of complete frames, all of which are kept
};

/// Returns the id of a process on this machine that has the file open for writing; std::nullopt if none is
/// found. Processes that this user may not inspect are never found.
std::optional<std::string> writer_of(const std::filesystem::path& file);

/// Whether more than an eighth of a recording, and more than 1 MiB, is unused space. HDF5 does not use the
/// space of removed frames again. Returns false if the space is unknown, because another program added
/// objects to the recording that have several paths or cannot be opened.
bool has_much_unused_space(const Hdf5File& recording);

/// Replaces a closed recording by a copy of its content, which has no unused space. No object of the file may
/// be open. Returns false, and leaves the recording as it is, if it cannot be copied: because the disk is
/// full, because no file can be created beside the recording, or because another program added an object that
/// cannot be copied.
bool remove_unused_space(const std::filesystem::path& file);

/// Returns the number of frames of a recording that repair_recording() would leave as it is; std::nullopt if
/// the recording must be repaired. Changes nothing. Throws the errors that repair_recording() throws before
/// it makes a copy: the file is not a recording, nothing was ever flushed to it, or a process is still
/// writing it.
std::optional<std::uint64_t> frames_without_repair(const std::filesystem::path& file);

/// Makes a recording that was cut off readable for ordinary HDF5 tools. The function marks the file as closed
/// and removes incomplete frames from all arrays. A frame is the recorded state of the world at one time. If
/// the file has much unused space, the function also tries to remove this space. A closed recording without
/// incomplete frames and with little unused space is not changed.
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
