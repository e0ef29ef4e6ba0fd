#pragma once

#include <filesystem>
#include <utility>

namespace troupe::worldio {

/// Owns a file descriptor and closes it when destroyed.
class Descriptor {
 public:
  Descriptor() = default;
  /// Opens a file with the flags and, for a new file, the permission bits of open(). If the file cannot be
  /// opened, get() is -1, and errno has the reason.
  Descriptor(const std::filesystem::path& file, int flags, unsigned mode = 0);
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  int get() const { return fd_; }  ///< -1: no file is open

 private:
  int fd_ = -1;
};

}  // namespace troupe::worldio
