#include "worldio/results/replay_codec.hpp"

#include "tests/worldio/replay_unpacked.hpp"

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <string>
#include <vector>

namespace troupe::worldio::replay_codec_test {
namespace {

std::string packed(const std::vector<std::int32_t>& values, Expected expected) {
  std::string bytes;
  append_series(values, expected, bytes);
  return bytes;
}

std::vector<int> numbers(const std::string& bytes) {
  std::vector<int> numbers;
  for (const char byte : bytes) numbers.push_back(static_cast<unsigned char>(byte));
  return numbers;
}

TEST(ReplayCodec, WritesHowFarAValueIsFromWhatWasExpected) {
  using ::testing::ElementsAre;
  EXPECT_THAT(numbers(packed({5, 5, 4, k_absent, 7}, Expected::same)), ElementsAre(11, 1, 2, 0, 7));
  EXPECT_THAT(numbers(packed({10, 20, 30, 40, 40}, Expected::line)), ElementsAre(21, 21, 1, 1, 20));
  EXPECT_THAT(numbers(packed({100}, Expected::same)), ElementsAre(201, 1));
  EXPECT_TRUE(packed({}, Expected::line).empty());
}

TEST(ReplayCodec, StandingAndGoingStraightTakeAByteAValue) {
  std::vector<std::int32_t> straight;
  for (int i = 0; i < 1000; ++i) straight.push_back(123456 + 50 * i);
  EXPECT_EQ(packed(straight, Expected::line).size(), 3u + 1u + 998u);
  EXPECT_LT(deflated(packed(straight, Expected::line)).size(), 40u);
}

RC_GTEST_PROP(ReplayCodec, WhatIsReadIsWhatWasWritten, ()) {
  const auto series = *rc::gen::container<std::vector<std::int32_t>>(rc::gen::oneOf(
      rc::gen::just(k_absent), rc::gen::inRange(-300, 300), rc::gen::just(k_most_in_series),
      rc::gen::just(-k_most_in_series), rc::gen::inRange(-k_most_in_series, k_most_in_series)));
  for (const Expected expected : {Expected::same, Expected::line}) {
    test::Series bytes(packed(series, expected));
    const std::vector<std::int64_t> read = bytes.next(series.size(), expected == Expected::line);
    RC_ASSERT(bytes.at_end());
    for (std::size_t i = 0; i < series.size(); ++i)
      RC_ASSERT(read[i] == (series[i] == k_absent ? test::k_gone : series[i]));
  }
}

TEST(ReplayCodec, NoValueTakesMoreThan31Bits) {
  // A browser's bit operations have no more.
  const std::int32_t m = k_most_in_series;
  const std::string worst = packed({-m, m, -m, m}, Expected::line);
  for (std::size_t at = 0; at < worst.size();) {
    std::uint64_t number = 0;
    for (int shift = 0;; shift += 7) {
      const auto byte = static_cast<unsigned char>(worst[at++]);
      number |= std::uint64_t{byte & 127u} << shift;
      if (byte < 128) break;
    }
    EXPECT_LT(number, std::uint64_t{1} << 31);
  }
}

TEST(ReplayCodec, Base64IsThatOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xfb\xff\xfe"), "+//+");
}

TEST(ReplayCodec, DeflatedIsZlibs) {
  EXPECT_EQ(test::inflated(deflated("")), "");
  const std::string text(100000, 'x');
  EXPECT_EQ(test::inflated(deflated(text)), text);
  EXPECT_EQ(numbers(deflated(text))[0], 0x78);  // RFC 1950: what "deflate" means to a browser
}

}  // namespace
}  // namespace troupe::worldio::replay_codec_test
