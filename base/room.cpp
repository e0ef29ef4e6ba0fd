#include "base/capacity.hpp"

#ifdef __GLIBC__
#include <malloc.h>

#include <mutex>
#endif

namespace troupe {

void release_freed_memory() {
#ifdef __GLIBC__
  // If another allocator replaces that of glibc (a sanitizer, or a preloaded library), this may be the first
  // call into the allocator of glibc. Two threads that make their first calls at the same time would both
  // initialize it, and glibc would abort when the second of them ends.
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  malloc_trim(0);
#endif
}

}  // namespace troupe
