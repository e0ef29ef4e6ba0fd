#pragma once

#include <filesystem>
#include <string_view>
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

/// Writes all bytes to an open file or pipe. Returns false, with the reason in errno, if writing fails; some
/// of the bytes may then have been written.
bool write_all(int descriptor, std::string_view bytes);

}  // namespace troupe::worldio
