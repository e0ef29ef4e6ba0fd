// Short forms of the world format: arenas, lines of walls, discs, rings, and types from other files.
#include "engine/fields/description.hpp"
#include "tests/support/scratch.hpp"
#include "tests/worldio/json_test_world.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_include.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/wall_line.hpp"
#include "worldio/json/world_document.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

namespace troupe::worldio::arena_test {
namespace {

using engine::WorldSpec;
using testing::ElementsAre;
using testing::IsEmpty;

struct LoadedArena {
  Diagnostics diagnostics;
  WorldSpec spec;
  std::vector<std::string> found;

  explicit LoadedArena(const std::string& text, const LoadOptions& options = {},
                       const std::filesystem::path& file = "maze.json") {
    spec = load_json_world(file, text, json_test_registry(), options, diagnostics);
    for (std::string line : findings(diagnostics)) {  // without the folder
      const std::string folder = file.parent_path().string() + "/";
      for (std::size_t at; folder != "/" && (at = line.find(folder)) != std::string::npos;)
        line.erase(at, folder.size());
      found.push_back(line);
    }
  }
  const engine::TypeSpec& type(std::string_view name) const {
    return *std::ranges::find(spec.types, name, &engine::TypeSpec::name);
  }
};

std::string world(const std::string& keys) { return "{\"troupe\": 1,\n" + keys + "}"; }

Box extent(const engine::PartSpec& part) {
  Box box;
  for (const Solid& solid : part.solids)
    for (const Ring& ring : solid.contours) box.extend(bounds(ring));
  return box;
}

bool is_solid(const engine::PartSpec& part, const Vec2& point) {
  return std::ranges::any_of(part.solids, [&](const Solid& solid) { return contains(solid, point); });
}

TEST(Arena, IsBoundsAndWallsOutsideOfThem) {
  const LoadedArena loaded(
      world(R"("arena": {"size_m": [4, 2], "height_m": 0.3, "thickness_cm": 20, "color": "red"})"));
  ASSERT_THAT(loaded.found, IsEmpty());
  ASSERT_EQ(loaded.spec.bodies.size(), 2u);
  EXPECT_EQ(loaded.spec.name(BodyId(1)), "arena");
  EXPECT_EQ(loaded.spec.bodies[1].color, (Color{1, 0, 0, 1}));
  EXPECT_EQ(loaded.spec.bodies[1].where.line, 2u);
  ASSERT_TRUE(loaded.spec.bounds);
  EXPECT_EQ(loaded.spec.bounds->min, Vec2(-2, -1));
  EXPECT_EQ(loaded.spec.bounds->max, Vec2(2, 1));
  const engine::PartSpec& walls = loaded.type("arena").parts.front();
  EXPECT_TRUE(walls.floor_plan);
  EXPECT_TRUE(extent(walls).max.isApprox(Vec2(2.2, 1.2)));
  EXPECT_TRUE(extent(walls).min.isApprox(Vec2(-2.2, -1.2)));
  for (const Vec2& inside : {Vec2(0, 0), Vec2(1.99, 0.99), Vec2(-1.99, 0.99)})
    EXPECT_FALSE(is_solid(walls, inside));
  for (const Vec2& wall : {Vec2(2.1, 0), Vec2(2.15, 1.15), Vec2(-2.15, 1.19), Vec2(0, -1.1)})
    EXPECT_TRUE(is_solid(walls, wall)) << wall.transpose();
  for (const Solid& wall : walls.solids) EXPECT_EQ(wall.z, (ZInterval{0, 0.3}));
}

TEST(Arena, WallsWithoutAColourHaveTheOneThatTheReferenceStates) {
  const auto stated = [](const DocumentTable& table) {
    return std::string(std::ranges::find(table.keys, "color", [](const DocumentKey& key) {
                         return key.field.name;
                       })->by_default);
  };
  const std::string arena = R"("arena": {"size_m": [4, 2])";
  const LoadedArena plain(world(arena + "}"));
  const LoadedArena colored(world(arena + ", \"color\": " + stated(document_table<ArenaDocument>()) + "}"));
  ASSERT_THAT(colored.found, IsEmpty());
  EXPECT_EQ(plain.spec.bodies[1].color, colored.spec.bodies[1].color);
  const std::string lines = R"("floorplans": [{"name": "w", "walls_m": [[0, 0], [1, 0]])";
  const LoadedArena bare(world(lines + "}]"));
  const LoadedArena painted(
      world(lines + ", \"color\": " + stated(document_table<FloorplanDocument>()) + "}]"));
  ASSERT_THAT(painted.found, IsEmpty());
  EXPECT_EQ(bare.spec.bodies[1].color, painted.spec.bodies[1].color);
}

TEST(Arena, MayHaveNoWallsAndOtherBounds) {
  const LoadedArena open(world(R"("arena": {"size_m": [4, 2], "walls": false})"));
  ASSERT_THAT(open.found, IsEmpty());
  EXPECT_EQ(open.spec.bodies.size(), 1u);
  EXPECT_EQ(open.spec.bounds->max, Vec2(2, 1));
  const LoadedArena other(world(R"("arena": {"size_m": [4, 2]}, "bounds_m": [[-1, -1], [1, 1]])"));
  ASSERT_THAT(other.found, IsEmpty());
  EXPECT_EQ(other.spec.bounds->max, Vec2(1, 1));
  EXPECT_THAT(
      LoadedArena(world(R"("arena": {"walls": true})")).found,
      ElementsAre(
          R"(maze.json:2: error: /arena: missing "size_m", "size_cm" or "size_mm": [x, y], the size of the free floor)"));
  EXPECT_THAT(
      LoadedArena(world(R"("arena": {"size_m": [4, 0]})")).found,
      ElementsAre("maze.json:2: error: /arena/size_m/1: must be above 0 and at most 100000 m, found 0"));
}

TEST(Arena, PopulationsFillIt) {
  const LoadedArena loaded(world(
      R"("arena": {"size_m": [2, 2]}, "types": {"bot": {"size_m": [0.2, 0.2, 0.1], "drive": {"kind": "diff"}}},
    "populations": [{"name": "r", "type": "bot", "count": 20, "place": {"rule": "uniform"}}])"));
  ASSERT_THAT(loaded.found, IsEmpty());
  for (std::size_t i = 2; i < loaded.spec.bodies.size(); ++i)
    EXPECT_LT(loaded.spec.bodies[i].pose_world_body.position().cwiseAbs().maxCoeff(), 0.95);
  EXPECT_THAT(
      LoadedArena(
          world(
              R"("arena": {"size_m": [2, 2]}, "types": {"bot": {"size_m": [0.2, 0.2, 0.1], "drive": {"kind": "diff"}}},
    "populations": [{"name": "r", "type": "bot", "count": 20, "place": "uniform"}])"))
          .found,
      ElementsAre(
          R"(maze.json:3: error: /populations/0/place: expected an object such as {"rule": "uniform"}, found the text "uniform")"));
}

TEST(WallLine, HasMitredCornersAndIsClosedWhenItsEndsMeet) {
  const LoadedArena loaded(world(R"("floorplans": [
    {"name": "open", "walls_m": [[0, 0], [2, 0], [2, 1]], "thickness_m": 0.2, "pose": {"x_m": 10}},
    {"name": "ring", "walls_m": [[0, 0], [2, 0], [1, 2], [0, 0]], "height_m": 0.5}])"));
  ASSERT_THAT(loaded.found, IsEmpty());
  const engine::PartSpec& open = loaded.type("open").parts.front();
  ASSERT_EQ(open.solids.size(), 2u);
  EXPECT_EQ(open.solids[0].z, (ZInterval{0, 1}));
  for (const Vec2& wall : {Vec2(0.01, 0.09), Vec2(2.09, -0.09), Vec2(2.09, 0.99)})
    EXPECT_TRUE(is_solid(open, wall));
  for (const Vec2& free : {Vec2(-0.01, 0), Vec2(2, 1.01), Vec2(1.89, 0.11), Vec2(2.11, -0.05)})
    EXPECT_FALSE(is_solid(open, free)) << free.transpose();
  EXPECT_EQ(loaded.type("ring").parts.front().solids.size(), 3u);
  EXPECT_EQ(loaded.type("ring").parts.front().solids[0].z, (ZInterval{0, 0.5}));
  EXPECT_TRUE(loaded.spec.bounds->max.isApprox(Vec2(12, 2)));
}

TEST(WallLine, RobotsOnBothSidesOfClosedWallsAreAWarning) {
  const auto found = [](const std::string& line, const std::string& plan, const std::string& place,
                        const std::string& drive = R"(, "drive": {"kind": "diff"})") {
    return LoadedArena(
               world(R"("bounds_m": [[-4, -2], [4, 2]], "floorplans": [{"name": "ring", "thickness_m": 0.02,
      "pose": {"x_m": 2}, "walls_m": )" +
                     line + plan + R"(}], "types": {"bot": {"size_m": [0.1, 0.1, 0.1])" + drive + R"(}},
    "populations": [
      {"name": "q", "type": "bot", "count": 2, "reserve": 3, "place": {"rule": "uniform", "region_m": [[-4, -2], [-3, 2]]}},
      {"name": "r", "type": "bot", "count": 40, "place": )" +
                     place + "}]"))
        .found;
  };
  const std::string closed = "[[1.9, 0], [0, 1.9], [-1.9, 0], [0, -1.9], [1.9, 0]]";
  const std::string uniform = R"({"rule": "uniform"})";
  EXPECT_THAT(found(closed, "", uniform),
              ElementsAre(testing::MatchesRegex(
                  "maze.json:6: warning: /populations/1/place: \"r[0-9]+\" starts inside the closed walls of "
                  "floor plan \"ring\", and \"r[0-9]+\" outside: use the rule free_floor, or give a "
                  "\"polygon_m\" on one side of the walls; if both sides are meant, write one population for "
                  "each side")));
  EXPECT_THAT(found("[[1.9, 0], [0, 1.9], [-1.9, 0], [0, -1.9]]", "", uniform), IsEmpty());
  EXPECT_THAT(found(closed, R"(, "obstacle": false)", uniform), IsEmpty());
  EXPECT_THAT(found(closed, "", uniform, R"(, "gripper_return": true)"), IsEmpty());         // no robots
  EXPECT_THAT(found(closed, "", R"({"rule": "free_floor", "from_m": [2, 0]})"), IsEmpty());  // q is outside
  EXPECT_THAT(
      found(closed, "", R"({"rule": "uniform", "polygon_m": [[3.8, 0], [2, 1.8], [0.2, 0], [2, -1.8]]})"),
      IsEmpty());
}

TEST(WallLine, Errors) {
  const auto error_of = [](const std::string& keys) {
    return LoadedArena(world(R"("floorplans": [{"name": "w", )" + keys + "}]")).found;
  };
  const std::string at = "maze.json:2: error: /floorplans/0";
  EXPECT_THAT(error_of(R"("walls_m": [[0, 0], [1, 0], [1, 0]])"),
              ElementsAre(at + "/walls_m: point 2 repeats point 1 (points are counted from 0): remove one of "
                               "the two, because a wall of length 0 is not allowed"));
  EXPECT_THAT(error_of(R"("walls_m": [[0, 0]])"),
              ElementsAre(at + "/walls_m: expected 2 to 1000 points, found 1"));
  EXPECT_THAT(
      error_of(R"("walls_m": [[0, 0], [1, 0], [0, 0.01]])"),
      ElementsAre(at + "/walls_m: the line turns back on itself at point 1, counted from 0: a line may "
                       "turn by at most 165 degrees"));
  EXPECT_THAT(error_of(R"("walls_m": [[0, 0], [0.1, 0], [0.1, 1]], "thickness_m": 0.4)"),
              ElementsAre(at + "/walls_m: the segment that begins at point 0, counted from 0, is too short "
                               "for walls 0.4 m thick: move this point, or make the walls thinner"));
  EXPECT_THAT(error_of(R"("walls_m": [[0, 0], [1, 0]], "bitmap": "x.png")"),
              ElementsAre(at + R"(: give "bitmap" or "walls_m", not both)"));
}

TEST(Disc, IsARegularPolygon) {
  const LoadedArena loaded(world(R"("types": {"foot": {"disc": {"radius_cm": 8.5, "height_m": 0.15}},
    "post": {"disc": {"radius_m": 1, "height_m": 2, "corners": 6}, "blocks": []}, "none": {"disc": {"radius_m": 1}}})"));
  EXPECT_THAT(
      loaded.found,
      ElementsAre(
          R"(maze.json:3: error: /types/none/disc: missing "height_m", "height_cm" or "height_mm": height of the cylinder)"));
  const engine::PartSpec& foot = loaded.type("foot").parts.front();
  ASSERT_EQ(foot.solids.size(), 1u);
  ASSERT_EQ(foot.solids[0].contours[0].size(), 16u);
  for (const Vec2& corner : foot.solids[0].contours[0]) EXPECT_NEAR(corner.norm(), 0.085, 1e-15);
  EXPECT_GT(signed_area(foot.solids[0].contours[0]), 0);
  EXPECT_EQ(foot.solids[0].z, (ZInterval{0, 0.15}));
  EXPECT_NEAR(foot.size.x(), 0.17, 1e-15);
  EXPECT_EQ(loaded.type("post").parts.front().solids[0].contours[0].size(), 6u);
}

TEST(Ring, RepeatsTransducersAroundTheirPose) {
  const LoadedArena loaded(
      world(R"("types": {"bot": {"size_m": [1, 1, 1], "sensors": [{"name": "ir", "kind": "ranger",
    "transducers": [{"ring": {"count": 4, "radius_m": 0.5, "start_deg": 45}, "pose": {"x_m": 1, "heading_deg": 90}, "range_max_m": 2},
                    {"range_max_m": 3}]}]}})"));
  ASSERT_THAT(loaded.found, IsEmpty());
  const engine::Registry registry = json_test_registry();
  const engine::FieldTable& ranger = registry.device("ranger")->params;
  const auto& fans = engine::get(ranger, loaded.type("bot").devices[0].params, "transducers").records();
  ASSERT_EQ(fans.size(), 5u);
  const engine::FieldTable& fan = *ranger.fields.front().record;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pose = engine::from_record<Pose>(engine::get(fan, fans[i], "pose").records().front());
    const double angle = radians(135 + 90.0 * static_cast<double>(i));
    EXPECT_NEAR(pose.x, 1 + 0.5 * std::cos(angle), 1e-12);
    EXPECT_NEAR(pose.y, 0.5 * std::sin(angle), 1e-12);
    EXPECT_NEAR(std::remainder(pose.heading - angle, 2 * k_pi), 0, 1e-12);
    EXPECT_EQ(engine::get(fan, fans[i], "range_max").number(), 2.0);
  }
  EXPECT_EQ(engine::get(fan, fans[4], "range_max").number(), 3.0);
}

TEST(Ring, RepeatsPartsAndTheNamesOfTheirDevices) {
  const LoadedArena loaded(world(R"("types": {"bot": {"size_m": [1, 1, 1], "parts": [
    {"name": "lamp", "size_m": [0.1, 0.1, 0.1], "ring": {"count": 3, "radius_m": 0.4},
     "sensors": [{"name": "eye", "kind": "ranger", "transducers": []}]}]}})"));
  ASSERT_THAT(loaded.found, IsEmpty());
  const engine::TypeSpec& bot = loaded.type("bot");
  ASSERT_EQ(bot.parts.size(), 4u);
  EXPECT_EQ(bot.parts[1].name, "lamp0");
  EXPECT_EQ(bot.parts[3].name, "lamp2");
  EXPECT_EQ(bot.parts[1].pose_body_part, (Pose{0.4, 0, 0, 0}));
  EXPECT_NEAR(bot.parts[2].pose_body_part.x, -0.2, 1e-12);
  ASSERT_EQ(bot.devices.size(), 3u);
  EXPECT_EQ(bot.devices[2].name, "eye2");
  EXPECT_EQ(bot.devices[2].part, 3u);
}

TEST(Ring, Errors) {
  const auto error_of = [](const std::string& ring) {
    return LoadedArena(world(R"("types": {"bot": {"size_m": [1, 1, 1], "sensors": [
    {"name": "ir", "kind": "ranger", "transducers": [{"ring": )" +
                             ring + "}]}]}}"))
        .found;
  };
  const std::string at = "maze.json:3: error: /types/bot/sensors/0/transducers/0";
  EXPECT_THAT(error_of(R"({"count": 0})"), ElementsAre(at + "/ring/count: must be from 1 to 10000, found 0"));
  EXPECT_THAT(error_of(R"({"radius_m": 1})"),
              ElementsAre(at + R"(/ring: missing "count": number of copies)"));
  EXPECT_THAT(error_of("3"), ElementsAre(at + "/ring: expected an object, found the number 3"));
  // An error of the entry is reported once, not for each copy.
  EXPECT_THAT(error_of(R"({"count": 8}, "range_max_m": -1)"),
              ElementsAre(at + "/range_max_m: must be above 0 and at most 100 m, found -1"));
  EXPECT_THAT(LoadedArena(world(R"("types": {"bot": {"size_m": [1, 1, 1], "ring": {"count": 2}}})")).found,
              ElementsAre(testing::StartsWith(R"(maze.json:2: error: /types/bot: unknown key "ring")")));
}

constexpr const char* k_base = R"({"types": {
  "base": {
    "size_m": [0.2, 0.2, 0.1], "color": "blue", "name": "Base",
    "drive": {"kind": "diff", "speed_max_mps": 0.5},
    "sensors": [{"name": "ir", "kind": "ranger", "transducers": [{"range_max_m": 2}]},
                {"name": "far", "kind": "ranger", "transducers": []}],
    "controllers": [{"kind": "expand"}, {"kind": "expand"}]}}})";

class IncludeTest : public test::ScratchTest {
 protected:
  LoadedArena load(const std::string& keys, const LoadOptions& options = {}) const {
    return LoadedArena(world(keys), options, folder_ / "maze.json");
  }
};

TEST_F(IncludeTest, TypesOfOtherFilesComeFirst) {
  write("lib/base.json", k_base);
  write("lib/all.json",
        R"({"troupe": 1, "include": ["base.json"], "types": {"box": {"size_m": [1, 1, 1]}}})");
  const LoadedArena loaded =
      load(R"("include": ["lib/all.json", "lib/base.json"], "types": {"own": {"extends": "box"}},
    "models": [{"name": "a", "type": "base"}])");
  ASSERT_THAT(loaded.found, IsEmpty());
  ASSERT_EQ(loaded.spec.types.size(), 4u);
  EXPECT_EQ(loaded.spec.types[1].name, "Base");
  EXPECT_EQ(loaded.spec.types[2].name, "box");
  EXPECT_EQ(loaded.spec.types[3].name, "own");
  EXPECT_EQ(loaded.spec.types[3].parts[0].size, Eigen::Vector3d(1, 1, 1));
  const Where where = loaded.spec.types[1].drive->where;
  EXPECT_EQ(loaded.diagnostics.files()->name(where.file), (folder_ / "lib/base.json").string());
  EXPECT_EQ(where.line, 4u);
}

TEST_F(IncludeTest, PathsOfImagesAreRelativeToTheirFile) {
  write("lib/dot.pgm", std::string("P5\n1 1\n255\n\0", 12));
  write("lib/plan.json", R"({"types": {"plan": {"bitmap": "dot.pgm", "size_m": [1, 1, 1]}}})");
  const LoadedArena loaded = load(R"("include": ["lib/plan.json"])");
  ASSERT_THAT(loaded.found, IsEmpty());
  EXPECT_EQ(loaded.type("plan").parts[0].solids.size(), 1u);
}

TEST_F(IncludeTest, ParentFoldersOfSymbolicLinksAreThoseOfTheirTargets) {
  write("base.json", "another file");
  write("store/base.json", k_base);
  write("store/robots/all.json", R"({"include": ["../base.json"]})");
  std::filesystem::create_directory_symlink("store/robots", folder_ / "lib");
  for (const char* name : {"lib/all.json", "lib/../base.json"}) {
    const LoadedArena loaded = load(fmt::format(R"("include": ["{}"])", name));
    ASSERT_THAT(loaded.found, IsEmpty()) << name;
    EXPECT_EQ(loaded.type("Base").controllers.size(), 2u);
  }
}

TEST_F(IncludeTest, ErrorsNameTheirFileAndLine) {
  write("base.json", k_base);
  write("wrong.json", "{\"types\": {\n\"w\": {\"size_m\": [1, 1, 1], \"colour\": \"red\"}}}");
  write("models.json", R"({"models": []})");
  write("broken.json", "{\n");
  write("a.json", R"({"include": ["sub/b.json"]})");
  write("sub/b.json", "{\n\"include\": [\"../a.json\"]}");
  EXPECT_THAT(
      load(R"("include": ["none.json"])").found,
      ElementsAre("maze.json:2: error: /include/0: \"none.json\" cannot be included: there is no such file"));
  EXPECT_THAT(load(R"("include": ["base.json\u0000.txt"])").found,
              ElementsAre("maze.json:2: error: /include/0: the text contains the character U+0000 (\\u0000): "
                          "remove it"));
  EXPECT_THAT(load(R"("include": [])").found, IsEmpty());
  // The types of a file that cannot be included are not unknown.
  for (const char* file : {"none.json", "broken.json"})
    EXPECT_THAT(load(fmt::format(R"("include": ["{}"], "types": {{"own": {{"extends": "base"}}}},
      "models": [{{"name": "m", "type": "base"}}])",
                                 file))
                    .found,
                testing::SizeIs(1))
        << file;
  EXPECT_THAT(load(R"("include": "base.json")").found,
              ElementsAre("maze.json:2: error: /include: expected a list, found the text \"base.json\""));
  EXPECT_THAT(load(R"("include": ["wrong.json"])").found,
              ElementsAre(testing::StartsWith("wrong.json:2: error: /types/w: unknown key \"colour\"")));
  EXPECT_THAT(
      load(R"("include": ["models.json"])").found,
      ElementsAre("models.json:1: error: unknown key \"models\"; known: $schema, include, troupe, types"));
  EXPECT_THAT(load(R"("include": ["broken.json"])").found,
              ElementsAre(testing::StartsWith("broken.json:2: error: ")));
  EXPECT_THAT(load(R"("include": ["a.json"])").found,
              ElementsAre("sub/b.json:2: error: /include/0: the files include each other in a circle: a.json "
                          "includes sub/b.json includes a.json; remove one \"include\""));
  EXPECT_THAT(
      load("\"include\": [\"base.json\"],\n\"types\": {\"base\": {\"size_m\": [1, 1, 1]}}").found,
      ElementsAre(
          "maze.json:3: error: /types/base: a type of this name is already defined in base.json, line "
          "2: choose another name; to inherit from the other type, name that type in the key "
          "\"extends\""));
}

TEST_F(IncludeTest, AChainOfIncludedFilesHasALimit) {
  for (std::size_t i = 1; i <= k_most_nested_includes; ++i)
    write(fmt::format("c{}.json", i), fmt::format(R"({{"include": ["c{}.json"]}})", i + 1));
  write("c101.json", k_base);
  EXPECT_THAT(load(R"("include": ["c2.json"])").found, IsEmpty());
  EXPECT_THAT(load(R"("include": ["c101.json", "c1.json"])").found, IsEmpty());
  EXPECT_THAT(
      load(R"("include": ["c1.json"])").found,
      ElementsAre(
          "c100.json:1: error: /include/0: \"c101.json\" cannot be included: it would be the last of "
          "101 files, each of which includes the next one, and at most 100 are allowed; include it in "
          "a file nearer to the world"));
}

TEST_F(IncludeTest, ATypeExtendsAnother) {
  write("base.json", k_base);
  const LoadedArena loaded = load(R"("include": ["base.json"], "types": {
    "small": {"extends": "base", "size_cm": [10, 10, 10], "drive": {"speed_max_mps": 0.1},
              "sensors": [{"name": "near", "kind": "ranger", "transducers": []},
                          {"name": "ir", "transducers": [{"range_max_m": 1}]}],
              "controller": {"kind": "expand_swarm"}},
    "car": {"extends": "small", "drive": {"kind": "car", "wheelbase_m": 0.1}, "color": null},
    "still": {"extends": "base", "drive": null, "controllers": null}})");
  ASSERT_THAT(loaded.found, IsEmpty());
  const engine::TypeSpec& small = loaded.type("small");
  EXPECT_EQ(small.parts[0].size, Eigen::Vector3d(10 * 0.01, 10 * 0.01, 10 * 0.01));
  EXPECT_EQ(small.drive->kind, "diff");
  EXPECT_EQ(small.drive->params, engine::Record{0.1});
  ASSERT_EQ(small.devices.size(), 3u);
  EXPECT_EQ(small.devices[0].name, "ir");
  EXPECT_EQ(small.devices[1].name, "far");
  EXPECT_EQ(small.devices[2].name, "near");
  ASSERT_EQ(small.controllers.size(), 1u);
  EXPECT_EQ(loaded.type("Base").controllers.size(), 2u) << "the base is unchanged";
  const engine::TypeSpec& car = loaded.type("car");
  EXPECT_EQ(car.drive->params, (engine::Record{1.0, 0.1})) << "another kind inherits no parameter";
  EXPECT_EQ(car.devices.size(), 3u);
  EXPECT_FALSE(loaded.type("still").drive);
  EXPECT_THAT(loaded.type("still").controllers, IsEmpty());
}

TEST_F(IncludeTest, SetChangesATypeAndThoseThatExtendIt) {
  write("base.json", k_base);
  LoadOptions options;
  options.set = {{"/types/base/drive/speed_max_mps", "0.9"}};
  const LoadedArena loaded =
      load(R"("include": ["base.json"], "types": {"small": {"extends": "base"}})", options);
  ASSERT_THAT(loaded.found, IsEmpty());
  EXPECT_EQ(loaded.type("small").drive->params, engine::Record{0.9});
}

TEST_F(IncludeTest, ErrorsOfExtends) {
  EXPECT_THAT(load(R"("types": {"a": {"extends": "bass"}, "base": {"size_m": [1, 1, 1]}})").found,
              ElementsAre("maze.json:2: error: /types/a/extends: unknown type \"bass\"; known: base "
                          "(did you mean \"base\"?)"));
  EXPECT_THAT(
      load("\"types\": {\"a\": {\"extends\": \"b\"},\n\"b\": {\"extends\": \"c\"}, \"c\": {\"extends\": "
           "\"a\"}}")
          .found,
      ElementsAre("maze.json:2: error: /types/a/extends: the types extend each other in a circle: a extends "
                  "b extends c extends a; remove one \"extends\""));
  EXPECT_THAT(
      load(R"("types": {"a": {"extends": 3, "size_m": [1, 1, 1]}})").found,
      ElementsAre("maze.json:2: error: /types/a/extends: expected the name of a type, found the number 3"));
}

TEST_F(IncludeTest, AnEntryWithAMisspelledInheritedNameIsTold) {
  const auto found = [&](const std::string& entry) {
    return load(R"("types": {"base": {"size_m": [1, 1, 1],
      "sensors": [{"name": "front", "kind": "ranger", "transducers": []}]},
      "a": {"extends": "base", "sensors": [{"name": "front", "period_s": 1},
        )" + entry +
                "]}}")
        .found;
  };
  EXPECT_THAT(
      found(R"({"name": "fornt", "period_s": 1})"),
      ElementsAre("maze.json:5: error: /types/a/sensors: the type inherits no entry \"fornt\" (did you "
                  "mean \"front\"?); an entry with a new name needs a \"kind\""));
  EXPECT_THAT(found(R"({"name": "rear", "period_s": 1})"),
              ElementsAre(testing::StartsWith("maze.json:5: error: /types/a/sensors/1: missing \"kind\"")));
  EXPECT_THAT(found(R"({"name": "frond", "kind": "ranger", "transducers": []})"), IsEmpty());
}

TEST_F(IncludeTest, AWrongBaseHidesNoOtherError) {
  EXPECT_THAT(
      load("\"types\": {\"a\": {\"extends\": \"b\"},\n\"b\": {\"extends\": \"a\", \"fidget\": 3}}").found,
      ElementsAre("maze.json:2: error: /types/a/extends: the types extend each other in a circle: a extends "
                  "b extends a; remove one \"extends\"",
                  testing::StartsWith("maze.json:3: error: /types/b: unknown key \"fidget\"; known: ")));
  EXPECT_THAT(
      load("\"types\": {\"a\": {\"extends\": \"bass\",\n\"fidget\": 3}, \"base\": {\"size_m\": [1, 1, 1]}}")
          .found,
      ElementsAre(testing::HasSubstr("unknown type \"bass\""),
                  testing::StartsWith("maze.json:3: error: /types/a: unknown key \"fidget\"")));
  EXPECT_THAT(
      load("\"types\": {\"a\": {\"extends\": \"bass\", \"bitmap\": \"a.png\", \"margins\": \"cut\"}}").found,
      ElementsAre(testing::HasSubstr("unknown type \"bass\""),
                  testing::StartsWith("maze.json:2: error: /types/a/margins: ")));
}

TEST_F(IncludeTest, AKeyThatATypeDoesNotInheritIsNoErrorIfTheBaseIsWrong) {
  const std::string types =
      R"("types": {"base": {"size_m": [1, 1, 1], "drive": {"kind": "diff"}, "sensors": []},
    "a": {"extends": "bass", "sensors": null, "drive": {"pushes": null, "kind": "diff"}}})";
  EXPECT_THAT(load(types).found, ElementsAre(testing::HasSubstr("unknown type \"bass\"")));
}

TEST_F(IncludeTest, AWrongBaseCausesNoErrorAboutWhatItWouldGive) {
  for (const char* own : {R"("drive": {"speed_max_mps": 0.1})", R"("sensors": [{"name": "ir"}])",
                          R"("disc": {"height_m": 0.1})", R"("controller": {"period_s": 1})",
                          R"("controllers": [{"kind": "expand"}])", R"("bitmap": "a.png")",
                          R"("boundary": true, "margins": "keep", "origin": {"x_m": 1}, "fit": true)",
                          R"("device": {"name": "b"})", R"("device_order": ["ir"])",
                          R"("parts": [{"name": "arm", "device": {"name": "b"}}])"})
    EXPECT_THAT(
        load(R"("types": {"a": {"extends": "bass", )" + std::string(own) +
             R"(}}, "models": [{"name": "m", "type": "a", "fiducial_return": 2, "global_parts": ["arm"]}])")
            .found,
        ElementsAre("maze.json:2: error: /types/a/extends: unknown type \"bass\"; no type exists"))
        << own;
  // A base may itself have a wrong base.
  EXPECT_THAT(load(R"("types": {"a": {"extends": "b", "drive": {"speed_max_mps": 0.1}},
    "b": {"extends": "bass", "drive": {"kind": "diff"}}})")
                  .found,
              ElementsAre(testing::HasSubstr("/types/b/extends: unknown type \"bass\"")));
  EXPECT_THAT(
      load(R"("types": {"base": 3, "a": {"extends": "base", "drive": {"speed_max_mps": 0.1}}})").found,
      ElementsAre("maze.json:2: error: /types/base: expected an object, found the number 3"));
}

TEST_F(IncludeTest, AWrongValueOfABaseCausesNoErrorInAnHeir) {
  const auto found = [&](const std::string& base, const std::string& own) {
    return load("\"types\": {\"base\": {" + base + "},\n\"a\": {\"extends\": \"base\", " + own + "}}").found;
  };
  const auto one = [](const std::string& error) {
    return ElementsAre(testing::StartsWith("maze.json:2: error: /types/base" + error));
  };
  const std::string box = R"("size_m": [1, 1, 1], )";
  const std::string slow = R"("drive": {"speed_max_mps": 0.1})";
  EXPECT_THAT(found(box + R"("drive": 3)", slow), one("/drive: expected an object, found the number 3"));
  EXPECT_THAT(found(box + R"("drive": {})", slow), one("/drive: missing \"kind\""));
  EXPECT_THAT(found(box + R"("controller": "expand_swarm")", R"("controller": {"period_s": 1})"),
              one("/controller: expected an object such as {\"kind\": \"expand_swarm\"}, found the text "
                  "\"expand_swarm\""));
  EXPECT_THAT(found(box + R"("sensors": {"name": "ir"})", R"("sensors": [{"name": "ir"}])"),
              one("/sensors: expected a list, found an object"));
  EXPECT_THAT(found(box + R"("sensors": [{"name": "ir"}])", R"("sensors": [{"name": "ir", "period_s": 1}])"),
              one("/sensors/0: missing \"kind\""));
  EXPECT_THAT(found(R"("disc": 3)", R"("disc": {"height_m": 0.1})"),
              one("/disc: expected an object, found the number 3"));
  EXPECT_THAT(found(R"("color": "red")", R"("color": "blue")"), one(": the type has no shape"));
  // A type that removes the shape of its base has an error of its own.
  EXPECT_THAT(found(R"("size_m": [1, 1, 1])", R"("size_m": null)"),
              ElementsAre(testing::StartsWith("maze.json:3: error: /types/a: the type has no shape")));
}

TEST_F(IncludeTest, AnErrorOfABaseIsReportedOnce) {
  const std::string base = R"("base": {"size_m": [1, 1, 1],
  "mass": 3,
  "sensors": [{"name": "ir", "kind": "ranger",
    "transducers": [{"range_max_m": -1}]}]})";
  const std::string heirs = R"("a": {"extends": "base"}, "b": {"extends": "a", "sensors": [{"name": "ir"}]},
  "c": {"extends": "base", "color": "blue",
    "mass": 4})";
  const auto expected = ElementsAre(
      "maze.json:5: error: /types/base/sensors/0/transducers/0/range_max_m: must be above 0 and at most 100 "
      "m, found -1",
      testing::StartsWith("maze.json:3: error: /types/base: unknown key \"mass\""),
      testing::StartsWith("maze.json:8: error: /types/c: unknown key \"mass\""));
  EXPECT_THAT(load("\"types\": {" + base + ",\n" + heirs + "}").found, expected);
  // A base may come after its heirs.
  EXPECT_THAT(load("\"types\": {" + heirs + ",\n" + base + "}").found,
              ElementsAre(testing::StartsWith("maze.json:8: error: /types/base/sensors/0/transducers/0/"),
                          testing::StartsWith("maze.json:6: error: /types/base: unknown key \"mass\""),
                          testing::StartsWith("maze.json:4: error: /types/c: unknown key \"mass\"")));
  // An error of meaning, which is found after the errors of form.
  write("base.json", R"({"types": {
    "base": {"size_m": [1, 1, 1],
             "sensors": [{"kind": "ranger", "on": "arm", "transducers": []}]}}})");
  EXPECT_THAT(load(R"("include": ["base.json"],
    "types": {"a": {"extends": "base"}, "b": {"extends": "base", "size_m": [2, 2, 2]}})")
                  .found,
              ElementsAre(testing::StartsWith("base.json:3: error: /types/base/sensors/0/on: ")));
}

constexpr const char* k_boxes = R"("types": {"wall": {"size_m": [2, 0.1, 1]},
    "bot": {"size_m": [0.2, 0.2, 0.1], "drive": {"kind": "diff"}}, "puck": {"size_m": [0.2, 0.2, 0.1], "pushable": true}},
    "models": [)";

TEST(StartOverlaps, StaticBodiesMayOverlap) {
  EXPECT_THAT(LoadedArena(world(std::string(k_boxes) + R"({"name": "a", "type": "wall"},
    {"name": "b", "type": "wall", "pose": {"heading_deg": 90}}])"))
                  .found,
              IsEmpty());
  // A population still avoids both.
  EXPECT_THAT(LoadedArena(world(std::string(k_boxes) + R"({"name": "a", "type": "wall"}], "populations": [
    {"name": "r", "type": "bot", "count": 1, "place": {"rule": "grid", "region_m": [[0, 0], [0, 0]], "pitch_m": 1}}])"))
                  .found,
              ElementsAre(testing::HasSubstr("placed 0 of 1 body")));
}

TEST(StartOverlaps, ABodyThatMayMoveIsFoundAmongManyStaticOnesAtOnePlace) {
  std::string models;
  for (int i = 0; i < 300; ++i) models += fmt::format(R"({{"name": "w{}", "type": "wall"}}, )", i);
  const std::vector<std::string> found =
      LoadedArena(
          world(k_boxes + models + R"({"name": "b", "type": "bot"}, {"name": "last", "type": "wall"}])"))
          .found;
  ASSERT_EQ(found.size(), 301u);
  EXPECT_THAT(found.front(), testing::HasSubstr("\"b\" overlaps \"w0\""));
  EXPECT_THAT(found.back(), testing::HasSubstr("\"last\" overlaps \"b\""));
}

TEST(StartOverlaps, OthersAreErrorsThatSayByHowMuch) {
  const auto found = [](const std::string& models) {
    return LoadedArena(world(k_boxes + models + "]")).found;
  };
  for (const char* type : {"bot", "puck"})
    EXPECT_THAT(
        found(fmt::format(
            R"({{"name": "a", "type": "wall"}}, {{"name": "b", "type": "{}", "pose": {{"y_m": 0.12}}}})",
            type)),
        ElementsAre(
            "maze.json:4: error: /models/1: \"b\" overlaps \"a\" by 0.03 m at the start; \"overlaps\": "
            "\"warn\" in the world allows this"));
  // In either order.
  EXPECT_THAT(found(R"({"name": "b", "type": "bot", "pose": {"y_m": 0.12}}, {"name": "a", "type": "wall"})"),
              ElementsAre("maze.json:4: error: /models/1: \"a\" overlaps \"b\" by 0.03 m at the start; "
                          "\"overlaps\": \"warn\" in the world allows this"));
}

// Measuring a depth takes much longer than finding an overlap.
TEST(StartOverlaps, OnlyTheFirstOverlapsOfABodyAreMeasured) {
  constexpr int k_small = 4000;
  std::string models;
  for (int i = 0; i < k_small; ++i)
    models += fmt::format(R"({{"name": "s{}", "type": "small", "pose": {{"x_m": {}, "y_m": {}}}}}, )", i,
                          0.5 * (i % 50), 0.5 * (i / 50));
  const std::string text = world(R"("types": {"small": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}},
    "big": {"size_m": [100, 100, 0.2], "drive": {"kind": "diff"}}},
    "models": [)" + models + R"({"name": "big", "type": "big"}])");
  Diagnostics diagnostics;
  EXPECT_THROW(load_json_world("maze.json", text, json_test_registry(), {}, diagnostics), InputError);
  ASSERT_EQ(diagnostics.findings().size(), Diagnostics::k_most_errors);
  EXPECT_THAT(diagnostics.findings()[49].message,
              testing::HasSubstr("overlaps \"s49\" by 25.6 m at the start"));
  EXPECT_THAT(diagnostics.findings()[50].message, testing::HasSubstr("overlaps \"s50\" at the start"));
}

TEST(StartOverlaps, RoundingIsTolerated) {
  const auto found = [](double overlap) {
    return LoadedArena(world(fmt::format(R"({}{{"name": "a", "type": "wall"}},
      {{"name": "b", "type": "bot", "pose": {{"y_m": {:.17g}}}}}])",
                                         k_boxes, 0.15 - overlap)))
        .found;
  };
  EXPECT_THAT(found(0.9e-9), IsEmpty());
  EXPECT_EQ(found(1.5e-9).size(), 1u);
}

}  // namespace
}  // namespace troupe::worldio::arena_test
