#include "apps/check/filled_storage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <new>
#include <vector>

namespace troupe::apps::filled_storage_test {
namespace {

using ::testing::Each;

/// What `new` hands out, after storage of that size was used and given back.
std::vector<int> fresh_bytes(std::size_t size) {
  void* used = ::operator new(size);
  for (std::size_t i = 0; i < size; ++i) static_cast<volatile unsigned char*>(used)[i] = 0x11;
  ::operator delete(used);
  void* fresh = ::operator new(size);
  std::vector<int> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<volatile unsigned char*>(fresh)[i];
  ::operator delete(fresh);
  return bytes;
}

TEST(FilledStorage, FillsWhatNewHandsOutWhileItLives) {
  for (const std::size_t size : {1u, 8u, 24u, 1000u, 300000u}) {
    int filled_later = 0;
    for (const int byte : {0x5a, 0xa5, 0}) {
      {
        const FilledStorage filled{static_cast<std::byte>(byte)};
        EXPECT_THAT(fresh_bytes(size), Each(byte)) << size;
      }
      filled_later += byte != 0 && ::testing::Matches(Each(byte))(fresh_bytes(size));
    }
    // A single byte may equal one of the two by chance: the heap stores parts of random addresses in it.
    EXPECT_LT(filled_later, size == 1 ? 2 : 1) << size;
  }
}

}  // namespace
}  // namespace troupe::apps::filled_storage_test
