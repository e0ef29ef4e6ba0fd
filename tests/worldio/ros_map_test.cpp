#include "worldio/images/ros_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace troupe::worldio::ros_map_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

class RosMapTest : public testing::Test {
 protected:
  std::optional<RosMap> parse(std::string_view text) {
    Diagnostics diagnostics;
    auto map = parse_ros_map("maps/lab.yaml", text, diagnostics);
    messages_ = diagnostics.warnings();
    for (const Finding& finding : diagnostics.findings())
      if (finding.severity == Severity::error) messages_.push_back(diagnostics.text(finding));
    EXPECT_EQ(map.has_value(), !diagnostics.has_errors());
    return map;
  }

  std::vector<std::string> messages_;
};

constexpr std::string_view k_least = "image: lab.pgm\nresolution: 0.05\norigin: [-1.5, 2, 0]\n";

TEST_F(RosMapTest, SaysWhichImageHowLargeAndWhere) {
  const auto map = parse(
      "image: lab.pgm\nresolution: 5e-2\norigin: [-10.0, +2, 1.5707963267948966]\nnegate: 1\n"
      "occupied_thresh: .7\nfree_thresh: 0.2\nmode: scale\n");
  ASSERT_TRUE(map) << testing::PrintToString(messages_);
  EXPECT_THAT(messages_, IsEmpty());
  EXPECT_EQ(map->image, std::filesystem::path("maps/lab.pgm"));
  EXPECT_EQ(map->where_image.line, 1u);
  EXPECT_EQ(map->resolution_m, 0.05);
  EXPECT_EQ(map->pose_map_corner, (Pose{-10, 2, 0, 1.5707963267948966}));
  EXPECT_TRUE(map->negate);
  EXPECT_EQ(map->occupied_thresh, 0.7);
  EXPECT_EQ(map->free_thresh, 0.2);
  EXPECT_EQ(map->mode, RosMap::Mode::scale);
}

TEST_F(RosMapTest, WhatMapSaversWriteIsRead) {
  const auto map = parse(std::string(k_least) + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n\n");
  ASSERT_TRUE(map);
  EXPECT_EQ(map->mode, RosMap::Mode::trinary);
  EXPECT_TRUE(parse("{image: /maps/lab.png, resolution: 1, origin: [0, 0, 0]}"));
  const auto absolute = parse("image: /maps/lab.png\nresolution: 1\norigin:\n  - 0\n  - 0\n  - 0\n");
  ASSERT_TRUE(absolute);
  EXPECT_EQ(absolute->image, std::filesystem::path("/maps/lab.png"));
}

TEST_F(RosMapTest, WhatIsMissingIsNamed) {
  EXPECT_FALSE(parse("negate: 0"));
  EXPECT_THAT(
      messages_,
      ElementsAre(
          "maps/lab.yaml: error: a ROS map needs the key \"image\", the path of its image",
          "maps/lab.yaml: error: a ROS map needs the key \"resolution\", the edge length of a cell in m",
          "maps/lab.yaml: error: a ROS map needs the key \"origin\", the pose of its lower left corner: [x, "
          "y, yaw]"));
}

TEST_F(RosMapTest, WhatIsWrongIsToldAtItsLine) {
  EXPECT_FALSE(parse(
      "image: []\nresolution: 0\norigin: [0, nan, 0]\nnegate: maybe\noccupied_thresh: 65\nmode: tri\n"));
  EXPECT_THAT(
      messages_,
      ElementsAre(
          "maps/lab.yaml:1: error: \"image\" needs the path of an image, found a list",
          "maps/lab.yaml:2: error: \"resolution\" needs a length from 0.000001 to 200000 m, found \"0\"",
          "maps/lab.yaml:3: error: \"origin\" needs [x, y, yaw]: x and y from -100000 to 100000 m, yaw in "
          "rad, found "
          "\"nan\"",
          "maps/lab.yaml:5: error: \"occupied_thresh\" needs a probability from 0 to 1, found \"65\"",
          "maps/lab.yaml:4: error: \"negate\" needs 0, 1, false or true, found \"maybe\"",
          "maps/lab.yaml:6: error: unknown mode \"tri\"; known: raw, scale, trinary"));
  EXPECT_FALSE(parse("image: a.png\nresolution: 0.05 m\norigin: [0, 0]\nfree_thresh: 0.9\n"));
  EXPECT_THAT(
      messages_,
      ElementsAre(
          "maps/lab.yaml:2: error: \"resolution\" needs a length from 0.000001 to 200000 m, found \"0.05 m\"",
          "maps/lab.yaml:3: error: \"origin\" needs a list of three numbers, [x, y, yaw], in m and rad, "
          "found a "
          "list of length 2",
          "maps/lab.yaml:4: error: \"free_thresh\" is 0.9, but must be at most \"occupied_thresh\", which is "
          "0.65"));
  EXPECT_FALSE(parse(std::string(k_least) + "occupied_thresh: 0.1\n"));
  EXPECT_THAT(messages_,
              ElementsAre("maps/lab.yaml:4: error: \"free_thresh\" is 0.196 by default, but must be at "
                          "most \"occupied_thresh\", which is 0.1"));
}

TEST_F(RosMapTest, AMissingValueIsToldAtTheLineOfItsKey) {
  EXPECT_FALSE(parse("image: a.png\nresolution:\norigin:\nmode:\nnegate: 0\n"));
  EXPECT_THAT(
      messages_,
      ElementsAre(
          "maps/lab.yaml:2: error: \"resolution\" needs a length from 0.000001 to 200000 m, found nothing",
          "maps/lab.yaml:3: error: \"origin\" needs a list of three numbers, [x, y, yaw], in m and rad, "
          "found nothing",
          "maps/lab.yaml:4: error: \"mode\" needs one of trinary, scale, raw, found nothing"));
}

TEST_F(RosMapTest, AWrongThresholdIsNotCompared) {
  EXPECT_FALSE(parse(std::string(k_least) + "occupied_thresh: 95%\nfree_thresh: 0.9\n"));
  EXPECT_THAT(messages_,
              ElementsAre("maps/lab.yaml:4: error: \"occupied_thresh\" needs a probability from 0 to "
                          "1, found \"95%\""));
}

TEST_F(RosMapTest, ASecondDocumentIsAnError) {
  EXPECT_FALSE(parse(std::string(k_least) + "---\nnegate: 1\n"));
  EXPECT_THAT(messages_,
              ElementsAre("maps/lab.yaml:5: error: a ROS map is one YAML document, but here a second "
                          "one begins: remove the line \"---\""));
}

TEST_F(RosMapTest, KeysThatMapsDoNotHaveAreWarnings) {
  EXPECT_TRUE(parse(std::string(k_least) + "occupied_tresh: 0.6\n"));
  EXPECT_THAT(messages_, ElementsAre("maps/lab.yaml:4: warning: a ROS map has no key \"occupied_tresh\"; the "
                                     "key is ignored (did you mean \"occupied_thresh\"?)"));
}

TEST_F(RosMapTest, KeysThatAreGivenTwiceAreErrors) {
  EXPECT_FALSE(parse("image: a.png\nresolution: 0.05\norigin: [0, 0, 0]\nresolution: 0.1\n"));
  EXPECT_THAT(messages_, ElementsAre("maps/lab.yaml:4: error: \"resolution\" is given twice: line 2 gives it "
                                     "already: remove one of the two lines"));
}

TEST_F(RosMapTest, TheMisspeltKeyIsShownBesideTheMissingOne) {
  EXPECT_FALSE(parse("image: lab.pgm\nresoluton: 0.05\norigin: [-1.5, 2, 0]\n"));
  EXPECT_THAT(
      messages_,
      ElementsAre(
          "maps/lab.yaml: error: a ROS map needs the key \"resolution\", the edge length of a cell in m",
          "maps/lab.yaml:2: error: a ROS map has no key \"resoluton\" (did you mean \"resolution\"?)"));
}

TEST_F(RosMapTest, WhatIsNoYamlIsAnError) {
  EXPECT_FALSE(parse("image: lab.pgm\n\tresolution: [1\n"));
  EXPECT_THAT(messages_, ElementsAre(StartsWith("maps/lab.yaml:2: error: not valid YAML: ")));
  for (const std::string_view text : {"", "just a text", "- image: a.png\n"}) {
    EXPECT_FALSE(parse(text));
    EXPECT_THAT(messages_,
                ElementsAre(StartsWith("maps/lab.yaml: error: a ROS map consists of lines \"key: value\" "
                                       "with the keys image, resolution, origin and others, found ")));
  }
  EXPECT_FALSE(parse(std::string(60000, '[')));
  EXPECT_FALSE(parse(std::string(70000, ' ')));
  EXPECT_THAT(messages_, ElementsAre("maps/lab.yaml: error: the file is too large: 70000 bytes; a ROS map is "
                                     "a few lines of YAML, at most 65536 bytes"));
}

using Pixel = std::vector<std::uint8_t>;

TEST(RosMapCells, TrinaryMapsTellOccupiedUnknownAndFree) {
  const RosMap map;
  for (const bool unknown_is_solid : {false, true}) {
    const PixelRule rule = solid_cells(map, unknown_is_solid);
    EXPECT_TRUE(rule(Pixel{0}));
    EXPECT_TRUE(rule(Pixel{89}));                   // p = 0.651
    EXPECT_EQ(rule(Pixel{90}), unknown_is_solid);   // p = 0.647
    EXPECT_EQ(rule(Pixel{205}), unknown_is_solid);  // what map savers write for unknown cells: p = 0.19608
    EXPECT_FALSE(rule(Pixel{206}));                 // p = 0.192
    EXPECT_FALSE(rule(Pixel{254}));
    EXPECT_TRUE(rule(Pixel{0, 0, 200}));  // the mean of the colours is what counts: p = 0.739
    EXPECT_EQ(rule(Pixel{0, 255, 255}), unknown_is_solid);
    EXPECT_TRUE(rule(Pixel{0, 0, 0, 0}));  // and not the opacity
    EXPECT_FALSE(rule(Pixel{254, 0}));
  }
}

TEST(RosMapCells, NegatedMapsAreWhiteOnBlack) {
  RosMap map;
  map.negate = true;
  EXPECT_TRUE(solid_cells(map, false)(Pixel{255}));
  EXPECT_FALSE(solid_cells(map, true)(Pixel{0}));
}

TEST(RosMapCells, ScaledMapsHaveUnknownCellsWhereTheyAreTransparent) {
  RosMap map;
  map.mode = RosMap::Mode::scale;
  for (const bool unknown_is_solid : {false, true}) {
    const PixelRule rule = solid_cells(map, unknown_is_solid);
    EXPECT_TRUE(rule(Pixel{0, 255}));
    EXPECT_EQ(rule(Pixel{0, 254}), unknown_is_solid);
    EXPECT_EQ(rule(Pixel{255, 255, 255, 0}), unknown_is_solid);
    EXPECT_FALSE(rule(Pixel{150}));  // a probability, below the one of occupied cells
  }
}

TEST(RosMapCells, RawMapsAreProbabilitiesInPercent) {
  RosMap map;
  map.mode = RosMap::Mode::raw;
  map.negate = true;  // does not count
  for (const bool unknown_is_solid : {false, true}) {
    const PixelRule rule = solid_cells(map, unknown_is_solid);
    EXPECT_FALSE(rule(Pixel{0}));
    EXPECT_FALSE(rule(Pixel{65}));
    EXPECT_TRUE(rule(Pixel{66}));
    EXPECT_TRUE(rule(Pixel{100}));
    EXPECT_EQ(rule(Pixel{101}), unknown_is_solid);
    EXPECT_EQ(rule(Pixel{255}), unknown_is_solid);
  }
}

}  // namespace
}  // namespace troupe::worldio::ros_map_test
