#include "base/room.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace troupe {

void release_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace troupe
