#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// The owner, the group and the permission bits of a file.
struct FileRights {
  unsigned owner = 0;
  unsigned group = 0;
  unsigned mode = 0;
};
/// Returns the rights of a file, or of the file to which a link points; nothing if it does not exist.
std::optional<FileRights> rights_of(const std::filesystem::path& file);
/// Gives an open file these rights, as far as the system allows it: only root can change the owner, other
/// users can give a file only a group to which they belong, and some file systems have no permissions.
void set_rights(int descriptor, const FileRights& rights);

/// A file NAME that gets its name only when it is complete. Until then it has a temporary name in the same
/// folder and is called the partial file. The temporary name is `NAME.partial`. If this name cannot be used,
/// for example because another program is writing the same file, the next of the names `NAME.2.partial`,
/// `NAME.3.partial`, ..., `NAME.1000.partial` that can be used is taken.
///
/// A writer holds a lock (flock) on its partial file until it renames or removes the file. A partial file
/// without a lock was left by a killed writer, and the next writer of NAME overwrites it. On a file system
/// without locks, the temporary name also contains the process id, and the partial file of a killed writer
/// remains.
///
/// If NAME is a symbolic link to a file, that file is NAME everywhere in this class: the partial file is in
/// its folder and replaces it, and the link remains. The file need not exist, but its folder must exist. A
/// file that replaces another has the same permission bits and, if the system allows it, the same owner and
/// group.
///
/// The constructor, write(), sync() and both commits throw std::system_error on failure; the error has the
/// reason, but no path. The constructor also throws if NAME exists and is not a regular file, if NAME is a
/// link to itself, or if commit() could not replace NAME: it is a mount point, or belongs to another user in
/// a folder such as /tmp (with the sticky bit).
class PartialFile {
 public:
  /// Creates an empty partial file for the file NAME with the path `file`. `ending`, such as ".mp4", is
  /// appended to the temporary name, for programs that choose the format of a file by the ending of its name.
  explicit PartialFile(std::filesystem::path file, std::string_view ending = {});
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  /// Removes the partial file, unless commit() renamed it.
  ~PartialFile();

  /// Path of the file that commit() creates or replaces: `file`, or the file to which this link points.
  const std::filesystem::path& target() const { return file_; }
  const std::filesystem::path& path() const { return partial_; }  ///< path of the partial file until commit()
  /// File descriptor of the partial file, open for writing; -1 after commit(). A child process that inherits
  /// the descriptor shares the lock, which then lasts until both processes have closed the descriptor.
  int descriptor() const { return descriptor_; }
  /// Appends all bytes to the partial file.
  void write(std::span<const std::byte> bytes);
  /// Flushes the written bytes to the disk (fsync).
  void sync();
  /// Renames the partial file to NAME and closes it. An existing file NAME is replaced. After commit(), do
  /// not call write(), sync() or commit().
  void commit();
  /// Like sync() and commit(), and also flushes the folder of NAME to the disk: after a power loss, NAME
  /// still exists and is complete.
  void commit_to_disk();

 private:
  /// The result of take(), which tries to use `partial` as the temporary name:
  /// - yes: the partial file is open, locked and empty
  /// - no: the name cannot be used: another writer uses it, or it belongs to a file or folder that cannot be
  ///   overwritten
  /// - no_locks: the file system has no locks
  enum class Taken : char { yes, no, no_locks };
  Taken take(const std::filesystem::path& partial);

  std::filesystem::path file_;
  std::filesystem::path partial_;
  std::optional<FileRights> replaced_;  // of the file NAME, if it existed
  int descriptor_ = -1;
};

/// Flushes the folder of a file to the disk (fsync), if the file system supports this, so that the name of
/// the file is on the disk. The content of the file must be on the disk already. Ignores errors.
void sync_folder_of(const std::filesystem::path& file);

}  // namespace troupe::worldio
