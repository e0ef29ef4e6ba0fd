#include "tests/apps/program.hpp"
#include "tests/support/paths.hpp"

#include <png.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe::apps::camera_pictures_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Pixels of a PNG, row by row, a number a channel.
struct Pixels {
  int width = 0;
  int height = 0;
  int bits = 0;
  int channels = 0;
  std::vector<int> values;

  /// The first three channels as 0xRRGGBB.
  int color(int column, int row) const {
    const int* pixel = &values[static_cast<std::size_t>((row * width + column) * channels)];
    return pixel[0] << 16 | pixel[1] << 8 | pixel[2];
  }
  int depth(int column, int row) const { return values[static_cast<std::size_t>(row * width + column)]; }
};

class CameraPicturesOf : public ProgramTest {
 protected:
  const std::string world_ = test::source_dir().string() + "/worlds/camera.world";

  Pixels pixels(const std::string& name) const {
    Pixels out;
    std::FILE* in = std::fopen(path(name).c_str(), "rb");
    EXPECT_NE(in, nullptr) << name;
    if (!in) return out;
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, in);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    out.width = static_cast<int>(png_get_image_width(png, info));
    out.height = static_cast<int>(png_get_image_height(png, info));
    out.bits = png_get_bit_depth(png, info);
    out.channels = png_get_channels(png, info);
    png_bytepp rows = png_get_rows(png, info);
    const int bytes = out.bits / 8;
    for (int row = 0; row < out.height; ++row)
      for (int i = 0; i < out.width * out.channels; ++i) {
        int value = 0;
        for (int byte = 0; byte < bytes; ++byte) value = value << 8 | rows[row][i * bytes + byte];
        out.values.push_back(value);
      }
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(in);
    return out;
  }
  std::vector<std::string> pictures(const std::string& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path(folder)))
      names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
  }
  /// The names of pictures() without those of depths.
  std::vector<std::string> color_pictures(const std::string& folder) const {
    std::vector<std::string> names = pictures(folder);
    std::erase_if(names, [](const std::string& name) { return name.find("-depth") != std::string::npos; });
    return names;
  }
};

TEST_F(CameraPicturesOf, AreWhatTheCameraReads) {
  const Outcome outcome =
      troupe({"run", world_, "--for", "0.1", "--quiet", "--camera-png", "seen", "--camera-every", "0"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(pictures("seen"), ElementsAre("r0.eye-000000.100s-color.png", "r0.eye-000000.100s-depth.png"));
  const Pixels color = pixels("seen/r0.eye-000000.100s-color.png");
  EXPECT_EQ(color.width, 40);
  EXPECT_EQ(color.height, 30);
  EXPECT_EQ(color.bits, 8);
  ASSERT_EQ(color.channels, 4);
  const Pixels depth = pixels("seen/r0.eye-000000.100s-depth.png");
  EXPECT_EQ(depth.width, 40);
  EXPECT_EQ(depth.bits, 16);
  ASSERT_EQ(depth.channels, 1);
  // Worked out in tests/troupe/sensor_scenes_test.cpp; depths in mm, and 0 for the sky.
  EXPECT_EQ(color.color(10, 14), 0xff0000);
  EXPECT_EQ(depth.depth(10, 14), 2000);
  EXPECT_EQ(color.color(30, 17), 0x0000ff);
  EXPECT_EQ(depth.depth(30, 17), 1600);
  EXPECT_EQ(color.color(20, 10), 0x00ff00);
  EXPECT_EQ(depth.depth(20, 10), 2900);
  EXPECT_EQ(color.color(12, 10), 0xf5deb3);
  EXPECT_EQ(color.color(20, 29), 0xcccccc);
  EXPECT_EQ(depth.depth(20, 29), 414);
  EXPECT_EQ(color.color(20, 3), 0x87ceeb);
  EXPECT_EQ(depth.depth(20, 3), 0);
}

TEST_F(CameraPicturesOf, EachSecondUnlessToldAndTheSameOnAnyThreads) {
  ASSERT_EQ(troupe({"run", world_, "--for", "2.5", "--quiet", "--threads", "1", "--camera-png", "a/"}).code,
            0);
  ASSERT_EQ(troupe({"run", world_, "--for", "2.5", "--quiet", "--threads", "3", "--tile-size", "0.7",
                    "--camera-png", "b"})
                .code,
            0);
  const std::vector<std::string> names = pictures("a");
  EXPECT_THAT(names, ElementsAre("r0.eye-000001.000s-color.png", "r0.eye-000001.000s-depth.png",
                                 "r0.eye-000002.000s-color.png", "r0.eye-000002.000s-depth.png"));
  EXPECT_EQ(pictures("b"), names);
  for (const std::string& name : names) EXPECT_EQ(read("a/" + name), read("b/" + name)) << name;
  EXPECT_NE(read("a/" + names[0]), read("a/" + names[2])) << "the robot drives on";
}

TEST_F(CameraPicturesOf, ChangeNoResult) {
  ASSERT_EQ(
      troupe({"run", world_, "--for", "1", "--quiet", "--hash-log", "with.log", "--camera-png", "seen"}).code,
      0);
  ASSERT_EQ(troupe({"run", world_, "--for", "1", "--quiet", "--hash-log", "without.log"}).code, 0);
  EXPECT_EQ(read("with.log"), read("without.log"));
}

TEST_F(CameraPicturesOf, CamerasOfOneNameAndSlowOnes) {
  write("w.world",
        "define bot position( size [0.2 0.2 0.2] camera( name \"eye\" alwayson 1 resolution [4 3] "
        "update_interval "
        "250 ) )\n"
        "bot( name \"a/b\" )\nbot( name \"a/b\" pose [1 0 0 0] )\n"
        "position( pose [3 0 0 0] camera( resolution [4 3] ) )\n");
  const Outcome outcome =
      troupe({"run", "w.world", "--for", "0.3", "--quiet", "--camera-png", "seen", "--camera-every", "0.1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  // The first reading is that of tick 3; the camera that no controller reads does not run.
  EXPECT_THAT(pictures("seen"),
              ElementsAre("a_b.eye#2-000000.300s-color.png", "a_b.eye#2-000000.300s-depth.png",
                          "a_b.eye-000000.300s-color.png", "a_b.eye-000000.300s-depth.png"));
}

TEST_F(CameraPicturesOf, RobotsThatAreNotInTheWorldHaveNone) {
  write("w.json", R"({"troupe": 1, "tick_s": 0.1,
  "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "sensors": [
    {"name": "eye", "kind": "camera", "active": true, "width": 4, "height": 3, "period_s": 0.2}]}},
  "populations": [{"name": "r", "type": "bot", "count": 1, "reserve": 2,
    "place": {"rule": "grid", "region_m": [[0, 0], [0, 0]], "pitch_m": 1}}],
  "at": [{"time_s": 0.3, "remove": {"model": "r0"}},
         {"time_s": 0.5, "add": {"population": "r", "pose": {"x_m": 4}}}]})");
  const Outcome outcome =
      troupe({"run", "w.json", "--for", "0.8", "--quiet", "--camera-png", "seen", "--camera-every", "0.1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(color_pictures("seen"),
              ElementsAre("r0.eye-000000.200s-color.png", "r0.eye-000000.300s-color.png",
                          "r1.eye-000000.700s-color.png", "r1.eye-000000.800s-color.png"));
}

TEST_F(CameraPicturesOf, CamerasThatAreStoppedHaveNone) {
  write("w.json", R"({"troupe": 1, "tick_s": 0.1,
  "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "sensors": [
    {"name": "eye", "kind": "camera", "active": true, "width": 4, "height": 3}]}},
  "models": [{"name": "r0", "type": "bot"}, {"name": "r1", "type": "bot", "pose": {"x_m": 4}}],
  "at": [{"time_s": 0.2, "disable": {"model": "r0"}}, {"time_s": 0.4, "enable": {"model": "r0"}}],
  "faults": [{"model": "r1", "from_s": 0.3, "dead_sensors": {}}]})");
  const Outcome outcome =
      troupe({"run", "w.json", "--for", "0.5", "--quiet", "--camera-png", "seen", "--camera-every", "0.1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(color_pictures("seen"),
              ElementsAre("r0.eye-000000.100s-color.png", "r0.eye-000000.200s-color.png",
                          "r0.eye-000000.500s-color.png", "r1.eye-000000.100s-color.png",
                          "r1.eye-000000.200s-color.png", "r1.eye-000000.300s-color.png"));
}

TEST_F(CameraPicturesOf, NamesThatAreTooLongForFilesAreRefusedBeforeTheRun) {
  const auto run = [&](std::size_t bytes) {
    write("w.json", R"({"troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "sensors": [
      {"name": "eye", "kind": "camera", "active": true, "width": 4, "height": 3}]}},
      "models": [{"type": "bot", "name": ")" +
                        std::string(bytes - std::string(".eye").size(), 'x') + R"("}]})");
    return troupe({"run", "w.json", "--for", "1", "--quiet", "--camera-png", "seen", "--hash-log", "h.log"});
  };
  constexpr std::size_t k_most = 255 - std::string_view("-000001.000s-depth.png.1000.partial").size();
  const Outcome refused = run(k_most + 1);
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(lines_of(refused.err),
              ElementsAre(AllOf(HasSubstr("w.json: error: --camera-png: the name \"xxx"),
                                HasSubstr("xxx.eye\" has 221 bytes, which is too long for the names of its "
                                          "images: at most 220 bytes are possible"))));
  EXPECT_THAT(files(), ElementsAre("w.json"));
  EXPECT_EQ(run(k_most).code, 0);
  EXPECT_EQ(pictures("seen").size(), 2u);
}

TEST_F(CameraPicturesOf, WhatCannotBeWrittenIsToldBeforeTheRun) {
  write("file", "x");
  write("blind.world", "position()\n");
  const auto refused = [&](std::vector<std::string> arguments, const std::string& message) {
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), {"--for", "1", "--hash-log", "h.log"});
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(lines_of(outcome.err), ElementsAre(HasSubstr(message)));
    EXPECT_THAT(files(), ElementsAre("blind.world", "file"));
  };
  refused({world_, "--camera-png", "file"}, "file: error: cannot be written: it is not a folder");
  refused({world_, "--camera-png", "none/seen"},
          "none/seen: error: cannot be written: there is no folder none");
  refused({"blind.world", "--camera-png", "seen"},
          "blind.world: error: --camera-png: no camera of this world runs");
  refused({world_, "blind.world", "--camera-png", "seen"}, "several worlds need different outputs");
  refused({world_, "--camera-every", "1"}, "--camera-every requires --camera-png");
  refused({world_, "--camera-png", "seen", "--camera-every", "often"},
          "--camera-every: \"often\" is not a time in seconds, from 0 to 1000000000");
}

}  // namespace
}  // namespace troupe::apps::camera_pictures_test
