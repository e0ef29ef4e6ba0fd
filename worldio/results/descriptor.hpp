#pragma once

#include <filesystem>

namespace troupe::worldio {

/// Owns a file descriptor and closes it when destroyed.
class Descriptor {
 public:
  /// Opens a file with the flags and, for a new file, the permission bits of open(). If the file cannot be
  /// opened, get() is -1, and errno has the reason.
  Descriptor(const std::filesystem::path& file, int flags, unsigned mode = 0);
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

}  // namespace troupe::worldio
