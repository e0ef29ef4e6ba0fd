#include "base/fp_environment.hpp"

#include <gtest/gtest.h>

#include <cfenv>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace troupe {
namespace {

class FpEnvironment : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(fp_environment_fault(), ""); }
  void TearDown() override {
    restore_fp_environment();
    EXPECT_EQ(fp_environment_fault(), "");
  }
};

TEST_F(FpEnvironment, EveryOtherRoundingIsAFault) {
  for (const int rounding : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    ASSERT_EQ(std::fesetround(rounding), 0);
    const std::string fault = fp_environment_fault();
    restore_fp_environment();
    EXPECT_EQ(fault, "rounding is not to nearest") << rounding;
    EXPECT_EQ(fp_environment_fault(), "");
  }
}

#if defined(__x86_64__)
constexpr unsigned k_flush_to_zero = 0x8000;
constexpr unsigned k_denormals_are_zero = 0x0040;

TEST_F(FpEnvironment, FlushToZeroIsAFault) {
  _mm_setcsr(_mm_getcsr() | k_flush_to_zero);
  EXPECT_EQ(fp_environment_fault(), "denormal results are flushed to zero");
}

TEST_F(FpEnvironment, DenormalsAreZeroIsAFault) {
  _mm_setcsr(_mm_getcsr() | k_denormals_are_zero);
  EXPECT_EQ(fp_environment_fault(), "denormal operands are read as zero");
}

// What gcc's -ffast-math start-up code sets.
TEST_F(FpEnvironment, FastMathIsAFault) {
  _mm_setcsr(_mm_getcsr() | k_flush_to_zero | k_denormals_are_zero);
  EXPECT_EQ(fp_environment_fault(), "denormal operands are read as zero");
}

TEST_F(FpEnvironment, FaultsAreListedTogether) {
  ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
  _mm_setcsr(_mm_getcsr() | k_denormals_are_zero);
  const std::string fault = fp_environment_fault();
  restore_fp_environment();
  EXPECT_EQ(fault, "rounding is not to nearest, denormal operands are read as zero");
}
#endif

}  // namespace
}  // namespace troupe
