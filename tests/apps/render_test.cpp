#include "apps/exit_code.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/paths.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps::render_test {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Render : public ProgramTest {
 protected:
  void SetUp() override {
    write("room.world", k_room);
    const Outcome outcome = draw({"room.world"});
    if (lacks_pictures(outcome)) GTEST_SKIP() << "no pictures here: " << outcome.err;
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    first_ = pixels("p.png");
  }
  Outcome draw(std::vector<std::string> options) const {
    options.insert(options.begin(), "render");
    options.insert(options.end(), {"-o", "p.png", "--size", "96x64"});
    return troupe(options);
  }
  void record() {
    if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
    ASSERT_EQ(
        troupe({"run", "room.world", "--for", "1", "--quiet", "--record", "run.h5", "--checkpoint", "c.h5"})
            .code,
        0);
  }
  /// The compressed pixels of a picture, without the texts about it.
  std::string pixels(const std::string& png) const {
    const std::string bytes = read(png);
    const std::size_t begin = bytes.find("IDAT");
    return begin == bytes.npos ? "" : bytes.substr(begin);
  }

  std::string first_;  // the world as it begins
};

TEST_F(Render, AWorldIsDrawnAsItBeginsAndAtOtherTimes) {
  ASSERT_EQ(
      troupe({"run", "room.world", "--for", "0.5", "--quiet", "--snapshot", "run.png", "--size", "96x64"})
          .code,
      0);
  EXPECT_EQ(draw({"room.world", "--at", "0"}).code, 0);
  EXPECT_EQ(pixels("p.png"), first_);
  EXPECT_EQ(draw({"room.world", "--at", "0.5"}).code, 0);
  EXPECT_EQ(read("p.png"), read("run.png"));
  EXPECT_NE(pixels("p.png"), first_);
}

TEST_F(Render, AnImageOfTheWorldIsNotReplaced) {
  const std::string image = std::string("P5 3 3 255\n") + std::string(9, '\0');
  write("plan.png", image);  // the content of an image decides its format
  write("w.json", R"({"troupe": 1, "floorplans": [
      {"name": "plan", "bitmap": "plan.png", "size_m": [3, 3, 1]}]})");
  const Outcome outcome = troupe({"render", "w.json", "-o", "plan.png"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "plan.png: error: cannot be written: it is a file of the world, which this command reads: choose "
            "another file name\n");
  EXPECT_EQ(read("plan.png"), image);
}

TEST_F(Render, SeveralTimesAreSeveralPictures) {
  const Outcome outcome =
      troupe({"render", "room.world", "-o", "q-{time}.png", "--at", "0.2,0", "--size", "96x64"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(files(), ElementsAre("p.png", "q-0.2.png", "q-0.png", "room.world"));
}

TEST_F(Render, ACheckpointIsDrawnAsItWasSaved) {
  record();
  if (IsSkipped()) return;
  ASSERT_EQ(draw({"room.world", "--at", "1", "--layers", "scans"}).code, 0);
  const std::string at_its_end = pixels("p.png");
  EXPECT_EQ(draw({"c.h5", "--layers", "scans"}).code, 0);
  EXPECT_EQ(pixels("p.png"), at_its_end);
  const Outcome earlier = draw({"c.h5", "--at", "0.5"});
  EXPECT_EQ(earlier.code, 2);
  EXPECT_EQ(earlier.err,
            "c.h5: error: --at 0.5: the checkpoint was saved at 1 s; give this time or a later one\n");
  const Outcome film = troupe({"render", "c.h5", "--film", "f%06d.png", "--for", "0.5", "--size", "96x64"});
  EXPECT_EQ(film.code, 2);
  EXPECT_EQ(film.err,
            "c.h5: error: --for 0.5: the checkpoint was saved at 1 s; give this time or a later one\n");
  EXPECT_EQ(troupe({"render", "c.h5", "--film", "f%06d.png"}).err,
            "c.h5: error: no end time: give --for SECONDS\n");
  EXPECT_FALSE(std::filesystem::exists(path("f000000.png")));
}

TEST_F(Render, ARecordingIsDrawnWithoutItsWorld) {
  record();
  if (IsSkipped()) return;
  // Stalled robots have red outlines, and recordings are not asked to know.
  std::vector<std::pair<std::vector<std::string>, std::string>> pictures;
  for (const auto& [at, time] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--at", "0"}, "0"}, {{}, "1"}, {{"--at", "0.45"}, "0.4"}}) {
    EXPECT_EQ(draw({"room.world", "--at", time, "--layers=trails,coverage,-stalls"}).code, 0);
    pictures.emplace_back(at, pixels("p.png"));
  }
  std::filesystem::remove(path("room.world"));
  for (const auto& [at, expected] : pictures) {
    std::vector<std::string> options{"run.h5", "--layers=trails,coverage,-stalls"};
    options.insert(options.end(), at.begin(), at.end());
    const Outcome outcome = draw(options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(pixels("p.png"), expected) << at.size();
  }
  EXPECT_THAT(read("p.png"), HasSubstr("room.world"));
}

TEST_F(Render, WhatWasRecordedOfTheStateIsDrawn) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  ASSERT_EQ(
      troupe({"run", "room.world", "--for", "1", "--quiet", "--record", "all.h5", "--record-fields", "all"})
          .code,
      0);
  for (const std::vector<std::string>& look : std::vector<std::vector<std::string>>{
           {"--layers=scans,beams,names"},
           {"--color-by", "velocity.x"},
           {"--camera", "perspective", "--color-by", "pose.heading", "--layers=-legend"}}) {
    std::vector<std::string> options{"room.world", "--at", "1"};
    options.insert(options.end(), look.begin(), look.end());
    EXPECT_EQ(draw(options).code, 0);
    const std::string of_world = pixels("p.png");
    options = {"all.h5"};
    options.insert(options.end(), look.begin(), look.end());
    const Outcome outcome = draw(options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(pixels("p.png"), of_world) << look.front();
  }
}

TEST_F(Render, TheLegendOfARecordingNamesTypesWhosePartsShowColours) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  write("lit.json", R"({"troupe": 1, "types": {"bot": {"size_m": [1, 1, 0.2], "drive": {"kind": "diff"},
    "parts": [{"name": "mast", "size_m": [0.5, 0.5, 0.1], "pose": {"z_m": 0.2},
               "devices": [{"name": "lamp", "kind": "led", "shows": [0, 1, 0]}]}]}},
    "models": [{"name": "a", "type": "bot"}]})");
  ASSERT_EQ(troupe({"run", "lit.json", "--for", "0.2", "--quiet", "--record", "lit.h5"}).code, 0);
  for (const char* file : {"lit.json", "lit.h5"}) {
    const Outcome outcome = troupe({"render", file, "-o", "lit.svg", "--layers", "types"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(read("lit.svg"), HasSubstr(">bot (1)<")) << file;
  }
}

TEST_F(Render, ChargesThatWereRecordedAreThoseOfTheRun) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  write("packs.json", R"({"troupe": 1, "types": {
    "full": {"size_m": [0.4, 0.4, 0.2], "drive": {"kind": "diff"},
             "devices": [{"name": "pack", "kind": "power_pack", "capacity_J": 100, "stored_J": 40}]},
    "endless": {"size_m": [0.4, 0.4, 0.2], "drive": {"kind": "diff"},
                "devices": [{"name": "pack", "kind": "power_pack", "infinite": true}]},
    "plain": {"size_m": [0.4, 0.4, 0.2], "drive": {"kind": "diff"}}},
    "models": [{"name": "f", "type": "full"}, {"name": "e", "type": "endless", "pose": {"x_m": 1}},
               {"name": "p", "type": "plain", "pose": {"x_m": 2}}]})");
  ASSERT_EQ(troupe({"run", "packs.json", "--for", "1", "--quiet", "--record", "packs.h5", "--record-fields",
                    "pose,power_pack"})
                .code,
            0);
  ASSERT_EQ(draw({"packs.json", "--at", "1", "--layers=energy"}).code, 0);
  const std::string of_world = pixels("p.png");
  ASSERT_EQ(draw({"packs.h5", "--layers=energy"}).code, 0);
  EXPECT_EQ(pixels("p.png"), of_world);
  ASSERT_EQ(draw({"packs.h5"}).code, 0);
  EXPECT_NE(pixels("p.png"), of_world);
}

TEST_F(Render, ColoursThatAreShownAreThoseOfTheRun) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  const std::string world = test::source_dir().string() + "/worlds/gradient.json";  // hops by LEDs
  ASSERT_EQ(troupe({"run", world, "--for", "5", "--quiet", "--record", "g.h5"}).code, 0);
  ASSERT_EQ(draw({world, "--at", "5", "--layers=-stalls"}).code, 0);
  const std::string of_world = pixels("p.png");
  ASSERT_EQ(draw({world, "--at", "0", "--layers=-stalls"}).code, 0);
  const std::string at_first = pixels("p.png");
  ASSERT_EQ(draw({"g.h5", "--layers=-stalls"}).code, 0);
  EXPECT_EQ(pixels("p.png"), of_world);
  ASSERT_EQ(draw({"g.h5", "--at", "0", "--layers=-stalls"}).code, 0);
  EXPECT_EQ(pixels("p.png"), at_first);
}

// 4701 ticks of 3599.9 s end at 16923129.900000002 s in floating point.
TEST_F(Render, AFrameOfARecordingIsFoundByItsTimeHoweverLate) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  write("slow.json", R"({"troupe": 1, "tick_s": 3599.9, "bounds_m": [[-5, -5], [5, 5]],
    "types": {"bot": {"size_m": [0.3, 0.3, 0.3], "drive": {"kind": "diff"}}},
    "models": [{"name": "r", "type": "bot"}]})");
  const std::string end = "16923129.9";
  ASSERT_EQ(
      troupe({"run", "slow.json", "--for", end, "--quiet", "--record", "r.h5", "--record-every", end}).code,
      0);
  const Outcome outcome = draw({"r.h5", "--at", end});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(read("p.png"), HasSubstr(std::string("time_s\0", 7) + "16923129.900000002"));
}

TEST_F(Render, ScansWhoseFirstReadingIsZeroAreDrawn) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  // The first transducer is on the surface of the wall.
  write("touch.json", R"({"troupe": 1, "types": {
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "sensors": [
      {"name": "eye", "kind": "ranger", "transducers": [
        {"range_max_m": 2, "samples": 1, "pose": {"x_m": 0.5}},
        {"range_max_m": 2, "samples": 9, "fov_deg": 90, "pose": {"heading_deg": 90}}]}]},
    "wall": {"size_m": [1, 2, 1]}},
    "models": [{"name": "b", "type": "bot"}, {"name": "w", "type": "wall", "pose": {"x_m": 1}}]})");
  ASSERT_EQ(troupe({"run", "touch.json", "--for", "0.2", "--quiet", "--record", "touch.h5", "--record-fields",
                    "pose,ranges"})
                .code,
            0);
  ASSERT_EQ(draw({"touch.json", "--at", "0.2", "--layers=scans"}).code, 0);
  const std::string of_world = pixels("p.png");
  ASSERT_EQ(draw({"touch.h5", "--layers=scans"}).code, 0);
  EXPECT_EQ(pixels("p.png"), of_world);
  ASSERT_EQ(draw({"touch.h5"}).code, 0);
  EXPECT_NE(pixels("p.png"), of_world);
}

TEST_F(Render, TrailsOfARecordingAreThoseOfTheRun) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  ASSERT_EQ(troupe({"run", "room.world", "--for", "30.1", "--quiet", "--record", "long.h5"}).code, 0);
  ASSERT_EQ(draw({"room.world", "--at", "30.1", "--layers=trails,-stalls"}).code, 0);
  const std::string of_world = pixels("p.png");
  ASSERT_EQ(draw({"long.h5", "--layers=trails,-stalls"}).code, 0);
  EXPECT_EQ(pixels("p.png"), of_world);
}

TEST_F(Render, PartsThatAJointHasMovedAreDrawnFarFromTheirBody) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  write("crane.json", R"({"troupe": 1, "types": {"crane": {"size_m": [0.1, 0.1, 0.1], "pushable": true,
    "devices": [{"name": "arm", "kind": "actuator", "max_position": 3, "start_position": 3,
                 "size_m": [0.1, 0.1, 0.1]}]}}, "models": [{"name": "c", "type": "crane"}]})");
  ASSERT_EQ(troupe({"run", "crane.json", "--for", "0.2", "--quiet", "--record", "crane.h5"}).code, 0);
  for (const char* camera : {"top", "perspective", "follow:c"}) {
    const std::vector<std::string> look{"--camera", camera, "--center", "3,0", "--across", "2"};
    const auto drawn = [&](std::vector<std::string> options) {
      options.insert(options.end(), look.begin(), look.end());
      EXPECT_EQ(draw(options).code, 0) << camera;
      return pixels("p.png");
    };
    const std::string of_world = drawn({"crane.json", "--at", "0.2"});
    EXPECT_NE(of_world,
              drawn({"crane.json", "--at", "0.2", "--set", "/types/crane/devices/0/start_position=0"}))
        << camera;
    EXPECT_EQ(drawn({"crane.h5"}), of_world) << camera;
  }
}

TEST_F(Render, NamesArePlacedBesideShapesThatJointsHaveMoved) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  const std::string world = test::source_dir().string() + "/worlds/gripper.json";
  ASSERT_EQ(troupe({"run", world, "--for", "30", "--quiet", "--record", "g.h5"}).code, 0);
  ASSERT_EQ(draw({world, "--at", "30", "--layers=names,-stalls"}).code, 0);
  const std::string of_world = pixels("p.png");
  ASSERT_EQ(draw({"g.h5", "--layers=names,-stalls"}).code, 0);
  EXPECT_EQ(pixels("p.png"), of_world);
}

TEST_F(Render, ARecordingCanBeFilmed) {
  record();
  if (IsSkipped()) return;
  std::filesystem::create_directory(path("frames"));
  const Outcome outcome = troupe(
      {"render", "run.h5", "--film", "frames/%06d.png", "--fps", "20", "--size", "96x64", "--layers=trails"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Outcome faster =
      troupe({"render", "run.h5", "--film", "frames/f%06d.png", "--film-speed", "10", "--size", "96x64"});
  EXPECT_EQ(faster.code, 0) << faster.err;
  EXPECT_TRUE(std::filesystem::exists(path("frames/000020.png")));  // 0 to 1 s
  EXPECT_FALSE(std::filesystem::exists(path("frames/000021.png")));
  EXPECT_EQ(outcome.out, "frames/%06d.png: 21 pictures, 1.05 s\n");
  const Outcome both = draw({"run.h5", "--film", "frames/b%06d.png", "--fps", "20", "--layers=trails"});
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_EQ(both.out, "frames/b%06d.png: 21 pictures, 1.05 s\n");
  EXPECT_EQ(read("frames/b000010.png"), read("frames/000010.png"));
}

TEST_F(Render, AWorldIsRunAsOptionsSayAndFilmed) {
  const auto says = [&](const std::string& key, const std::string& value) {
    return read("p.png").find(key + '\0' + value) != std::string::npos;
  };
  ASSERT_EQ(draw({"room.world", "--for", "0.5", "--seed", "77", "--threads", "2"}).code, 0);
  EXPECT_TRUE(says("seed", "77"));
  EXPECT_TRUE(says("time_s", "0.5"));
  const std::string of_seed = pixels("p.png");
  ASSERT_EQ(draw({"room.world", "--at", "0.5", "--seed", "77", "--threads", "1"}).code, 0);
  EXPECT_EQ(pixels("p.png"), of_seed);

  std::filesystem::create_directory(path("frames"));
  const Outcome film = troupe({"render", "room.world", "--film", "frames/%06d.png", "--for", "0.5", "--fps",
                               "10", "--size", "96x64"});
  EXPECT_EQ(film.code, 0) << film.err;
  EXPECT_EQ(film.out, "frames/%06d.png: 6 pictures, 0.6 s\n");
  EXPECT_TRUE(std::filesystem::exists(path("frames/000005.png")));
  EXPECT_FALSE(std::filesystem::exists(path("frames/000006.png")));
  const Outcome both = draw({"room.world", "--film", "frames/b%06d.png", "--for", "0.5", "--fps", "10"});
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_TRUE(says("time_s", "0.5"));
  EXPECT_EQ(both.out, "frames/b%06d.png: 6 pictures, 0.6 s\n");
  for (const char* frame : {"000000.png", "000005.png"})
    EXPECT_EQ(read(std::string("frames/b") + frame), read(std::string("frames/") + frame));
}

TEST_F(Render, WhatIsStoppedKeepsWhatIsDrawn) {
  record();
  if (IsSkipped()) return;
  std::filesystem::create_directory(path("frames"));
  const Outcome film = troupe_until(
      {"render", "run.h5", "--film", "frames/%06d.png", "--film-speed", "0.01", "--size", "96x64"},
      "frames/000001.png", 1, SIGTERM);
  EXPECT_EQ(film.code, k_stopped) << film.err;
  EXPECT_FALSE(std::filesystem::exists(path("frames/002500.png")));
  const auto is_picture = [](const auto& entry) { return entry.path().extension() == ".png"; };
  EXPECT_TRUE(std::ranges::all_of(std::filesystem::directory_iterator(path("frames")), is_picture));

  const Outcome stills =
      troupe_until({"render", "room.world", "-o", "at-{time}.png", "--at", "1,100000", "--size", "96x64"},
                   "at-1.png", 1, SIGTERM);
  EXPECT_EQ(stills.code, k_stopped) << stills.err;
  EXPECT_FALSE(std::filesystem::exists(path("at-100000.png")));
}

TEST_F(Render, SaysThePresentNameOfAnEarlierSpelling) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  ASSERT_EQ(troupe({"run", "room.world", "--for", "1", "--quiet", "--record", "run.h5", "--record-fields",
                    "pose,ranges"})
                .code,
            0);
  const Outcome old = draw({"run.h5", "--color-by", "sensors/bot/ranger:0.ranges.3"});
  EXPECT_EQ(old.code, 0);
  EXPECT_EQ(
      old.err,
      "run.h5: warning: --color-by: \"sensors/bot/ranger:0.ranges.3\" is a name of an earlier version of "
      "Troupe; the name is now \"ranger:0.ranges.3\"\n");
  const Outcome present = draw({"run.h5", "--color-by", "ranger:0.ranges.3"});
  EXPECT_EQ(present.code, 0);
  EXPECT_EQ(present.err, "");

  // A world has no paths of recordings, so that the spelling is an error.
  for (const char* path : {"sensors/bot/ranger:0.ranges", "bot/ranger:0/ranges"}) {
    const std::string its_name = std::string(path) + "\": write \"ranger:0.ranges\" instead\n";
    const Outcome drawn = draw({"room.world", "--color-by", path});
    EXPECT_EQ(drawn.code, 2);
    EXPECT_THAT(drawn.err, EndsWith(": unknown value \"" + its_name));
    const Outcome recorded =
        troupe({"run", "room.world", "--for", "1", "--quiet", "--record", "r.h5", "--record-fields", path});
    EXPECT_EQ(recorded.code, 2);
    EXPECT_THAT(recorded.err, EndsWith(": unknown field \"" + its_name));
  }
  EXPECT_THAT(draw({"room.world", "--color-by", "sensors/bot/ranger:0.rangs"}).err,
              HasSubstr("unknown value \"sensors/bot/ranger:0.rangs\"; known: "));
}

TEST_F(Render, ColorsARecordingByAValueThatOnlyTypesWithoutBodiesHave) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  write("w.json", R"({"troupe": 1, "types": {
    "cart": {"size_m": [0.4, 0.4, 0.2], "drive": {"kind": "diff"}, "sensors": [{"name": "north", "kind": "compass"}]},
    "bot": {"extends": "cart", "sensors": [
      {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2, "fov_deg": 90, "samples": 9}]}],
      "controller": {"kind": "wander"}}},
    "models": [{"name": "r0", "type": "cart"}],
    "populations": [{"name": "b", "type": "bot", "count": 0,
                     "place": {"rule": "uniform", "region_m": [[1, 1], [2, 2]]}}]})");
  ASSERT_EQ(
      troupe({"run", "w.json", "--for", "1", "--quiet", "--record", "run.h5", "--record-fields", "all"}).code,
      0);
  const auto legend = [&](const std::string& value) {
    const Outcome drawn = troupe({"render", "run.h5", "-o", "p.svg", "--color-by", value});
    EXPECT_EQ(drawn.code, 0) << drawn.err;
    return read("p.svg");
  };
  for (const char* value : {"eye.ranges", "eye.ranges.3", "wander.avoid_updates", "wander/0.avoid_updates"})
    EXPECT_THAT(legend(value), HasSubstr(std::string(value) + ": no robot has the value"));
  for (const char* value : {"north.headin", "eyes.ranges", "eye"})
    EXPECT_THAT(troupe({"render", "run.h5", "-o", "q.svg", "--color-by", value}).err,
                HasSubstr("unknown value \"" + std::string(value)));
}

TEST_F(Render, WhatARecordingHasNotIsRefused) {
  record();
  if (IsSkipped()) return;
  std::filesystem::remove(path("p.png"));
  const auto refusal = [&](std::vector<std::string> options) {
    const Outcome outcome = draw(std::move(options));
    EXPECT_EQ(outcome.code, 2);
    EXPECT_FALSE(std::filesystem::exists(path("p.png")));
    return outcome.err;
  };
  EXPECT_EQ(refusal({"run.h5", "--layers", "scans"}),
            "run.h5: error: the recording has no ranges: record the run with --record-fields pose,ranges (in "
            "C++ and Python: fields)\n");
  EXPECT_EQ(refusal({"run.h5", "--layers", "energy"}),
            "run.h5: error: the recording has no power packs: record the run with --record-fields "
            "pose,power_pack (in C++ and Python: fields)\n");
  for (const char* layer : {"sights", "blobs", "grips", "links", "tiles", "cells", "speed"})
    EXPECT_EQ(refusal({"run.h5", "--layers", layer}),
              "run.h5: error: the layer \"" + std::string(layer) +
                  "\" can be drawn for worlds and checkpoints, but not for recordings: omit this layer\n");
  EXPECT_THAT(
      refusal({"run.h5", "--color-by", "velocity.x"}),
      AllOf(HasSubstr("run.h5: error: unknown value \"velocity.x\"; known: pose.heading, pose.x, "),
            HasSubstr("; the option --record-fields of the run (in C++ and Python: fields) selects what is "
                      "recorded\n")));
  EXPECT_EQ(refusal({"run.h5", "--camera", "follow:missing"}),
            "run.h5: error: there is no model \"missing\" to follow\n");
  EXPECT_THAT(
      refusal({"run.h5", "--camera", "window"}),
      HasSubstr("run.h5: error: the camera \"window\" needs a world file with the entry \"window\"; other "
                "cameras"));
  EXPECT_EQ(refusal({"run.h5", "--seed", "3"}),
            "run.h5: error: --seed cannot be used with a recording: omit this option (--at selects a time of "
            "the recording)\n");
  EXPECT_EQ(refusal({"run.h5", "--spare", "3"}),
            "run.h5: error: --spare cannot be used with a recording: omit this option (--at selects a time "
            "of the recording)\n");
  EXPECT_EQ(refusal({"c.h5", "--spare", "3"}),
            "c.h5: error: --spare cannot be used with a checkpoint: omit this option\n");
  EXPECT_EQ(refusal({"run.h5", "--for", "0.5"}),
            "run.h5: error: --for cannot be used with a recording: omit this option (--at selects a time of "
            "the recording)\n");
  EXPECT_EQ(refusal({"run.h5", "--at", "2"}),
            "run.h5: error: 2 s is not recorded: the recording contains 0 s to 1 s\n");
  const std::vector<std::string> before = files();
  EXPECT_EQ(troupe({"render", "run.h5", "-o", "at-{time}.png", "--at", "0.5,2"}).err,
            "run.h5: error: 2 s is not recorded: the recording contains 0 s to 1 s\n");
  EXPECT_EQ(files(), before);
  ASSERT_EQ(troupe({"run", "room.world", "--for", "1", "--quiet", "--record", "v.h5", "--record-fields",
                    "velocity"})
                .code,
            0);
  EXPECT_EQ(refusal({"v.h5"}),
            "v.h5: error: the recording has no poses: record the run with pose in --record-fields (in C++ "
            "and Python: fields)\n");
  {
    worldio::Hdf5File damaged = worldio::Hdf5File::open_to_write(path("v.h5"));
    const std::size_t frames = damaged.group("frames").dataset("tick").rows();
    const std::size_t bodies = damaged.group("bodies").dataset("id").rows();
    worldio::Hdf5Group pose = damaged.group("state").create_group("pose");
    for (const char* field : {"x", "y", "heading"}) {
      worldio::Hdf5Dataset array = pose.create_dataset(field, engine::Element::f64, {frames, bodies, 0});
      for (const char* name : {"unit", "frame", "text"}) array.set_text(name, "");
    }
  }
  EXPECT_THAT(refusal({"v.h5"}), HasSubstr("v.h5: error: the recording has no poses: "));
}

TEST_F(Render, BadInputIsOneLine) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"render"}, "troupe render: error: "},
      {{"render", "room.world"}, "troupe render: error: "},
      {{"render", "room.world", "-o", "q.jpg"},
       "troupe render: error: --output: \"q.jpg\" is not the name of a picture, as in --output crowd.png, "
       "crowd.svg or "
       "crowd.pdf; see"},
      {{"render", "room.world", "-o", "q.png", "--at", "1,2"},
       "troupe render: error: --at: several pictures need different names: write {time} in the name, as in "
       "--output q-{time}.png; see"},
      {{"render", "room.world", "-o", "q-{time}.png"},
       "troupe render: error: --output: {time} in the name of a picture is the time that --at gives: give "
       "--at, or another name; see"},
      {{"render", "nothing.world", "-o", "q.png"}, "nothing.world: error: "},
      {{"render", "room.world", "-o", "q.png", "--at", "1", "--for", "2"}, "--at excludes --for"},
      {{"render", "room.world", "-o", "q.png", "--for", "-2"}, "\"-2\" is not a time in seconds"},
      {{"render", "room.world", "-o", "q.png", "--seed", "x"}, "\"x\" is not a whole number"},
      {{"render", "room.world", "-o", "q.png", "--threads", "0"}, "\"0\" is not a number of threads"},
      {{"render", "room.world", "-o", "q.png", "--across-plugins"},
       "room.world: error: --across-versions and --across-plugins are only for checkpoints: omit these "
       "options"},
      {{"render", "room.world", "--film", "f%06d.png", "--at", "1"}, "--at requires --output"},
      {{"render", "room.world", "--film", "%06d.png"}, "no end time: give --for SECONDS"},
      {{"render", "room.world", "-o", "q.png", "--film", "%06d.png"}, "no end time: give --for SECONDS"},
      {{"render", "room.world", "-o", "none/q.png"},
       "none/q.png: error: cannot be written: there is no folder none"},
      {{"render", "room.world", "-o", "q.png", "--camera", "window"},
       "room.world: error: the camera \"window\" needs a world file with the entry \"window\""},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(lines_of(outcome.err), ElementsAre(HasSubstr(message)));
    EXPECT_THAT(files(), ElementsAre("p.png", "room.world"));
  }
}

}  // namespace
}  // namespace troupe::apps::render_test
