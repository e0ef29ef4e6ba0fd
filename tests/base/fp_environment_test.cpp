#include "base/fp_environment.hpp"

#include "tests/support/result.hpp"

#include <gtest/gtest.h>

#include <cfenv>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace troupe::fp_environment_test {
namespace {

class FpEnvironment : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(test::error_text(check_fp_environment()), ""); }
  void TearDown() override {
    restore_fp_environment();
    EXPECT_EQ(test::error_text(check_fp_environment()), "");
  }
};

TEST_F(FpEnvironment, EveryOtherRoundingIsAnError) {
  for (const int rounding : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    ASSERT_EQ(std::fesetround(rounding), 0);
    const std::string error = test::error_text(check_fp_environment());
    restore_fp_environment();
    EXPECT_EQ(error, "rounding is not to nearest") << rounding;
    EXPECT_EQ(test::error_text(check_fp_environment()), "");
  }
}

#if defined(__x86_64__)
constexpr unsigned k_flush_to_zero = 0x8000;
constexpr unsigned k_denormals_are_zero = 0x0040;

TEST_F(FpEnvironment, FlushToZeroIsAnError) {
  _mm_setcsr(_mm_getcsr() | k_flush_to_zero);
  EXPECT_EQ(test::error_text(check_fp_environment()), "denormal results are flushed to zero");
}

TEST_F(FpEnvironment, DenormalsAreZeroIsAnError) {
  _mm_setcsr(_mm_getcsr() | k_denormals_are_zero);
  EXPECT_EQ(test::error_text(check_fp_environment()), "denormal operands are read as zero");
}

// What gcc's -ffast-math start-up code sets.
TEST_F(FpEnvironment, FastMathIsAnError) {
  _mm_setcsr(_mm_getcsr() | k_flush_to_zero | k_denormals_are_zero);
  EXPECT_EQ(test::error_text(check_fp_environment()), "denormal operands are read as zero");
}

TEST_F(FpEnvironment, ErrorsAreListedTogether) {
  ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
  _mm_setcsr(_mm_getcsr() | k_denormals_are_zero);
  const std::string error = test::error_text(check_fp_environment());
  restore_fp_environment();
  EXPECT_EQ(error, "rounding is not to nearest, denormal operands are read as zero");
}
#endif

}  // namespace
}  // namespace troupe::fp_environment_test
