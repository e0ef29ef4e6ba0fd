#include "worldio/json/json_world.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "tests/worldio/json_test_world.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/json/type_document.hpp"
#include "worldio/stage/stage_limits.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>

namespace troupe::worldio::json_world_test {
namespace {

using engine::WorldSpec;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string k_world = R"({
  "troupe": 1,
  "seed": 7,
  "types": {
    "minibot": {
      "size_m": [0.2, 0.2, 0.1],
      "drive": {"kind": "diff", "speed_max_mps": 0.5},
      "sensors": [{"name": "ir", "kind": "ranger", "transducers": [{"range_max_m": 2}]}],
      "controller": {"kind": "expand_swarm"}
    },
    "crate": {"size_m": [1, 1, 1]}
  },
  "models": [
    {"name": "c0", "type": "crate", "pose": {"x_m": 5, "y_m": 5}}
  ],
  "populations": [
    {"name": "r", "type": "minibot", "count": 4,
     "place": {"rule": "grid", "region_m": [[0, 0], [1, 1]], "pitch_m": 0.25}}
  ]
})";

struct Loaded {
  Diagnostics diagnostics;
  WorldSpec spec;
  std::vector<std::string> found;

  explicit Loaded(const std::string& text, const LoadOptions& options = {},
                  const std::filesystem::path& file = "maze.json") {
    spec = load_json_world(file, text, json_test_registry(), options, diagnostics);
    found = findings(diagnostics);
  }
};

std::string changed(const std::string& from, const std::string& to, std::string text = k_world) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Worlds beside pictures of their own.
class JsonWorldOfPictures : public test::ScratchTest {
 protected:
  /// A one-channel picture, binary PNM; '#' is solid. Gives where a world beside it lies.
  std::filesystem::path write_picture(const std::string& name, const std::vector<std::string>& rows) const {
    std::string pixels = fmt::format("P5\n{} {}\n255\n", rows[0].size(), rows.size());
    for (const std::string& row : rows)
      for (const char c : row) pixels += c == '#' ? '\0' : '\xff';
    write(name, pixels);
    return folder_ / "maze.json";
  }
};

// The bodies of "r" are r0, r1, ...: a group "r" would contain those of "r2" as well.
TEST(JsonWorld, PopulationsWhoseNamesDifferOnlyInDigitsAtTheEndAreRefused) {
  const std::string second = R"("pitch_m": 0.25}},
    {"name": "NAME", "type": "minibot", "count": 2,
     "place": {"rule": "grid", "region_m": [[2, 2], [3, 3]], "pitch_m": 0.25}})";
  const std::string world = changed(R"("pitch_m": 0.25}})", second);
  EXPECT_THAT(
      Loaded(changed("NAME", "r2", world)).found,
      ElementsAre("maze.json:19: error: /populations/1/name: the names of the populations \"r\" and \"r2\" "
                  "differ only in digits at the end, so a body of one could have the same name as a body of "
                  "the other: append a character that is not a digit to one of the two names, as in "
                  "\"r2_\""));
  for (const char* name : {"r2_", "rs", "R2"})
    EXPECT_THAT(Loaded(changed("NAME", name, world)).found, IsEmpty()) << name;

  EXPECT_THAT(Loaded(changed("NAME", "r", changed("\"name\": \"r\"", "\"name\": \"r20\"", world))).found,
              ElementsAre(HasSubstr("the names of the populations \"r\" and \"r20\" differ only in digits")))
      << "in either order";
}

TEST(JsonWorld, TheNamesOfManyPopulationsAreCompared) {
  WorldDocument document;
  for (int i = 0; i < 200000; ++i) {  // comparing all pairs would take minutes
    PopulationDocument& population = document.populations.emplace_back();
    population.name = fmt::format("r{}_", i);
  }
  document.populations.emplace_back().name = "r7_3";
  Diagnostics diagnostics;
  expand(document, "maze.json", json_test_registry(), {}, diagnostics);
  EXPECT_THAT(
      findings(diagnostics),
      ElementsAre(HasSubstr("the names of the populations \"r7_\" and \"r7_3\" differ only in digits")));
}

TEST(JsonWorld, AWrongArenaIsTheOnlyErrorOfItsWorld) {
  EXPECT_THAT(Loaded(R"({"troupe": 1, "arena": {"size_m": 6},
      "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}}},
      "populations": [{"name": "r", "type": "bot", "count": 3, "place": {"rule": "uniform"}}]})")
                  .found,
              ElementsAre(HasSubstr("maze.json:1: error: /arena/size_m: expected a list of 2 numbers")));
}

// Measures and interventions find populations by the names of their bodies.
TEST(JsonWorld, AModelIsNotCalledLikeAPopulationOrOneOfItsBodies) {
  const auto errors = [](std::string_view name, std::string_view type) {
    return Loaded(fmt::format(R"({{"troupe": 1,
      "types": {{"bot": {{"size_m": [0.2, 0.2, 0.2], "drive": {{"kind": "diff"}}}}, "wall": {{"size_m": [1, 1, 1]}}}},
      "bounds_m": [[-9, -9], [9, 9]],
      "models": [
        {{"name": "{}", "type": "{}", "pose": {{"x_m": 8}}}}],
      "populations": [{{"name": "fast", "type": "bot", "count": 3, "place": {{"rule": "uniform",
        "region_m": [[-5, -5], [5, 5]]}}}}]}})",
                              name, type))
        .found;
  };
  EXPECT_THAT(errors("fast100", "bot"),
              ElementsAre("maze.json:5: error: /models/0: a body called \"fast100\" would belong to the "
                          "population \"fast\", whose bodies are fast0, fast1, ...: choose another name for "
                          "the model"));
  EXPECT_THAT(errors("fast", "bot"),
              ElementsAre("maze.json:5: error: /models/0: \"fast\" is also the name of a "
                          "population: choose another name for the model"));
  for (const char* name : {"faster", "fast_1", "fas1", "slow100"})
    EXPECT_THAT(errors(name, "bot"), IsEmpty());
  EXPECT_THAT(errors("fast100", "wall"), IsEmpty()) << "static bodies are in no population";
}

TEST(JsonWorld, AWorldIsReadAsItStands) {
  const Loaded loaded(k_world);
  ASSERT_THAT(loaded.found, IsEmpty());
  const WorldSpec& spec = loaded.spec;
  EXPECT_EQ(spec.title, "maze");
  EXPECT_EQ(spec.seed, 7u);
  EXPECT_EQ(spec.tick_s, 0.1);
  EXPECT_FALSE(spec.quit_time_s);
  EXPECT_FALSE(spec.bounds);
  ASSERT_EQ(spec.types.size(), 3u);  // the ground, then the document's order
  EXPECT_EQ(spec.types[1].name, "minibot");
  EXPECT_EQ(spec.types[2].name, "crate");

  const engine::TypeSpec& minibot = spec.types[1];
  ASSERT_EQ(minibot.parts.size(), 1u);
  EXPECT_EQ(minibot.parts[0].kind, "position");
  EXPECT_EQ(minibot.parts[0].size, Eigen::Vector3d(0.2, 0.2, 0.1));
  ASSERT_EQ(minibot.parts[0].solids.size(), 1u);
  EXPECT_EQ(minibot.parts[0].solids[0],
            (Solid{{{{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}}, {0, 0.1}}));
  ASSERT_TRUE(minibot.drive);
  EXPECT_EQ(minibot.drive->kind, "diff");
  EXPECT_EQ(minibot.drive->params, engine::Record{0.5});
  EXPECT_EQ(minibot.drive->where.line, 7u);
  ASSERT_EQ(minibot.devices.size(), 1u);
  EXPECT_EQ(minibot.devices[0].name, "ir");
  EXPECT_TRUE(minibot.devices[0].active);
  const engine::Record no_pose{0.0, 0.0, 0.0, 0.0};
  const engine::Record transducer{std::vector<engine::Record>{no_pose}, 2.0, 0.1, 1};
  EXPECT_EQ(minibot.devices[0].params, (engine::Record{std::vector<engine::Record>{transducer}, false}));
  ASSERT_EQ(minibot.controllers.size(), 1u);
  EXPECT_EQ(minibot.controllers[0].kind, "expand");  // of which expand_swarm is a preset
  EXPECT_EQ(
      engine::get(json_test_registry().controller("expand")->params, minibot.controllers[0].params, "gain"),
      engine::Value(2.5));
  EXPECT_EQ(spec.types[2].parts[0].kind, "model");
  EXPECT_FALSE(spec.types[2].drive);

  ASSERT_EQ(spec.bodies.size(), 6u);
  EXPECT_EQ(spec.name(BodyId(0)), "_ground_model");
  EXPECT_EQ(spec.name(BodyId(1)), "c0");
  EXPECT_EQ(spec.bodies[1].type, TypeId(2));
  EXPECT_EQ(spec.bodies[1].pose_world_body, (Pose{5, 5, 0, 0}));
  EXPECT_EQ(spec.bodies[1].where.line, 14u);
  EXPECT_EQ(spec.bodies[1].color, (Color{0.3f, 0.3f, 0.3f, 1}));  // it neither moves nor senses
  const double y[] = {0, 0.25, 0.5, 0.75};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(spec.name(BodyId(2 + i)), fmt::format("r{}", i));
    EXPECT_EQ(spec.bodies[2 + i].type, TypeId(1));
    EXPECT_EQ(spec.bodies[2 + i].pose_world_body, (Pose{0, y[i], 0, 0}));
    EXPECT_EQ(spec.bodies[2 + i].color, (Color{0, 114 / 255.0f, 178 / 255.0f, 1}));  // the palette's first
    EXPECT_EQ(spec.bodies[2 + i].where.line, 17u);
  }
  EXPECT_EQ(loaded.diagnostics.files()->name(spec.bodies[1].where.file), "maze.json");
}

TEST(JsonWorld, TypesHaveTheColorsOfTheirPalette) {
  // In the order of the types, each type that moves, senses or can be moved has the next colour; walls do not
  // count. The colours are those of Okabe and Ito (2008), which colour-blind readers can distinguish.
  const std::string bot = R"({"size_m": [1, 1, 1], "drive": {"kind": "diff"}})";
  std::string types = R"("wall": {"size_m": [1, 1, 1]}, "puck": {"size_m": [1, 1, 1], "pushable": true},)";
  std::string models = R"({"name": "w", "type": "wall"}, {"name": "p", "type": "puck", "pose": {"x_m": 3}})";
  for (int i = 0; i < 7; ++i) {
    types += fmt::format(R"({}"bot{}": {})", i > 0 ? "," : "", i, bot);
    models += fmt::format(R"(, {{"name": "b{}", "type": "bot{}", "pose": {{"y_m": {}}}}})", i, i, 3 * i + 3);
  }
  types += R"(, "red": {"size_m": [1, 1, 1], "drive": {"kind": "diff"}, "color": "red"},
    "last": {"size_m": [1, 1, 1], "drive": {"kind": "diff"}})";
  models +=
      R"(, {"name": "r", "type": "red", "pose": {"y_m": -3}}, {"name": "l", "type": "last", "pose": {"y_m": -6}})";
  const Loaded loaded(R"({"troupe": 1, "types": {)" + types + R"(}, "models": [)" + models + "]}");
  ASSERT_THAT(loaded.found, IsEmpty());
  std::vector<std::string> colors;
  for (const engine::BodySpec& body : loaded.spec.bodies)
    colors.push_back(fmt::format("{:02x}{:02x}{:02x}", to_byte(body.color.r), to_byte(body.color.g),
                                 to_byte(body.color.b)));
  colors.erase(colors.begin());  // of the ground
  EXPECT_THAT(colors, ElementsAre("4d4d4d", "0072b2", "e69f00", "009e73", "d55e00", "56b4e9", "cc79a7",
                                  "f0e442", "0072b2", "ff0000", "009e73"));
}

TEST(JsonWorld, ModelsMayHaveNumbersForFinders) {
  const Loaded loaded(R"({"troupe": 1,
    "types": {"post": {"size_m": [1, 1, 1], "fiducial_return": 3}, "plain": {"size_m": [1, 1, 1]}},
    "models": [{"name": "a", "type": "post", "fiducial_return": -9},
               {"name": "b", "type": "post", "pose": {"x_m": 3}}]})");
  ASSERT_THAT(loaded.found, IsEmpty());
  EXPECT_EQ(fiducial_of(loaded.spec, BodyId(1), 0), -9);
  EXPECT_EQ(fiducial_of(loaded.spec, BodyId(2), 0), 3);
  const Loaded wrong(R"({"troupe": 1,
    "types": {"post": {"size_m": [1, 1, 1], "fiducial_return": 3}, "plain": {"size_m": [1, 1, 1]}},
    "models": [{"name": "a", "type": "post", "fiducial_return": 0},
               {"name": "b", "type": "plain", "pose": {"x_m": 3}, "fiducial_return": 4}]})");
  EXPECT_THAT(
      wrong.found,
      ElementsAre("maze.json:3: error: /models/0/fiducial_return: must not be 0: give the model a type "
                  "without \"fiducial_return\" instead",
                  "maze.json:4: error: /models/1/fiducial_return: a model can have its own "
                  "\"fiducial_return\" only if its type has one: give the type \"plain\" a "
                  "\"fiducial_return\" that is not 0"));
}

TEST(JsonWorld, SettingsAndUnits) {
  const Loaded loaded(
      R"({"troupe": 1, "title": "A maze", "tick_ms": 50, "quit_time_s": 60, "ranging": "grid", "resolution_cm": 5,
    "seed": 18446744073709551615,
    "types": {"t": {"size_m": [1, 2, 3], "color": [0.5, 0.25, 0, 0.75], "obstacle": false, "ranger_return": -1,
      "drive": {"kind": "car", "wheelbase_cm": 50, "period_ms": 200},
      "sensors": [{"kind": "ranger", "transducers": [{"fov_deg": 360, "pose": {"x_mm": 10, "heading_deg": 90}}], "period_s": 0.5,
                   "pose": {"z_m": 0.1}, "active": false, "intensity": true},
                  {"kind": "ranger", "transducers": []}],
      "controllers": [{"kind": "expand", "clearances_cm": [50, 25], "law": "far"}, {"kind": "expand"}]}},
    "models": [{"name": "a", "type": "t", "pose": {"heading_deg": 450}}, {"name": "b", "type": "t", "color": "SteelBlue"}]})");
  ASSERT_THAT(loaded.found, IsEmpty());
  const WorldSpec& spec = loaded.spec;
  EXPECT_EQ(spec.title, "A maze");
  EXPECT_EQ(spec.seed, ~std::uint64_t{0});
  EXPECT_EQ(spec.tick_s, 50 * 0.001);
  EXPECT_EQ(spec.quit_time_s, 60.0);
  EXPECT_EQ(spec.ranging, engine::RangingEngine::grid);
  EXPECT_EQ(spec.resolution_m, 0.05);
  EXPECT_EQ(spec.resolution_where.line, 1u);
  const engine::TypeSpec& type = spec.types[1];
  EXPECT_EQ(type.parts[0].returns, (engine::Returns{false, -1}));
  EXPECT_EQ(type.drive->period_s, 0.2);
  EXPECT_EQ(type.drive->params, (engine::Record{1.0, 0.5}));
  EXPECT_EQ(type.devices[0].name, "ranger:0");
  EXPECT_EQ(type.devices[1].name, "ranger:1");
  EXPECT_EQ(type.devices[0].period_s, 0.5);
  EXPECT_FALSE(type.devices[0].active);
  EXPECT_EQ(type.devices[0].pose_body_device, (Pose{0, 0, 0.1, 0}));
  const engine::Registry registry = json_test_registry();
  const engine::FieldTable& ranger = registry.device("ranger")->params;
  const engine::FieldTable& fan = *ranger.fields.front().record;
  const engine::Record& transducer =
      engine::get(ranger, type.devices[0].params, "transducers").records().front();
  EXPECT_EQ(engine::get(fan, transducer, "fov").number(), 2 * k_pi);  // the limit itself, in degrees
  const auto pose = engine::from_record<Pose>(engine::get(fan, transducer, "pose").records().front());
  EXPECT_EQ(pose.x, 0.01);
  EXPECT_EQ(pose.heading, radians(90));
  EXPECT_TRUE(engine::get(ranger, type.devices[0].params, "intensity").boolean());
  ASSERT_EQ(type.controllers.size(), 2u);
  EXPECT_EQ(type.controllers[0].params, (engine::Record{1.0, std::vector<double>{0.5, 0.25}, "far"}));
  EXPECT_DOUBLE_EQ(spec.bodies[1].pose_world_body.heading, radians(90));
  EXPECT_EQ(spec.bodies[1].color, (Color{0.5f, 0.25f, 0, 0.75f}));
  EXPECT_EQ(spec.bodies[2].color, (Color{70 / 255.f, 130 / 255.f, 180 / 255.f, 1}));
}

TEST(JsonWorld, BlocksAreTakenAsTheyAre) {
  const Loaded loaded(R"({"troupe": 1, "types": {"t": {"blocks": [
      {"points_m": [[0, 0], [0, 2], [1, 2], [1, 0]], "z_m": [0.5, 1]},
      {"points_m": [[-1, 0], [0, 0], [0, 1]], "z_cm": [-10, 20]}]}}})");
  ASSERT_THAT(loaded.found, IsEmpty());
  const engine::PartSpec& part = loaded.spec.types[1].parts[0];
  ASSERT_EQ(part.solids.size(), 2u);
  EXPECT_EQ(part.solids[0],
            (Solid{{{{1, 0}, {1, 2}, {0, 2}, {0, 0}}}, {0.5, 1}}));  // turned counter-clockwise
  EXPECT_EQ(part.solids[1].z.max, 0.2);
  EXPECT_EQ(part.size, Eigen::Vector3d(2, 2, 1.1));
}

TEST_F(JsonWorldOfPictures, FloorPlans) {
  const auto file = write_picture("plan.pgm", {".....", ".###.", ".#.#.", ".....", "....."});
  const std::string text = R"({"troupe": 1, "floorplans": [
    {"name": "a", "bitmap": "plan.pgm", "size_m": [6, 4, 2], "pose": {"x_m": 10, "heading_deg": 90}},
    {"name": "b", "bitmap": "plan.pgm", "size_m": [5, 10, 1], "margins": "keep", "color": "red", "obstacle": false,
     "ranger_return": 0.5, "boundary": true}]})";
  const Loaded loaded(text, {}, file);
  ASSERT_THAT(loaded.found, IsEmpty());
  const WorldSpec& spec = loaded.spec;
  ASSERT_EQ(spec.bodies.size(), 3u);
  EXPECT_EQ(spec.name(BodyId(1)), "a");
  EXPECT_EQ(spec.bodies[1].pose_world_body, (Pose{10, 0, 0, radians(90)}));

  const engine::PartSpec& trimmed = spec.type(BodyId(1)).parts[0];
  ASSERT_EQ(trimmed.solids.size(), 1u);
  EXPECT_EQ(trimmed.solids[0].z, (ZInterval{0, 2}));
  ASSERT_EQ(trimmed.solids[0].contours.size(), 1u);  // the arch of dark pixels fills the size
  EXPECT_EQ(bounds(trimmed.solids[0].contours[0]).min, Vec2(-3, -2));
  EXPECT_EQ(bounds(trimmed.solids[0].contours[0]).max, Vec2(3, 2));
  EXPECT_FALSE(contains(trimmed.solids[0], Vec2(0, -1)));
  EXPECT_TRUE(contains(trimmed.solids[0], Vec2(0, 1)));

  const engine::PartSpec& kept = spec.type(BodyId(2)).parts[0];
  EXPECT_EQ(kept.returns, (engine::Returns{false, 0.5f}));
  ASSERT_EQ(kept.solids.size(), 5u);  // and four walls
  EXPECT_EQ(kept.solids[0].z, (ZInterval{0, 1}));
  const Box arch = bounds(kept.solids[0].contours[0]);  // rows 1 and 2 of 5, of 2 m each
  EXPECT_TRUE(arch.min.isApprox(Vec2(-1.5, -1)) && arch.max.isApprox(Vec2(1.5, 3)));
  Box walls;
  for (std::size_t i = 1; i < 5; ++i) {
    walls.extend(bounds(kept.solids[i].contours[0]));
    EXPECT_NEAR(bounds(kept.solids[i].contours[0]).size().minCoeff(), 0.01, 1e-12);
  }
  EXPECT_EQ(walls.min, Vec2(-2.5, -5));
  EXPECT_EQ(walls.max, Vec2(2.5, 5));

  ASSERT_TRUE(spec.bounds);  // of 4 x 6 m about (10, 0) and 5 x 10 m about the origin
  EXPECT_TRUE(spec.bounds->min.isApprox(Vec2(-2.5, -5)));
  EXPECT_TRUE(spec.bounds->max.isApprox(Vec2(12, 5)));
}

TEST_F(JsonWorldOfPictures, MapsOfRosSayTheirSizeAndPlaceThemselves) {
  const auto file = write_picture("lab.pgm", {"....", ".##.", "...."});
  write("lab.yaml", "image: lab.pgm\nresolution: 0.5\norigin: [10, -3, 1.5707963267948966]\n");
  const Loaded loaded(R"({"troupe": 1, "floorplans": [
    {"name": "a", "bitmap": "lab.yaml", "height_m": 2, "boundary": true}]})",
                      {}, file);
  ASSERT_THAT(loaded.found, IsEmpty());
  const engine::PartSpec& part = loaded.spec.type(BodyId(1)).parts[0];
  EXPECT_EQ(part.size, Eigen::Vector3d(2, 1.5, 2));
  ASSERT_EQ(part.solids.size(), 5u);
  // The image leans on its lower left corner, at (10, -3), and is turned to the left about it.
  const Box block = bounds(part.solids[0].contours[0]);
  EXPECT_TRUE(block.min.isApprox(Vec2(9, -2.5))) << block.min.transpose();
  EXPECT_TRUE(block.max.isApprox(Vec2(9.5, -1.5))) << block.max.transpose();
  EXPECT_EQ(part.solids[0].z, (ZInterval{0, 2}));
  ASSERT_TRUE(loaded.spec.bounds);
  EXPECT_TRUE(loaded.spec.bounds->min.isApprox(Vec2(8.5, -3)));
  EXPECT_TRUE(loaded.spec.bounds->max.isApprox(Vec2(10, -1)));

  const Loaded sized(R"({"troupe": 1, "floorplans": [
    {"name": "a", "bitmap": "lab.yaml", "size_m": [1, 1, 1]}]})",
                     {}, file);
  EXPECT_THAT(
      sized.found,
      ElementsAre(testing::HasSubstr("unknown key \"size_m\"; known: bitmap, blob_return, boundary")));

  write("explored.yaml", "image: lab.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n");
  write("grey.pgm", "P5 2 1 255\n" + std::string("\xcd\x00", 2));
  write("partly.yaml", "image: grey.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n");
  const Loaded solid(R"({"troupe": 1, "floorplans": [
    {"name": "a", "bitmap": "explored.yaml",
     "unknown": "solid"},
    {"name": "b", "bitmap": "partly.yaml", "unknown": "solid"}]})",
                     {}, file);
  EXPECT_THAT(solid.found, ElementsAre(testing::EndsWith(
                               ":3: warning: /floorplans/0/unknown: \"solid\" has no effect, because "
                               "the ROS map \"explored.yaml\" has no unknown cell: remove this key")));
}

TEST_F(JsonWorldOfPictures, AnImageThatIsASymbolicLinkIsWrittenAsTheLink) {
  const auto file = write_picture("site/lab.pgm", {"....", ".##.", "...."});
  write("store/map", "image: lab.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n");
  std::filesystem::create_symlink("../store/map", folder_ / "site/lab.yaml");
  const Loaded loaded(R"({"troupe": 1, "floorplans": [{"name": "a", "bitmap": "site/lab.yaml"}]})", {}, file);
  ASSERT_THAT(loaded.found, IsEmpty());
  Diagnostics diagnostics;
  const auto written =
      write_json_world(loaded.spec, folder_ / "written.json", json_test_registry(), diagnostics);
  EXPECT_THAT(findings(diagnostics), IsEmpty());
  ASSERT_TRUE(written);
  EXPECT_EQ(*written->find("floorplans")->list()->front().find("bitmap")->text(), "site/lab.yaml");
}

TEST(JsonWorld, ItSaysHowItIsToBeWatched) {
  const Loaded loaded(R"({"troupe": 1,
    "watch": {"clock": true, "clock_ticks": 10, "rate": 2.5, "paused": true},
    "window": {"size_px": [800, 600], "rotate_deg": [30, 0], "show_grid": false}})");
  ASSERT_THAT(loaded.found, IsEmpty());
  EXPECT_EQ(loaded.spec.watch, (engine::WatchSpec{true, 10, 2.5, true}));
  ASSERT_TRUE(loaded.spec.window);
  const engine::FieldTable& fields = window_fields();
  EXPECT_THAT(get(fields, *loaded.spec.window, "size_px").numbers(), ElementsAre(800, 600));
  EXPECT_NEAR(get(fields, *loaded.spec.window, "rotate").numbers()[0], radians(30), 1e-15);
  EXPECT_FALSE(get(fields, *loaded.spec.window, "show_grid").boolean());
  EXPECT_FALSE(Loaded(R"({"troupe": 1})").spec.window);
  EXPECT_THAT(Loaded(R"({"troupe": 1, "watch": {"rate": -1}})").found,
              ElementsAre(testing::HasSubstr("/watch/rate: ")));
}

/// Everything that a document of its own kind has.
const std::string k_all = R"({
  "troupe": 1, "title": "All", "seed": 3, "tick_s": 0.05, "quit_time_s": 9, "measure_every_s": 2,
  "ranging": "grid", "resolution_m": 0.05, "bounds_m": [[-50, -50], [50, 50]], "ground": {"alias": "floor"},
  "record": {"file": "r.h5", "every_s": 1, "fields": ["pose"]}, "watch": {"clock": true}, "mortal": true,
  "overlaps": "warn", "same_names": "warn",
  "types": {
    "bot": {"size_m": [0.2, 0.2, 0.1], "color": "blue", "ranger_return": 0.3, "pushable": true,
      "drive": {"kind": "car", "period_s": 0.2, "wheelbase_m": 0.1},
      "sensors": [{"kind": "ranger", "pose": {"heading_deg": 90}, "active": false, "period_s": 0.5,
                   "transducers": [{"range_max_m": 2}]}],
      "controllers": [{"kind": "expand_swarm"}, {"kind": "expand", "law": "far"}],
      "parts": [{"name": "hat", "pose": {"z_m": 0.1}, "floor_plan": true,
                 "blocks": [{"points_m": [[0, 0], [0.1, 0], [0, 0.1]], "z_m": [0, 0.1], "frame": "body"}]}]},
    "stretched": {"size_m": [1, 2, 1], "fit": true, "origin": {"x_m": 1}, "extent_m": [3, 3, 3],
      "blocks": [{"contours_m": [[[0, 0], [1, 0], [0, 1]], [[0.1, 0.1], [0.2, 0.1], [0.1, 0.2]]], "z_m": [0, 1]}]}
  },
  "models": [{"name": "s", "type": "stretched", "alias": "t", "pose": {"x_m": 20}, "color": [0.1, 0.2, 0.3, 0.5]},
             {"name": "later", "type": "bot", "reserve_of": "g", "global_parts": ["hat"]}],
  "populations": [
    {"name": "g", "type": "bot", "count": 3, "color": "random", "place": {"rule": "grid",
     "region_m": [[0, 0], [1, 1]], "spill_m": [[2, 0], [3, 1]], "pitch_m": 0.5, "jitter_m": 0.01, "heading": "random"}},
    {"name": "h", "type": "bot", "count": 2, "reserve": 2, "color": "red", "place": {"rule": "gaussian",
     "mean_m": [-5, -5], "deviation_m": [1, 2], "heading_deg": 30, "z_m": 0.5}},
    {"name": "u", "type": "bot", "count": 2, "place": {"rule": "uniform", "polygon_m": [[5, 5], [9, 5], [5, 9]]}},
    {"name": "p", "type": "bot", "count": 2, "place": {"rule": "poisson_disc", "distance_m": 1,
     "region_m": [[-20, -20], [-10, -10]]}},
    {"name": "f", "type": "bot", "count": 2, "place": {"rule": "free_floor", "from_m": [12, 12], "cell_m": 0.5,
     "region_m": [[10, 10], [15, 15]]}}]
})";

TEST(WorldDocument, IsWhatTheFileSays) {
  Diagnostics diagnostics;
  const engine::Registry registry = json_test_registry();
  const auto document = load_json_document("maze.json", k_all, registry, {}, diagnostics);
  ASSERT_TRUE(document);
  ASSERT_THAT(findings(diagnostics), IsEmpty());
  EXPECT_EQ(document->title, "All");
  EXPECT_EQ(document->quit_time, 9.0);
  EXPECT_EQ(document->overlaps, WorldDocument::Check::warn);
  EXPECT_EQ(document->where_of("ranging").line, 3u);
  EXPECT_FALSE(document->says("measures"));
  ASSERT_EQ(document->types.size(), 2u);
  const auto& [key, bot] = document->types[0];
  EXPECT_EQ(key, "bot");
  EXPECT_EQ(bot.image.size, Eigen::Vector3d(0.2, 0.2, 0.1));
  EXPECT_EQ(bot.returns.ranger, 0.3f);
  ASSERT_TRUE(bot.drive);
  EXPECT_EQ(bot.drive->period, 0.2);
  EXPECT_EQ(bot.drive->params, (engine::Record{1.0, 0.1}));
  EXPECT_EQ(bot.drive->where_of("wheelbase").line, bot.drive->where.line)
      << "parameters have no place of their own";
  ASSERT_EQ(bot.controllers.size(), 2u);
  EXPECT_EQ(bot.controllers[0].kind, "expand") << "of which expand_swarm is a preset";
  EXPECT_EQ(engine::get(registry.controller("expand")->params, bot.controllers[0].params, "gain"),
            engine::Value(2.5));
  EXPECT_EQ(document->types[1].second.blocks->front().contours->size(), 2u);
  ASSERT_EQ(document->populations.size(), 5u);
  const PopulationDocument& grid = document->populations[0];
  EXPECT_TRUE(grid.color->is_random);
  EXPECT_TRUE(grid.place->heading->is_random);
  EXPECT_EQ(grid.place->rule, engine::PlacementRule::Kind::grid);
  EXPECT_EQ(grid.place->pitch, 0.5);
  EXPECT_EQ(grid.place->where.line, 20u);
}

TEST(WorldDocument, IsWrittenAsItReadsBack) {
  Diagnostics diagnostics;
  const engine::Registry registry = json_test_registry();
  const auto document = load_json_document("maze.json", k_all, registry, {}, diagnostics);
  ASSERT_TRUE(document);
  const WorldSpec spec = expand(*document, "maze.json", registry, {}, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors()) << findings(diagnostics).front();
  const std::string text = json_text(json_world_node(*document, "maze.json", registry, diagnostics));
  const Loaded back(text);
  ASSERT_FALSE(back.diagnostics.has_errors()) << back.found.front() << text;
  EXPECT_EQ(spec_difference(spec, back.spec), "");
  EXPECT_EQ(back.spec.bodies.size(), spec.bodies.size());
  EXPECT_EQ(back.spec.record->fields, spec.record->fields);
  EXPECT_EQ(back.spec.reserves.size(), 2u);
  const auto again = load_json_document("maze.json", text, registry, {}, diagnostics);
  ASSERT_TRUE(again);
  EXPECT_EQ(json_text(json_world_node(*again, "maze.json", registry, diagnostics)), text);
}

/// Parameters whose types do not hold all numbers.
struct Narrow {
  std::uint64_t large = 7;
  float single = 1;
  std::array<float, 2> singles{1, 1};
  std::array<std::int64_t, 2> wholes{1, 1};
  std::array<std::uint64_t, 2> large_wholes{1, 1};
  std::array<bool, 2> flags{};
  std::array<std::int16_t, 1> meters{};

  static constexpr void describe(engine::Description<Narrow>& d) {
    d.member<&Narrow::large>("large", "");
    d.member<&Narrow::single>("single", "");
    d.member<&Narrow::singles>("singles", "");
    d.member<&Narrow::wholes>("wholes", "");
    d.member<&Narrow::large_wholes>("large_wholes", "");
    d.member<&Narrow::flags>("flags", "");
    d.member<&Narrow::meters>("meters", engine::Unit::meters, "");
  }
};

TEST(JsonWorld, NumbersThatTheTypeOfAParameterCannotHoldAreRefused) {
  engine::Registry registry = json_test_registry();
  registry.controllers.push_back({.name = "narrow", .params = engine::described<Narrow>()});
  const auto found = [&](const std::string& parameter) {
    Diagnostics diagnostics;
    load_json_world("maze.json",
                    changed(R"({"kind": "expand_swarm"})", R"({"kind": "narrow", )" + parameter + "}"),
                    registry, {}, diagnostics);
    return findings(diagnostics);
  };
  const auto refused = [&](const std::string& parameter, const std::string& key, const std::string& message) {
    EXPECT_THAT(found(parameter),
                ElementsAre("maze.json:9: error: /types/minibot/controller/" + key + ": must be " + message))
        << parameter;
  };
  refused(R"("large": -1)", "large", "at least 0, found -1");
  refused(R"("large": 9223372036854775808)", "large", "at most 2^63 - 1, found 9223372036854775808");
  refused(R"("single": 1e39)", "single", "from -3.402823466e+38 to 3.402823466e+38, found 1e+39");
  refused(R"("singles": [1, 1e39])", "singles/1", "from -3.402823466e+38 to 3.402823466e+38, found 1e+39");
  refused(R"("wholes": [9007199254740993, 1])", "wholes/0",
          "from -9007199254740991 to 9007199254740991, found 9007199254740993");
  refused(R"("wholes": [1, 1.5])", "wholes/1", "a whole number, found 1.5");
  refused(R"("large_wholes": [-1, 1])", "large_wholes/0", "from 0 to 9007199254740991, found -1");
  refused(R"("large_wholes": [1, 18446744073709551615])", "large_wholes/1",
          "from 0 to 9007199254740991, found 18446744073709551615");
  refused(R"("flags": [0.5, 0])", "flags/0", "a whole number, found 0.5");
  refused(R"("flags": [0, 2])", "flags/1", "from 0 to 1, found 2");
  refused(R"("meters_cm": [150])", "meters_cm/0", "a whole number, found 150");
  EXPECT_THAT(found(R"("large": 9223372036854775807, "single": 3e38, "singles": [-3e38, 0.1],
      "wholes": [9007199254740991, -3.0], "large_wholes": [0, 9007199254740991], "flags": [1, 0],
      "meters_cm": [200])"),
              IsEmpty());
  EXPECT_EQ(check_limits(registry.controller("narrow")->params.fields[3], 1.5).error().text,
            "must be a whole number")
      << "in .world files";
}

struct Wrong {
  const char* from;
  const char* to;
  const char* message;
};

void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.to; }

class JsonWorldError : public testing::TestWithParam<Wrong> {};

TEST_P(JsonWorldError, SaysWhatAndWhere) {
  EXPECT_THAT(Loaded(changed(GetParam().from, GetParam().to)).found, ElementsAre(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    TopLevel, JsonWorldError,
    testing::Values(
        Wrong{R"("troupe": 1,)", "", R"(maze.json:1: error: missing "troupe": 1, the version of the format)"},
        Wrong{R"("troupe": 1)", R"("troupe": 2)",
              "maze.json:2: error: /troupe: unknown format version 2: this program reads version 1"},
        Wrong{R"("troupe": 1)", R"("troupe": "1")",
              R"(maze.json:2: error: /troupe: expected 1, the version of the format, found the text "1")"},
        Wrong{R"("seed": 7)", R"("sede": 7)",
              R"(maze.json:3: error: unknown key "sede" (did you mean "seed"?))"},
        Wrong{R"("seed": 7)", R"("seed": -7)",
              "maze.json:3: error: /seed: expected a whole number from 0 to 2^64 - 1, found the number -7"},
        Wrong{R"("seed": 7)", R"("seed": 7.5)",
              "maze.json:3: error: /seed: expected a whole number from 0 to 2^64 - 1, found the number 7.5"},
        Wrong{
            R"("seed": 7)", R"("seed": 1e17)",
            "maze.json:3: error: /seed: expected a whole number from 0 to 2^64 - 1, found the number 1e+17"},
        Wrong{R"("seed": 7)", R"("title": 7)",
              "maze.json:3: error: /title: expected the world's title, found the number 7"},
        Wrong{R"("seed": 7)", R"("tick_s": 0)",
              "maze.json:3: error: /tick_s: must be from 0.000001 to 3600 s, found 0"},
        Wrong{R"("seed": 7)", R"("tick_s": 3600.0000001)",
              "maze.json:3: error: /tick_s: must be from 0.000001 to 3600 s, found 3600.0000001"},
        Wrong{R"("seed": 7)", R"("tick_ms": 4e6)",
              "maze.json:3: error: /tick_ms: must be from 0.001 to 3600000 ms, found 4000000"},
        Wrong{R"("seed": 7)", R"("tick": 0.1)",
              R"(maze.json:3: error: "tick" needs its unit: write "tick_s" or "tick_ms")"},
        Wrong{
            R"("seed": 7)", R"("tick_s": 0.1, "tick_ms": 100)",
            R"(maze.json:3: error: /tick_ms: given twice, in different units: give only one of "tick_s" or "tick_ms")"},
        Wrong{R"("seed": 7)", R"("tick_s": "fast")",
              R"(maze.json:3: error: /tick_s: expected a number in s, found the text "fast")"},
        Wrong{R"("seed": 7)", R"("quit_time_s": -1)",
              "maze.json:3: error: /quit_time_s: must be above 0 and at most 1000000000 s, found -1"},
        Wrong{
            R"("seed": 7)", R"("ranging": "exakt")",
            R"(maze.json:3: error: /ranging: unknown ranging "exakt"; known: exact, grid (did you mean "exact"?))"},
        Wrong{R"("seed": 7)", R"("resolution_m": 0)",
              "maze.json:3: warning: /resolution_m: must be from 0.0001 to 100 m, found 0; it has no effect, "
              "because "
              "\"ranging\" is \"exact\""},
        Wrong{R"("seed": 7)", R"("ranging": "grid", "resolution_m": 0)",
              "maze.json:3: error: /resolution_m: must be from 0.0001 to 100 m, found 0"},
        Wrong{R"("seed": 7)", R"("floorplans": {})",
              "maze.json:3: error: /floorplans: expected a list, found an object"}));

INSTANTIATE_TEST_SUITE_P(
    Types, JsonWorldError,
    testing::Values(
        Wrong{
            R"("crate": {"size_m": [1, 1, 1]})", R"("crate": {})",
            R"(maze.json:11: error: /types/crate: the type has no shape: give "size_m" (a box), "disc", "blocks", "bitmap" or "device")"},
        Wrong{
            R"("controller": {"kind": "expand_swarm"})", R"("controller": "expand_swarm")",
            R"(maze.json:9: error: /types/minibot/controller: expected an object such as {"kind": "expand_swarm"}, found the text "expand_swarm")"},
        Wrong{R"("controller": {"kind": "expand_swarm"})", R"("controller": "none")",
              R"(maze.json:9: error: /types/minibot/controller: expected an object, found the text "none")"},
        Wrong{R"("crate": {"size_m": [1, 1, 1]})", R"("crate": 3)",
              "maze.json:11: error: /types/crate: expected an object, found the number 3"},
        Wrong{"[1, 1, 1]", "[1, 0, 1]",
              "maze.json:11: error: /types/crate/size_m/1: must be above 0 and at most 100000 m, found 0"},
        Wrong{"[1, 1, 1]", "[1, -1, 1]",
              "maze.json:11: error: /types/crate/size_m/1: must be above 0 and at most 100000 m, found -1"},
        Wrong{"[1, 1, 1]", "[1, 1]",
              "maze.json:11: error: /types/crate/size_m: expected a list of 3 numbers in m, found a list of "
              "length 2"},
        Wrong{"[1, 1, 1]", "[1, null, 1]",
              "maze.json:11: error: /types/crate/size_m/1: expected a number in m, found null"},
        Wrong{
            R"({"size_m": [1, 1, 1]})", R"({"size": [1, 1, 1]})",
            R"(maze.json:11: error: /types/crate: "size" needs its unit: write "size_m", "size_cm" or "size_mm")"},
        Wrong{R"([1, 1, 1])", R"([1, 1, 1], "colour": "red")",
              R"(maze.json:11: error: /types/crate: unknown key "colour" (did you mean "color"?))"},
        Wrong{
            R"([1, 1, 1])", R"([1, 1, 1], "color": "rde")",
            R"(maze.json:11: error: /types/crate/color: unknown color "rde": give an X11 name or [r, g, b] (did you mean "red"?))"},
        Wrong{R"([1, 1, 1])", R"([1, 1, 1], "color": [1, 2, 0])",
              "maze.json:11: error: /types/crate/color/1: must be from 0 to 1, found 2"},
        Wrong{R"([1, 1, 1])", R"([1, 1, 1], "color": [1, 1])",
              "maze.json:11: error: /types/crate/color: expected a color: an X11 name, [r, g, b] or [r, g, "
              "b, a], found a list of length 2"},
        Wrong{R"([1, 1, 1])", R"([1, 1, 1], "obstacle": 1)",
              "maze.json:11: error: /types/crate/obstacle: expected true or false, found the number 1"},
        Wrong{
            R"([1, 1, 1])", R"([1, 1, 1], "controller": {"kind": "expand"})",
            R"(maze.json:11: error: /types/crate: the controller commands a drive, but the type has none: add a "drive")"},
        Wrong{
            R"("kind": "diff")", R"("kind": "hover")",
            R"(maze.json:7: error: /types/minibot/drive/kind: unknown drive "hover"; known: car, diff, omni)"},
        Wrong{
            R"("kind": "diff")", R"("kind": "onmi")",
            R"(maze.json:7: error: /types/minibot/drive/kind: unknown drive "onmi"; known: car, diff, omni (did you mean "omni"?))"},
        Wrong{
            R"("kind": "diff")", R"("kind": "car")",
            R"(maze.json:7: error: /types/minibot/drive: missing "wheelbase_m", "wheelbase_cm" or "wheelbase_mm": between the axles)"},
        Wrong{R"("kind": "diff", )", "",
              R"(maze.json:7: error: /types/minibot/drive: missing "kind": one of car, diff, omni)"},
        Wrong{R"("speed_max_mps": 0.5)", R"("speed_max_mps": -0.5)",
              "maze.json:7: error: /types/minibot/drive/speed_max_mps: must be at least 0 m/s, found -0.5"},
        Wrong{R"("kind": "ranger")", R"("kind": 4)",
              "maze.json:8: error: /types/minibot/sensors/0/kind: expected the name of a sensor, found the "
              "number 4"},
        Wrong{R"(, "transducers": [{"range_max_m": 2}])", "",
              R"(maze.json:8: error: /types/minibot/sensors/0: missing "transducers": fans of beams)"},
        Wrong{R"("range_max_m": 2)", R"("fov_deg": 361)",
              "maze.json:8: error: /types/minibot/sensors/0/transducers/0/fov_deg: must be from 0 to 360 "
              "deg, found 361"},
        Wrong{
            R"("range_max_m": 2)", R"("fov": 1)",
            R"(maze.json:8: error: /types/minibot/sensors/0/transducers/0: "fov" needs its unit: write "fov_rad" or "fov_deg")"},
        Wrong{
            R"("range_max_m": 2)", R"("fov_deg": 1, "fov_rad": 1)",
            R"(maze.json:8: error: /types/minibot/sensors/0/transducers/0/fov_deg: given twice, in different units: give only one of "fov_rad" or "fov_deg")"},
        Wrong{R"("range_max_m": 2)", R"("samples": 2.5)",
              "maze.json:8: error: /types/minibot/sensors/0/transducers/0/samples: expected a whole number, "
              "found the number 2.5"},
        Wrong{R"("range_max_m": 2)", R"("samples": 0)",
              "maze.json:8: error: /types/minibot/sensors/0/transducers/0/samples: must be from 1 to 1000, "
              "found 0"},
        Wrong{R"("range_max_m": 2)", R"("samples": 18446744073709551615)",
              "maze.json:8: error: /types/minibot/sensors/0/transducers/0/samples: must be from 1 to 1000, "
              "found 18446744073709551615"},
        Wrong{R"("range_max_m": 2)", R"("pose": {"x_m": 1e6})",
              "maze.json:8: error: /types/minibot/sensors/0/transducers/0/pose/x_m: must be from -100000 to "
              "100000 m, found 1000000"},
        Wrong{R"("transducers")",
              R"("name": "ir"}, {"name": "x", "kind": "ranger", "period_s": -1, "transducers")",
              R"(maze.json:8: error: repeated key "name": first given on line 8)"},
        Wrong{
            R"({"name": "ir", "kind": "ranger", )",
            R"({"name": "ir", "kind": "ranger", "transducers": []}, {"name": "ir", "kind": "ranger", )",
            R"(maze.json:8: error: /types/minibot/sensors/1/name: the type already has a sensor "ir": choose another name)"},
        Wrong{
            R"("kind": "expand_swarm")", R"("kind": "expand_sworm")",
            R"(maze.json:9: error: /types/minibot/controller/kind: unknown controller "expand_sworm"; known: expand, expand_swarm (did you mean "expand_swarm"?))"},
        Wrong{
            R"("kind": "expand_swarm")", R"("kind": "expand", "law": "fat")",
            R"(maze.json:9: error: /types/minibot/controller/law: unknown law "fat"; known: far, near (did you mean "far"?))"},
        Wrong{R"("kind": "expand_swarm")", R"("kind": "expand", "law": 1)",
              "maze.json:9: error: /types/minibot/controller/law: expected one of near, far, found the "
              "number 1"},
        Wrong{R"("kind": "expand_swarm"})", R"("kind": "expand_swarm"}, "controllers": [])",
              R"(maze.json:9: error: /types/minibot: give "controller" or "controllers", not both)"}));

INSTANTIATE_TEST_SUITE_P(
    Blocks, JsonWorldError,
    testing::Values(
        Wrong{R"("size_m": [1, 1, 1])", R"("blocks": [{"points_m": [[0, 0], [1, 0]], "z_m": [0, 1]}])",
              "maze.json:11: error: /types/crate/blocks/0/points_m: expected 3 to 1000 points, found 2"},
        Wrong{R"("size_m": [1, 1, 1])",
              R"("blocks": [{"points_m": [[0, 0], [1, 0], [1, 1, 1]], "z_m": [0, 1]}])",
              "maze.json:11: error: /types/crate/blocks/0/points_m/2: expected a list of 2 numbers in m, "
              "found a list of length 3"},
        Wrong{
            R"("size_m": [1, 1, 1])", R"("blocks": [{"points_m": [[0, 0], [1, 0], [1, 1]]}])",
            R"(maze.json:11: error: /types/crate/blocks/0: missing "z_m", "z_cm" or "z_mm": the heights of the bottom and the top of the prism, [min, max])"},
        Wrong{
            R"("size_m": [1, 1, 1])", R"("blocks": [{"z_m": [0, 1]}])",
            R"(maze.json:11: error: /types/crate/blocks/0: missing "points_m": the outline, [[x, y], ...] (or "contours_m", a list of outlines))"},
        Wrong{
            R"("size_m": [1, 1, 1])", R"("blocks": [{"points_m": [[0, 0], [1, 0], [1, 1]], "z_m": [1, 1]}])",
            R"(maze.json:11: error: /types/crate/blocks/0: "z_m" must be [min, max] with min below max, found 1 and 1)"},
        Wrong{R"("size_m": [1, 1, 1])",
              R"("blocks": [{"points_m": [[0, 0], [1, 0.1], [2, 0.2]], "z_m": [0, 1]}])",
              "maze.json:11: error: /types/crate/blocks/0/points_m: the outline has no area: all its points "
              "lie on one line"},
        Wrong{R"("size_m": [1, 1, 1])",
              R"("blocks": [{"points_m": [[0, 0], [1, 1], [1, 0], [0, 1]], "z_m": [0, 1]}])",
              "maze.json:11: error: /types/crate/blocks/0/points_m: the outline crosses or touches itself: "
              "the edges that begin at points 0 and 2, counted from 0, meet"}));

INSTANTIATE_TEST_SUITE_P(
    Bodies, JsonWorldError,
    testing::Values(
        Wrong{R"("name": "c0", )", "", R"(maze.json:14: error: /models/0: missing "name": the model's name)"},
        Wrong{R"("name": "c0")", R"("name": "")",
              R"(maze.json:14: error: /models/0/name: expected a name, found the text "")"},
        Wrong{
            R"("name": "c0")", R"("name": "c0", "global_parts": ["lid"])",
            R"(maze.json:14: error: /models/0/global_parts/0: the type "crate" of this model has no part "lid"; known: none)"},
        Wrong{
            R"("name": "c0")", R"("name": "r2")",
            R"(maze.json:17: error: the name "r2" is already used by the body on line 14; "same_names": "warn" in the world allows this)"},
        Wrong{
            R"("name": "c0")", R"("name": "_ground_model")",
            R"(maze.json:14: error: the name "_ground_model" is already used; "same_names": "warn" in the world allows this)"},
        Wrong{R"("type": "crate", )", "",
              R"(maze.json:14: error: /models/0: missing "type": the name of a type, a key of "types")"},
        Wrong{
            R"("type": "crate")", R"("type": "create")",
            R"(maze.json:14: error: /models/0/type: unknown type "create"; known: crate, minibot (did you mean "crate"?))"},
        Wrong{R"("x_m": 5)", R"("x": 5)",
              R"(maze.json:14: error: /models/0/pose: "x" needs its unit: write "x_m", "x_cm" or "x_mm")"},
        Wrong{R"("x_m": 5)", R"("heading_deg": 5000)",
              "maze.json:14: error: /models/0/pose/heading_deg: must be from -3600 to 3600 deg, found 5000"},
        Wrong{R"({"x_m": 5, "y_m": 5})", "[5, 5]",
              "maze.json:14: error: /models/0/pose: expected an object, found a list of length 2"},
        Wrong{
            R"("y_m": 5}})", R"("y_m": 5}},
    {"name": "m", "type": "minibot", "pose": {"x_m": 5.5, "y_m": 5.5}})",
            R"(maze.json:15: error: /models/1: "m" overlaps "c0" by 0.1 m at the start; "overlaps": "warn" in the world allows this)"},
        Wrong{R"("count": 4)", R"("count": -4)",
              "maze.json:17: error: /populations/0/count: must be from 0 to 10000000, found -4"},
        Wrong{R"("count": 4)", R"("count": 20000000)",
              "maze.json:17: error: /populations/0/count: must be from 0 to 10000000, found 20000000"},
        Wrong{R"("count": 4)", R"("count": 10000000)",
              "maze.json:17: error: the world would hold 10000002 bodies; at most 10000000 are allowed"},
        Wrong{R"("count": 4)", R"("count": 4, "reserve": -1)",
              "maze.json:17: error: /populations/0/reserve: must be from 0 to 10000000, found -1"},
        Wrong{R"("count": 4)", R"("count": 4, "reserve": 10000000)",
              "maze.json:17: error: the world would hold 10000006 bodies; at most 10000000 are allowed"},
        Wrong{
            R"("count": 4)", R"("count": 4, "reserve": "many")",
            "maze.json:17: error: /populations/0/reserve: expected a whole number, found the text \"many\""},
        Wrong{R"("count": 4,)", "",
              R"(maze.json:17: error: /populations/0: missing "count": number of bodies)"},
        Wrong{R"("count": 4)", R"("count": 26)",
              "maze.json:18: error: /populations/0/place: placed 25 of 26 bodies: the region has no "
              "further free cell (it has 25 cells); enlarge the region or lower the count"},
        Wrong{
            R"("rule": "grid", )", "",
            R"(maze.json:18: error: /populations/0/place: missing "rule": grid, uniform, gaussian, poisson_disc or free_floor)"},
        Wrong{
            R"("rule": "grid")", R"("rule": "gird")",
            R"(maze.json:18: error: /populations/0/place/rule: unknown rule "gird"; known: free_floor, gaussian, grid, poisson_disc, uniform (did you mean "grid"?))"},
        Wrong{
            R"("rule": "grid")", R"("rule": "uniform")",
            R"(maze.json:18: error: /populations/0/place: unknown key "pitch_m"; known: heading_deg, heading_rad, polygon_m, region_m, rule, z_cm, z_m, z_mm)"},
        Wrong{R"("rule": "grid", "region_m": [[0, 0], [1, 1]], "pitch_m": 0.25)",
              R"("rule": "uniform", "region_m": [[0, 0], [0.1, 0.1]])",
              "maze.json:18: error: /populations/0/place: placed 1 of 4 bodies: none of 1000 random "
              "poses for the next body was free; enlarge the region or lower the count"},
        Wrong{
            R"("region_m": [[0, 0], [1, 1]], )", "",
            R"(maze.json:18: error: /populations/0/place: missing "region_m", [[x_min, y_min], [x_max, y_max]] (or "polygon_m"), which is needed because the world has no bounds, floor plans or arena)"},
        Wrong{"[[0, 0], [1, 1]]", "[[0, 0], [1, -1]]",
              "maze.json:18: error: /populations/0/place/region_m: the corners are in the wrong order: "
              "expected [[x_min, y_min], [x_max, y_max]], found [[0, 0], [1, -1]]"},
        Wrong{"[[0, 0], [1, 1]]", "[[0, 0]]",
              "maze.json:18: error: /populations/0/place/region_m: expected 2 points, found 1"},
        Wrong{
            R"(, "pitch_m": 0.25)", "",
            R"(maze.json:18: error: /populations/0/place: missing "pitch_m", "pitch_cm" or "pitch_mm": the distance between neighbouring cells of the grid)"},
        Wrong{R"("pitch_m": 0.25)", R"("pitch_m": 0)",
              "maze.json:18: error: /populations/0/place/pitch_m: must be above 0 and at most 100000 m, "
              "found 0"},
        Wrong{R"("pitch_m": 0.25)", R"("pitch_m": 1e-6)",
              "maze.json:18: error: /populations/0/place: the region has 1000002 million cells of 0.000001 "
              "m; at most 100 million are allowed: give a larger \"pitch_m\""},
        Wrong{
            R"("pitch_m": 0.25)", R"("pitch_m": 0.25, "heading": "random", "heading_deg": 3)",
            R"(maze.json:18: error: /populations/0/place: give only one of "heading": "random", "heading_rad" or "heading_deg")"},
        Wrong{
            R"("pitch_m": 0.25)", R"("pitch_m": 0.25, "heading": 3)",
            R"(maze.json:18: error: /populations/0/place: "heading" needs its unit: write "heading_rad" or "heading_deg")"}));

TEST(JsonWorld, EverythingWrongIsReportedAtOnce) {
  EXPECT_THAT(
      Loaded("{\n\"troupe\": 3,\n\"types\": {\n\"a\": {\"size_m\": 1, \"drive\": {\"kind\": "
             "\"x\"}}},\n\"noise\": {},\n"
             "\"models\": [{\"name\": \"m\", \"type\": \"b\"}, 4]}")
          .found,
      ElementsAre(
          "maze.json:2: error: /troupe: unknown format version 3: this program reads version 1",
          "maze.json:4: error: /types/a/size_m: expected a list of 3 numbers in m, found the number 1",
          "maze.json:4: error: /types/a/drive/kind: unknown drive \"x\"; known: car, diff, omni",
          "maze.json:6: error: /models/1: expected an object, found the number 4",
          "maze.json:5: error: unknown key \"noise\"; known: $schema, arena, at, bounds_m, contacts, faults, "
          "floorplans, "
          "ground, include, "
          "measure_every_ms, measure_every_s, measures, models, mortal, overlaps, populations, quit_time_ms, "
          "quit_time_s, ranging, record, resolution_cm, resolution_m, resolution_mm, same_names, seed, "
          "stop_when, tick_ms, tick_s, title, troupe, types, watch, window",
          "maze.json:6: error: /models/0/type: unknown type \"b\"; known: a"));
  EXPECT_THAT(Loaded("[]").found,
              ElementsAre("maze.json:1: error: expected an object, found a list of length 0"));
}

TEST(JsonWorld, AKeyInAnUnknownUnitIsToldItsUnits) {
  const auto found = [](const std::string& keys, const std::string& of_bot = "") {
    return Loaded(R"({"troupe": 1, "types": {"bot": {"size_m": [1, 1, 1])" + of_bot + "}}" + keys + "}")
        .found;
  };
  const auto ends = [](const char* hint) { return ElementsAre(testing::EndsWith(hint)); };
  EXPECT_THAT(found(R"(, "quit_time_min": 5)"), ends(R"( (did you mean "quit_time_s" or "quit_time_ms"?))"));
  EXPECT_THAT(found(R"(, "models": [{"name": "a", "type": "bot", "pose": {"x_ft": 3}}])"),
              ends(R"( (did you mean "x_m" or "x_cm" or "x_mm"?))"));
  EXPECT_THAT(found("", R"(, "drive": {"kind": "diff", "speed_max_kmh": 3})"),
              ends(R"( (did you mean "speed_max_mps"?))"));
  EXPECT_THAT(found("", R"(, "sensors": [{"kind": "ranger", "transducers": [{"samples_kg": 3}]}])"),
              ends(R"( (did you mean "samples"?))"));
  EXPECT_THAT(found(R"(, "sede": 3)"), ends(R"( (did you mean "seed"?))"));
}

TEST_F(JsonWorldOfPictures, FloorPlanErrors) {
  const auto file = write_picture("white.pgm", {"..", ".."});
  write_picture("dark.pgm", {"##", "#."});
  const auto wrong = [&](const std::string& plan) {
    const Loaded loaded(
        "{\"troupe\": 1, \"types\": {\"t\": {\"size_m\": [1, 1, 1], \"drive\": {\"kind\": \"diff\"}}},\n"
        "\"floorplans\": [" +
            plan +
            "],\n"
            "\"models\": [{\"name\": \"m\", \"type\": \"t\"}]}",
        {}, file);
    std::string text;
    for (const std::string& line : loaded.found) text += (text.empty() ? "" : "\n") + line;
    for (std::size_t at; (at = text.find(file.parent_path().string() + "/")) != std::string::npos;)
      text.erase(at, file.parent_path().string().size() + 1);
    return text;
  };
  EXPECT_EQ(wrong(R"({"name": "a", "bitmap": "white.pgm", "size_m": [4, 4, 1]})"),
            "maze.json:2: warning: /floorplans/0/bitmap: the image white.pgm has no solid pixel, so it has "
            "no walls; "
            "pixels whose first channel is at most 127 are solid");
  EXPECT_EQ(wrong(R"({"name": "a", "bitmap": "white.pgm", "size_m": [4, 4, 1], "boundary": true})"),
            "maze.json:2: warning: /floorplans/0/bitmap: the image white.pgm has no solid pixel, so only its "
            "\"boundary\" has walls; pixels whose first channel is at most 127 are solid");
  EXPECT_EQ(wrong(R"({"name": "a", "bitmap": "white.pgm"})"),
            R"(maze.json:2: error: /floorplans/0: missing "size_m", "size_cm" or "size_mm": [x, y, height])");
  EXPECT_EQ(
      wrong(R"({"name": "a", "size_m": [4, 4, 1]})"),
      R"(maze.json:2: error: /floorplans/0: a floor plan needs "bitmap" (the path of an image, or of the YAML file of a ROS map, relative to the world file) or "walls_m" (points [[x, y], ...] of a line of walls))");
  EXPECT_EQ(
      wrong(R"({"name": "a", "bitmap": "dark.pgm", "size_m": [4, 4, 1], "margins": "kep"})"),
      R"(maze.json:2: error: /floorplans/0/margins: unknown margins "kep"; known: keep, trim (did you mean "keep"?))");
  EXPECT_THAT(wrong(R"({"name": "a", "bitmap": "none.pgm", "size_m": [4, 4, 1]})"),
              testing::AllOf(testing::StartsWith("maze.json:2: error: "), testing::HasSubstr("none.pgm")));
  EXPECT_EQ(
      wrong(R"({"name": "a", "bitmap": "dark.pgm", "size_m": [4, 4, 1]})"),
      R"(maze.json:3: error: /models/0: "m" overlaps "a" by 0.5 m at the start; "overlaps": "warn" in the world allows this)");
  EXPECT_EQ(wrong(R"({"name": "a", "bitmap": "dark.pgm", "size_m": [4, 4, 1], "obstacle": false})"), "");
  EXPECT_EQ(
      wrong(R"({"name": "a", "bitmap": "dark.pgm", "size_m": [4, 4, 1], "pose": {"x_m": 9}})"),
      R"(maze.json:3: error: /models/0: "m" is at [0, 0] m, outside the bounds of the world, [[7, -2], [11, 2]] m: move the model, or change "bounds_m")");
}

TEST(JsonWorld, OutlineFaults) {
  EXPECT_TRUE(check_outline({{0, 0}, {2, 0}, {2, 1}, {1, 0.5}, {0, 1}}));  // need not be convex
  EXPECT_EQ(check_outline({{0, 0}, {0, 0}, {2, 1}}).error().text,
            "point 1 repeats point 0 (points are counted from 0): remove one of the two");
  EXPECT_EQ(
      check_outline({{0, 0}, {2, 0}, {2, 1}, {0, 0}}).error().text,
      "the last point repeats the first: omit the last point, because outlines are closed automatically");
  EXPECT_EQ(check_outline({{0.1, 0.1}, {0.2, 0.2}, {0.7, 0.7}}).error().text,
            "the outline has no area: all its points lie on one line");
  EXPECT_EQ(check_outline({{0, 0}, {2, 0}, {2, 2}, {3, 2}, {1, 2}}).error().text,
            "the outline turns back on itself at point 3, counted from 0: remove this point");
  EXPECT_EQ(
      check_outline({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}).error().text,  // a corner touches an edge
      "the outline crosses or touches itself: the edges that begin at points 0 and 2, counted from 0, meet");
}

TEST(JsonWorld, SetAndSeed) {
  LoadOptions options;
  options.seed = 99;
  options.set = {
      {"/populations/0/count", "6"}, {"/types/minibot/color", "blue"}, {"/populations/0/color", "random"}};
  const Loaded loaded(k_world, options);
  ASSERT_THAT(loaded.found, IsEmpty());
  EXPECT_EQ(loaded.spec.seed, 99u);
  EXPECT_EQ(loaded.spec.bodies.size(), 8u);
  const Color c = loaded.spec.bodies[3].color;
  EXPECT_NE(c, loaded.spec.bodies[4].color);
  EXPECT_EQ(c, Loaded(k_world, options).spec.bodies[3].color);
  options.seed = 98;
  EXPECT_NE(c, Loaded(k_world, options).spec.bodies[3].color);
  options.seed.reset();
  options.set = {{"/seed", "1e+05"}};  // as a study writes a value of "steps"
  EXPECT_EQ(Loaded(k_world, options).spec.seed, 100000u);

  options.set = {{"/populations/0/count", "many"},
                 {"/populations/0/pitch_m", "1"},
                 {"/types/minibot/drive/kind", "fly"}};
  EXPECT_THAT(
      Loaded(k_world, options).found,
      ElementsAre(
          "--set /types/minibot/drive/kind: error: /types/minibot/drive/kind: unknown drive \"fly\"; known: "
          "car, diff, omni",
          "--set /populations/0/count: error: /populations/0/count: expected a whole number, found the text "
          "\"many\"",
          "--set /populations/0/pitch_m: error: /populations/0: unknown key \"pitch_m\"; known: color, "
          "count, name, place, reserve, type"));

  options.set = {{"/include", R"(["more.json"])"}};
  EXPECT_THAT(
      Loaded(k_world, options).found,
      ElementsAre("--set /include: error: /include: this key cannot be set from outside the world file: "
                  "write it in the file"));
}

TEST(JsonWorld, TextsWithANulCharacterAreRefused) {
  EXPECT_THAT(Loaded("{\"troupe\": 1,\n\"types\": {\"b\": {\"size_m\": [1, 1, 1]}},\n\"models\": [\n"
                     "{\"type\": \"b\", \"name\": \"a\\u0000b\"},\n{\"type\": \"b\", \"name\": \"a_b\"}]}")
                  .found,
              ElementsAre(HasSubstr(
                  "4: error: /models/0/name: the text contains the character U+0000 (\\u0000): remove it")));
  EXPECT_THAT(Loaded("{\"troupe\": 1,\n\"types\": {\"b\\u0000\": {\"size_m\": [1, 1, 1]}}}").found,
              Contains(HasSubstr("2: error: a key contains the character U+0000 (\\u0000): remove it")));
  LoadOptions options;
  options.set = {{"/populations/0/name", "\"a\\u0000b\""}};
  EXPECT_THAT(Loaded(k_world, options).found,
              Contains(HasSubstr("error: /populations/0/name: the text contains the character U+0000")));
}

TEST(JsonWorld, ThreadsChangeNeitherAWorldNorItsFindings) {
  const auto load = [](unsigned threads, const std::string& place) {
    LoadOptions options;
    options.threads = threads;
    options.set = {{"/populations/0/count", "3000"}, {"/populations/0/place", place}};
    return Loaded(k_world, options);
  };
  const std::string uniform = R"({"rule": "uniform", "region_m": [[0, 0], [25, 25]]})";
  const std::string grid = R"({"rule": "grid", "region_m": [[0, 0], [25, 25]], "pitch_m": 0.25})";
  const std::string narrow = R"({"rule": "uniform", "region_m": [[0, 0], [3, 3]]})";  // no room for all
  for (const std::string& place : {uniform, grid, narrow}) {
    const Loaded one = load(1, place);
    EXPECT_EQ(one.found.size(), place == narrow ? 1u : 0u);
    for (const unsigned threads : {2u, 3u, 8u}) {
      const Loaded loaded = load(threads, place);
      EXPECT_EQ(loaded.found, one.found);
      ASSERT_EQ(loaded.spec.bodies.size(), one.spec.bodies.size());
      for (std::size_t b = 0; b < one.spec.bodies.size(); ++b) {
        EXPECT_EQ(loaded.spec.name(BodyId(b)), one.spec.name(BodyId(b)));
        EXPECT_EQ(loaded.spec.bodies[b].pose_world_body, one.spec.bodies[b].pose_world_body);
      }
    }
  }
}

TEST(JsonWorld, RobotsSetAPopulation) {
  const std::string two =
      changed("\"pitch_m\": 0.25}}",
              "\"pitch_m\": 0.25}},\n{\"name\": \"s\", \"type\": \"crate\", \"count\": 1, \"place\": "
              "{\"rule\": \"uniform\", \"region_m\": [[20, 20], [30, 30]]}}");
  const auto load = [](const std::string& text, std::vector<std::pair<std::string, std::size_t>> robots) {
    LoadOptions options;
    options.robots = std::move(robots);
    return Loaded(text, options);
  };
  EXPECT_EQ(load(k_world, {{"", 9}}).spec.bodies.size(), 2u + 9);
  EXPECT_EQ(load(changed("\"count\": 4,", ""), {{"", 9}}).spec.bodies.size(), 2u + 9);
  EXPECT_EQ(load(two, {{"s", 3}}).spec.bodies.size(), 2u + 4 + 3);
  EXPECT_EQ(load(two, {{"s", 3}, {"r", 0}}).spec.bodies.size(), 2u + 3);
  EXPECT_THAT(load(two, {{"", 3}}).found, ElementsAre("--robots 3: error: the world has 2 populations: name "
                                                      "one of them, as in --robots NAME=N; known: r, s"));
  EXPECT_THAT(load(two, {{"t", 3}}).found,
              ElementsAre("--robots t=3: error: unknown population \"t\"; known: r, s"));
  EXPECT_THAT(load("{\"troupe\": 1}", {{"", 3}}).found,
              ElementsAre("--robots 3: error: the number of robots can be set only for a population, but the "
                          "world has no populations"));
  EXPECT_THAT(
      load(k_world, {{"r", ~std::size_t{0}}}).found,
      ElementsAre(
          "--robots r=18446744073709551615: error: /populations/0/count: must be from 0 to 10000000, found "
          "18446744073709551615"));
  EXPECT_THAT(
      load(k_world, {{"", 100}}).found,
      ElementsAre(
          "maze.json:18: error: /populations/0/place: placed 25 of 100 bodies: the region has no further "
          "free cell (it has 25 cells); enlarge the region or lower the count"));
}

TEST(JsonWorld, AReserveFollowsItsPopulation) {
  const Loaded loaded(changed(R"("count": 4)", R"("count": 4, "reserve": 3, "color": "red")"));
  ASSERT_THAT(loaded.found, IsEmpty());
  ASSERT_EQ(loaded.spec.bodies.size(), 1u + 1 + 4 + 3);
  ASSERT_EQ(loaded.spec.reserves.size(), 1u);
  const engine::ReserveSpec& reserve = loaded.spec.reserves[0];
  EXPECT_EQ(reserve.population, "r");
  EXPECT_EQ(reserve.first, BodyId(6));
  EXPECT_EQ(reserve.count, 3u);
  EXPECT_EQ(loaded.spec.name(BodyId(6)), "r4");
  EXPECT_EQ(loaded.spec.name(BodyId(8)), "r6");
  EXPECT_EQ(loaded.spec.bodies[8].type, loaded.spec.bodies[5].type);
  EXPECT_EQ(loaded.spec.bodies[8].color, loaded.spec.bodies[5].color);
  EXPECT_TRUE(loaded.spec.starts(BodyId(5)));
  EXPECT_FALSE(loaded.spec.starts(BodyId(6)));
  EXPECT_FALSE(loaded.spec.starts(BodyId(8)));
  EXPECT_EQ(loaded.spec.reserve_of(BodyId(5)), nullptr);
  EXPECT_EQ(loaded.spec.reserve_of(BodyId(6)), &reserve);
  EXPECT_EQ(loaded.spec.reserve_of(BodyId(8)), &reserve);
  EXPECT_EQ(loaded.spec.reserve_of(BodyId(9)), nullptr);
  const Loaded plain(k_world);
  for (std::size_t b = 0; b < 6; ++b)
    EXPECT_EQ(plain.spec.bodies[b].pose_world_body, loaded.spec.bodies[b].pose_world_body);
  EXPECT_TRUE(plain.spec.reserves.empty());
  EXPECT_FALSE(plain.spec.mortal);
  EXPECT_TRUE(Loaded(changed(R"("seed": 7)", R"("seed": 7, "mortal": true)")).spec.mortal);
}

TEST(JsonWorld, PopulationsAvoidModelsAndOneAnother) {
  const Loaded loaded(
      R"({"troupe": 1, "types": {"t": {"size_m": [1, 1, 1]}, "ghost": {"size_m": [1, 1, 1], "obstacle": false}},
    "models": [{"name": "m", "type": "t", "pose": {"y_m": 1}}],
    "populations": [
      {"name": "a", "type": "t", "count": 2, "place": {"rule": "grid", "region_m": [[0, 0], [3, 3]], "pitch_m": 1}},
      {"name": "b", "type": "t", "count": 1, "place": {"rule": "grid", "region_m": [[0, 0], [3, 3]], "pitch_m": 1}},
      {"name": "g", "type": "ghost", "count": 1, "place": {"rule": "grid", "region_m": [[0, 0], [3, 3]], "pitch_m": 1}}]})");
  ASSERT_THAT(loaded.found, IsEmpty());
  EXPECT_EQ(loaded.spec.bodies[2].pose_world_body, (Pose{0, 0, 0, 0}));
  EXPECT_EQ(loaded.spec.bodies[3].pose_world_body, (Pose{0, 2, 0, 0}));  // the model stands at (0, 1)
  EXPECT_EQ(loaded.spec.bodies[4].pose_world_body, (Pose{0, 3, 0, 0}));
  EXPECT_EQ(loaded.spec.bodies[5].pose_world_body, (Pose{0, 0, 0, 0}));  // not an obstacle: the place is free
}

TEST(JsonWorld, AGridMaySpill) {
  LoadOptions options;
  options.robots = {{"", 30}};
  options.set = {{"/populations/0/place/spill_m", "[[2, 0], [3, 3]]"}};
  const Loaded loaded(k_world, options);
  ASSERT_THAT(loaded.found, IsEmpty());
  EXPECT_EQ(loaded.spec.bodies[2 + 24].pose_world_body, (Pose{1, 1, 0, 0}));
  EXPECT_EQ(loaded.spec.bodies[2 + 25].pose_world_body, (Pose{2, 0, 0, 0}));
  EXPECT_EQ(loaded.spec.bodies[2 + 29].pose_world_body, (Pose{2, 1, 0, 0}));

  options.set = {{"/populations/0/place/spill_m", "[[2, 0], [1, 3]]"}};
  EXPECT_THAT(Loaded(k_world, options).found,
              ElementsAre("--set /populations/0/place/spill_m: error: /populations/0/place/spill_m: the "
                          "corners are in the wrong "
                          "order: expected [[x_min, y_min], [x_max, y_max]], found [[2, 0], [1, 3]]"));
}

TEST(JsonWorld, ASpillOutsideThePolygonIsAnError) {
  const auto found = [](const std::string& spill) {
    return Loaded(
               fmt::format(R"({{"troupe": 1, "types": {{"t": {{"size_m": [0.1, 0.1, 0.1]}}}}, "populations": [
      {{"name": "a", "type": "t", "count": 1, "place": {{"rule": "grid", "pitch_m": 1,
        "polygon_m": [[0, 0], [3, 0], [0, 3]], "spill_m": {}}}}}]}})",
                           spill))
        .found;
  };
  EXPECT_THAT(found("[[1, 1], [5, 5]]"), IsEmpty());
  EXPECT_THAT(
      found("[[4, 0], [5, 5]]"),
      ElementsAre("maze.json:3: error: /populations/0/place/spill_m: outside \"polygon_m\", in which all "
                  "bodies must lie: give a rectangle that overlaps the polygon, or remove \"spill_m\""));
}

TEST(JsonWorld, AMillionRobotsLoad) {
  constexpr std::size_t k_robots = test::k_slow_build ? 100'000 : 1'000'000;
  LoadOptions options;
  options.robots = {{"", k_robots}};
  options.set = {{"/populations/0/place/region_m", "[[10, 10], [400, 400]]"}};
  const Loaded loaded(k_world, options);
  EXPECT_THAT(loaded.found, IsEmpty());
  EXPECT_EQ(loaded.spec.bodies.size(), k_robots + 2);
}

TEST(JsonWorld, EveryWorldWeShipLoads) {
  std::size_t worlds = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_dir() / "worlds")) {
    if (entry.path().extension() != ".json") continue;
    if (entry.path().filename() == "scenes.json") continue;               // the manifest
    if (test::k_slow_build && entry.path().stem() == "campus") continue;  // a million robots
    Diagnostics diagnostics;
    const WorldSpec spec = load_world(entry.path(), make_registry(), {}, diagnostics);
    EXPECT_THAT(findings(diagnostics), IsEmpty());
    EXPECT_GT(spec.bodies.size(), 5u) << entry.path();
    ++worlds;
  }
  EXPECT_GE(worlds, 6u);
}

/// A document with a few bytes cut out and scraps of JSON put in.
std::string mutated(std::string text) {
  static const std::vector<std::string> k_scraps{"{",
                                                 "}",
                                                 "[",
                                                 "]",
                                                 ",",
                                                 ":",
                                                 "\"",
                                                 "null",
                                                 "-",
                                                 "1e5",
                                                 "0",
                                                 "\n",
                                                 "\\",
                                                 "\"x\"",
                                                 "{}",
                                                 "[]",
                                                 "true",
                                                 "\xff",
                                                 "\"heading\": 1,",
                                                 "9"};
  for (int i = *rc::gen::inRange(1, 6); i > 0; --i) {
    const auto at = *rc::gen::resize(100, rc::gen::inRange<std::size_t>(0, text.size()));
    const auto gone = *rc::gen::resize(100, rc::gen::inRange<std::size_t>(0, 12));
    text.replace(at, gone, *rc::gen::elementOf(k_scraps));
  }
  return text;
}

RC_GTEST_PROP(JsonWorldFuzz, MutatedWorldsNeverCrash, ()) {
  for (int i = 0; i < 50; ++i) {
    const std::string text = mutated(k_world);
    if (text.find("\"count\": 4,") == std::string::npos)
      continue;  // another count is legal, but may take long
    const Loaded loaded(text);
    for (const std::string& line : loaded.found) RC_ASSERT(line.starts_with("maze.json:"));
  }
}

RC_GTEST_PROP(JsonWorldFuzz, MutatedDocumentsNeverCrash, ()) {
  for (int i = 0; i < 50; ++i) {
    Diagnostics diagnostics;
    const auto root =
        parse_json(mutated(k_world), {diagnostics.files()->add("maze.json"), 0}, false, diagnostics);
    RC_ASSERT(root.has_value() == !diagnostics.has_errors());
  }
}

RC_GTEST_PROP(JsonWorldFuzz, ValuesOfTheWrongKindNeverCrash, ()) {
  static const std::vector<std::string> k_pointers{"/troupe",
                                                   "/seed",
                                                   "/types",
                                                   "/types/minibot",
                                                   "/types/minibot/size_m",
                                                   "/types/minibot/size_m/1",
                                                   "/types/minibot/drive",
                                                   "/types/minibot/drive/kind",
                                                   "/types/minibot/sensors",
                                                   "/types/minibot/sensors/0",
                                                   "/types/minibot/sensors/0/transducers",
                                                   "/types/minibot/sensors/0/transducers/0",
                                                   "/types/minibot/controller",
                                                   "/models",
                                                   "/models/0",
                                                   "/models/0/pose",
                                                   "/models/0/pose/x_m",
                                                   "/populations",
                                                   "/populations/0",
                                                   "/populations/0/place",
                                                   "/populations/0/place/region_m",
                                                   "/populations/0/place/region_m/1",
                                                   "/populations/0/place/rule",
                                                   "/populations/0/name",
                                                   "/populations/0/color",
                                                   "/floorplans",
                                                   "/types/crate/blocks",
                                                   "/types/crate/color"};
  static const std::vector<std::string> k_values{"null",
                                                 "true",
                                                 "-1",
                                                 "0",
                                                 "1e300",
                                                 "18446744073709551615",
                                                 "\"\"",
                                                 "\"diff\"",
                                                 "[]",
                                                 "[[]]",
                                                 "[[0,0],[1,1]]",
                                                 "[1,2,3]",
                                                 "{}",
                                                 "{\"kind\": \"omni\"}",
                                                 "[{}]",
                                                 "{\"name\": 3, \"type\": []}",
                                                 "text"};
  LoadOptions options;
  for (int i = *rc::gen::inRange(1, 5); i > 0; --i)
    options.set.emplace_back(*rc::gen::elementOf(k_pointers), *rc::gen::elementOf(k_values));
  options.robots = {{*rc::gen::elementOf(std::vector<std::string>{"", "r", "x"}), 5}};
  const Loaded loaded(k_world, options);
  for (const std::string& line : loaded.found)
    RC_ASSERT(line.starts_with("maze.json:") || line.starts_with("--set /") || line.starts_with("--robots "));
}

}  // namespace
}  // namespace troupe::worldio::json_world_test
