// Threads take turns inside HDF5's library. A library that was built thread-safe would hide an error in this.
// The H5Dwrite of this program therefore replaces that of the library, and counts the calls.

#ifdef TROUPE_HAS_HDF5

#include "tests/support/scratch.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <dlfcn.h>
#include <hdf5.h>

namespace {

std::atomic<int> inside = 0;
std::atomic<int> most_inside = 0;
std::atomic<int> calls = 0;

}  // namespace

extern "C" herr_t H5Dwrite(hid_t dataset, hid_t memory_type, hid_t memory, hid_t file, hid_t properties,
                           const void* from) {
  static const auto library = reinterpret_cast<decltype(&H5Dwrite)>(dlsym(RTLD_NEXT, "H5Dwrite"));
  ++calls;
  const int now = ++inside;
  for (int most = most_inside; most < now && !most_inside.compare_exchange_weak(most, now);) {
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const herr_t result = library(dataset, memory_type, memory, file, properties, from);
  --inside;
  return result;
}

namespace troupe::worldio::hdf5_turns_test {
namespace {

class Hdf5Turns : public test::ScratchTest {};

TEST_F(Hdf5Turns, OneThreadAtATimeIsInsideTheLibrary) {
  calls = most_inside = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t)
    threads.emplace_back([this, t] {
      Hdf5File file = Hdf5File::create(folder_ / (std::to_string(t) + ".h5"));
      for (int i = 0; i < 20; ++i) {
        const std::vector<double> values(100, t + i);
        file.write(std::to_string(i), std::span<const double>(values));
      }
      file.close();
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(calls, 60) << "this is not the H5Dwrite that is called";
  EXPECT_EQ(most_inside, 1);
  for (int t = 0; t < 3; ++t)
    EXPECT_EQ(Hdf5File::open(folder_ / (std::to_string(t) + ".h5")).dataset("7").read<double>(),
              std::vector<double>(100, t + 7));
}

}  // namespace
}  // namespace troupe::worldio::hdf5_turns_test

#endif
