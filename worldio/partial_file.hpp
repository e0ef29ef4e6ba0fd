#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// A file that is written under a temporary name in the folder of its final one: `NAME.partial`, or
/// `NAME.2.partial`, `NAME.3.partial`, ... if several writers write NAME at the same time. A writer holds a
/// lock (flock) on its partial file until it renames or removes it. An unlocked partial file was left by a
/// killed writer; the next writer of NAME reuses it. On file systems without locks the temporary name
/// contains the process id, and the partial file of a killed writer remains.
///
/// All functions throw std::system_error. If NAME exists, it must be a regular file.
class PartialFile {
 public:
  /// Creates an empty partial file for `file`. `ending` is appended to the temporary name, for programs that
  /// choose a format by it: ".mp4".
  explicit PartialFile(std::filesystem::path file, std::string_view ending = {});
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  /// Removes the partial file, unless commit() renamed it.
  ~PartialFile();

  const std::filesystem::path& path() const { return partial_; }  ///< the temporary name
  /// Open for writing. A process that inherits it shares the lock.
  int descriptor() const { return descriptor_; }
  void write(std::span<const std::byte> bytes);
  /// Flushes the written bytes to the disk (fsync).
  void sync();
  /// Renames the partial file to its final name, replacing any existing file.
  void commit();

 private:
  enum class Taken : char { yes, no, no_locks };
  Taken take(const std::filesystem::path& partial);

  std::filesystem::path file_;
  std::filesystem::path partial_;
  int descriptor_ = -1;
};

}  // namespace troupe::worldio
