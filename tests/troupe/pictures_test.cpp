#include "troupe/pictures.hpp"

#include "base/diagnostics.hpp"
#include "models/devices/led.hpp"
#include "tests/support/scratch.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::pictures_test {
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

/// Leaves out everything but the bodies.
constexpr const char* k_only_robots = "-grid,-shadows,-headings,-scale,-clock,-legend";

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

/// What a picture with a white background shows besides it.
struct Blots {
  int count = 0;            ///< connected areas of pixels that are not white
  bool touch_edge = false;  ///< whether one of them reaches the edge of the picture
};

Blots blots_in(const std::vector<std::uint8_t>& rgba, int width, int height) {
  const auto is_white = [&](int i) { return rgba[4 * static_cast<std::size_t>(i)] > 250; };
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(width) * height, 0);
  Blots blots;
  for (int start = 0; start < width * height; ++start) {
    if (seen[start] != 0 || is_white(start)) continue;
    ++blots.count;
    std::vector<int> open{start};
    seen[start] = 1;
    while (!open.empty()) {
      const int i = open.back();
      open.pop_back();
      const int x = i % width, y = i / width;
      blots.touch_edge = blots.touch_edge || x == 0 || y == 0 || x == width - 1 || y == height - 1;
      for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
        if (x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= height) continue;
        const int next = i + dx + dy * width;
        if (seen[next] != 0 || is_white(next)) continue;
        seen[next] = 1;
        open.push_back(next);
      }
    }
  }
  return blots;
}

TEST_F(PicturesTest, CamerasThatFollowAllRobotsShowAllOfThem) {
  for (const double away : {0.0, 40.0}) {
    Simulation simulation(world_);
    Pictures fit(
        simulation,
        {.width = 320, .height = 240, .camera = "fit", .layers = k_only_robots, .background = "white"});
    Pictures follow(simulation, {.width = 320,
                                 .height = 240,
                                 .camera = "follow:all",
                                 .layers = k_only_robots,
                                 .background = "white"});
    if (away > 0) {  // far outside of the region where the robots started
      for (std::size_t i = 0; i < 6; ++i) {
        Model robot = simulation.find(simulation.robot_names()[i]);
        const Pose pose = robot.pose();
        robot.set_pose({pose.x + away, pose.y + 1.5 * away, 0, 0});
      }
    }
    for (Pictures* pictures : {&fit, &follow}) {
      const Blots blots = blots_in(pictures->draw(pictures->take(simulation)), 320, 240);
      EXPECT_EQ(blots.count, 6) << away << (pictures == &fit ? " fit" : " follow:all");
      EXPECT_FALSE(blots.touch_edge) << away;
    }
  }
}

TEST_F(PicturesTest, AGivenCenterIsShownAlsoByACameraThatFollowsABody) {
  const Simulation simulation(world_);
  const auto drawn = [&](const std::string& camera) {
    Pictures pictures(simulation, {.width = 160,
                                   .height = 120,
                                   .camera = camera,
                                   .center_m = std::array<double, 2>{2.2, 1.3},
                                   .across_m = 6});
    return pictures.draw(pictures.take(simulation));
  };
  EXPECT_EQ(drawn("follow:" + simulation.robot_names()[0]), drawn("perspective"));
}

// A robot the size of a coin fills as much of its picture as one the size of a table.
TEST_F(PicturesTest, AFollowedBodyFillsThePictureAlikeWhateverItsSize) {
  const auto pixels_of = [&](const std::string& solids) {
    const Simulation simulation(
        write("one.json", R"({"troupe": 1, "bounds_m": [[-2, -2], [2, 2]], "types": {"bot": {)" + solids +
                              R"("drive": {"kind": "diff"}}},
      "models": [{"name": "b", "type": "bot"}]})"));
    Pictures pictures(simulation, {.width = 320,
                                   .height = 240,
                                   .camera = "follow:b",
                                   .layers = std::string(k_only_robots) + ",-bounds",
                                   .background = "white"});
    const std::vector<std::uint8_t> rgba = pictures.draw(pictures.take(simulation));
    double pixels = 0;
    for (std::size_t i = 0; i < rgba.size(); i += 4) pixels += rgba[i] <= 250;
    return pixels;
  };
  const double large = pixels_of(R"("size_m": [0.8, 0.6, 0.4], )");
  EXPECT_GT(large, 100);
  EXPECT_NEAR(pixels_of(R"("size_m": [0.04, 0.03, 0.02], )"), large, 0.2 * large);
  EXPECT_EQ(pixels_of(R"("device": {"kind": "led"}, )"), 0);  // without a shape
}

TEST_F(PicturesTest, LedsOnPartsAreDrawn) {
  // Two robots of a type whose LED is on a part above the body. The second one's LED is commanded.
  world_ = write(
      "lit.json",
      R"({"troupe": 1, "types": {"bot": {"size_m": [1, 1, 0.2], "color": "gray", "drive": {"kind": "diff"},
    "parts": [{"name": "mast", "size_m": [0.5, 0.5, 0.1], "pose": {"z_m": 0.2},
               "devices": [{"name": "lamp", "kind": "led", "shows": [0, 1, 0]}]}]}},
    "models": [{"name": "a", "type": "bot", "pose": {"x_m": -1}}, {"name": "b", "type": "bot", "pose": {"x_m": 1}}]})");
  Simulation simulation(world_);
  PictureOptions options{.width = 200,
                         .height = 100,
                         .center_m = std::array<double, 2>{0, 0},
                         .across_m = 4,
                         .layers = k_only_robots};
  const auto middles = [](Pictures& pictures, const Pictures::Shot& shot) {
    const std::vector<std::uint8_t> rgba = pictures.draw(shot);
    std::vector<std::vector<int>> found;
    for (const std::size_t x : {40U, 140U}) {  // behind the heading mark
      const std::uint8_t* pixel = &rgba[4 * (50 * 200 + x)];
      found.push_back({pixel[0], pixel[1], pixel[2]});
    }
    return found;
  };
  const std::vector<int> red{255, 0, 0}, green{0, 255, 0};
  Pictures pictures(simulation, options);
  EXPECT_THAT(middles(pictures, pictures.take(simulation)), ::testing::ElementsAre(green, green));
  simulation.find("b").command<models::LedCommand>("lamp") = {.shows = 1, .red = 1};
  simulation.step();
  EXPECT_THAT(middles(pictures, pictures.take(simulation)), ::testing::ElementsAre(green, red));
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

TEST_F(PicturesTest, AfterAResetWithASeedTheyShowTheStaticBodiesOfThisSeed) {
  const auto file = write("pillars.json", R"({"troupe": 1, "bounds_m": [[-5, -5], [5, 5]],
    "types": {"pillar": {"size_m": [0.4, 0.4, 1]}},
    "populations": [{"name": "p", "type": "pillar", "count": 8, "color": "random",
                     "place": {"rule": "uniform", "region_m": [[-4, -4], [4, 4]]}}]})");
  const PictureOptions options{.width = 200, .height = 200, .center_m = {{0, 0}}, .across_m = 10};
  Simulation again(file, {.threads = 1, .seed = 1});
  const std::vector<std::uint8_t> of_first_seed = again.picture(options);
  again.reset(2);
  const Simulation fresh(file, {.threads = 1, .seed = 2});
  EXPECT_EQ(again.picture(options), fresh.picture(options));
  EXPECT_NE(again.picture(options), of_first_seed);
  Pictures pictures(again, options);
  static_cast<void>(pictures.draw(pictures.take(again)));
  again.reset(1);
  pictures.update_scene(again);
  const Simulation first(file, {.threads = 1, .seed = 1});
  Pictures of_first(first, options);
  EXPECT_EQ(pictures.draw(pictures.take(again)), of_first.draw(of_first.take(first)));
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

// The shapes and rangers of a picture are those of the world with which the Pictures were made.
TEST_F(PicturesTest, StatesOfAnotherWorldAreErrors) {
  const auto refused = [](auto&& call, const std::string& what) {
    EXPECT_THAT(call, ::testing::ThrowsMessage<std::invalid_argument>(
                          what + ": found a state of another world: these Pictures draw only the world with "
                                 "which they were made"));
  };
  const Simulation small(write("small.json", R"({"troupe": 1})"));
  Simulation simulation(world_);
  simulation.step();
  const Pictures::Shot shot = Pictures(simulation, {.layers = "scans"}).take(simulation);
  for (const char* layers : {"", "scans", "coverage"}) {
    Pictures pictures(small, {.width = 16, .height = 16, .camera = "fit", .layers = layers});
    refused([&] { pictures.take(simulation); }, "take()");
    refused([&] { pictures.draw(shot); }, "draw()");
    refused([&] { pictures.write(shot, folder_ / "p.svg"); }, "write()");
    if (std::string(layers) == "coverage") refused([&] { pictures.see(simulation); }, "see()");
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "p.svg"));
}

TEST_F(PicturesTest, ShotsAndSharesAreChecked) {
  const Simulation simulation(world_);
  Pictures pictures(simulation, {.width = 16, .height = 16});
  const Pictures::Shot shot = pictures.take(simulation);
  const auto refused = [](auto&& call, const std::string& message) {
    EXPECT_THAT(call, ::testing::ThrowsMessage<std::invalid_argument>(message));
  };
  const std::string no_shot = ": found a null Shot: give one that take() returned";
  refused([&] { pictures.draw({}); }, "draw()" + no_shot);
  refused([&] { pictures.write({}, folder_ / "p.png"); }, "write()" + no_shot);
  refused([&] { Pictures::between({}, shot, 0.5); }, "between()" + no_shot);
  refused([&] { Pictures::between(shot, {}, 0.5); }, "between()" + no_shot);
  for (const double share : {-0.5, 1.5, std::numeric_limits<double>::quiet_NaN()})
    refused([&] { Pictures::between(shot, shot, share); },
            fmt::format("between(): share is {}: give a number from 0 to 1", share));
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

TEST_F(PicturesTest, TheLegendSaysThatASensorDoesNotRun) {
  world_ = write("resting.json", R"({"troupe": 1, "types": {"bot": {"size_m": [0.4, 0.4, 0.2],
    "drive": {"kind": "diff"}, "sensors": [
      {"name": "eye", "kind": "ranger", "active": false, "transducers": [{"range_max_m": 2}]}]}},
    "models": [{"name": "r0", "type": "bot"}]})");
  for (const bool runs : {false, true}) {
    Simulation simulation(world_);
    if (runs) simulation.subscribe("r0");
    simulation.step();
    Pictures pictures(simulation, {.color_by = "eye.ranges"});
    const std::filesystem::path file = folder_ / "colors.svg";
    pictures.write(pictures.take(simulation), file.string());
    EXPECT_EQ(content(file).find("eye.ranges (m): the sensor does not run") == std::string::npos, runs);
  }
}

TEST_F(PicturesTest, TheLegendSaysThatNoRobotHasAValue) {
  world_ = write("idle.json", R"({"troupe": 1, "types": {
    "cart": {"size_m": [0.4, 0.4, 0.2], "drive": {"kind": "diff"}},
    "bot": {"extends": "cart", "sensors": [
      {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2}]}]}},
    "models": [{"name": "r0", "type": "cart"}],
    "populations": [{"name": "b", "type": "bot", "count": 0,
                     "place": {"rule": "uniform", "region_m": [[1, 1], [2, 2]]}}]})");
  Simulation simulation(world_);
  simulation.step();
  Pictures pictures(simulation, {.color_by = "eye.ranges"});
  const std::filesystem::path file = folder_ / "colors.svg";
  pictures.write(pictures.take(simulation), file.string());
  EXPECT_THAT(content(file), HasSubstr("eye.ranges (m): no robot has the value"));
  EXPECT_EQ(refusal({.color_by = "eye.ranges.1"}),
            world_.string() + ": error: there is no column 1: \"eye.ranges\" has only the columns 0 to 0");
  EXPECT_THAT(refusal({.color_by = "eye.rangs"}), HasSubstr("(did you mean \"eye.ranges\"?)"));
}

TEST_F(PicturesTest, WhatTheWorldHasNotIsNamed) {
  const std::string file = world_.string();
  EXPECT_EQ(refusal({.camera = "follow:missing"}), file + ": error: there is no model \"missing\" to follow");
  EXPECT_THAT(refusal({.color_by = "velocity.z"}),
              AllOf(HasSubstr(file + ": error: unknown value \"velocity.z\"; known: command.mode, "),
                    HasSubstr("(did you mean \"velocity.x\"?)")));
  EXPECT_THAT(refusal({.color_by = "velocity"}), HasSubstr("unknown value \"velocity\""));
  EXPECT_EQ(refusal({.color_by = "ranger/eye.ranges.9"}),
            file + ": error: there is no column 9: \"ranger/eye.ranges\" has only the columns 0 to 8");
  EXPECT_THAT(refusal({.layers = "scan"}), HasSubstr("unknown layer \"scan\""));
  world_ = write("no_window.json", R"({"troupe": 1})");
  EXPECT_EQ(
      refusal({.camera = "window"}),
      world_.string() +
          ": error: the camera \"window\" needs a world file with the entry \"window\"; other cameras: fit, "
          "follow:all, follow:NAME, perspective, top");
}

TEST_F(PicturesTest, NumbersThatCannotBeDrawnAreErrors) {
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  const Simulation simulation(world_);
  const auto refused = [&](const PictureOptions& options, const std::string& message) {
    EXPECT_THAT([&] { Pictures(simulation, options); },
                ::testing::ThrowsMessage<std::invalid_argument>(message));
  };
  refused({.across_m = -1}, "across_m is -1: give a finite number, at least 1e-06");
  refused({.across_m = 0}, "across_m is 0: give a finite number, at least 1e-06");
  refused({.across_m = 1e-308}, "across_m is 1e-308: give a finite number, at least 1e-06");
  refused({.across_m = k_nan}, "across_m is nan: give a finite number, at least 1e-06");
  refused({.across_m = k_infinity}, "across_m is inf: give a finite number, at least 1e-06");
  refused({.angle_rad = {{k_infinity, 0}}}, "angle_rad is (inf, 0): give two finite numbers");
  refused({.center_m = {{0, k_nan}}}, "center_m is (0, nan): give two finite numbers");
  refused({.color_by = "velocity.x", .color_range = {{k_nan, 1}}},
          "color_range is (nan, 1): give two finite numbers");
  refused({.color_range = {{0, 1}}},
          "color_range has no effect without color_by: give color_by, or leave out color_range");
  Pictures smallest(simulation, {.width = 320, .height = 240, .across_m = k_least_across_m});
  EXPECT_EQ(smallest.draw(smallest.take(simulation)).size(), 320U * 240 * 4);
  for (const double high : {2.0, 1.5})
    refused({.color_by = "velocity.x", .color_range = {{2, high}}},
            fmt::format("color_range is (2, {}): give two different numbers, the lower first", high));
}

TEST_F(PicturesTest, ErrorsOfWritingNameThePicture) {
  const Simulation simulation(world_);
  Pictures pictures(simulation, {.width = 16, .height = 16});
  const Pictures::Shot shot = pictures.take(simulation);
  const auto expect_error = [&](const char* name) {
    const std::filesystem::path file = folder_ / name;
    const auto expected = ::testing::ThrowsMessage<std::runtime_error>(
        file.string() + ": error: cannot be written: there is no folder " + (folder_ / "none").string());
    EXPECT_THAT([&] { pictures.rehearse(file); }, expected);
    EXPECT_THAT([&] { pictures.write(shot, file); }, expected);
  };
  expect_error("none/p.png");
  expect_error("none/p.svg");
  try {
    pictures.rehearse(folder_ / "p.pdf");
  } catch (const std::runtime_error& error) {
    ASSERT_THAT(error.what(), HasSubstr("cairo is not installed"));
    GTEST_SKIP() << "cairo is not installed: a PDF was not tried";
  }
  expect_error("none/p.pdf");
}

TEST_F(PicturesTest, APictureIsAFile) {
  Simulation simulation(world_);
  simulation.run_for(0.3);
  Pictures pictures(simulation, {.width = 64, .height = 48, .camera = "perspective"});
  pictures.write(pictures.take(simulation), folder_ / "p.png");
  EXPECT_THAT(content(folder_ / "p.png"), HasSubstr("time_s"));
  EXPECT_THROW(pictures.write(pictures.take(simulation), folder_ / "none" / "p.png"), std::runtime_error);
  for (const char* name : {"p.jpg", "p"}) {
    EXPECT_THROW(pictures.write(pictures.take(simulation), folder_ / name), InputError);
    EXPECT_FALSE(std::filesystem::exists(folder_ / name));
  }
}

#else

TEST_F(PicturesTest, WithoutRenderTheyAreAnError) {
  const Simulation simulation(world_);
  EXPECT_THROW(Pictures(simulation, {}), std::runtime_error);
}

#endif

}  // namespace
}  // namespace troupe::pictures_test
