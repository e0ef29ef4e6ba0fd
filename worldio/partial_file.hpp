#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// A file that is being made, under another name beside the one that it will get: `NAME.partial`, or
/// `NAME.2.partial`, `NAME.3.partial`, ... where others write the same file at the same time. A writer holds
/// a lock (flock) on its partial file until it gives the file its name or removes it; a partial file without
/// a lock was left by a writer that was killed, and the next writer of the same name takes it over. On file
/// systems without locks the name holds the process id, and what a killed writer leaves stays.
///
/// Everything throws std::system_error. What has the name already must be a regular file.
class PartialFile {
 public:
  /// A new, empty one. `ending` follows the name, for programs that look at it: ".mp4".
  explicit PartialFile(std::filesystem::path file, std::string_view ending = {});
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  /// Removes it, unless it was given its name.
  ~PartialFile();

  const std::filesystem::path& path() const { return partial_; }
  /// Open for writing. A process that inherits it holds the lock as well.
  int descriptor() const { return descriptor_; }
  void write(std::span<const std::byte> bytes);
  /// Hands what was written to the disk.
  void sync();
  /// Gives it its name, in place of a file that has it.
  void commit();

 private:
  enum class Taken : char { yes, no, no_locks };
  Taken take(const std::filesystem::path& partial);

  std::filesystem::path file_;
  std::filesystem::path partial_;
  int descriptor_ = -1;
};

}  // namespace troupe::worldio
