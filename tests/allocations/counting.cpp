#include "tests/allocations/counting.hpp"

#include <malloc.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <new>

namespace {

std::atomic<bool> counting = false;
std::atomic<std::size_t> allocations = 0;
std::atomic<std::size_t> live_bytes = 0;
std::atomic<std::size_t> live_blocks = 0;

void* allocate(std::size_t size, std::size_t align) {
  if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
  void* place = align > alignof(std::max_align_t)
                    ? std::aligned_alloc(align, (size + align - 1) / align * align)
                    : std::malloc(size > 0 ? size : 1);
  if (!place) throw std::bad_alloc();
  live_bytes.fetch_add(malloc_usable_size(place), std::memory_order_relaxed);
  live_blocks.fetch_add(1, std::memory_order_relaxed);
  return place;
}

void release(void* place) {
  if (!place) return;
  live_bytes.fetch_sub(malloc_usable_size(place), std::memory_order_relaxed);
  live_blocks.fetch_sub(1, std::memory_order_relaxed);
  std::free(place);
}

}  // namespace

// The array forms call these. The nothrow form would, too, but an address sanitizer brings its own.
void* operator new(std::size_t size) { return allocate(size, 1); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return allocate(size, 1); }
void* operator new(std::size_t size, std::align_val_t align) {
  return allocate(size, static_cast<std::size_t>(align));
}
void operator delete(void* place) noexcept { release(place); }
void operator delete(void* place, std::size_t) noexcept { release(place); }
void operator delete(void* place, const std::nothrow_t&) noexcept { release(place); }
void operator delete(void* place, std::align_val_t) noexcept { release(place); }
void operator delete(void* place, std::size_t, std::align_val_t) noexcept { release(place); }

namespace troupe::test {

void start_counting() {
  allocations = 0;
  counting = true;
}

std::size_t stop_counting() {
  counting = false;
  return allocations;
}

Live live() { return {live_bytes, live_blocks}; }

std::size_t resident_bytes() {
  std::size_t all = 0;
  std::size_t resident = 0;  // pages
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace troupe::test
