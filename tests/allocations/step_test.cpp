// A warm step allocates nothing. Counted is every call of the global operator new, in any thread, from
// anywhere in the process: standard containers, std::function, Eigen's dynamic matrices and exceptions all go
// through it. Not counted is malloc itself, which nothing in this library calls: oneTBB takes its own task
// objects from pools that it fills by malloc.

#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

namespace {

std::atomic<bool> counting = false;
std::atomic<std::size_t> allocations = 0;

void* allocate(std::size_t size, std::size_t align) {
  if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
  void* place = align > alignof(std::max_align_t)
                    ? std::aligned_alloc(align, (size + align - 1) / align * align)
                    : std::malloc(size > 0 ? size : 1);
  if (!place) throw std::bad_alloc();
  return place;
}

}  // namespace

// The array and nothrow forms call these.
void* operator new(std::size_t size) { return allocate(size, 1); }
void* operator new(std::size_t size, std::align_val_t align) {
  return allocate(size, static_cast<std::size_t>(align));
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }
void operator delete(void* place, std::align_val_t) noexcept { std::free(place); }
void operator delete(void* place, std::size_t, std::align_val_t) noexcept { std::free(place); }

namespace troupe {
namespace {

template <class Work>
std::size_t allocations_in(Work&& work) {
  allocations = 0;
  counting = true;
  work();
  counting = false;
  return allocations;
}

TEST(Allocations, AreCounted) {
  std::vector<int> grows;
  EXPECT_EQ(allocations_in([&] { grows.resize(100); }), 1u);
  struct alignas(64) Line {
    char bytes[64];
  };
  std::vector<Line> lines;
  EXPECT_EQ(allocations_in([&] { lines.resize(3); }), 1u);
  EXPECT_EQ(allocations_in([&] { grows.resize(50); }), 0u);
}

struct Scene {
  std::string name;
  std::string world;
  std::uint64_t warm;   ///< ticks until all that grows has grown
  std::uint64_t ticks;  ///< counted
};

class WarmStep : public ::testing::TestWithParam<Scene> {};
INSTANTIATE_TEST_SUITE_P(World, WarmStep,
                         ::testing::Values(Scene{"hospital", "hospital.json", 20, 100},
                                           Scene{"caveWithLasers", "cave-complex-laser.json", 20, 100},
                                           Scene{"crowd", "crowd.json", 20, 100}),
                         [](const auto& scene) { return scene.param.name; });

TEST_P(WarmStep, AllocatesNothing) {
  const Scene& scene = GetParam();
  for (const unsigned threads : {1u, 2u}) {
    SimulationOptions options;
    options.threads = threads;
    Simulation simulation(std::filesystem::path(TROUPE_SOURCE_DIR) / "worlds" / scene.world, options);
    const auto step = [&](std::uint64_t ticks) {
      for (std::uint64_t tick = 0; tick < ticks; ++tick) simulation.step();
    };
    step(test::k_slow_build ? 5 : scene.warm);
    // What a worker senses with is its own, and made when it first does: on a busy machine a second thread
    // may come late, or meet its first crowd late. One thread has no such excuse.
    std::size_t count = 0;
    for (int attempts = threads == 1 ? 1 : 10; attempts > 0; --attempts) {
      count = allocations_in([&] { step(test::k_slow_build ? 5 : scene.ticks); });
      if (count == 0) break;
    }
    EXPECT_EQ(count, 0u) << threads << " threads";
  }
}

}  // namespace
}  // namespace troupe
