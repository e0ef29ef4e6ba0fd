// An allocator for LD_PRELOAD, used by scripts/prove. It returns addresses in descending or random order
// (TROUPE_ALLOCATOR=descending|shuffled); those of glibc mostly ascend. It fills new and freed memory with
// junk that differs from run to run. Code whose results depend on the order of addresses, or that reads
// memory before writing it, gets other bits.
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <mutex>
#include <utility>

namespace {

constexpr std::size_t k_header = 16;                   // before each block; keeps its alignment
constexpr std::size_t k_arena = std::size_t{1} << 40;  // reserved, not used: pages come as they are touched
constexpr std::size_t k_slab = 64;  // blocks of one size made at once, where they are small
constexpr std::size_t k_slab_bytes = 1 << 16;
constexpr unsigned k_classes = 40;  // class c holds blocks of 2^c bytes

struct Header {
  std::uint32_t size_class;
  std::uint32_t offset;  // of what was handed out, from the block's begin
  std::uint64_t size;    // asked for
};
static_assert(sizeof(Header) == k_header);

/// Free blocks of one size: a list in storage of its own, of which any may be taken.
struct FreeList {
  std::byte** blocks = nullptr;
  std::size_t count = 0;
  std::size_t capacity = 0;
};

// The constructors of a preloaded library run after others have allocated: nothing here may need one.
constinit std::mutex mutex;
constinit FreeList lists[k_classes];
constinit std::byte* arena_begin = nullptr;
constinit std::byte* arena_end = nullptr;  // what is above has been handed out
constinit bool shuffled = false;
constinit std::uint64_t junk = 0;

std::uint64_t
next_junk() {  // splitmix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014)
  std::uint64_t z = (junk += 0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

void* map(std::size_t bytes) {
  void* memory =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) std::abort();
  return memory;
}

void start() {
  if (arena_begin) return;
  const char* order = std::getenv("TROUPE_ALLOCATOR");
  shuffled = order && std::strcmp(order, "shuffled") == 0;
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  junk = static_cast<std::uint64_t>(now.tv_nsec) * 0x9e3779b97f4a7c15 + static_cast<std::uint64_t>(getpid());
  arena_begin = static_cast<std::byte*>(map(k_arena));
  arena_end = arena_begin + k_arena;
}

void put(FreeList& list, std::byte* block) {
  if (list.count == list.capacity) {
    const std::size_t capacity = list.capacity ? 2 * list.capacity : 512;
    auto* const blocks = static_cast<std::byte**>(map(capacity * sizeof(std::byte*)));
    if (list.count > 0) std::memcpy(blocks, list.blocks, list.count * sizeof(std::byte*));
    if (list.blocks) munmap(list.blocks, list.capacity * sizeof(std::byte*));
    list.blocks = blocks;
    list.capacity = capacity;
  }
  list.blocks[list.count++] = block;
}

/// New blocks of one size from the top of the arena, so that the next one taken lies highest.
void grow(FreeList& list, std::size_t block_bytes) {
  const std::size_t count = block_bytes <= k_slab_bytes / k_slab ? k_slab : 1;
  arena_end -= count * block_bytes;
  if (arena_end < arena_begin) std::abort();
  for (std::size_t i = 0; i < count; ++i) put(list, arena_end + i * block_bytes);
}

std::byte* take(unsigned size_class) {
  FreeList& list = lists[size_class];
  if (list.count == 0) grow(list, std::size_t{1} << size_class);
  if (shuffled) std::swap(list.blocks[next_junk() % list.count], list.blocks[list.count - 1]);
  return list.blocks[--list.count];
}

/// The large are left as the kernel gives them, zeros, but for their first part: pages that are not needed
/// stay untouched.
void fill(void* memory, std::size_t bytes) {
  constexpr std::size_t k_most = std::size_t{1} << 24;
  const std::uint64_t word = next_junk();
  auto* out = static_cast<std::byte*>(memory);
  bytes = bytes < k_most ? bytes : k_most;
  for (; bytes >= sizeof(word); bytes -= sizeof(word), out += sizeof(word))
    std::memcpy(out, &word, sizeof(word));
  std::memcpy(out, &word, bytes);
}

Header* header_of(void* memory) {
  return reinterpret_cast<Header*>(static_cast<std::byte*>(memory) - k_header);
}

void* allocate(std::size_t size, std::size_t alignment) {
  if (size > k_arena / 4 || alignment > k_arena / 4) {
    errno = ENOMEM;
    return nullptr;
  }
  const std::size_t needed = size + k_header + (alignment > k_header ? alignment : 0);
  unsigned size_class = 5;
  while ((std::size_t{1} << size_class) < needed) ++size_class;
  const std::lock_guard lock(mutex);
  start();
  std::byte* const block = take(size_class);
  auto address = reinterpret_cast<std::uintptr_t>(block) + k_header;
  if (alignment > k_header) address = (address + alignment - 1) / alignment * alignment;
  auto* const memory = reinterpret_cast<std::byte*>(address);
  *header_of(memory) = {size_class, static_cast<std::uint32_t>(memory - block), size};
  fill(memory, size);
  return memory;
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) { return allocate(size, k_header); }

void free(void* memory) {
  if (!memory) return;
  const int error = errno;
  const std::lock_guard lock(mutex);
  const Header header = *header_of(memory);
  fill(memory, header.size);
  put(lists[header.size_class], static_cast<std::byte*>(memory) - header.offset);
  errno = error;
}

void* calloc(std::size_t count, std::size_t size) {
  std::size_t bytes = 0;
  if (__builtin_mul_overflow(count, size, &bytes)) {
    errno = ENOMEM;
    return nullptr;
  }
  void* const memory = allocate(bytes, k_header);
  if (memory) std::memset(memory, 0, bytes);
  return memory;
}

void* realloc(void* memory, std::size_t size) {
  if (!memory) return malloc(size);
  if (size == 0) {
    free(memory);
    return nullptr;
  }
  void* const other = malloc(size);  // always elsewhere
  if (!other) return nullptr;
  const std::size_t old = header_of(memory)->size;
  std::memcpy(other, memory, old < size ? old : size);
  free(memory);
  return other;
}

void* memalign(std::size_t alignment, std::size_t size) { return allocate(size, alignment); }
void* aligned_alloc(std::size_t alignment, std::size_t size) { return allocate(size, alignment); }
void* valloc(std::size_t size) { return allocate(size, 4096); }

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  *memory = allocate(size, alignment);
  return *memory ? 0 : ENOMEM;
}

std::size_t malloc_usable_size(void* memory) { return memory ? header_of(memory)->size : 0; }

}  // extern "C"
