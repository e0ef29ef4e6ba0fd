#include "worldio/results/recording_repair.hpp"

#include "worldio/files.hpp"
#include "worldio/partial_file.hpp"
#include "worldio/results/descriptor.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/hdf5_torn.hpp"
#include "worldio/results/recording_reader.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

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

// The groups whose arrays have one row per frame.
constexpr std::array<const char*, 3> k_framed = {"frames", "state", "sensors"};

/// Returns the arrays of a recording that have one row per frame.
std::vector<Hdf5Dataset> framed_arrays(const Hdf5File& recording) {
  std::vector<Hdf5Dataset> arrays;
  for (const char* name : k_framed) {
    if (!recording.has_group(name)) continue;
    const Hdf5Group group = recording.group(name);
    for (const std::string& path : group.paths())
      if (!group.has_group(path)) arrays.push_back(group.dataset(path));
  }
  return arrays;
}

fs::path packed_copy(fs::path file) { return file.concat(".packed"); }

/// Whether every array of a recording has exactly `frames` rows. Throws Hdf5Error if the addresses of the
/// chunks of an array cannot be read: if such a file were continued, HDF5 would try to read them for years.
bool is_even(const Hdf5File& recording, std::size_t frames) {
  return std::ranges::all_of(framed_arrays(recording), [&](const Hdf5Dataset& array) {
    static_cast<void>(array.bytes_in_file());  // reads all addresses
    return array.rows() == frames;
  });
}

/// Gives an open file the owner, the group and the permission bits of the file `from`, as far as the system
/// allows it.
void copy_rights(const fs::path& from, const Descriptor& to) {
  if (const std::optional<FileRights> rights = rights_of(from)) set_rights(to.get(), *rights);
}

/// Replaces a recording, which must not be a symbolic link, by a copy of its content with the same owner and
/// permission bits, which is first written to the file `packed`. Returns false, and leaves the recording as
/// it is, if it cannot be copied.
bool replace_by_content(const fs::path& file, const fs::path& packed) {
  std::optional<Hdf5File> into;
  std::error_code ignored;
  try {
    const Hdf5File from = Hdf5File::open(file);
    into = Hdf5File::create(packed);
    into->copy_content(from);
    into->flush();
    into->close();
    copy_rights(file, Descriptor(packed, O_WRONLY | O_NOFOLLOW));
    fs::rename(packed, file);
    return true;
  } catch (const std::runtime_error&) {  // Hdf5Error, or the error of rename()
    if (into) into->abandon();
    fs::remove(packed, ignored);
    return false;
  }
}

/// Copies a file with its owner and permission bits to a new file. Throws std::system_error.
/// std::filesystem::copy_file() would report a full disk as an "input/output error".
void copy_bytes(const fs::path& from, const fs::path& to) {
  constexpr std::size_t k_piece_bytes = std::size_t{1} << 20;
  const auto check = [](ssize_t result) {
    if (result < 0) throw std::system_error(errno, std::generic_category());
    return static_cast<std::size_t>(result);
  };
  const Descriptor in(from, O_RDONLY);
  check(in.get());
  const Descriptor out(to, O_WRONLY | O_CREAT | O_EXCL, S_IRUSR | S_IWUSR);
  check(out.get());
  std::vector<char> piece(k_piece_bytes);
  while (const std::size_t bytes = check(::read(in.get(), piece.data(), piece.size())))
    for (std::size_t done = 0; done < bytes;)
      done += check(::write(out.get(), piece.data() + done, bytes - done));
  copy_rights(from, out);
}

/// Repairs a file in place. Returns the number of its complete frames.
std::uint64_t repair_copy(const fs::path& copy) {
  const std::optional<Hdf5Superblock> head = read_superblock(copy);
  close_superblock(copy);
  // Without the mark of SWMR mode, the writer has not overwritten any metadata, and its file may be so
  // incomplete that HDF5 must not look for objects in it.
  const bool is_torn =
      head && head->swmr_writing() && mend_torn_metadata(copy, Hdf5File::open(copy).header_addresses()) > 0;
  const std::size_t frames = RecordingReader(copy).frames();
  Hdf5File hdf5 = Hdf5File::open_to_write(copy);
  for (Hdf5Dataset& array : framed_arrays(hdf5))
    if (array.rows() != frames) array.resize(frames);
  hdf5.flush();
  hdf5.close();
  if (is_torn || has_much_unused_space(Hdf5File::open(copy))) replace_by_content(copy, packed_copy(copy));
  if (RecordingReader(copy).frames() != frames || !is_even(Hdf5File::open(copy), frames))
    throw Hdf5Error(fmt::format(
        "{}: error: cannot be repaired: some arrays in the file have more frames than others, and cannot be "
        "shortened, because the file is damaged",
        copy.string()));
  return frames;
}

}  // namespace

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

bool has_much_unused_space(const Hdf5File& recording) {
  constexpr std::uint64_t k_least_bytes = std::uint64_t{1} << 20;
  try {
    const std::uint64_t unused = recording.unused_bytes();
    return unused > k_least_bytes && unused > fs::file_size(recording.file_name()) / 8;
  } catch (const Hdf5Error&) {
    return false;
  }
}

bool remove_unused_space(const fs::path& file) {
  try {
    const PartialFile turn(file);  // reserves a name for the copy, as in repair_recording()
    const fs::path packed = packed_copy(turn.path());
    std::error_code ignored;
    fs::remove(packed, ignored);
    return replace_by_content(turn.target(), packed);
  } catch (const std::system_error&) {
    return false;
  }
}

std::optional<std::uint64_t> frames_without_repair(const fs::path& file) {
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
    const Hdf5File recording = Hdf5File::open(file);
    if (is_even(recording, frames) && !has_much_unused_space(recording)) return frames;
  }
  if (const std::optional<std::string> writer = writer_of(file))
    throw Hdf5Error(
        fmt::format("{}: error: process {} is still writing the file: there is nothing to repair yet",
                    file.string(), *writer));
  return std::nullopt;
}

Repair repair_recording(const fs::path& file) {
  if (const std::optional<std::uint64_t> frames = frames_without_repair(file)) return {false, *frames};
  fs::path copy;
  std::error_code ignored;
  try {
    // `turn` reserves a name for the copy: a second repair at the same time gets another name, and thus makes
    // another copy. The copy is a file in addition to `turn`, because both PartialFile and HDF5 lock their
    // file. Copies that a killed repair left are removed, and so are links with their names, through which
    // another user of the folder could make root write into any file.
    const PartialFile turn(file);
    copy = fs::path(turn.path()).concat(".copy");
    for (const fs::path& left : {copy, packed_copy(copy)}) fs::remove(left, ignored);
    copy_bytes(file, copy);
    const std::uint64_t frames = repair_copy(copy);
    fs::rename(copy, turn.target());
    return {true, frames};
  } catch (const std::system_error& error) {
    fs::remove(copy, ignored);
    throw Hdf5Error(fmt::format("{}: error: cannot be repaired: {}", file.string(), error.code().message()));
  } catch (const std::runtime_error& error) {  // the message must name the file, not the copy
    fs::remove(copy, ignored);
    throw Hdf5Error(error_about(error.what(), copy, file));
  } catch (...) {
    fs::remove(copy, ignored);
    throw;
  }
}

}  // namespace troupe::worldio
