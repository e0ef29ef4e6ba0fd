// A file of some kilobytes must not use all memory or take hours: macros, images and numbers that multiply
// have limits, and a file beyond a limit is an error.

#include "base/diagnostics.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/simulation.hpp"
#include "worldio/images/bitmap.hpp"
#include "worldio/images/png.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <chrono>
#include <functional>
#include <string>

namespace troupe::worldio::limits_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

class Limits : public test::ScratchTest {
 protected:
  /// What is said when the world is refused.
  std::string refusal(const std::string& name, std::string_view text) const {
    const auto file = write(name, text);
    try {
      Simulation simulation(file);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "the world was loaded";
    return {};
  }

  ~Limits() override {
    if (!test::k_slow_build) {
      // At most six seconds are usual; without a limit, it takes hours.
      EXPECT_LT(std::chrono::steady_clock::now() - start_, std::chrono::seconds(600));
    }
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

TEST_F(Limits, RingsInRings) {
  const auto world = [](std::string_view parts) {
    return fmt::format(R"({{"troupe": 1, "types": {{"a": {{"size_m": [1, 1, 1], "parts": [
{{"name": "p", "ring": {{"count": 10000}}, "parts": [{{"name": "q", "ring": {{"count": {}}}}}]}}]}}}}}})",
                       parts);
  };
  for (const std::string_view parts : {"10000", "10000.0", "1e4"})
    EXPECT_THAT(
        refusal("rings.json", world(parts)),
        HasSubstr("rings.json:2: error: /types/a/parts/0/ring: up to here, the rings of the world make "
                  "more than 1000000 objects"));
  EXPECT_THAT(refusal("wrong.json", world("10001")), HasSubstr("/ring/count: must be from 1 to 10000"));
}

std::string repeated(std::string_view text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

std::string number(std::uint32_t n) {
  return {static_cast<char>(n >> 24), static_cast<char>(n >> 16), static_cast<char>(n >> 8),
          static_cast<char>(n)};
}

std::string chunk(const std::string& kind, const std::string& data) {
  const std::string all = kind + data;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(all.data()), static_cast<uInt>(all.size()));
  return number(static_cast<std::uint32_t>(data.size())) + all + number(static_cast<std::uint32_t>(sum));
}

/// A grey PNG of this size, whatever its pixels are.
std::string png(std::uint32_t width, std::uint32_t height, const std::string& rows) {
  std::string packed(compressBound(rows.size()), '\0');
  uLongf size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
           rows.size());
  packed.resize(size);
  return "\x89PNG\r\n\x1a\n" +
         chunk("IHDR", number(width) + number(height) + std::string("\x08\0\0\0\0", 5)) +
         chunk("IDAT", packed) + chunk("IEND", "");
}

std::string error_of(std::string_view bytes) {
  Diagnostics diagnostics;
  EXPECT_FALSE(decode_bitmap(bytes, "map.png", {}, diagnostics));
  EXPECT_THAT(diagnostics.findings(), SizeIs(1));
  return diagnostics.text(diagnostics.findings()[0]);
}

TEST(BitmapLimits, PixelsAreCountedBeforeTheyTakeMemory) {
  EXPECT_EQ(error_of(png(20000, 20000, "")),
            "error: the image map.png is too large: 20000 x 20000 pixels; at most 100 million are allowed");
}

TEST(BitmapLimits, OnlyTheNumberOfPixelsIsLimitedNotTheWidth) {
  Diagnostics diagnostics;
  const auto bitmap =
      decode_bitmap("P5\n40000 1\n255\n" + std::string(40000, '\xff'), "map.pgm", {}, diagnostics);
  ASSERT_TRUE(bitmap) << diagnostics.text(diagnostics.findings()[0]);
  EXPECT_EQ(bitmap->width, 40000);
}

TEST(BitmapLimits, CompressedBmpsAreNotRead) {
  std::string rle = "BM";
  rle += std::string(12, '\0') + '\x28' + std::string(15, '\0') + '\1' + std::string(23, '\0');
  EXPECT_EQ(
      error_of(rle),
      "error: the image map.png is a compressed BMP; only BMPs that are not compressed are read: convert "
      "the image to PNG");
}

TEST(BitmapLimits, WhatUnpacksToMoreThanThePixelsIsDamaged) {
  EXPECT_THAT(error_of(png(10, 10, std::string(10 << 20, '\0'))),
              HasSubstr("there is more data than the pixels need"));
  Diagnostics diagnostics;
  EXPECT_TRUE(decode_bitmap(png(10, 10, std::string(110, '\0')), "map.png", {}, diagnostics));
}

TEST(BitmapLimits, CornersAreCounted) {
  std::string checkers;
  for (int y = 0; y < 1500; ++y) {
    checkers += '\0';
    for (int x = 0; x < 1500; ++x) checkers += static_cast<char>((x + y) % 2 == 0 ? 0 : 255);
  }
  EXPECT_THAT(error_of(png(1500, 1500, checkers)), HasSubstr("too large: its outlines have 45"));
}

TEST(BitmapLimits, ColumnsOfAPgm) {
  const auto pgm = [](std::size_t columns) {
    return fmt::format("P5\n{} 1\n255\n", columns) + std::string(columns, '\0');
  };
  EXPECT_THAT(error_of(pgm(1000000)), HasSubstr("its header is invalid, has a number above 999999, or "));
  Diagnostics diagnostics;
  EXPECT_TRUE(decode_bitmap(pgm(999999), "map.pgm", {}, diagnostics));
}

TEST(BitmapLimits, ImagesThatAreCutOffAreDamaged) {
  using std::string_view_literals::operator""sv;
  EXPECT_THAT(error_of("P5\n4 4\n255\n0123456789"), HasSubstr("the image is cut off"));
  EXPECT_THAT(error_of("P6\n2 1\n65535\n0123456789"), HasSubstr("the image is cut off"));
  EXPECT_THAT(error_of("P5\n552562327681 1\n255\n0"), HasSubstr("its header is invalid"));
  EXPECT_THAT(error_of("BM\xff\0\0\0"sv), HasSubstr("it is cut off"));
  EXPECT_THAT(error_of("\xff\xd8\xff\xc4\0\x14\0\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x07"sv),
              HasSubstr("it violates the JPEG format, or is cut off"));
  EXPECT_THAT(
      error_of("\xff\xd8\xff\xc0\0\x0b\x08\0\x08\0\x08\1\1\x11\0\xff\xda\0\x08\1\1\0\0\x3f\0\0\xff\xd9"sv),
      HasSubstr("it violates the JPEG format"))
      << "its Huffman tables were not given";
  Diagnostics diagnostics;
  const auto bitmap = decode_bitmap("P5 # a comment\n2 #\n 1 255\n\x7f\x80"sv, "map.pgm", {}, diagnostics);
  ASSERT_TRUE(bitmap);
  EXPECT_TRUE(bitmap->at(0, 0));
  EXPECT_FALSE(bitmap->at(1, 0));
}

TEST_F(Limits, IncludedFiles) {
  write("long.inc", repeated("# nothing but a comment, and a long one\n", 30000));
  EXPECT_THAT(refusal("w.world", repeated("include \"long.inc\"\n", 400)),
              HasSubstr("the included files are too large: at most 256 MiB in total are allowed, and a file "
                        "counts each time it is included"));
}

TEST_F(Limits, MacrosThatMultiply) {
  if (test::k_slow_build) GTEST_SKIP() << "a million models";
  std::string world =
      "define a model( " + repeated("model() ", 140) + ")\ndefine b model( " + repeated("a() ", 140) + ")\n";
  for (int i = 1; i < 60; ++i) world += "b( size [1 1 " + std::to_string(i) + "] )\n";
  EXPECT_THAT(refusal("w.world", world),
              HasSubstr("too large: with its macros expanded, the world contains more than 1000000"));
}

TEST_F(Limits, MacrosOnMacros) {
  if (test::k_slow_build) GTEST_SKIP() << "twenty million steps";
  std::string world = "define m0 model()\n";
  for (int i = 1; i < 5000; ++i)
    world += "define m" + std::to_string(i) + " m" + std::to_string(i - 1) + "( size [1 1 1] )\n";
  EXPECT_THAT(refusal("w.world", world + repeated("m4999()\n", 5000)),
              HasSubstr("error: the world is too large: macros that are based on other macros were looked up "
                        "more than 20000000 times"));
}

TEST_F(Limits, PointsThatAreNotThere) {
  EXPECT_THAT(
      refusal("w.world", repeated("model( block( points 99999 point[0] [0 0] ) )\n", 50)),
      HasSubstr("w.world:1: error: \"points\" is 99999, but the block has only 2 properties, and each corner "
                "needs a property \"point[...]\": set \"points\" to the number of corners"));
}

TEST_F(Limits, OutlinesOfRobotsThatCrossThemselves) {
  if (test::k_slow_build) GTEST_SKIP() << "counting a million crossings takes minutes in a slow build";
  constexpr int k_points = 3000;
  std::string block = "block( z [0 1] points " + std::to_string(k_points);
  for (int i = 0; i < k_points; ++i)
    block += "\n point[" + std::to_string(i) + "] [" + std::to_string((i * 7919) % 3001) + " " +
             std::to_string(i % 2 == 0 ? i : 100000 - i) + "]";
  EXPECT_THAT(refusal("w.world", "position( " + block + ") )\n"),
              HasSubstr("w.world:1: error: a body of type \"position\": the outline is too intricate"));
  EXPECT_NO_THROW(Simulation(write("fixed.world", "model( " + block + ") )\n")))
      << "what stands still is not cut up";
}

TEST_F(Limits, DistancesOfTheJointsOfABody) {
  const auto world = [](int most_m) {
    const std::string arm = R"("kind": "actuator", "max_position": )";
    return R"({"troupe": 1, "types": {"crane": {"size_m": [1, 1, 1], "devices": [
{"name": "boom", )" +
           arm + R"(600}, {"name": "trolley", )" + arm + std::to_string(most_m) +
           R"(}]}}, "models": [{"name": "c", "type": "crane"}]})";
  };
  EXPECT_THAT(refusal("far.json", world(401)),
              HasSubstr("far.json:1: error: too large: the joints of type \"crane\" can move by 1001 m in "
                        "total, at most 1000 m are allowed"));
  EXPECT_NO_THROW(Simulation(write("near.json", world(400))));
}

TEST_F(Limits, SamplesAndReadings) {
  const std::string sensor = "ranger( alwayson 1 " + repeated("sensor( samples 100000 ) ", 11) + ")";
  EXPECT_THAT(
      refusal("w.world", "position( " + sensor + " )\n"),
      HasSubstr("w.world:1: error: too large: sensor \"ranger:0\" has 1100000 samples, at most 1000000"));
  std::string many =
      "define bot position( ranger( alwayson 1 " + repeated("sensor( samples 100000 ) ", 9) + ") )\n";
  EXPECT_THAT(
      refusal("many.world", many + repeated("bot( obstacle_return 0 )\n", 6000)),
      HasSubstr(
          "too large: with this body, the sensor readings, controller memories, outlines and effects of "
          "all bodies take more than 16 GB"));
  std::string types = many;
  for (int i = 1; i < 14; ++i) types += "bot( size [1 1 " + std::to_string(i) + "] )\n";
  EXPECT_THAT(
      refusal("types.world", types),
      HasSubstr(
          "too large: the sensors of this type and of the types before it have 10800000 beams in total"));
}

TEST_F(Limits, Populations) {
  const auto world = [](const std::string& count, const std::string& pitch) {
    return R"({ "troupe": 1, "types": {"bot": {"size_m": [0.1, 0.1, 0.1]}}, "populations": [
  {"name": "a", "type": "bot", "count": )" +
           count + R"(, "place": {"rule": "grid", "region_m": [[0, 0], [600, 600]], "pitch_m": )" + pitch +
           R"(}},
  {"name": "b", "type": "bot", "count": 1, "place": {"rule": "grid", "region_m": [[0, 0], [600, 600]], "pitch_m": 0.08}}
  ] })";
  };
  EXPECT_THAT(refusal("w.json", world("1000000000000", "1")),
              AllOf(HasSubstr("w.json:2: error: /populations/0/count"), HasSubstr("10000000")));
  EXPECT_THAT(refusal("w.json", world("1", "0.001")), HasSubstr("at most 100 million are allowed"));
  EXPECT_THAT(refusal("w.json", world("1", "0.08")),
              HasSubstr("w.json:3: error: /populations/1/place: the grids of this population and of the grid "
                        "populations before it have 112.5 million cells"));
}

/// A world of types t0, t1, ..., each on its own line from line 2, of which each type but t0 extends another.
std::string heirs(std::size_t types, bool from_the_end, const std::function<std::string(std::size_t)>& keys) {
  std::string text = R"({"troupe": 1, "types": {)";
  for (std::size_t i = 0; i < types; ++i) {
    const std::size_t t = from_the_end ? types - 1 - i : i;
    text += fmt::format("{}\n\"t{}\": {{{}}}", i > 0 ? "," : "", t, keys(t));
  }
  return text + "}}";
}

TEST_F(Limits, ChainsOfTypes) {
  const auto chain = [](std::size_t types, bool from_the_end) {
    return heirs(types, from_the_end, [](std::size_t t) {
      return t == 0 ? std::string(R"("size_m": [1, 1, 1])") : fmt::format(R"("extends": "t{}")", t - 1);
    });
  };
  constexpr std::string_view k_error =
      "error: /types/t1001/extends: the type inherits from more than 1000 types, directly or through other "
      "types, which is the limit: extend a type that inherits from fewer types";
  const auto only = [&](int line) {
    return AllOf(HasSubstr(fmt::format("chain.json:{}: {}", line, k_error)), Not(HasSubstr("\n")));
  };
  EXPECT_THAT(refusal("chain.json", chain(100000, false)), only(1003));
  EXPECT_THAT(refusal("chain.json", chain(100000, true)), only(99000));
  EXPECT_NO_THROW(Simulation(write("chain.json", chain(1001, true))));
}

TEST_F(Limits, InheritedValues) {
  // A type inherits 10,000 values: itself, a list of 3 numbers and a list of 9,994 numbers.
  const std::string base = R"("size_m": [1, 1, 1], "x": [)" + repeated("1,", 9993) + "1]";
  const std::string text = refusal("w.json", heirs(600, false, [&](std::size_t t) {
                                     return t == 0 ? base : std::string(R"("extends": "t0")");
                                   }));
  EXPECT_THAT(
      text,
      HasSubstr("w.json:503: error: /types/t501/extends: up to here, the types of the world inherit more "
                "than 5000000 values, which is the limit: extend smaller types, or use fewer types with "
                "\"extends\""));
}

// If each key and each entry of the base were compared with all those of the heir, this test would run for
// hours.
TEST_F(Limits, ManyKeysThatAreMerged) {
  const auto keys = [](std::string_view name) {
    std::string text, entries;
    for (int i = 0; i < 50000; ++i) {
      text += fmt::format("\"{}{}_m\": 1, ", name, i);
      entries += fmt::format("{{\"name\": \"{}{}\"}}, ", name, i);
    }
    return fmt::format("{}\"parts\": [{}{{}}]", text, entries);
  };
  const std::string text = refusal("w.json", heirs(2, false, [&](std::size_t t) {
                                     return t == 0 ? keys("a") : keys("b") + R"(, "extends": "t0")";
                                   }));
  EXPECT_THAT(text, HasSubstr("the rest of the input was not read"));
}

TEST_F(Limits, ErrorsAndWhatTheyQuote) {
  std::string types, models;
  for (int i = 0; i < 5000; ++i) {
    types += (i ? ",\n" : "") + ("\"t" + std::to_string(i)) + R"(": {"size_m": [1, 1, 1]})";
    models += (i ? ",\n" : "") + std::string(R"({"name": "m", "type": "none"})");
  }
  const std::string text =
      refusal("w.json", R"({ "troupe": 1, "types": {)" + types + "}, \"models\": [" + models + "] }");
  EXPECT_THAT(text, HasSubstr("unknown type \"none\"; known: t0, t1, t10, "));
  EXPECT_THAT(text, HasSubstr(" and 4950 more\n"));
  EXPECT_THAT(text, HasSubstr("... and 950 more errors; the rest of the input was not read"));
  EXPECT_LT(text.size(), 100000u);

  const std::string endless =
      refusal("e.json", R"({ "troupe": 1, ")" + std::string(1000000, 'x') + "\": 1 }");
  EXPECT_LT(endless.size(), 10000u);
  EXPECT_THAT(endless, HasSubstr("e.json:1: error: unknown key \"xxx"));
}

}  // namespace
}  // namespace troupe::worldio::limits_test
