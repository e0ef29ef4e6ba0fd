#include "partition/simd_target.hpp"

#include "partition/compress_tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdio>
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::partition::simd_target_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string error_of(const std::string& name) {
  try {
    use_simd_target(name);
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(SimdTarget, KernelsRunOnTheBestUnlessAnotherIsChosen) {
  const std::vector<std::string>& usable = simd_targets().usable;
  ASSERT_FALSE(usable.empty());
  EXPECT_EQ(simd_target(), usable.front());
  for (const std::string& name : usable) {
    use_simd_target(name);
    EXPECT_EQ(simd_target(), name);
    EXPECT_THAT(simd_targets().missing, Not(Contains(name)));
  }
  use_simd_target(usable.front());
  EXPECT_EQ(std::set<std::string>(usable.begin(), usable.end()).size(), usable.size());
}

TEST(SimdTarget, PortableKernelsAreAlwaysThere) { EXPECT_EQ(simd_targets().usable.back(), "scalar"); }

TEST(SimdTarget, TheKernelsOfX86AreThoseThatHighwayKnows) {
#if defined(__x86_64__)
  std::set<std::string> all(simd_targets().usable.begin(), simd_targets().usable.end());
  all.insert(simd_targets().missing.begin(), simd_targets().missing.end());
  for (const char* name : {"scalar", "ssse3", "sse4", "avx2", "avx512"}) EXPECT_THAT(all, Contains(name));
#else
  GTEST_SKIP() << "another processor";
#endif
}

TEST(SimdTarget, AnUnknownOneIsRefusedAndChangesNothing) {
  const std::string before = simd_target();
  for (const char* name : {"avx9", "", "AVX2", "avx", "scalar "})
    EXPECT_THAT(error_of(name),
                AllOf(StartsWith("\"" + std::string(name) +
                                 "\" is not an instruction set that this program is compiled for; this "
                                 "processor can use "),
                      HasSubstr(before)));
  EXPECT_EQ(simd_target(), before);
}

/// Chooses an instruction set on a processor that supports only the portable kernels, and ends the process.
[[noreturn]] void choose_on_a_poor_processor(const std::string& name) {
  hwy::DisableTargets(~(HWY_SCALAR | HWY_EMU128));
  const std::string error = error_of(name);
  std::fputs((error + "; kernels run on " + simd_target()).c_str(), stderr);
  std::exit(0);
}

TEST(SimdTargetDeathTest, OneThatTheProcessorLacksIsRefused) {
#if defined(__x86_64__)
  const char* other = "ssse3";
#else
  const char* other = "neon";
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a new process, in which the targets are not known yet
  EXPECT_EXIT(
      choose_on_a_poor_processor(other), ::testing::ExitedWithCode(0),
      "is not an instruction set of this processor; this processor has scalar; kernels run on scalar");
}

TEST(CompressTables, MoveTheLanesThatAreSetToTheFront) {
  for (std::size_t mask = 0; mask < 256; ++mask) {
    std::vector<std::size_t> from;
    for (std::size_t lane = 0; lane < 8; ++lane)
      if (mask >> lane & 1) from.push_back(lane);
    for (std::size_t to = 0; to < from.size(); ++to) ASSERT_EQ(k_compress_lanes[8 * mask + to], from[to]);
    for (std::size_t to = 0; to < 8; ++to) ASSERT_LT(k_compress_lanes[8 * mask + to], 8);
    if (mask >= 16) continue;
    for (std::size_t to = 0; to < 4 * from.size(); ++to)
      ASSERT_EQ(k_compress_bytes[16 * mask + to], 4 * from[to / 4] + to % 4);
    for (std::size_t to = 0; to < 16; ++to) ASSERT_LT(k_compress_bytes[16 * mask + to], 16);
  }
}

}  // namespace
}  // namespace troupe::partition::simd_target_test
