#include "worldio/results/descriptor.hpp"

#include <fcntl.h>
#include <unistd.h>

namespace troupe::worldio {

Descriptor::Descriptor(const std::filesystem::path& file, int flags, unsigned mode)
    : fd_(open(file.c_str(), flags | O_CLOEXEC, mode)) {}

Descriptor::~Descriptor() {
  if (fd_ >= 0) close(fd_);
}

}  // namespace troupe::worldio
