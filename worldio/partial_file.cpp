#include "worldio/partial_file.hpp"

#include "worldio/file_lock.hpp"
#include "worldio/files.hpp"
#include "worldio/results/descriptor.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

namespace troupe::worldio {
namespace fs = std::filesystem;
namespace {

constexpr int k_most_writers = 1000;  // simultaneous writers of one file
constexpr mode_t k_new_mode = 0666;   // permissions of a new file, before the umask

void check(std::int64_t result) {
  if (result < 0) throw std::system_error(errno, std::generic_category());
}

/// Whether an error of open() (an errno) may be caused by an existing file or folder with the tried name.
/// Another name may then work.
bool is_of_the_name(int error) {
  return error == EACCES || error == EPERM || error == EISDIR || error == ELOOP || error == ENXIO ||
         error == EEXIST;
}

/// Whether `name` still refers to the open file. False if another writer has renamed or removed the file.
bool is_called(int descriptor, const fs::path& name) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && lstat(name.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

/// Returns the permissions with which a partial file is created, before the umask: no user may read it who
/// may not read the file that it will replace.
mode_t first_mode(const std::optional<FileRights>& replaced) {
  return replaced ? (replaced->mode & k_new_mode) | S_IRUSR | S_IWUSR : k_new_mode;
}

/// Throws std::system_error if the system would not allow commit() to replace the existing file `file`. A run
/// then fails before its first tick, and not at its end.
void check_may_replace(const fs::path& file, const FileRights& replaced) {
  struct statx mounted {};
  if (statx(AT_FDCWD, file.c_str(), 0, 0, &mounted) == 0 &&
      (mounted.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0)  // for example a single file of a container
    throw std::system_error(EBUSY, std::generic_category());
  // In a folder such as /tmp, users can replace only their own files.
  struct stat folder {};
  const uid_t user = geteuid();
  if (stat(file.has_parent_path() ? file.parent_path().c_str() : ".", &folder) == 0 &&
      (folder.st_mode & S_ISVTX) != 0 && user != 0 && user != replaced.owner && user != folder.st_uid)
    throw std::system_error(EPERM, std::generic_category());
}

bool is_regular(int descriptor) {
  struct stat opened {};
  return fstat(descriptor, &opened) == 0 && S_ISREG(opened.st_mode);
}

}  // namespace

std::optional<FileRights> rights_of(const fs::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return std::nullopt;
  return FileRights{status.st_uid, status.st_gid, status.st_mode & ~static_cast<mode_t>(S_IFMT)};
}

void set_rights(int descriptor, const FileRights& rights) {
  constexpr auto k_same = static_cast<uid_t>(-1);
  [[maybe_unused]] const bool is_owned =
      fchown(descriptor, rights.owner, rights.group) == 0 || fchown(descriptor, k_same, rights.group) == 0;
  static_cast<void>(fchmod(descriptor, rights.mode));  // after fchown(), which may clear bits
}

PartialFile::PartialFile(fs::path file, std::string_view ending) : file_(std::move(file)) {
  std::error_code ignored;
  if (fs::is_directory(file_, ignored))
    throw std::system_error(std::make_error_code(std::errc::is_a_directory));
  if (fs::exists(file_, ignored) && !fs::is_regular_file(file_, ignored))  // commit() would replace it
    throw std::system_error(std::make_error_code(std::errc::not_supported));
  if (fs::is_symlink(file_, ignored))
    file_ = fs::exists(file_, ignored) ? fs::canonical(file_) : resolved_path(file_);
  if (fs::is_symlink(file_, ignored))
    throw std::system_error(std::make_error_code(std::errc::too_many_symbolic_link_levels));
  replaced_ = rights_of(file_);
  if (replaced_) check_may_replace(file_, *replaced_);
  for (int n = 1; n <= k_most_writers; ++n) {
    const std::string number = n == 1 ? "" : fmt::format(".{}", n);
    const auto called = [&](const std::string& middle) {
      return fs::path(file_).concat(fmt::format("{}{}.partial{}", middle, number, ending));
    };
    const Taken taken = take(called(""));
    if (taken == Taken::yes) return;
    if (taken == Taken::no) continue;
    partial_ = called(fmt::format(".{}", getpid()));
    descriptor_ = open(partial_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, first_mode(replaced_));
    if (descriptor_ >= 0) return;
    if (!is_of_the_name(errno)) check(-1);
  }
  check(-1);
}

PartialFile::~PartialFile() {
  if (descriptor_ < 0) return;
  unlink(partial_.c_str());  // before the lock ends: afterwards the file could belong to another writer
  close(descriptor_);
}

PartialFile::Taken PartialFile::take(const fs::path& partial) {
  for (;;) {
    const int descriptor = open(partial.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC,
                                first_mode(replaced_));
    if (descriptor < 0) {
      if (!is_of_the_name(errno)) check(-1);
      return Taken::no;
    }
    const auto give_up = [descriptor](Taken taken) {
      const int error = errno;
      close(descriptor);
      errno = error;
      return taken;
    };
    if (!is_regular(descriptor)) return give_up(Taken::no);
    const FileLock lock = lock_file(descriptor);
    if (lock == FileLock::held) return give_up(Taken::no);
    if (lock == FileLock::unavailable) {
      unlink(partial.c_str());  // without locks, the name must contain the process id
      return give_up(Taken::no_locks);
    }
    if (!is_called(descriptor, partial)) {  // another writer renamed or removed it before lock_file()
      close(descriptor);
      continue;
    }
    descriptor_ = descriptor;
    partial_ = partial;
    try {
      check(ftruncate(descriptor, 0));
    } catch (...) {
      close(descriptor);  // the file is not removed: its content may belong to another program
      throw;
    }
    return Taken::yes;
  }
}

void PartialFile::write(std::span<const std::byte> bytes) {
  if (!write_all(descriptor_, {reinterpret_cast<const char*>(bytes.data()), bytes.size()})) check(-1);
}

void PartialFile::sync() { check(fsync(descriptor_)); }

void PartialFile::commit_to_disk() {
  sync();
  commit();
  sync_folder_of(file_);
}

void PartialFile::commit() {
  // Some file systems report a full disk only on close. Closing a duplicate of the descriptor also reports
  // this error, and keeps the lock until the file has its final name.
  const int duplicate = dup(descriptor_);
  check(duplicate);
  check(close(duplicate));
  if (replaced_) set_rights(descriptor_, *replaced_);
  check(std::rename(partial_.c_str(), file_.c_str()));
  close(std::exchange(descriptor_, -1));
}

void sync_folder_of(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  const Descriptor descriptor(folder, O_RDONLY | O_DIRECTORY);
  if (descriptor.get() >= 0) static_cast<void>(fsync(descriptor.get()));
}

}  // namespace troupe::worldio
