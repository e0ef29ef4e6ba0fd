#include "apps/filled_storage.hpp"

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

// The program's own `new`: the C library's debugging aid, M_PERTURB, leaves out small blocks that it hands
// out again. Arrays and the kinds that do not throw come here too; so does what a shared library allocates.
void* operator new(std::size_t size) {
  void* const storage = std::malloc(size > 0 ? size : 1);
  if (!storage) throw std::bad_alloc();
  if (const int byte = troupe::apps::fill.load(std::memory_order_relaxed); byte != troupe::apps::k_off)
    std::memset(storage, byte, size);
  return storage;
}
void operator delete(void* storage) noexcept { std::free(storage); }
void operator delete(void* storage, std::size_t) noexcept { std::free(storage); }
