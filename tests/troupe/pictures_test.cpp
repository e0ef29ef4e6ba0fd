#include "troupe/pictures.hpp"

#include "base/diagnostics.hpp"
#include "tests/support/scratch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace troupe {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* k_world = R"({
  "troupe": 1, "seed": 7,
  "window": {"size_px": [200, 100], "center_m": [1, 2], "scale_px_per_m": 20, "show_grid": false},
  "types": {"bot": {"size_m": [0.4, 0.4, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"},
    "sensors": [{"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2, "samples": 9, "fov_deg": 90}]}]}},
  "populations": [{"name": "r", "type": "bot", "count": 6,
                   "place": {"rule": "grid", "region_m": [[0, 0], [4, 4]], "pitch_m": 1.5}}]
})";

class PicturesTest : public test::ScratchTest {
 protected:
  void SetUp() override { world_ = write("w.json", k_world); }
  std::string refusal(const PictureOptions& options) const {
    try {
      const Simulation simulation(world_);
      const Pictures pictures(simulation, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  std::filesystem::path world_;
};

TEST(PictureLayers, AreCheckedByName) {
  EXPECT_TRUE(check_layers(""));
  EXPECT_TRUE(check_layers("scans,-grid,+names"));
  EXPECT_THAT(check_layers("scan").error().text,
              AllOf(HasSubstr("unknown layer \"scan\"; known: beams, blobs, bounds, cells, "),
                    HasSubstr("(did you mean \"scans\"?)")));
  EXPECT_THAT(check_layers("scans,,grid").error().text, HasSubstr("unknown layer \"\""));
  for (const PictureLayer& layer : picture_layers()) EXPECT_TRUE(check_layers(std::string(layer.name)));
}

TEST(Cameras, AreCheckedByName) {
  for (const char* camera : {"top", "perspective", "window", "follow:r0", "follow:all", "fit"})
    EXPECT_TRUE(check_camera(camera)) << camera;
  EXPECT_EQ(check_camera("perspectiv").error().text,
            "unknown camera \"perspectiv\"; known: fit, follow:NAME, follow:all, perspective, top, window "
            "(did you mean "
            "\"perspective\"?)");
  EXPECT_THAT(check_camera("follow:").error().text, HasSubstr("unknown camera"));
  EXPECT_TRUE(check_camera("follow:NAME"));  // a model may be called so
}

#ifdef TROUPE_HAS_RENDER

TEST_F(PicturesTest, TheyShowWhatTheWorldHas) {
  Simulation simulation(world_);
  simulation.run_for(0.5);
  const std::string followed = "follow:" + simulation.robot_names()[2];
  for (const std::string& camera :
       {std::string("top"), std::string("perspective"), std::string("window"), followed}) {
    Pictures pictures(simulation,
                      {.width = 160, .height = 120, .camera = camera, .layers = "scans,names,trails,cells"});
    const std::vector<std::uint8_t> rgba = pictures.draw(pictures.take(simulation));
    ASSERT_EQ(rgba.size(), 160U * 120 * 4);
    int colored = 0;
    for (std::size_t i = 0; i < rgba.size(); i += 4) colored += rgba[i + 2] > rgba[i] + 60;
    EXPECT_GT(colored, 10) << camera;  // the robots are blue
  }
}

TEST_F(PicturesTest, AWindowSaysItsSizeUnlessAnotherIsAskedFor) {
  const Simulation simulation(world_);
  EXPECT_EQ(Pictures(simulation, {.camera = "window"}).width(), 200);
  EXPECT_EQ(Pictures(simulation, {.camera = "window"}).height(), 100);
  EXPECT_EQ(Pictures(simulation, {.width = 64, .height = 48, .camera = "window"}).width(), 64);
  EXPECT_EQ(Pictures(simulation, {}).width(), 1280);
  EXPECT_EQ(Pictures(simulation, {}).height(), 720);
}

TEST_F(PicturesTest, TheyChangeNothing) {
  Simulation watched(world_);
  Simulation alone(world_);
  Pictures pictures(watched, {.width = 64, .height = 48, .layers = "scans,trails", .color_by = "velocity.x"});
  for (int i = 0; i < 10; ++i) {
    watched.step();
    pictures.see(watched);
    static_cast<void>(pictures.draw(pictures.take(watched)));
    alone.step();
    EXPECT_EQ(watched.state_hash(), alone.state_hash());
  }
}

TEST_F(PicturesTest, BetweenTwoTicksBodiesAreBetweenTheirPlaces) {
  Simulation simulation(world_);
  simulation.run_for(1);
  Pictures pictures(simulation, {.width = 300,
                                 .height = 300,
                                 .center_m = std::array<double, 2>{1.5, 1.5},
                                 .across_m = 6,
                                 .layers = "-clock"});
  const Pictures::Shot earlier = pictures.take(simulation);
  simulation.run_for(0.5);
  const Pictures::Shot later = pictures.take(simulation);
  EXPECT_EQ(pictures.draw(Pictures::between(earlier, later, 0)), pictures.draw(earlier));
  const auto halfway = pictures.draw(Pictures::between(earlier, later, 0.5));
  EXPECT_NE(halfway, pictures.draw(earlier));
  EXPECT_NE(halfway, pictures.draw(later));
}

TEST_F(PicturesTest, AnyNumberOfTheStateMayBeTheColour) {
  Simulation simulation(world_);
  simulation.step();
  for (const char* value : {"velocity.x", "pose.heading", "stall.stalled", "ranger/eye.ranges.4",
                            "eye.ranges.4", "ranger.ranges.0", "command.mode"}) {
    Pictures pictures(simulation, {.width = 64, .height = 48, .color_by = value});
    EXPECT_EQ(pictures.draw(pictures.take(simulation)).size(), 64U * 48 * 4) << value;
  }
}

TEST_F(PicturesTest, WhatTheWorldHasNotIsNamed) {
  const std::string file = world_.string();
  EXPECT_EQ(refusal({.camera = "follow:missing"}), file + ": error: there is no model \"missing\" to follow");
  EXPECT_THAT(refusal({.color_by = "velocity.z"}),
              AllOf(HasSubstr(file + ": error: unknown value \"velocity.z\"; known: command.mode, "),
                    HasSubstr("(did you mean \"velocity.x\"?)")));
  EXPECT_THAT(refusal({.color_by = "velocity"}), HasSubstr("unknown value \"velocity\""));
  EXPECT_EQ(refusal({.color_by = "ranger/eye.ranges.9"}),
            file + ": error: \"ranger/eye.ranges\" has only the columns 0 to 8");
  EXPECT_THAT(refusal({.layers = "scan"}), HasSubstr("unknown layer \"scan\""));
  world_ = write("no_window.json", R"({"troupe": 1})");
  EXPECT_EQ(
      refusal({.camera = "window"}),
      world_.string() +
          ": error: the camera \"window\" needs a world file with the entry window; other cameras: fit, "
          "follow:all, follow:NAME, perspective, top");
}

TEST_F(PicturesTest, APictureIsAFile) {
  Simulation simulation(world_);
  simulation.run_for(0.3);
  Pictures pictures(simulation, {.width = 64, .height = 48, .camera = "perspective"});
  pictures.write(pictures.take(simulation), folder_ / "p.png");
  EXPECT_THAT(content(folder_ / "p.png"), HasSubstr("time_s"));
  EXPECT_THROW(pictures.write(pictures.take(simulation), folder_ / "none" / "p.png"), std::runtime_error);
}

#else

TEST_F(PicturesTest, WithoutRenderTheyAreAnError) {
  const Simulation simulation(world_);
  EXPECT_THROW(Pictures(simulation, {}), std::runtime_error);
}

#endif

}  // namespace
}  // namespace troupe
