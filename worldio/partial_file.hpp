#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// A file NAME that is written under a temporary name in the same folder and renamed when it is complete. The
/// temporary name is `NAME.partial`. If another writer uses this name, or the name cannot be used, the
/// temporary name is `NAME.2.partial`, `NAME.3.partial` and so on, at most `NAME.1000.partial`. A writer
/// holds a lock (flock) on its partial file until it renames or removes the file. A partial file without a
/// lock was left by a killed writer, and the next writer of NAME overwrites it. On file systems without locks
/// the temporary name also contains the process id, and the partial file of a killed writer remains.
///
/// The constructor, write(), sync() and commit() throw std::system_error on failure; the error has the
/// reason, but no path. The constructor also throws if NAME exists and is not a regular file.
class PartialFile {
 public:
  /// Creates an empty partial file for the final name `file`. `ending`, such as ".mp4", is appended to the
  /// temporary name, for programs that choose the format of the file by the ending of its name.
  explicit PartialFile(std::filesystem::path file, std::string_view ending = {});
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  /// Removes the partial file, unless commit() renamed it.
  ~PartialFile();

  const std::filesystem::path& path() const { return partial_; }  ///< path of the partial file until commit()
  /// Descriptor of the partial file, open for writing; -1 after commit(). A child process that inherits the
  /// descriptor shares the lock: the lock lasts until both processes have closed the descriptor.
  int descriptor() const { return descriptor_; }
  /// Appends all bytes to the partial file.
  void write(std::span<const std::byte> bytes);
  /// Flushes the written bytes to the disk (fsync).
  void sync();
  /// Renames the partial file to its final name and closes it. Replaces an existing file, or a link to a
  /// file, of that name. Afterwards, write(), sync() and commit() must not be called.
  void commit();

 private:
  /// The result of take(), which tries to use the name `partial`. yes: the partial file is open under this
  /// name, locked and empty. no: another writer uses the name, or a file or folder of this name cannot be
  /// overwritten. no_locks: the file system has no locks.
  enum class Taken : char { yes, no, no_locks };
  Taken take(const std::filesystem::path& partial);

  std::filesystem::path file_;
  std::filesystem::path partial_;
  int descriptor_ = -1;
};

}  // namespace troupe::worldio
