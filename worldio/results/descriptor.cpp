#include "worldio/results/descriptor.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace troupe::worldio {

Descriptor::Descriptor(const std::filesystem::path& file, int flags, unsigned mode)
    : fd_(open(file.c_str(), flags | O_CLOEXEC, mode)) {}

Descriptor::~Descriptor() {
  if (fd_ >= 0) close(fd_);
}

bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace troupe::worldio
