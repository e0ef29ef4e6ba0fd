#include "worldio/file_lock.hpp"

#include <sys/file.h>

#include <cerrno>

namespace troupe::worldio {

FileLock lock_file(int descriptor) {
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return FileLock::taken;
  return errno == EWOULDBLOCK ? FileLock::held : FileLock::unavailable;
}

}  // namespace troupe::worldio
