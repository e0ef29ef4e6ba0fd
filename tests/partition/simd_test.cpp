// Every operation of partition/simd.inl, on every instruction set of this processor, compared with a plain
// loop over lanes. Compilers and versions of the library Highway differ, and a kernel may meet every value
// here.

#include "base/random.hpp"
#include "tests/support/simd_targets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/partition/simd_test.cpp"
#include <hwy/foreach_target.h>

#include "partition/simd.inl"
#include "tests/support/paths.hpp"

#ifndef TROUPE_TESTS_PARTITION_SIMD_TEST
#define TROUPE_TESTS_PARTITION_SIMD_TEST
namespace troupe::partition {
namespace {

/// What the operations gave.
struct Report {
  std::set<std::string> operations;    ///< names of the operations that were called
  std::vector<std::string> different;  ///< results that differ from those of the plain loop

  /// Compares a lane. A NaN is a NaN, whatever its bits. either_zero: the sign of a zero does not matter.
  template <class T>
  void compare(const std::string& operation, std::size_t lane, T result, T expected,
               bool either_zero = false) {
    operations.insert(operation);
    bool is_same = result == expected;
    if constexpr (std::floating_point<T>) {
      is_same = (std::isnan(result) && std::isnan(expected)) ||
                (is_same && (either_zero || std::signbit(result) == std::signbit(expected)));
    }
    if (is_same || different.size() > 50) return;
    std::ostringstream text;
    text << operation << ": lane " << lane << " is " << result << ", not " << expected;
    different.push_back(text.str());
  }
  template <class T>
  void compare_all(const std::string& operation, const std::vector<T>& results,
                   const std::vector<T>& expected, bool either_zero) {
    for (std::size_t i = 0; i < results.size(); ++i)
      compare(operation, i, results[i], expected[i], either_zero);
  }
};

// The longest vector has this many lanes; arrays of values have a multiple of it.
constexpr std::size_t k_most_lanes = 16;

/// Special values, and random ones of all magnitudes that kernels meet.
template <class T>
std::vector<T> values() {
  using Limits = std::numeric_limits<T>;
  std::vector<T> out{0, 1, 2, 3, 5, 7, 8, 100, T(-1), T(-2), T(-8), Limits::max(), Limits::lowest()};
  if constexpr (std::floating_point<T>) {
    for (const T value : {T(-0.0), T(0.5), T(-0.5), T(1.5), T(2.5), T(-2.5), T(1e-30), T(0x1p23) - T(0.5),
                          T(0x1p24), Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(),
                          Limits::min(), Limits::denorm_min(), -Limits::denorm_min(), Limits::epsilon()})
      out.push_back(value);
  }
  Random random(1, 6, 0, 0);
  while (out.size() % k_most_lanes != 0 || out.size() < 1000) {
    if constexpr (std::floating_point<T>)
      out.push_back(
          static_cast<T>(random.uniform(-1, 1) * std::ldexp(1.0, static_cast<int>(random.below(60)) - 30)));
    else
      out.push_back(static_cast<T>(random.below(~0u) >> random.below(32)));
  }
  return out;
}

/// Pairs of the special values with one another and with some of the random ones.
template <class T>
const std::pair<std::vector<T>, std::vector<T>>& pairs(bool without_nan) {
  const auto make = [](bool without) {
    std::vector<T> in = values<T>();
    if (without) std::erase_if(in, [](T x) { return x != x; });
    std::pair<std::vector<T>, std::vector<T>> out;
    for (std::size_t i = 0; i < 5 * k_most_lanes; ++i)
      for (std::size_t j = 0; j < 5 * k_most_lanes; ++j) {
        out.first.push_back(in[i]);
        out.second.push_back(in[j]);
      }
    return out;
  };
  static const std::array made{make(false), make(true)};
  return made[without_nan ? 1 : 0];
}

}  // namespace
}  // namespace troupe::partition
#endif

HWY_BEFORE_NAMESPACE();
namespace troupe::partition {
namespace HWY_NAMESPACE {
namespace {

using namespace simd;

template <class Tag>
using Lane = hwy::HWY_NAMESPACE::TFromD<Tag>;

/// The lanes of a vector.
template <class Tag>
struct Lanes64 {
  alignas(64) std::array<Lane<Tag>, 64 / sizeof(Lane<Tag>)> lane{};
  Lanes64(Tag tag, const Vec<Tag>& v) { StoreU(v, tag, lane.data()); }
};

/// Calls operation(v) and plain(x) with the values.
template <class Tag, class Operation, class Plain>
void one(Report& report, const char* name, Tag tag, Operation&& operation, Plain&& plain,
         bool either_zero = false) {
  using T = Lane<Tag>;
  const std::vector<T> in = values<T>();
  std::vector<T> out(in.size()), expected(in.size());
  for (std::size_t i = 0; i < in.size(); i += Lanes(tag)) StoreU(operation(LoadU(tag, &in[i])), tag, &out[i]);
  for (std::size_t i = 0; i < in.size(); ++i) expected[i] = plain(in[i]);
  report.compare_all(name, out, expected, either_zero);
}

/// Calls operation(a, b) and plain(x, y) with pairs of values. without_nan: no NaN among them.
template <class Tag, class Operation, class Plain>
void two(Report& report, const char* name, Tag tag, Operation&& operation, Plain&& plain,
         bool without_nan = false) {
  using T = Lane<Tag>;
  const auto& [x, y] = pairs<T>(without_nan);
  std::vector<T> out(x.size()), expected(x.size());
  for (std::size_t i = 0; i < x.size(); i += Lanes(tag))
    StoreU(operation(LoadU(tag, &x[i]), LoadU(tag, &y[i])), tag, &out[i]);
  for (std::size_t i = 0; i < x.size(); ++i) expected[i] = plain(x[i], y[i]);
  report.compare_all(name, out, expected, without_nan);
}

template <class Tag>
void comparisons(Report& report, Tag tag) {
  using T = Lane<Tag>;
  const auto check = [&](const char* name, auto&& mask, auto&& holds, bool without_nan = false) {
    two(
        report, name, tag, [&](auto a, auto b) { return IfThenElse(mask(a, b), a, b); },
        [&](T x, T y) { return holds(x, y) ? x : y; }, without_nan);
  };
  check(
      "Eq", [](auto a, auto b) { return Eq(a, b); }, [](T x, T y) { return x == y; });
  check(
      "Lt", [](auto a, auto b) { return Lt(a, b); }, [](T x, T y) { return x < y; });
  check(
      "Gt", [](auto a, auto b) { return Gt(a, b); }, [](T x, T y) { return x > y; });
  if constexpr (std::floating_point<T>) {
    check(
        "Le", [](auto a, auto b) { return Le(a, b); }, [](T x, T y) { return x <= y; });
    check(
        "Ge", [](auto a, auto b) { return Ge(a, b); }, [](T x, T y) { return x >= y; });
  }
  // On some targets, Ne is false for NaN; kernels do not depend on it.
  check(
      "Ne", [](auto a, auto b) { return Ne(a, b); }, [](T x, T y) { return x != y; }, true);
}

/// The operations on masks.
template <class Tag>
void masks(Report& report, Tag tag) {
  using T = Lane<Tag>;
  two(
      report, "IfThenElseZero", tag, [&](auto a, auto b) { return IfThenElseZero(Gt(a, b), a); },
      [](T x, T y) { return x > y ? x : T{0}; });
  two(
      report, "IfThenZeroElse", tag, [&](auto a, auto b) { return IfThenZeroElse(Gt(a, b), a); },
      [](T x, T y) { return x > y ? T{0} : x; });
  const auto select = [&](const char* name, auto&& joined, auto&& plain) {
    two(
        report, name, tag,
        [&](auto a, auto b) { return IfThenElse(joined(Gt(a, b), Gt(a, Zero(tag))), a, b); },
        [&](T x, T y) { return plain(x > y, x > 0) ? x : y; });
  };
  select(
      "And", [](auto a, auto b) { return And(a, b); }, [](bool x, bool y) { return x && y; });
  select(
      "AndNot", [](auto a, auto b) { return AndNot(a, b); }, [](bool x, bool y) { return !x && y; });
  select(
      "Or", [](auto a, auto b) { return Or(a, b); }, [](bool x, bool y) { return x || y; });
  select(
      "Xor", [](auto a, auto b) { return Xor(a, b); }, [](bool x, bool y) { return x != y; });

  const auto in = values<T>();
  for (std::size_t i = 0; i + 3 + Lanes(tag) <= in.size(); ++i) {
    const auto a = LoadU(tag, &in[i]);
    const auto where = Gt(a, LoadU(tag, &in[i + 3]));
    std::vector<T> kept;
    for (std::size_t k = 0; k < Lanes(tag); ++k)
      if (in[i + k] > in[i + 3 + k]) kept.push_back(in[i + k]);
    report.compare<std::size_t>("count_true", 0, count_true(tag, where), kept.size());
    report.compare("AllFalse", 0, AllFalse(tag, where), kept.empty());
    if constexpr (sizeof(T) == 4) {
      if (Lanes(tag) < Lanes(Full<T>())) continue;  // compress() takes whole vectors
      const Lanes64<Tag> front(tag, compress(a, where));
      for (std::size_t k = 0; k < kept.size(); ++k) report.compare("compress", k, front.lane[k], kept[k]);
    }
  }
}

template <class Tag>
void arithmetic(Report& report, Tag tag) {
  using T = Lane<Tag>;
  two(
      report, "Add", tag, [](auto a, auto b) { return Add(a, b); }, [](T x, T y) { return x + y; });
  two(
      report, "Sub", tag, [](auto a, auto b) { return Sub(a, b); }, [](T x, T y) { return x - y; });
  if constexpr (std::floating_point<T>) {
    two(
        report, "Mul", tag, [](auto a, auto b) { return Mul(a, b); }, [](T x, T y) { return x * y; });
    two(
        report, "divide", tag, [](auto a, auto b) { return divide(a, b); }, [](T x, T y) { return x / y; });
    // Which operand Min and Max give for a NaN, and which of two zeros, differs between targets.
    two(
        report, "Min", tag, [](auto a, auto b) { return Min(a, b); }, [](T x, T y) { return std::min(x, y); },
        true);
    two(
        report, "Max", tag, [](auto a, auto b) { return Max(a, b); }, [](T x, T y) { return std::max(x, y); },
        true);
    two(
        report, "CopySign", tag, [](auto a, auto b) { return CopySign(a, b); },
        [](T x, T y) { return std::copysign(x, y); });
    one(
        report, "Abs", tag, [](auto a) { return Abs(a); }, [](T x) { return std::abs(x); });
    one(
        report, "Neg", tag, [](auto a) { return Neg(a); }, [](T x) { return -x; });
    one(
        report, "Sqrt", tag, [](auto a) { return Sqrt(a); }, [](T x) { return std::sqrt(x); });
    one(
        report, "Ceil", tag, [](auto a) { return Ceil(a); }, [](T x) { return std::ceil(x); }, true);
    one(
        report, "Floor", tag, [](auto a) { return Floor(a); }, [](T x) { return std::floor(x); }, true);
  } else {
    two(
        report, "And", tag, [](auto a, auto b) { return And(a, b); }, [](T x, T y) { return x & y; });
    two(
        report, "AndNot", tag, [](auto a, auto b) { return AndNot(a, b); }, [](T x, T y) { return ~x & y; });
    two(
        report, "Or", tag, [](auto a, auto b) { return Or(a, b); }, [](T x, T y) { return x | y; });
    two(
        report, "Xor", tag, [](auto a, auto b) { return Xor(a, b); }, [](T x, T y) { return x ^ y; });
    one(
        report, "ShiftLeft", tag, [](auto a) { return ShiftLeft<8>(a); }, [](T x) { return x << 8; });
    for (const int bits : {0, 1, 5, 16, 31})
      one(
          report, "ShiftLeftSame", tag, [&](auto a) { return ShiftLeftSame(a, bits); },
          [&](T x) { return x << bits; });
  }
}

template <class Tag>
void memory(Report& report, Tag tag) {
  using T = Lane<Tag>;
  const auto in = values<T>();
  const std::size_t lanes = Lanes(tag);
  const auto compare = [&](const char* name, const Vec<Tag>& v, auto&& expected) {
    const Lanes64<Tag> out(tag, v);
    for (std::size_t k = 0; k < lanes; ++k) report.compare<T>(name, k, out.lane[k], expected(k));
  };
  report.compare<bool>("Lanes", 0, lanes >= 1 && lanes <= 64 / sizeof(T), true);
  compare("Zero", Zero(tag), [](std::size_t) { return T{0}; });
  compare("Set", Set(tag, T{7}), [](std::size_t) { return T{7}; });
  compare("Iota", Iota(tag, T{3}), [](std::size_t k) { return static_cast<T>(3 + k); });
  alignas(64) std::array<T, 64 / sizeof(T)> aligned{};
  for (std::size_t i = 0; i + 4 * lanes <= in.size(); ++i) {
    const auto v = LoadU(tag, &in[i]);
    compare("LoadU", v, [&](std::size_t k) { return in[i + k]; });
    Store(v, tag, aligned.data());
    for (std::size_t k = 0; k < lanes; ++k) {
      report.compare<T>("Store", k, aligned[k], in[i + k]);
      report.compare<T>("StoreU", k, Lanes64<Tag>(tag, v).lane[k], in[i + k]);
    }
    compare("Load", Load(tag, aligned.data()), [&](std::size_t k) { return in[i + k]; });
    report.compare<T>("GetLane", 0, GetLane(v), in[i]);
    Vec<Tag> a, b, c, d;
    LoadInterleaved2(tag, &in[i], a, b);
    compare("LoadInterleaved2", a, [&](std::size_t k) { return in[i + 2 * k]; });
    compare("LoadInterleaved2", b, [&](std::size_t k) { return in[i + 2 * k + 1]; });
    LoadInterleaved4(tag, &in[i], a, b, c, d);
    compare("LoadInterleaved4", a, [&](std::size_t k) { return in[i + 4 * k]; });
    compare("LoadInterleaved4", b, [&](std::size_t k) { return in[i + 4 * k + 1]; });
    compare("LoadInterleaved4", c, [&](std::size_t k) { return in[i + 4 * k + 2]; });
    compare("LoadInterleaved4", d, [&](std::size_t k) { return in[i + 4 * k + 3]; });
    if constexpr (std::same_as<T, double>) {
      load_points(tag, &in[i], a, b);
      compare("load_points", a, [&](std::size_t k) { return in[i + 2 * k]; });
      compare("load_points", b, [&](std::size_t k) { return in[i + 2 * k + 1]; });
    }
  }
}

/// The largest and the smallest lane, of numbers that may be infinite.
template <class Tag>
void extremes(Report& report, Tag tag) {
  auto in = values<float>();
  std::erase_if(in, [](float x) { return std::isnan(x); });
  for (std::size_t i = 0; i + Lanes(tag) <= in.size(); ++i) {
    const auto v = LoadU(tag, &in[i]);
    const auto [least, most] = std::minmax_element(&in[i], &in[i] + Lanes(tag));
    report.compare("MinOfLanes", 0, GetLane(MinOfLanes(tag, v)), *least, true);
    report.compare("MaxOfLanes", 0, GetLane(MaxOfLanes(tag, v)), *most, true);
  }
}

void conversions(Report& report) {
  constexpr Full<double> k_double;
  constexpr Rebind<float, Full<double>> k_half;
  auto doubles = values<double>();
  // Kernels round coordinates and areas. Highway's portable code gives the largest float for an infinity.
  std::erase_if(doubles, [](double x) { return std::abs(x) > std::numeric_limits<float>::max(); });
  for (std::size_t i = 0; i + Lanes(k_double) <= doubles.size(); ++i) {
    const Lanes64<decltype(k_half)> out(k_half, DemoteTo(k_half, LoadU(k_double, &doubles[i])));
    for (std::size_t k = 0; k < Lanes(k_double); ++k)
      report.compare("DemoteTo", k, out.lane[k], static_cast<float>(doubles[i + k]));
  }
  constexpr Full<float> k_float;
  constexpr Rebind<std::int32_t, Full<float>> k_int;
  constexpr Rebind<std::uint32_t, Full<float>> k_unsigned;
  auto floats = values<float>();
  for (std::size_t i = 0; i + Lanes(k_float) <= floats.size(); ++i) {
    const auto v = LoadU(k_float, &floats[i]);
    const Lanes64<decltype(k_unsigned)> bits(k_unsigned, BitCast(k_unsigned, v));
    const auto is_positive = Gt(v, Zero(k_float));
    const Lanes64<decltype(k_unsigned)> mask(k_unsigned,
                                             VecFromMask(k_unsigned, RebindMask(k_unsigned, is_positive)));
    for (std::size_t k = 0; k < Lanes(k_float); ++k) {
      report.compare("BitCast", k, bits.lane[k], std::bit_cast<std::uint32_t>(floats[i + k]));
      const std::uint32_t expected = floats[i + k] > 0 ? ~0u : 0u;
      report.compare("RebindMask", k, mask.lane[k], expected);
      report.compare("VecFromMask", k, mask.lane[k], expected);
    }
  }
  std::erase_if(floats, [](float x) { return !(std::abs(x) < 1e9f); });  // kernels convert numbers of beams
  for (std::size_t i = 0; i + Lanes(k_float) <= floats.size(); ++i) {
    const Lanes64<decltype(k_int)> out(k_int, ConvertTo(k_int, LoadU(k_float, &floats[i])));
    for (std::size_t k = 0; k < Lanes(k_float); ++k)
      report.compare("ConvertTo", k, out.lane[k], static_cast<std::int32_t>(floats[i + k]));
  }
}

/// Calls every operation of partition/simd.inl with the types with which kernels call it.
Report try_operations() {
  Report report;
  const auto try_all = [&](auto tag) {
    memory(report, tag);
    arithmetic(report, tag);
    comparisons(report, tag);
    masks(report, tag);
  };
  try_all(Full<float>());
  try_all(Rebind<std::int32_t, Full<float>>());
  try_all(Rebind<std::uint32_t, Full<float>>());
  memory(report, Full<double>());
  arithmetic(report, Full<double>());
  memory(report, Capped<float, 8>());
  comparisons(report, Capped<float, 8>());
  masks(report, Capped<float, 8>());
  memory(report, Capped<float, 4>());
  extremes(report, Full<float>());
  conversions(report);
  return report;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace troupe::partition
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace troupe::partition {
namespace {

HWY_EXPORT(try_operations);

TEST(Simd, EveryOperationIsThePlainLoopOnEveryInstructionSet) {
  for_each_simd_target([](const std::string& target) {
    const Report report = HWY_DYNAMIC_DISPATCH(try_operations)();
    EXPECT_THAT(report.different, ::testing::IsEmpty()) << target;
  });
}

TEST(Simd, EveryOperationOfTheListIsTested) {
  std::ifstream file(test::source_dir() / "partition/simd.inl");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::set<std::string> listed;
  const std::regex operation(R"(\n(?:using hn::(\w+);|HWY_INLINE [^(]*\b(\w+)\())");
  for (std::sregex_iterator it(text.begin(), text.end(), operation), end; it != end; ++it)
    listed.insert((*it)[1].matched ? (*it)[1] : (*it)[2]);
  for (const char* type : {"Mask", "Rebind", "Vec"}) listed.erase(type);
  listed.erase("bits_of");     // used by compress()
  listed.erase("IfThenElse");  // used by each comparison
  EXPECT_GT(listed.size(), 40u);
  EXPECT_EQ(HWY_DYNAMIC_DISPATCH(try_operations)().operations, listed);
}

}  // namespace
}  // namespace troupe::partition
#endif
