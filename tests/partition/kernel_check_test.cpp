#include "partition/kernel_check.hpp"

#include "tests/support/simd_targets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace troupe::partition::kernel_check_test {
namespace {

TEST(KernelCheck, FindsTheKernelsOfEveryInstructionSetRight) {
  for_each_simd_target([](const std::string& target) { EXPECT_TRUE(kernels_are_right()) << target; });
}

float next(float x) { return std::nextafter(x, std::numeric_limits<float>::infinity()); }

TEST(KernelCheck, FindsADirectionThatIsRoundedWrongly) {
  Kernels kernels;
  kernels.turn = [](const Rotation& rotation, const double* x, const double* y, std::size_t count,
                    float* out_x, float* out_y) {
    turn(rotation, x, y, count, out_x, out_y);
    out_y[count - 1] = next(out_y[count - 1]);
  };
  EXPECT_FALSE(kernels_are_right(kernels));
}

TEST(KernelCheck, FindsARangeThatIsRoundedWrongly) {
  Kernels kernels;
  kernels.project = [](const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse,
                       float* returns) {
    project(edges, reference, fan, inverse, returns);
    if (fan.scan != nullptr) inverse[30] = next(inverse[30]);
  };
  EXPECT_FALSE(kernels_are_right(kernels));
}

TEST(KernelCheck, FindsAnIntensityOfAnotherSurface) {
  Kernels kernels;
  kernels.project = [](const EdgeBlock& edges, const Vec2& reference, const Fan& fan, float* inverse,
                       float* returns) {
    project(edges, reference, fan, inverse, returns);
    if (returns != nullptr) returns[0] = 0;  // of two surfaces at one distance, the other one
  };
  EXPECT_FALSE(kernels_are_right(kernels));
}

TEST(KernelCheck, FindsADivisionByZeroThatIsNotInfinite) {
  Kernels kernels;
  kernels.limits_of = [](const Fan& fan, const float* inverse, const float* range_max, float* limits) {
    float farthest = 0;
    for (std::size_t i = 0; i < fan.padded(); ++i) {
      const float range = std::min(inverse[i] == 0 ? 0 : 1 / inverse[i], range_max[i]);
      limits[i] = range * (1 + static_cast<float>(k_range_slack)) + k_cull_slack;
      farthest = std::max(farthest, limits[i]);
    }
    return farthest;
  };
  EXPECT_FALSE(kernels_are_right(kernels));
}

TEST(KernelCheck, FindsAReadingThatIsNotTheRange) {
  Kernels kernels;
  kernels.ranges_of = [](const Fan& fan, const float* inverse, const float*, float* ranges) {
    for (std::size_t i = 0; i < fan.count; ++i) ranges[i] = 1 / inverse[i];  // also where nothing is hit
  };
  EXPECT_FALSE(kernels_are_right(kernels));
}

TEST(KernelCheck, FindsACircleThatIsMissing) {
  for (const float hidden : {0.3f, 3.0f}) {  // in the near and in the far search
    static float from;
    from = hidden;
    Kernels kernels;
    kernels.may_meet = [](const CircleArrays& circles, std::size_t begin, std::size_t end,
                          const Vec2& reference, const Fan& fan, const float* limits, float low, float high,
                          MetCircles& met) {
      const std::size_t n = may_meet(circles, begin, end, reference, fan, limits, low, high, met);
      return low <= from && from <= high ? n / 2 : n;
    };
    EXPECT_FALSE(kernels_are_right(kernels)) << hidden;
  }
}

TEST(KernelCheck, FindsABeamThatIsMissing) {
  Kernels kernels;
  kernels.may_meet = [](const CircleArrays& circles, std::size_t begin, std::size_t end,
                        const Vec2& reference, const Fan& fan, const float* limits, float low, float high,
                        MetCircles& met) {
    const std::size_t n = may_meet(circles, begin, end, reference, fan, limits, low, high, met);
    for (std::size_t i = 0; i < n; ++i) met.beams[i] &= met.beams[i] - 1;
    return n;
  };
  EXPECT_FALSE(kernels_are_right(kernels));
}

TEST(KernelCheck, FindsACircleThatIsCopiedWrongly) {
  Kernels kernels;
  kernels.unpack = [](std::span<const CircleRun> runs, std::uint32_t mark, std::size_t size,
                      CircleArrays& out) {
    unpack(runs, mark, size, out);
    out.row[3] &= ~mark;
  };
  EXPECT_FALSE(kernels_are_right(kernels));
}

}  // namespace
}  // namespace troupe::partition::kernel_check_test
