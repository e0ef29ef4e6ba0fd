#include "apps/check/filled_storage.hpp"

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>

namespace troupe::apps {
namespace {

constexpr int k_off = -1;
std::atomic<int> fill = k_off;

}  // namespace

FilledStorage::FilledStorage(std::byte byte) { fill = std::to_integer<int>(byte); }
FilledStorage::~FilledStorage() { fill = k_off; }

}  // namespace troupe::apps

// The following functions replace the global `new`, because glibc's M_PERTURB does not fill small blocks that
// are reused. Shared libraries allocate with them as well. All forms are replaced except the over-aligned
// ones, which have their own `delete`. If another form were missing, an address sanitizer would supply it and
// report mismatched pairs of `new` and `delete`.
namespace {

void* filled(std::size_t size) {
  void* const storage = std::malloc(size > 0 ? size : 1);
  const int byte = troupe::apps::fill.load(std::memory_order_relaxed);
  if (storage && byte != troupe::apps::k_off) std::memset(storage, byte, size);
  return storage;
}

void* filled_or_thrown(std::size_t size) {
  void* const storage = filled(size);
  if (!storage) throw std::bad_alloc();
  return storage;
}

}  // namespace

void* operator new(std::size_t size) { return filled_or_thrown(size); }
void* operator new[](std::size_t size) { return filled_or_thrown(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return filled(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return filled(size); }
void operator delete(void* storage) noexcept { std::free(storage); }
void operator delete[](void* storage) noexcept { std::free(storage); }
void operator delete(void* storage, std::size_t) noexcept { std::free(storage); }
void operator delete[](void* storage, std::size_t) noexcept { std::free(storage); }
void operator delete(void* storage, const std::nothrow_t&) noexcept { std::free(storage); }
void operator delete[](void* storage, const std::nothrow_t&) noexcept { std::free(storage); }
