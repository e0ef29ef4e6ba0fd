// A world that was converted to another format runs with the same hashes.

#include "worldio/convert.hpp"
#include "base/diagnostics.hpp"
#include "engine/world/world.hpp"
#include "tests/support/hash_log.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "troupe/simulation.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <ostream>
#include <string>
#include <vector>

namespace troupe::convert_test {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const fs::path k_source = test::source_dir();

struct World {
  std::string file;  ///< below the source folder
  int ticks = 20;

  friend std::ostream& operator<<(std::ostream& out, const World& world) { return out << world.file; }
};

class ConvertTest : public test::ScratchTest {
 protected:
  /// Converts a world to a file of the scratch folder; what was found is kept in `found`.
  fs::path convert(const fs::path& from, const fs::path& to, const worldio::LoadOptions& options = {}) {
    Diagnostics diagnostics;
    fs::create_directories((folder_ / to).parent_path());
    const worldio::ConvertedWorld world =
        worldio::convert_world(from, folder_ / to, registry_, options, diagnostics);
    found.clear();
    for (const Finding& finding : diagnostics.findings())
      if (finding.severity == Severity::error) found.push_back(diagnostics.text(finding));
    warnings.clear();
    for (const Finding& finding : diagnostics.findings())
      if (finding.severity == Severity::warning) warnings.push_back(diagnostics.text(finding));
    return write(to, found.empty() ? world.text : std::string());
  }

  static std::vector<std::string> hash_log(const fs::path& world, int ticks) {
    Simulation simulation(world, SimulationOptions{.threads = 2});
    return test::hash_log(simulation, ticks);
  }

  std::vector<std::string> found;
  std::vector<std::string> warnings;

 private:
  engine::Registry registry_ = make_registry();
};

class ConvertedWorlds : public ConvertTest, public ::testing::WithParamInterface<World> {};

TEST_P(ConvertedWorlds, RunWithTheSameHashes) {
  const fs::path world = k_source / GetParam().file;
  if (!fs::exists(world)) GTEST_SKIP() << "Stage's data are not in " << world.string();
  const int ticks = test::k_slow_build ? 1 : GetParam().ticks;
  const std::vector<std::string> log = hash_log(world, ticks);
  const fs::path json = convert(world, "first.json");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_EQ(hash_log(json, ticks), log);
  // From JSON to JSON is a normal form: a second time changes nothing.
  const fs::path again = convert(json, "again.json");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_EQ(content(convert(again, "first.json")), content(again));
}

TEST_P(ConvertedWorlds, ComeBackFromJsonAsWorldsOfStage) {
  const fs::path world = k_source / GetParam().file;
  if (!fs::exists(world)) GTEST_SKIP() << "Stage's data are not in " << world.string();
  if (world.extension() != ".world") GTEST_SKIP() << "is no world of Stage";
  const int ticks = test::k_slow_build ? 1 : GetParam().ticks;
  const fs::path back = convert(convert(world, "w.json"), "w.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_EQ(hash_log(back, ticks), hash_log(world, ticks));
}

std::vector<World> converted_worlds() {
  std::vector<World> worlds;
  for (const scenes::Run& run : scenes::runs_of("convert"))
    worlds.push_back({"worlds/" + run.world, static_cast<int>(run.ticks)});
  for (const auto& [world, ticks] :
       {std::pair("simple.world", 50), std::pair("pioneer_walle.world", 50), std::pair("roomba.world", 50),
        std::pair("sensor_noise_demo.world", 50), std::pair("lsp_test.world", 50),
        std::pair("pioneer_flocking.world", 20), std::pair("benchmark/cave.world", 10)})
    worlds.push_back({fmt::format("../shared/stage-worlds/{}", world), ticks});
  return worlds;
}

INSTANTIATE_TEST_SUITE_P(Convert, ConvertedWorlds, ::testing::ValuesIn(converted_worlds()),
                         [](const auto& test) {
                           std::string name = fs::path(test.param.file).filename().string();
                           for (char& c : name)
                             if (c == '.' || c == '-' || c == '_') c = '0';
                           return name;
                         });

/// In Stage's syntax, with includes, macros, bitmaps and units, wherever Stage's own are not.
INSTANTIATE_TEST_SUITE_P(InStagesSyntax, ConvertedWorlds,
                         ::testing::Values(World{"tests/stage_like/quarry.world", 50},
                                           World{"tests/stage_like/yard.world", 40},
                                           World{"tests/stage_like/swarm.world", 50},
                                           World{"tests/troupe/stage_styles/demo.world", 50},
                                           World{"tests/troupe/stage_styles/blocks.world", 50},
                                           World{"tests/troupe/stage_styles/disc.world", 50},
                                           World{"tests/troupe/stage_styles/noise.world", 50},
                                           World{"tests/troupe/stage_styles/odometry.world", 50},
                                           World{"tests/troupe/stage_styles/flock.world", 20},
                                           World{"tests/troupe/stage_styles/everything.world"},
                                           World{"tests/troupe/stage_styles/units.world"},
                                           World{"tests/troupe/stage_styles/layers.world"}),
                         [](const auto& test) { return fs::path(test.param.file).stem().string(); });

/// All that a world of Stage can say that is not a property of one model alone.
constexpr std::string_view k_zoo = R"(
name "zoo" interval_sim 50 quit_time 7 seed 11 unit_angle "degrees" speedup 2 show_clock 1
window( size [ 700 500 ] center [1 2] rotate [33 7] scale 20 show_grid 0 )
define block_bot position(
  size [0.6 0.5 0.3] origin [0.05 0 0 10] color "NavyBlue" localization "odom"
  block( points 4 point[0] [0 0] point[1] [3 0] point[2] [2 2] point[3] [0 1] z [0 1] )
  block( points 3 point[0] [0 0] point[1] [1 0] point[2] [1 5] z [1 2] )
  update_interval 250 velocity_bounds [-0.3 0.3 0 0 0 0 -77 77]
  ctrl [ "script law=wave" ]
  ranger( name "eye" pose [0.1 0.02 -0.1 13] size [0.1 0.2 0.3]
    sensor( pose [0.01 0.02 0.03 17] range [0.1 3.3] fov 123 samples 7 noise [0.0001 0.01 0.2] )
    sensor( pose [0 0 0 -100] range [0 2] fov 30 samples 2 )
    model( pose [0.01 0.02 0.03 33] size [0.05 0.06 0.07] color_rgba [0.1 0.2 0.3 0.4]
      model( name "leaf" pose [0.1 0.2 0 71] size [0.01 0.01 0.01] ranger_return 0.3 ) ) )
  fiducial( range_max 3 fov 200 alwayson 1 )
  model( name "/global" size [0.1 0.1 0.1] color "random" fiducial_return 3 )
)
block_bot( name "a" pose [1 1 0 37] )
block_bot( pose [-1 2 0 270] color "red" )
block_bot( name "a" pose [-3 -2 0 -190] )
model( name "arm" pose [0 -3 0 20] size [0.3 0.3 0.3]
  actuator( type "rotational" axis [0 0 1] min_position -1 max_position 1 start_position 0.5 size [0.2 0.1 0.1]
    model( pose [0.2 0 0 0] size [0.3 0.05 0.05] ) ranger( alwayson 1 sensor( range [0 4] ) ) ) )
position( name "hand" pose [3 -3 0 0] size [0.3 0.3 0.2] joules 100 joules_capacity 200 mass 3
  gripper( pose [0.2 0 -0.2 0] size [0.1 0.2 0.1] autosnatch 1 alwayson 1 ) )
model( name "puck" pose [3.25 -3 0 0] size [0.05 0.05 0.05] gripper_return 1 )
model( name "charger" pose [4 3 0 45] size [0.2 0.2 0.2] joules -1 give_watts 20 alwayson 1 )
model( name "nothing" noblocks 1 )
model( name "overlap" pose [4.05 3 0 0] size [0.3 0.3 0.3] )
model( color "green" ) model( pose [6 6 0 0] )
)";

TEST_F(ConvertTest, TheZooComesThroughBothWays) {
  const fs::path world = write("zoo.world", k_zoo);
  const std::vector<std::string> log = hash_log(world, 40);
  const fs::path json = convert(world, "zoo.json");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_EQ(hash_log(json, 40), log) << content(json);
  const fs::path back = convert(json, "back.world");
  ASSERT_THAT(found, IsEmpty()) << content(json);
  EXPECT_EQ(hash_log(back, 40), log) << content(back);
}

TEST_F(ConvertTest, NamesAndWhatIsWatchedAreKept) {
  const fs::path json = convert(write("zoo.world", k_zoo), "zoo.json");
  ASSERT_THAT(found, IsEmpty());
  const Simulation simulation(json, {.threads = 1});
  EXPECT_EQ(simulation.title(), "zoo");
  const engine::World& world = simulation.world();
  EXPECT_TRUE(world.state().names.find("_ground_model").valid());
  EXPECT_EQ(world.state().names.find("model:0"), world.state().names.find("_ground_model"));
  EXPECT_EQ(world.state().names.find("position:1").index(), 2u) << "its generated name";
  EXPECT_EQ(world.state().names.find("a").index(), 3u) << "the last of a name";
  EXPECT_EQ(world.spec().part_aliases.at("global").body.index(), 3u);
  EXPECT_EQ(world.spec().watch.rate, 2);
  ASSERT_TRUE(world.spec().window);
  EXPECT_EQ(engine::get(worldio::window_fields(), *world.spec().window, "size_px").numbers(),
            (std::vector<double>{700, 500}));
}

TEST_F(ConvertTest, TheJsonReadsAsAPersonWouldWriteIt) {
  const std::string text = content(convert(write("w.world", R"(
define minibot position( size [0.2 0.2 0.2] color "SteelBlue" drive "diff"
  ranger( pose [0 0 -0.1 30] sensor( range [0 2] ) ) ctrl "expand" )
minibot( name "r0" pose [1 2 0 90] )
minibot( name "r1" pose [-0.25 2 0 0] color "red" )
)"),
                                           "w.json"));
  for (
      const char* line :
      {R"("minibot": {)", R"("size_m": [0.2, 0.2, 0.2],)", R"("color": "SteelBlue",)", R"("kind": "diff")",
       R"({"name": "r0", "alias": "position:0", "type": "minibot", "pose": {"x_m": 1, "y_m": 2, "heading_deg": 90}},)",
       R"("pose": {"x_m": -0.25, "y_m": 2, "heading_deg": 0},)", R"("controller": {"kind": "expand")",
       R"("name": "ranger:0",)"})
    EXPECT_THAT(text, HasSubstr(line));
}

TEST_F(ConvertTest, ImagesStayImagesWhereverTheWorldGoes) {
  const fs::path json = convert(k_source / "worlds/cave-simple.json", "deep/er/w.json");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_THAT(content(json), HasSubstr("/cave.png\""));
  EXPECT_THAT(content(json), Not(HasSubstr("contours_m")));
}

TEST_F(ConvertTest, ImagesWithoutHeightAreWrittenAsOutlines) {
  write("dot.pgm", "P5 2 1 255\n" + std::string("\x00\xff", 2));
  const fs::path world = write("w.world", "model( bitmap \"dot.pgm\" size [1 1 0] )\n");
  const fs::path json = convert(world, "w.json");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_THAT(content(json), HasSubstr("contours_m"));
  EXPECT_EQ(hash_log(json, 2), hash_log(world, 2));
}

TEST_F(ConvertTest, WhatStageHasNoWordForIsNamedWithItsLine) {
  const fs::path json = write("w.json", R"({"troupe": 1,
  "ranging": "grid",
  "measures": ["stalls"],
  "types": {
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
      "sensors": [
        {"name": "eye", "kind": "ranger", "transducers": [{"noise_relative": 0.1}]},
        {"name": "fid", "kind": "fiducial", "most_targets": 3}],
      "devices": [
        {"name": "pack", "kind": "power_pack", "capacity_J": 5}]}
  },
  "models": [{"name": "r", "type": "bot"}]})");
  convert(json, "w.world");
  EXPECT_THAT(found,
              ElementsAre(HasSubstr("w.json:2: error: a .world file cannot express this: \"ranging\""),
                          HasSubstr("w.json:3: error: a .world file cannot express this: \"measures\"")));

  std::string text = content(json);
  for (const char* line : {"  \"ranging\": \"grid\",\n", "  \"measures\": [\"stalls\"],\n"})
    text.erase(text.find(line), std::string_view(line).size());
  convert(write("w.json", text), "w.world");
  EXPECT_THAT(
      found,
      testing::UnorderedElementsAre(
          HasSubstr("w.json:5: error: a .world file cannot express this: type \"bot\": device \"eye\" "
                    "transducers: the value of \"noise_relative\""),
          HasSubstr("w.json:6: error: a .world file cannot express this: type \"bot\": device \"fid\": "
                    "the value of \"most_targets\""),
          HasSubstr("w.json:8: error: a .world file cannot express this: type \"bot\": its device "
                    "\"pack\" of kind power_pack: Stage has no such device"),
          HasSubstr("it has no device \"power\" of kind power_pack, but in the written file it would have "
                    "this device")));
}

TEST_F(ConvertTest, SecondNamesJointsAndLargeSeedsAreNamedWithTheirLines) {
  const std::string text = R"({"troupe": 1, "seed": 9007199254740993,
  "ground": {"alias": "floor"},
  "types": {"big bot": {"size_m": [0.2, 0.2, 0.2], "parts": [
    {"name": "lift", "kind": "actuator", "size_m": [0.1, 0.1, 0.1], "device": {}, "parts": [
      {"name": "load", "size_m": [0.1, 0.1, 0.1], "joint": null}]},
    {"name": "box", "alias": "chest", "size_m": [0.1, 0.1, 0.1]},
    {"name": "turned", "pose": {"heading_rad": 7}, "size_m": [0.1, 0.1, 0.1]}]}},
  "models": [
    {"name": "r", "alias": "robot", "type": "big bot", "global_parts": ["load"]}]})";
  convert(write("w.json", text), "w.world");
  EXPECT_THAT(found, ElementsAre(HasSubstr("w.json:1: error: a .world file cannot express this: \"seed\": "
                                           "numbers of a .world file must be from -2^53 to 2^53")));

  std::string small = text;
  small.replace(small.find("9007199254740993"), 16, "9007199254740992");
  convert(write("w.json", small), "w.world");
  EXPECT_THAT(
      found,
      ElementsAre(
          HasSubstr("a .world file cannot express this: \"_ground_model\": its alias \"floor\""),
          HasSubstr("w.json:9: error: a .world file cannot express this: \"r\": its alias \"robot\""),
          HasSubstr("w.json:6: error: a .world file cannot express this: type \"big bot\": part \"box\": "
                    "its alias \"chest\""),
          HasSubstr("w.json:5: error: a .world file cannot express this: type \"big bot\": part \"load\": "
                    "the joint that it is mounted on")));
  EXPECT_THAT(warnings,
              ElementsAre(HasSubstr("type \"big bot\" is called \"big_bot\" when the written file is read"),
                          HasSubstr("part \"turned\": its heading is wrapped into [-pi, pi]")));
}

TEST_F(ConvertTest, PartsThatAPowerPackSuppliesAreKeptOrNamed) {
  convert(write("w.json", R"({"troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "parts": [
    {"name": "lift", "kind": "actuator", "size_m": [0.1, 0.1, 0.1], "device": {},
     "devices": [{"name": "lift.power", "kind": "power_pack", "capacity_J": 9, "stored_J": 9, "idle_W": 0}]},
    {"name": "box", "size_m": [0.1, 0.1, 0.1], "joint": "lift",
     "sensors": [{"name": "eye", "kind": "fiducial"}]}]}},
  "models": [{"name": "r", "type": "bot"}]})"),
          "w.world");
  EXPECT_THAT(found,
              ElementsAre(HasSubstr("w.json:3: error: a .world file cannot express this: type \"bot\": "
                                    "device \"lift.power\": the devices that it supplies")));
}

TEST_F(ConvertTest, PowerPacksOfModelsWithTheSameNameComeBack) {
  const fs::path world = write("w.world", R"(define bay model( name "bay" size [0.1 0.1 0.1] joules 9 )
position( name "r" size [0.4 0.4 0.3] bay( pose [0.1 0 0 0] ) bay( pose [-0.1 0 0 0] ) )
)");
  const fs::path json = convert(world, "w.json");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_THAT(content(json), HasSubstr("\"bay.power#2\""));
  EXPECT_EQ(hash_log(json, 2), hash_log(world, 2));
}

TEST_F(ConvertTest, FullPowerPacksAndThoseThatNeverRunOutComeBack) {
  const fs::path json = write("packs.json", R"({"troupe": 1, "types": {
    "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"},
      "devices": [{"name": "power", "kind": "power_pack", "capacity_J": 5}]},
    "box": {"size_m": [0.4, 0.4, 0.3], "devices": [{"name": "power", "kind": "power_pack", "capacity_J": 5}]},
    "mains": {"size_m": [0.4, 0.4, 0.3],
      "devices": [{"name": "power", "kind": "power_pack", "capacity_J": 9, "infinite": true}]}},
  "models": [{"name": "a", "type": "bot"}, {"name": "b", "type": "box", "pose": {"x_m": 2}},
    {"name": "c", "type": "mains", "pose": {"x_m": 4}}]})");
  const fs::path back = convert(json, "back.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_EQ(hash_log(back, 3), hash_log(json, 3));

  const fs::path world = write("mains.world", "model( joules -1 joules_capacity 50 )\n");
  convert(convert(world, "mains.json"), "back.world");
  EXPECT_THAT(found, IsEmpty());
}

TEST_F(ConvertTest, ConstantDrawsComeBackInModelsThatRun) {
  const fs::path world = write("draws.world", R"(
define bot position( size [0.3 0.3 0.3] joules 100 )
bot( name "a" model( size [0.1 0.1 0.1] take_watts 5 ) model( size [0.1 0.1 0.1] watts 3 alwayson 1 )
  fiducial( watts 4 alwayson 1 ) )
bot( name "b" pose [3 0 0 0] fiducial( watts 4 alwayson 1 ) )
model( name "c" pose [6 0 0 0] joules 100 watts 2 alwayson 1 fiducial() )
)");
  const fs::path back = convert(convert(world, "draws.json"), "back.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_THAT(content(back), HasSubstr("watts 7\n"));
  EXPECT_THAT(content(back), Not(HasSubstr("alwayson 1\n    alwayson 1")));
  EXPECT_EQ(hash_log(back, 5), hash_log(world, 5));
}

TEST_F(ConvertTest, AnArenaWithoutWallsIsNotOfStage) {
  const auto world = [](const std::string& walls) {
    return R"({"troupe": 1,
  "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}}},
  "arena": {"size_m": [4, 4], "walls": )" +
           walls + R"(},
  "models": [{"name": "r", "type": "bot"}]})";
  };
  convert(write("w.json", world("false")), "w.world");
  EXPECT_THAT(found, ElementsAre(HasSubstr("w.json:3: error: a .world file cannot express this: \"arena\": "
                                           "without walls, an arena only sets the bounds")));
  convert(write("w.json", world("true")), "w.world");
  EXPECT_THAT(found, IsEmpty());
  EXPECT_THAT(warnings, Contains(HasSubstr("w.json:3: warning: the world of a .world file reaches 100 km "
                                           "from its origin in each direction: the edge of the arena no "
                                           "longer stops robots")));
}

TEST_F(ConvertTest, DevicesAndPartsOfOneNameComeBack) {
  const fs::path world = write("eyes.world", R"(
position( name "r" ranger( name "eye" alwayson 1 sensor( range [0 3] ) )
  ranger( name "eye" alwayson 1 sensor( range [0 7] ) ) model( name "eye" size [0.1 0.1 0.1] ) )
model( pose [5 0 0 0] size [0.2 4 2] )
)");
  const fs::path back = convert(convert(world, "eyes.json"), "back.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_EQ(hash_log(back, 2), hash_log(world, 2));
}

TEST_F(ConvertTest, AModelMayHaveThousandsOfPartsAndSensors) {
  constexpr int k_parts = 3000;  // a search through all sensors for each pair of parts would take minutes
  std::string text = "position( name \"r\"\n";
  for (int i = 0; i < k_parts; ++i) text += "  model( size [0.1 0.1 0.1] ranger( sensor( samples 1 ) ) )\n";
  convert(write("parts.world", text + ")\n"), "back.world");
  EXPECT_THAT(found, IsEmpty());
}

TEST_F(ConvertTest, AModelMayHaveThousandsOfPartsWithPowerPacks) {
  constexpr int k_parts = 8000;  // a search through all packs and parts for each pack would take minutes
  std::string text = "position( name \"r\"\n";
  for (int i = 0; i < k_parts; ++i) text += "  model( size [0.1 0.1 0.1] joules 9 watts 1 alwayson 1 )\n";
  convert(write("packs.world", text + ")\n"), "back.world");
  EXPECT_THAT(found, IsEmpty());
}

TEST_F(ConvertTest, APartMayHaveThousandsOfControllersAndSensors) {
  constexpr int k_each = 10000;  // a search through all sensors for each controller would take a minute
  std::string controllers, sensors;
  for (int i = 0; i < k_each; ++i) {
    controllers += fmt::format("{}{{\"kind\": \"rasterize\"}}", i > 0 ? ", " : "");
    sensors += fmt::format("{}{{\"kind\": \"fiducial\", \"name\": \"eye{}\"}}", i > 0 ? ", " : "", i);
  }
  convert(write("many.json", fmt::format(R"({{"troupe": 1,
  "types": {{"bot": {{"size_m": [1, 1, 1], "controllers": [{}], "sensors": [{}]}}}},
  "models": [{{"name": "r", "type": "bot"}}]}})",
                                         controllers, sensors)),
          "many.world");
  EXPECT_THAT(found, IsEmpty());
}

TEST_F(ConvertTest, OriginsOfSensorsComeBack) {
  const fs::path world = write("origin.world", R"(
position( name "r" pose [0 0 0 17] size [0.3 0.3 0.3]
  ranger( alwayson 1 size [0.1 0.1 0.1] pose [0.1 0 -0.2 20] origin [0.03 0.01 0.02 10] sensor( samples 5 fov 180 ) )
  fiducial( alwayson 1 origin [0.02 0 0 0] range_max 3 ) )
model( pose [3 0 0 0] size [1 1 1] fiducial_return 2 )
)");
  const fs::path back = convert(convert(world, "origin.json"), "back.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_THAT(content(back), HasSubstr("origin ["));
  EXPECT_EQ(hash_log(back, 3), hash_log(world, 3));
}

TEST_F(ConvertTest, BodiesOfTurnedDevicesComeBack) {
  const fs::path world = write("turned.world", R"(
position( name "r" size [0.3 0.3 0.3]
  fiducial( alwayson 1 pose [0.1 0 0 40] origin [0.03 0.01 0.02 30] size [0.3 0.2 0.1] boundary 1 )
  model( pose [0 0 0 25] size [0.1 0.1 0.1]
    bumper( pose [0.05 0.02 0 10] size [0.2 0.1 0.1] bcount 1 blength 0.1 boundary 1 noblocks 1
      block( points 3 point[0] [0 0] point[1] [3 0] point[2] [0 1] z [0 1] ) ) ) )
)");
  const fs::path back = convert(convert(world, "turned.json"), "back.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_THAT(content(back), HasSubstr("origin ["));
}

TEST_F(ConvertTest, ClockwiseOutlinesAreAWarning) {
  const fs::path json = write("w.json", R"({"troupe": 1, "types": {
    "t": {"blocks": [{"contours_m": [[[-1, -1], [-1, 1], [1, 1], [1, -1]]], "z_m": [0, 1]}]}},
  "models": [{"name": "a", "type": "t"}]})");
  convert(json, "w.world");
  EXPECT_THAT(found, IsEmpty());
  EXPECT_THAT(warnings,
              ElementsAre(HasSubstr("w.json:2: warning: type \"t\": its body: the corners of its outline "
                                    "are written counter-clockwise, as in Stage")));
}

TEST_F(ConvertTest, SizesOfZeroComeBack) {
  const fs::path world = write("flat.world", R"(
position( name "r" size [0.3 0.3 0.3]
  ranger( alwayson 1 size [0 0 0] sensor( samples 5 fov 180 ) )
  fiducial( alwayson 1 size [0.1 0.1 0] ) model( noblocks 1 size [0 0 0.2] fiducial_return 3 ) )
model( pose [3 0 0 0] size [1 1 0] )
)");
  const fs::path back = convert(convert(world, "flat.json"), "back.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_THAT(content(back), HasSubstr("size [0 0 0]"));
  EXPECT_THAT(content(back), HasSubstr("size [0.1 0.1 0]"));
  EXPECT_THAT(content(back), HasSubstr("size [0 0 0.2]"));
  EXPECT_EQ(hash_log(back, 3), hash_log(world, 3));
}

TEST_F(ConvertTest, AnOutlineWithoutAnExtentIsNotOfStage) {
  convert(write("line.json", R"({"troupe": 1, "types": {
    "t": {"blocks": [{"contours_m": [[[0, 0], [0, 1], [0, 2]]], "z_m": [0, 1]}]}},
  "models": [{"name": "a", "type": "t"}]})"),
          "w.world");
  EXPECT_THAT(found,
              ElementsAre(HasSubstr("line.json:2: error: a .world file cannot express this: type \"t\": an "
                                    "outline whose extent along x or y is 0")));
}

TEST_F(ConvertTest, OriginsOfGrippersComeBack) {
  const fs::path world = write("origin.world", R"(
position( name "r" size [0.25 0.25 0.25]
  gripper( alwayson 1 size [0.125 0.25 0.125] pose [0.25 0 -0.25 0] origin [0.125 0.0625 0.125 0] ) )
)");
  const fs::path back = convert(convert(world, "origin.json"), "back.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_THAT(content(back), HasSubstr("origin ["));
  EXPECT_EQ(hash_log(back, 3), hash_log(world, 3));
}

TEST_F(ConvertTest, GrippersWithBlocksOrWallsComeBack) {
  const fs::path world = write("hands.world", R"(
model( size [0.25 0.25 0.25]
  gripper( size [0.5 0.5 0.25] boundary 1 )
  gripper( size [0.25 0.5 0.25] block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0 1] ) ) )
)");
  const fs::path back = convert(convert(world, "hands.json"), "back.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_EQ(hash_log(back, 2), hash_log(world, 2));
}

TEST_F(ConvertTest, ValuesThatAreRoundedAreAWarning) {
  const fs::path json = write("w.json", R"({"troupe": 1, "types": {
    "bot": {"size_m": [0.4, 0.4, 0.3], "sensors": [{"name": "eye", "kind": "ranger", "transducers": [
      {"fov_deg": 90, "samples": 7, "noise_stddev_m": 0.1, "noise_angular_deg": 2}]}]}},
  "models": [{"name": "r", "type": "bot"}]})");
  convert(json, "w.world");
  EXPECT_THAT(found, IsEmpty());
  EXPECT_THAT(warnings,
              ElementsAre(HasSubstr("w.json:2: warning: type \"bot\": device \"eye\" transducers: the "
                                    "value of \"noise_angular_rad\" or \"noise_angular_deg\" is rounded")));
}

TEST_F(ConvertTest, AJsonWorldThatStageCanSayRunsTheSame) {
  const fs::path json = write("w.json", R"({"troupe": 1, "seed": 5, "tick_s": 0.05,
  "types": {
    "bot": {"size_m": [0.3, 0.3, 0.2], "color": "blue", "drive": {"kind": "diff", "turn_max_degps": 45},
      "sensors": [
        {"name": "eye", "kind": "ranger", "pose": {"x_m": 0.1, "z_m": 0.1, "heading_deg": 7}, "transducers": [
          {"pose": {"heading_deg": -33}, "fov_deg": 40, "samples": 11, "range_max_m": 3},
          {"pose": {"x_m": 0.01, "heading_deg": 33}, "range_max_m": 3, "noise_stddev_m": 0.013}]},
        {"name": "second", "kind": "ranger", "transducers": [{}], "period_s": 0.2}],
      "controller": {"kind": "wander", "cruise_speed_mps": 0.37}},
    "wall": {"size_m": [6, 0.2, 0.5]}
  },
  "models": [
    {"name": "w0", "type": "wall", "pose": {"y_m": 2.5}}, {"name": "w1", "type": "wall", "pose": {"y_m": -2.5}},
    {"name": "r1", "type": "bot", "pose": {"x_m": 1.1, "heading_deg": 123}},
    {"name": "r2", "type": "bot", "pose": {"x_m": -1.1, "heading_deg": 3}, "color": "red"}],
  "populations": [{"name": "p", "type": "bot", "count": 3,
                   "place": {"rule": "uniform", "region_m": [[-3, -2], [3, 2]]}}]})");
  const fs::path world = convert(json, "w.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_THAT(warnings, IsEmpty());
  EXPECT_EQ(hash_log(world, 30), hash_log(json, 30)) << content(world);
}

TEST_F(ConvertTest, WhatControllersAddToTheirModelIsNotWrittenTwice) {
  const fs::path world = write("w.world", R"(seed 7
define box model( size [0.2 0.2 0.2] )
box( name "d" ctrl [ "rasterize" "dynamic 3 0.8" "dynamic 5 0.5" ] color "blue" model( pose [0.5 0 0 0] ) )
box( name "e" pose [5 0 0 0] model( name "in" stack_children 0 ctrl "dynamic 2" model( size [0.1 0.1 0.1] ) ) )
box( name "f" pose [5 5 0 0] ctrl "dynamic 4" )
box( name "g" pose [5 9 0 0] ctrl "dynamic 4" color "green" )
position( name "n" pose [0 5 0 0]
  ranger( ctrl "lasernoise 0.1" sensor( samples 5 fov 90 ) sensor() alwayson 1 ) )
)");
  const fs::path json = convert(world, "w.json");
  ASSERT_THAT(found, IsEmpty());
  const fs::path back = convert(json, "back.world");
  ASSERT_THAT(found, IsEmpty()) << content(json);
  EXPECT_THAT(content(back), HasSubstr("ctrl [\"rasterize\" \"dynamic count=3 reach=0.8\" \"dynamic "));
  EXPECT_THAT(content(back), HasSubstr("ctrl \"lasernoise share=0.1\""));
  EXPECT_THAT(content(back), Not(HasSubstr("dynamic:")));
  for (const fs::path& other : {json, back}) EXPECT_EQ(hash_log(other, 20), hash_log(world, 20));

  worldio::LoadOptions other_seed;
  other_seed.set = {{"/seed", "8"}};
  convert(convert(write("one.world", "model( ctrl \"dynamic 2\" )\n"), "one.json"), "other.world",
          other_seed);
  EXPECT_THAT(found, ElementsAre(HasSubstr("controller \"dynamic\": the random parts that it has added to "
                                           "its model; with the seed of this world, it would add other "
                                           "parts when the written file is read")));
}

TEST_F(ConvertTest, NumbersOfMarkedBodiesAreKept) {
  std::string text = "define bot position( size [0.2 0.2 0.2] fiducial( range_max_id 8 alwayson 1 ) )\n";
  for (int i = 0; i < 5; ++i)
    text += fmt::format("bot( pose [{} 0 0 0] fiducial_return {} )\n", i, 10 * i - 20);
  const fs::path world = write("w.world", text);
  const fs::path json = convert(world, "w.json");
  EXPECT_THAT(content(json), HasSubstr("\"fiducial_return\": -20"));  // of the type
  EXPECT_THAT(content(json), HasSubstr("\"fiducial_return\": 20"));
  const fs::path back = convert(json, "back.world");
  ASSERT_THAT(found, IsEmpty());
  for (const fs::path& other : {json, back}) EXPECT_EQ(hash_log(other, 5), hash_log(world, 5));
  const Simulation simulation(back, {.threads = 1});
  const engine::WorldSpec& spec = simulation.world().spec();
  EXPECT_EQ(spec.types.size(), 3u) << "ground, bodies with a number, and the body with the number 0";
  for (std::uint32_t b = 1; b <= 5; ++b)
    EXPECT_EQ(fiducial_of(spec, BodyId(b), 0), 10 * static_cast<int>(b) - 30);
}

TEST_F(ConvertTest, ColoursWithoutANameCountBesideAMacrosThatHasOne) {
  const fs::path world = write("w.world", R"(define bot position( color "red" size [0.2 0.2 0.2] )
bot() bot( pose [1 0 0 0] color "random" ) bot( pose [2 0 0 0] color "blue" )
position( pose [0 2 0 0] blobfinder( alwayson 1 range 5 fov 200 pan -90 ) )
)");
  const fs::path back = convert(convert(world, "w.json"), "back.world");
  ASSERT_THAT(found, IsEmpty());
  EXPECT_EQ(hash_log(back, 5), hash_log(world, 5));
}

TEST_F(ConvertTest, BirthsAndDeathsAreNotOfStage) {
  const std::string types = R"({"troupe": 1, "types": {"t": {"size_m": [1, 1, 1]}}, )";
  convert(write("w.json", types + "\n\"populations\": [{\"name\": \"p\", \"type\": \"t\", \"count\": 1, "
                                  "\"reserve\": 3, \"place\": {\"rule\": \"uniform\", \"region_m\": "
                                  "[[-3, -2], [3, 2]]}}]}"),
          "w.world");
  EXPECT_THAT(found, ElementsAre(HasSubstr("w.json:2: error: a .world file cannot express this: "
                                           "\"populations\": Stage has no \"reserve\"")));
  convert(write("w.json", types + "\n\"mortal\": true, \"models\": [{\"name\": \"a\", \"type\": \"t\"}]}"),
          "w.world");
  EXPECT_THAT(found, ElementsAre(HasSubstr("w.json:2: error: a .world file cannot express this: \"mortal\": "
                                           "a .world file has no such property: remove this key")));
}

TEST_F(ConvertTest, ExtentsThatAreNotThoseOfOutlinesAreNotOfStage) {
  convert(write("w.json", R"({"troupe": 1, "types": {
    "t": {"extent_m": [2, 2, 2], "fiducial_return": 1,
          "blocks": [{"points_m": [[0, 0], [1, 0], [1, 1]], "z_m": [0, 1]}]}},
  "models": [{"name": "a", "type": "t"}]})"),
          "w.world");
  EXPECT_THAT(found,
              ElementsAre(HasSubstr("its body: an extent of 2 x 2 x 2 m around an outline of 1 x 1 x 1 m")));
}

TEST_F(ConvertTest, ParametersThatControllersNeedAndStageCannotWriteAreErrorsAtTheirLines) {
  convert(write("w.json", R"({"troupe": 1, "types": {
    "t": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"},
          "controller": {"kind": "waypoints", "goals": [{"x_m": 3}]}}},
  "models": [{"name": "a", "type": "t"}]})"),
          "w.world");
  EXPECT_THAT(found, ElementsAre(HasSubstr("w.json:3: error: a .world file cannot express this: type \"t\": "
                                           "controller \"waypoints\": the value of \"goals\"")));
}

TEST_F(ConvertTest, HeadingsBeyondHalfATurnComeBackAsTheyWere) {
  const fs::path json = write("w.json", R"({"troupe": 1, "types": {
    "bot": {"size_m": [0.3, 0.3, 0.2], "sensors": [
      {"name": "eye", "kind": "ranger", "transducers": [
        {"pose": {"heading_deg": 210}}, {"pose": {"heading_deg": 330}}, {"pose": {"heading_deg": -345}}]},
      {"name": "skin", "kind": "bumper", "bumpers": [{"pose": {"x_m": -0.15, "heading_deg": 270}, "length_m": 0.2}]}]}},
  "models": [{"name": "r", "type": "bot"}]})");
  convert(json, "w.world");
  EXPECT_THAT(found, IsEmpty());
  EXPECT_THAT(warnings, IsEmpty());
  EXPECT_THAT(content(folder_ / "w.world"), HasSubstr("wrap_headings 0"));
}

TEST_F(ConvertTest, HeadingsOfDevicesBeyondHalfATurnAreAWarning) {
  const fs::path json = write("w.json", R"({"troupe": 1, "types": {
    "bot": {"size_m": [0.3, 0.3, 0.2], "sensors": [
      {"name": "eye", "kind": "ranger", "pose": {"heading_deg": 210}, "transducers": [{}]}]}},
  "models": [{"name": "r", "type": "bot"}]})");
  convert(json, "w.world");
  EXPECT_THAT(found, IsEmpty());
  EXPECT_THAT(warnings,
              ElementsAre(HasSubstr(
                  "w.json:3: warning: type \"bot\": device \"eye\": its heading is wrapped into [-pi, pi]")));
}

TEST_F(ConvertTest, AWorldOfTheSearchPathHasItsLines) {
  write("shelf/w.json", R"({"troupe": 1,
  "types": {"bot": {"size_m": [0.3, 0.3, 0.2], "sensors": [
    {"name": "eye", "kind": "ranger", "pose": {"heading_deg": 210}, "transducers": [{}]}]}},
  "models": [{"name": "r", "type": "bot"}]})");
  convert("elsewhere/w.json", "w.world", {.search_path = {folder_ / "shelf"}});
  EXPECT_THAT(found, IsEmpty());
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("shelf/w.json:3: warning: type \"bot\": device \"eye\"")));
}

TEST_F(ConvertTest, TextsInLatin1ComeIntoJson) {
  const fs::path json = convert(write("w.world", "model( name \"caf\xe9\" )\n"), "w.json");
  EXPECT_THAT(found, IsEmpty());
  EXPECT_THAT(content(json), HasSubstr("\"caf\xc3\xa9\""));
}

}  // namespace
}  // namespace troupe::convert_test
