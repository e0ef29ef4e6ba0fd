#include "worldio/results/recording_repair.hpp"

#include "worldio/files.hpp"
#include "worldio/partial_file.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/recording_reader.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>

namespace troupe::worldio {
namespace fs = std::filesystem;
namespace {

/// Whether a process opened a file descriptor for writing. Reads the flags in Linux's /proc/PID/fdinfo/FD.
bool opened_to_write(const fs::path& process, const fs::path& descriptor) {
  std::ifstream info(process / "fdinfo" / descriptor.filename());
  for (std::string key, value; info >> key >> value;)
    if (key == "flags:") return (std::stoul(value, nullptr, 8) & O_ACCMODE) != O_RDONLY;
  return false;
}

/// Returns the id of a process on this machine that has the file open for writing. Empty if none is found;
/// processes that this user may not inspect are never found.
std::optional<std::string> writer_of(const fs::path& file) {
  struct stat wanted {};
  if (stat(file.c_str(), &wanted) != 0) return std::nullopt;
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    const std::string id = process.path().filename().string();
    if (id.find_first_not_of("0123456789") != id.npos) continue;
    std::error_code hidden;
    for (fs::directory_iterator descriptor(process.path() / "fd", hidden), end; !hidden && descriptor != end;
         descriptor.increment(hidden)) {
      struct stat open {};
      if (stat(descriptor->path().c_str(), &open) == 0 && open.st_dev == wanted.st_dev &&
          open.st_ino == wanted.st_ino && opened_to_write(process.path(), descriptor->path()))
        return id;
    }
  }
  return std::nullopt;
}

/// Removes the incomplete frames from every array in the group and in the groups inside it: `frames` rows
/// remain.
void cut(const Hdf5Group& group, std::size_t frames) {
  for (const std::string& name : group.names()) {
    if (group.has_group(name)) {
      cut(group.group(name), frames);
    } else if (Hdf5Dataset dataset = group.dataset(name); dataset.rows() != frames) {
      dataset.resize(frames);
    }
  }
}

/// Whether every array in the group and in the groups inside it has exactly `frames` rows.
bool has_only(const Hdf5Group& group, std::size_t frames) {
  return std::ranges::all_of(group.names(), [&](const std::string& name) {
    return group.has_group(name) ? has_only(group.group(name), frames) : group.dataset(name).rows() == frames;
  });
}

// The groups whose arrays have one row per frame.
constexpr std::array<const char*, 3> k_framed = {"frames", "state", "sensors"};

/// Whether every array in the groups k_framed of a recording has exactly `frames` rows.
bool is_even(const fs::path& file, std::size_t frames) {
  const Hdf5File hdf5 = Hdf5File::open(file);
  return std::ranges::all_of(k_framed, [&](const char* name) {
    return !hdf5.has_group(name) || has_only(hdf5.group(name), frames);
  });
}

/// Repairs a file in place. Returns the number of its complete frames.
std::uint64_t repair_copy(const fs::path& copy) {
  close_superblock(copy);
  const std::size_t frames = RecordingReader(copy).frames();
  Hdf5File hdf5 = Hdf5File::open_to_write(copy);
  for (const char* name : k_framed)
    if (hdf5.has_group(name)) cut(hdf5.group(name), frames);
  hdf5.flush();
  hdf5.close();
  if (RecordingReader(copy).frames() != frames || !is_even(copy, frames))
    throw Hdf5Error(fmt::format(
        "{}: error: cannot be repaired: some arrays in the file have more frames than others, and cannot be "
        "shortened, because the file is damaged",
        copy.string()));
  return frames;
}

}  // namespace

Repair repair_recording(const fs::path& file) {
  if (const Result<> readable = check_readable(file); !readable)
    throw Hdf5Error(fmt::format("{}: error: {}", file.string(), readable.error().text));
  const std::optional<Hdf5Superblock> head = read_superblock(file);
  if (!head)
    throw Hdf5Error(
        fmt::format("{}: error: has no complete HDF5 header: the file is not a recording, or was cut off "
                    "before its first frame",
                    file.string()));
  if (!head->writing()) {
    const std::size_t frames = RecordingReader(file).frames();
    if (is_even(file, frames)) return {false, frames};
  }
  if (const std::optional<std::string> writer = writer_of(file))
    throw Hdf5Error(
        fmt::format("{}: error: process {} is still writing the file: there is nothing to repair yet",
                    file.string(), *writer));

  fs::path copy;
  std::error_code ignored;
  try {
    // `turn` reserves a name for the copy: a second repair at the same time gets another name, and thus makes
    // another copy. The copy is a file in addition to `turn`, because both PartialFile and HDF5 lock their
    // file. A copy that a killed repair left is overwritten.
    const PartialFile turn(file);
    copy = fs::path(turn.path()).concat(".copy");
    fs::copy_file(file, copy, fs::copy_options::overwrite_existing);
    const std::uint64_t frames = repair_copy(copy);
    fs::rename(copy, file);
    return {true, frames};
  } catch (const std::system_error& error) {
    fs::remove(copy, ignored);
    throw Hdf5Error(fmt::format("{}: error: cannot be repaired: {}", file.string(), error.code().message()));
  } catch (const Hdf5Error& error) {  // the message must name the file, not the copy
    fs::remove(copy, ignored);
    throw Hdf5Error(file.string() + std::string(error.what()).substr(copy.string().size()));
  } catch (...) {
    fs::remove(copy, ignored);
    throw;
  }
}

}  // namespace troupe::worldio
