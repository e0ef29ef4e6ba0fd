// Compares some values of each function with a file that the Python test tests/python/math_test.py also
// reads.

#include "base/math.hpp"
#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace troupe::math_bits_test {
namespace {

double value(const std::string& function, double a, double b) {
  if (function == "sin") return sin(a);
  if (function == "cos") return cos(a);
  if (function == "exp") return exp(a);
  if (function == "log") return log(a);
  if (function == "wrap_angle") return wrap_angle(a);
  EXPECT_EQ(function, "atan2");
  return atan2(a, b);
}

TEST(MathBits, AreThoseOfTheFile) {
  std::ifstream file(test::source_dir() / "tests/base/math_bits.txt");
  int lines = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    std::string function;
    std::string a;
    std::string b;
    std::string result;
    words >> function >> a >> b >> result;  // "-" where a function takes one argument
    const double made = value(function, std::strtod(a.c_str(), nullptr), std::strtod(b.c_str(), nullptr));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(made),
              std::bit_cast<std::uint64_t>(std::strtod(result.c_str(), nullptr)))
        << line;
    ++lines;
  }
  EXPECT_GE(lines, 60);
}

}  // namespace
}  // namespace troupe::math_bits_test
