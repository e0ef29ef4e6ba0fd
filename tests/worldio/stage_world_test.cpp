#include "tests/support/paths.hpp"
#include "tests/worldio/stage_fixture.hpp"
#include "troupe/registry.hpp"
#include "worldio/images/png.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iterator>

namespace troupe::worldio::stage_world_test {
namespace {

using engine::get;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::SizeIs;

constexpr double k_degree = k_pi / 180;

class StageWorld : public StageTest {};
class Conformance07 : public StageTest {};

const engine::FieldTable& ranger_table() { return test_registry().device("ranger")->params; }

/// One field of one transducer of a ranger.
const engine::Value& transducer(const engine::DeviceSpec& sensor, std::size_t number,
                                std::string_view field) {
  const engine::FieldTable& table = *ranger_table().fields[ranger_table().find("transducers")].record;
  return get(table, get(ranger_table(), sensor.params, "transducers").records()[number], field);
}

double transducer_pose(const engine::DeviceSpec& sensor, std::size_t number, std::string_view field) {
  return get(engine::pose_fields(), transducer(sensor, number, "pose").records()[0], field).number();
}

Box bounds_of(const std::vector<Solid>& solids) {
  Box box;
  for (const Solid& solid : solids)
    for (const Ring& ring : solid.contours) box.extend(bounds(ring));
  return box;
}

void expect_box(const Box& box, double x_min, double x_max, double y_min, double y_max) {
  EXPECT_NEAR(box.min.x(), x_min, 1e-12);
  EXPECT_NEAR(box.max.x(), x_max, 1e-12);
  EXPECT_NEAR(box.min.y(), y_min, 1e-12);
  EXPECT_NEAR(box.max.y(), y_max, 1e-12);
}

// The world.

TEST_F(StageWorld, AnEmptyFileIsTheGroundAlone) {
  const auto spec = load("");
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model"));
  EXPECT_EQ(spec.tick_s, 0.1);
  EXPECT_FALSE(spec.quit_time_s);
  EXPECT_FALSE(spec.bounds);
  EXPECT_EQ(spec.seed, 1u);
  EXPECT_EQ(spec.title, (folder() / "w.world").string());
}

TEST_F(StageWorld, TakesItsPropertiesFromTheTopLevel) {
  const auto spec = load("name \"arena\" interval_sim 20.0005 quit_time 60 seed 7\n");
  EXPECT_EQ(spec.title, "arena");
  EXPECT_EQ(spec.tick_s, 0.02);  // whole microseconds
  EXPECT_EQ(spec.quit_time_s, 60);
  EXPECT_EQ(spec.seed, 7u);
  LoadOptions options;
  options.seed = 9;
  EXPECT_EQ(load("seed 7", options).seed, 9u);
  EXPECT_FALSE(load("quit_time 0").quit_time_s);
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: warning: \"quit_time 0\" has no effect: the run does not end by "
                          "itself; write quit_time 60, or give --for 60"));
}

TEST_F(StageWorld, RefusesWrongWorldProperties) {
  load("interval_sim 0\nquit_time -1\nseed -1\nunit_length \"km\"\nunit_angle \"grad\"\nseed 1.5\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:4: error: unknown unit_length \"km\"; known: m, cm, mm",
                          "w.world:5: error: unknown unit_angle \"grad\"; known: degrees, radians",
                          "w.world:1: error: \"interval_sim\" must be at least 0.001 ms, found 0",
                          "w.world:2: error: \"quit_time\" must be 0 (never) or above, in s, found -1",
                          "w.world:6: error: \"seed\" needs a whole number, found 1.5"));
  load("seed -1");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: \"seed\" must be 0 or above, found -1"));
}

TEST_F(StageWorld, TheResolutionIsOfTheGridEngine) {
  EXPECT_EQ(load("").resolution_m, 0.02);
  const engine::WorldSpec spec = load("unit_length \"cm\"\nresolution 0.1\n");
  EXPECT_EQ(spec.resolution_m, 0.1);  // metres, as in Stage
  EXPECT_EQ(spec.resolution_where.line, 2u);
  EXPECT_EQ(spec.ranging, engine::RangingEngine::exact);
  EXPECT_THAT(messages(), IsEmpty());
  load("resolution 0");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: warning: \"resolution\" must be from 0.0001 to 100 m, found 0; it "
                          "has no effect, because only the grid ray engine (--raytracer grid) uses it"));
}

TEST_F(StageWorld, SaysHowItIsToBeWatched) {
  EXPECT_EQ(load("").watch, engine::WatchSpec{});
  EXPECT_FALSE(load("").window);
  EXPECT_EQ(load("show_clock 1 show_clock_interval 7 speedup 2.5").watch,
            (engine::WatchSpec{true, 7, 2.5, false}));
  EXPECT_EQ(load("speedup -1").watch.rate, 0);  // as fast as possible
  EXPECT_TRUE(load("paused 1").watch.paused);
  EXPECT_THAT(messages(), SizeIs(1));
  load("show_clock_interval 0 show_clock 1");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: \"show_clock_interval\" must be from 1 to 1000000000 ticks, "
                          "found 0"));
  load("show_clock_interval 0 speedup \"fast\"\nshow_clock 0.5");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: warning: \"show_clock_interval\" must be from 1 to 1000000000 ticks, found 0; "
                  "it has no "
                  "effect, because \"show_clock\" is 0",
                  "w.world:2: error: \"show_clock\" needs a whole number, found 0.5",
                  "w.world:1: error: \"speedup\" needs a number such as 2, -0.5 or .25, found \"fast\""));
}

TEST_F(StageWorld, TheFirstWindowIsKept) {
  const auto spec = load(
      "unit_length \"cm\" unit_angle \"radians\"\n"
      "model( window( size [700.5 300] center [1 -2] rotate [30 -90] scale 37.5 pcam_loc [100 200 300]\n"
      "  pcam_angle [70 10] pcam_on 1 interval 50 screenshot_skip 3 follow_model \"r0\" show_grid 0 ) )\n"
      "window( scale 1 )\n");
  EXPECT_THAT(messages(), SizeIs(1));
  ASSERT_TRUE(spec.window);
  const auto field = [&](std::string_view name) { return get(window_fields(), *spec.window, name); };
  EXPECT_THAT(field("size_px").numbers(), ElementsAre(700.5, 300));
  EXPECT_THAT(field("center").numbers(), ElementsAre(1, -2));  // metres, whatever the units
  EXPECT_NEAR(field("rotate").numbers()[1], -k_pi / 2, 1e-15);
  EXPECT_EQ(field("scale_px_per_m").number(), 37.5);
  EXPECT_THAT(field("camera").numbers(), ElementsAre(1, 2, 3));
  EXPECT_NEAR(field("camera_angle").numbers()[0], 70 * k_degree, 1e-15);  // degrees, whatever the units
  EXPECT_TRUE(field("perspective").boolean());
  EXPECT_EQ(field("interval").number(), 0.05);
  EXPECT_EQ(field("screenshot_skip").integer(), 3);
  EXPECT_EQ(field("follow").text(), "r0");
  EXPECT_FALSE(field("show_grid").boolean());
  EXPECT_TRUE(field("show_blocks").boolean());
}

TEST_F(StageWorld, RefusesWrongWindows) {
  load(
      "window( size [1]\n scale 0\n interval -3\n rotate [1 \"two\"]\n show_grid 0.5\n screenshot_skip 0\n"
      " follow_model [\"a\"] )");
  std::vector<std::string> found = messages();
  std::erase_if(found, [](const std::string& line) { return line.find("error") == line.npos; });
  EXPECT_THAT(found, testing::UnorderedElementsAre(
                         "w.world:1: error: \"size\" needs 2 values [a b], found 1",
                         "w.world:2: error: \"scale\" must be above 0, found 0",
                         "w.world:3: error: \"interval\" must be above 0, found -3",
                         "w.world:4: error: \"rotate\" needs a number such as 2, -0.5 or .25, found \"two\"",
                         "w.world:5: error: \"show_grid\" needs a whole number, found 0.5",
                         "w.world:6: error: \"screenshot_skip\" must be at least 1, found 0",
                         "w.world:7: error: \"follow_model\" needs one value, not a tuple"));
}

TEST_F(StageWorld, SumsUpWhatHasNoEffect) {
  load(
      "resolution 0.02\nthreads 7\npaused 1\nspeedup 4\ninterval_real 100\nwindow( size [1 2] wibble 3 "
      "show_status 1 )\n"
      "model( gui_nose 1 friction 1 polygons 1\n polygon[0].points 4 gui_nose 0 fill_polygons 1 )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:5: warning: old syntax: \"interval_real\" is ignored, as in Stage: write speedup 1, with "
          "troupe run "
          "--rate world",
          "w.world:6: warning: a window has no property \"wibble\"; the property is ignored",
          "w.world:7: warning: old syntax: \"polygons\" and \"polygon[k].points\" are ignored, as in Stage: "
          "write a "
          "block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0 1] ) for each polygon",
          "w.world:2: warning: properties without effect (docs/stage-worlds.md says why): "
          "threads, friction",
          "w.world:3: warning: properties without effect on the run, because only Stage's window uses them: "
          "paused, show_status of a window, gui_nose",
          "w.world:8: warning: obsolete properties, ignored as in Stage: remove them: fill_polygons"));
}

TEST_F(StageWorld, AModelWhoseDeviceTheRegistryLacksIsOnlyABody) {
  ASSERT_EQ(test_registry().device("actuator"), nullptr);
  load("\n\n\n\nactuator( max_speed 2 )\nactuator()\n");
  EXPECT_THAT(messages(), ElementsAre("w.world:5: warning: Troupe does not implement an actuator: this model "
                                      "is a body that neither senses nor acts (and 1 more such warning)"));
}

TEST_F(StageWorld, MacrosThatNoModelUsesAreNotChecked) {
  load("define a laser( wibble 3 pose [1] )\nmodel()");
  EXPECT_THAT(messages(), IsEmpty());
}

TEST_F(StageWorld, PopulationsAreForJson) {
  LoadOptions options;
  options.robots = {{"", 3}};
  load("", options);
  EXPECT_THAT(messages(),
              ElementsAre("w.world: error: the number of robots can be set only in a .json world with "
                          "populations; a .world file lists its robots one by one"));
}

TEST_F(StageWorld, PointersReachIntoWhatItBecomesInJson) {
  LoadOptions options;
  options.set = {{"/seed", "3"}, {"/models/1/pose/x_m", "4.5"}, {"/types/box/size_m/2", "0.25"}};
  const engine::WorldSpec spec =
      load("define box model( size [1 1 1] )\nbox( pose [1 0 0 0] )\nbox( pose [2 0 0 90] )\n", options);
  EXPECT_EQ(spec.seed, 3u);
  ASSERT_EQ(spec.bodies.size(), 3u);
  EXPECT_EQ(spec.bodies[1].pose_world_body, (Pose{1, 0, 0, 0}));
  EXPECT_EQ(spec.bodies[2].pose_world_body, (Pose{4.5, 0, 0, radians(90)}));
  EXPECT_EQ(type_of(spec, 1).parts[0].solids[0].z, (ZInterval{0, 0.25}));

  options.set = {{"/models/1/pose/x", "4.5"}};
  load("model( )\nmodel( )\n", options);
  EXPECT_THAT(messages(), testing::ElementsAre(testing::HasSubstr("/models/1/pose: \"x\" needs its unit")));
  options.set = {{"/types/model/size_m", "[1, 0, 1]"}};
  load("\nmodel( )\n", options);
  EXPECT_THAT(messages(), testing::ElementsAre(testing::HasSubstr(
                              "--set /types/model/size_m: error: /types/model/size_m/1: must be above 0")));
}

// Names.

TEST_F(Conformance07, Names) {
  const auto spec = load(
      "model()\nposition()\nmodel( name \"box\" )\nmodel( name \"/g\" )\n"
      "position( name \"r0\" ranger() ranger( name \"eye\" model() ) ranger() model( name \"/gkid\" model() "
      ") )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:5: warning: a ranger without a sensor( ... ) measures nothing: add a sensor( ... )"));
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "model:1", "position:0", "box", "g", "r0"));
  EXPECT_EQ(alias(spec, "model:0"), BodyId(0));
  EXPECT_EQ(alias(spec, "model:2"), BodyId(3));
  EXPECT_EQ(alias(spec, "position:1"), BodyId(5));
  EXPECT_FALSE(alias(spec, "model:1").valid());  // it is the body's name
  const engine::TypeSpec& r0 = type_of(spec, 5);
  EXPECT_THAT(part_names(r0),
              ElementsAre("", "ranger:0", "eye", "eye.model:0", "ranger:2", "gkid", "gkid.model:0"));
  EXPECT_EQ(r0.parts[2].alias, "ranger:1");
  EXPECT_EQ(r0.parts[5].alias, "model:0");
  EXPECT_EQ(spec.part_aliases.at("gkid").body, BodyId(5));
  EXPECT_EQ(spec.part_aliases.at("gkid").part, "gkid");
  EXPECT_EQ(spec.part_aliases.at("gkid.model:0").part, "gkid.model:0");
  EXPECT_THAT(spec.part_aliases, SizeIs(2));
}

TEST_F(Conformance07, Sizes) {
  const auto spec = load("model()\nranger( sensor() )\nfiducial()\nposition()\n");
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_EQ(type_of(spec, 1).parts[0].size, Eigen::Vector3d(0.4, 0.4, 1.0));
  EXPECT_EQ(type_of(spec, 2).parts[0].size, Eigen::Vector3d(0.15, 0.15, 0.2));
  EXPECT_EQ(type_of(spec, 3).parts[0].size, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(type_of(spec, 4).parts[0].size, Eigen::Vector3d(0.4, 0.4, 1.0));
  EXPECT_EQ(spec.bodies[2].color, (Color{0, 0, 0.5f, 1}));
}

TEST_F(StageWorld, DuplicateAndEmptyNamesAreReported) {
  const auto spec = load(
      "model( name \"x\" )\nmodel( name \"x\" )\nmodel( name \"\" )\nmodel( name \"/\" )\n"
      "model( name [\"a\"] )");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:2: warning: the name \"x\" is already used by the model at line 1: a search for this name "
          "finds only the "
          "last model that has it",
          "w.world:3: warning: \"name\" is empty or only a /; a generated name is used instead (and 1 more "
          "such warning)",
          "w.world:5: error: \"name\" needs one value, not a tuple"));
  EXPECT_EQ(name_of(spec, 3), "model:3");
}

// Bodies.

TEST_F(StageWorld, DefaultBodiesAreBoxesOfTheirSize) {
  const auto spec = load("model( size [2 4 3] )\nranger( sensor() )\nbumper()\nmodel( noblocks 1 )");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:3: warning: as in Stage, a bumper without \"size\" has a body of 0.4 m x 0.4 m x "
                  "1 m; give it a \"size\" (or \"noblocks 1\", if it should have no body)",
                  "w.world:3: warning: a bumper without \"bcount\", the number of bumpers, senses nothing: "
                  "give \"bcount\""));
  const engine::PartSpec& box = type_of(spec, 1).parts[0];
  ASSERT_THAT(box.solids, SizeIs(1));
  expect_box(bounds_of(box.solids), -1, 1, -2, 2);
  EXPECT_EQ(box.solids[0].z, (ZInterval{0, 3}));
  EXPECT_GT(signed_area(box.solids[0].contours[0]), 0);
  EXPECT_THAT(type_of(spec, 2).parts[0].solids, IsEmpty());
  EXPECT_THAT(type_of(spec, 3).parts[0].solids, SizeIs(1));
  EXPECT_THAT(type_of(spec, 4).parts[0].solids, IsEmpty());
}

TEST_F(StageWorld, BlocksAreStretchedTogetherAndTurnLeft) {
  const auto spec = load(
      "model( size [2 2 1]\n"
      " block( points 3 point[0] [0 0] point[1] [0 10] point[2] [10 0] z [0.5 1] )\n"
      " block( points 3 point[0] [10 10] point[1] [20 10] point[2] [20 20] z [0.75 1] ) )\n");
  const engine::PartSpec& part = type_of(spec, 1).parts[0];
  ASSERT_THAT(part.solids, SizeIs(2));
  EXPECT_THAT(part.solids[0].contours[0], ElementsAre(Vec2(0, -1), Vec2(-1, 0), Vec2(-1, -1)));  // reversed
  EXPECT_THAT(part.solids[1].contours[0], ElementsAre(Vec2(0, 0), Vec2(1, 0), Vec2(1, 1)));
  EXPECT_EQ(part.solids[0].z, (ZInterval{1, 2}));  // z keeps its ratio and is not shifted
  EXPECT_EQ(part.solids[1].z, (ZInterval{1.5, 2}));
}

TEST_F(StageWorld, RefusesBrokenBlocks) {
  load(
      "model( block() )\nmodel( block( points 2 ) )\nmodel( block( points 3.5 ) )\n"
      "model( block( points 3 point[0] [0 0] point[1] [1] point[2] [1 1] z [0 1] ) )\n"
      "model( block( points 3 point[0] [0 0] point[1] [1 0] point[2] [1 1] z [1 0] ) )\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: a block needs \"points\", the number of its corners",
                          "w.world:2: error: \"points\" must be from 3 to 100000, found 2",
                          "w.world:3: error: \"points\" needs a whole number, found 3.5",
                          "w.world:4: error: \"point[1]\" needs 2 values [x y], found 1",
                          "w.world:5: error: \"z\" needs [min max] with min at most max, found [1 0]"));
}

TEST_F(StageWorld, WarnsOfDoubtfulBlocks) {
  load(
      "model( block( points 4 point[1] [1 0] point[2] [1 1]\n point[7] [3 3] ) )\n"
      "model( block( points 3 point[0] [0 0] point[1] [1 1] point[2] [2 2] z [0 1] ) )\n"
      "model( block( points 4 point[0] [0 0] point[1] [1 1] point[2] [1 0] point[3] [0 1] z [0 1] ) )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:2: warning: \"point[7]\" is ignored: the block has 4 corners, numbered from 0",
                  "w.world:1: warning: \"point[k]\" is missing for 2 of the 4 corners; as in Stage, a corner "
                  "without this property is at [0 0]: give all properties from \"point[0]\" to \"point[3]\"",
                  "w.world:1: warning: this block has no height: give the block a \"z\" [min max], with min "
                  "below max",
                  "w.world:3: warning: this block has no area: check its corners, \"point[k]\"",
                  "w.world:4: warning: the outline of this block crosses or touches itself: check the order "
                  "of its corners, \"point[k]\""));
}

TEST_F(StageWorld, IgnoresPointsBelowTheFirst) {
  load("model( block( points 3 point[0] [0 0] point[1] [1 0] point[2] [1 1] z [0 1]\n point[-3] [3 3] ) )\n");
  EXPECT_THAT(messages(), ::testing::Contains("w.world:2: warning: \"point[-3]\" is ignored: the block has 3 "
                                              "corners, numbered from 0"));
}

TEST_F(StageWorld, BoundaryIsFourWallsWithin) {
  const auto spec = load("model( size [4 2 1] boundary 1 noblocks 1 )\nmodel( size [4 2 1] boundary 1 )\n");
  const engine::PartSpec& walls = type_of(spec, 1).parts[0];
  ASSERT_THAT(walls.solids, SizeIs(4));
  expect_box(bounds(walls.solids[0].contours[0]), -2, -1.99, -1, 1);
  expect_box(bounds(walls.solids[1].contours[0]), 1.99, 2, -1, 1);
  expect_box(bounds(walls.solids[2].contours[0]), -2, 2, -1, -0.99);
  expect_box(bounds(walls.solids[3].contours[0]), -2, 2, 0.99, 1);
  EXPECT_EQ(walls.solids[3].z, (ZInterval{0, 1}));
  EXPECT_THAT(type_of(spec, 2).parts[0].solids, SizeIs(5));
}

TEST_F(StageWorld, BlocksDiscardWhatCameBeforeUnlessABitmapDid) {
  write_png(folder() / "dot.png", Image{.width = 1, .height = 1, .rgba = {0, 0, 0, 255}});
  const std::string block = " block( points 3 point[0] [0 0] point[1] [1 0] point[2] [1 1] z [0 1] ) )\n";
  const auto spec = load("model( size [4 2 1]\n boundary 1" + block + "model( boundary 1 bitmap \"dot.png\"" +
                         block + "ranger( boundary 1 sensor()" + block);
  EXPECT_THAT(messages(),
              ElementsAre("w.world:2: warning: \"boundary\" has no effect: as in Stage, a model that has "
                          "blocks and no \"bitmap\" gets no walls: remove this property"));
  EXPECT_THAT(type_of(spec, 1).parts[0].solids, SizeIs(1));
  EXPECT_THAT(type_of(spec, 2).parts[0].solids, SizeIs(6));
  EXPECT_THAT(type_of(spec, 3).parts[0].solids, SizeIs(5));
}

TEST_F(StageWorld, ABitmapIsOneSolidStretchedToItsSize) {
  // A ring of solid pixels with a white margin, which is trimmed; its file lies beside the world's.
  Image image{.width = 6, .height = 5, .rgba = std::vector<std::uint8_t>(6 * 5 * 4, 255)};
  for (const int x : {1, 2, 3})
    for (const int y : {1, 2, 3})
      if (x != 2 || y != 2) image.rgba[static_cast<std::size_t>((y * 6 + x) * 4)] = 0;
  write("maps/map.inc", "define plan model( bitmap \"maps/ring.png\" size [3 6 0.5] )\n");
  write_png(folder() / "maps/ring.png", image);
  const auto spec = load("include \"maps/map.inc\"\nplan()");
  const engine::PartSpec& part = type_of(spec, 1).parts[0];
  ASSERT_THAT(part.solids, SizeIs(1));
  ASSERT_THAT(part.solids[0].contours, SizeIs(2));
  expect_box(bounds_of(part.solids), -1.5, 1.5, -3, 3);
  EXPECT_EQ(part.solids[0].z, (ZInterval{0, 0.5}));
  EXPECT_FALSE(contains(part.solids[0], Vec2(0, 0)));
  EXPECT_TRUE(contains(part.solids[0], Vec2(1.2, 0)));
}

TEST_F(StageWorld, BitmapMarginsAreKeptForWhoAsks) {
  // Of 4 x 2 pixels the second of the lower row is solid.
  Image image{.width = 4, .height = 2, .rgba = std::vector<std::uint8_t>(4 * 2 * 4, 255)};
  image.rgba[(4 + 1) * 4] = 0;
  write_png(folder() / "dot.png", image);
  const auto spec = load(
      "define plan model( size [8 4 0.5] bitmap \"dot.png\" )\n"
      "plan( bitmap_margins 1 )\nplan( bitmap_margins 0 )\nplan( bitmap_margins 1 boundary 1 )\n"
      "plan( bitmap_margins 1 block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z "
      "[0 "
      "0.5] ) )\n");
  const auto solids = [&](std::size_t body) { return type_of(spec, body).parts[0].solids; };
  expect_box(bounds_of(solids(1)), -2, 0, -2, 0);
  EXPECT_EQ(solids(1)[0].z, (ZInterval{0, 0.5}));
  expect_box(bounds_of(solids(2)), -4, 4, -2, 2);
  ASSERT_THAT(solids(3), SizeIs(5));
  EXPECT_EQ(solids(3)[0], solids(1)[0]);
  expect_box(bounds_of(solids(3)), -4, 4, -2, 2);
  ASSERT_THAT(solids(4), SizeIs(2));  // blocks join the whole image, not only its solid pixels
  EXPECT_EQ(solids(4)[0].contours, solids(1)[0].contours);
  expect_box(bounds(solids(4)[1].contours[0]), 0, 1, 0, 1);
}

TEST_F(StageWorld, AMapOfRosLiesWhereItSays) {
  write("maps/lab.pgm", "P5 4 2 255\n" + std::string("\xfe\xfe\xcd\xfe\xfe\x00\xfe\xfe", 8));
  write("maps/lab.yaml", "image: lab.pgm\nresolution: 0.5\norigin: [10, 20, 0]\n");
  const auto spec = load(
      "unit_length \"cm\"\ndefine plan model( bitmap \"maps/lab.yaml\" )\n"
      "plan()\nplan( size [1 1 30] pose [0 0 0 90] )\nplan( bitmap_unknown 1 )\n"
      "plan( block( points 3 point[1] [1 0] point[2] [1 1] z [0 1] ) )\n");
  EXPECT_THAT(messages(),  // one cell is unknown
              ElementsAre("w.world:4: warning: only the height (third value) of \"size\" is used: the ROS "
                          "map is 2 m x 1 m, not 0.01 m x 0.01 m",
                          "w.world:6: error: a model whose \"bitmap\" is a ROS map cannot have blocks: "
                          "remove the blocks, or put them into another model"));
  const engine::PartSpec& plan = type_of(spec, 1).parts[0];
  EXPECT_EQ(plan.size, Eigen::Vector3d(2, 1, 1));
  expect_box(bounds_of(plan.solids), 10.5, 11, 20, 20.5);
  EXPECT_EQ(plan.solids[0].z, (ZInterval{0, 1}));
  EXPECT_TRUE(plan.floor_plan);
  EXPECT_EQ(type_of(spec, 2).parts[0].solids[0].z, (ZInterval{0, 0.3}));
  EXPECT_EQ(spec.bodies[2].pose_world_body.heading, k_pi / 2);                  // of the map's frame
  expect_box(bounds_of(type_of(spec, 3).parts[0].solids), 10.5, 11.5, 20, 21);  // the unknown cell too
}

TEST_F(StageWorld, SolidUnknownCellsOfAMapWithoutSuchCellsAreAWarning) {
  write("lab.pgm", "P5 2 1 255\n" + std::string("\xfe\x00", 2));
  write("lab.yaml", "image: lab.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n");
  load("model( bitmap \"lab.yaml\" )\nmodel( bitmap \"lab.yaml\" bitmap_unknown 1 )\n");
  EXPECT_THAT(messages(), ElementsAre("w.world:2: warning: \"bitmap_unknown\" has no effect: the ROS map "
                                      "lab.yaml has no unknown cell: remove this property"));
}

TEST_F(StageWorld, WhatIsWrongWithAMapOfRosIsToldInItsFile) {
  write("a.yaml", "image: no.pgm\nresolution: 0\norigin: [0, 0, 0]\n");
  write("b.yaml", "# where\nimage: no.pgm\nresolution: 1\norigin: [0, 0, 0]\n");
  write("c.yml", "image: free.pgm\nresolution: 1\norigin: [0, 0, 0]\n");
  write("free.pgm", "P5 1 1 255\n\xff");
  load(
      "model( bitmap \"a.yaml\" )\nmodel( bitmap \"b.yaml\" )\nmodel( bitmap \"c.yml\" )\nmodel( bitmap "
      "\"d.yml\" )");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:3: warning: the ROS map c.yml has no occupied cell, so it has no walls; if it "
                  "should have, "
                  "check its image, \"negate\" and \"occupied_thresh\"",
                  "a.yaml:2: error: \"resolution\" needs a length from 0.000001 to 200000 m, found \"0\"",
                  "b.yaml:2: error: cannot read the image no.pgm: there is no such file",
                  "w.world:4: error: cannot read the map d.yml: there is no such file"));
}

TEST_F(StageWorld, AMapOfRosLargerThanTheWorldIsAnError) {
  write("row.pgm", "P5 4 1 255\n" + std::string(4, '\0'));
  write("wide.yaml", "image: row.pgm\nresolution: 50001\norigin: [0, 0, 0]\n");
  write("column.pgm", "P5 1 4 255\n" + std::string(4, '\0'));
  write("high.yaml", "resolution: 200000\nimage: column.pgm\norigin: [0, 0, 0]\n");
  write("most.yaml", "image: row.pgm\nresolution: 50000\norigin: [0, 0, 0]\n");
  load("model( bitmap \"wide.yaml\" )\nmodel( bitmap \"high.yaml\" )\nmodel( bitmap \"most.yaml\" )\n");
  EXPECT_THAT(messages(),
              ElementsAre("wide.yaml:2: error: the map is larger than the world, which is 200 km wide and "
                          "high: 4 pixels of 50001 m make the map 200.004 km wide",
                          "high.yaml:1: error: the map is larger than the world, which is 200 km wide and "
                          "high: 4 pixels of 200000 m make the map 800 km high"));
}

TEST_F(StageWorld, ABitmapWithoutASolidPixelHasOnlyItsBoundary) {
  write_png(folder() / "white.png", Image{.width = 1, .height = 1, .rgba = {255, 255, 255, 255}});
  const auto spec =
      load("model( bitmap \"white.png\" )\nmodel( bitmap \"white.png\" boundary 1 size [8 6 1] )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: warning: the image white.png has no solid pixel, so it has no walls; pixels "
                  "whose first channel is at most 127 are solid",
                  "w.world:2: warning: the image white.png has no solid pixel, so only its \"boundary\" has "
                  "walls; pixels whose first channel is at most 127 are solid"));
  EXPECT_THAT(type_of(spec, 1).parts[0].solids, IsEmpty());
  const std::vector<Solid>& walls = type_of(spec, 2).parts[0].solids;
  EXPECT_THAT(walls, SizeIs(4));
  expect_box(bounds_of(walls), -4, 4, -3, 3);
  for (const Solid& wall : walls) EXPECT_EQ(wall.z, (ZInterval{0, 1}));
  // With blocks, or with its margins kept, it also only adds the boundary.
  const auto others = load(
      "model( bitmap \"white.png\" bitmap_margins 1 boundary 1 )\n"
      "model( bitmap \"white.png\" block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0 1] ) "
      ")\n");
  EXPECT_THAT(messages(), SizeIs(2));
  EXPECT_THAT(type_of(others, 1).parts[0].solids, SizeIs(4));
  EXPECT_THAT(type_of(others, 2).parts[0].solids, SizeIs(1));
}

TEST_F(StageWorld, ABlankMapOfRosHasOnlyItsBoundary) {
  write("blank.yaml", "image: blank.pgm\nresolution: 0.5\norigin: [1, 2, 0]\n");
  write("blank.pgm", "P2\n# no obstacle\n4 2\n255\n255 255 255 255\n205 255 255 255\n");
  const auto spec = load("model( bitmap \"blank.yaml\" boundary 1 )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: warning: the ROS map blank.yaml has no occupied cell, so only its "
                          "\"boundary\" has walls; if it should have, check its image, \"negate\" and "
                          "\"occupied_thresh\""));
  EXPECT_THAT(type_of(spec, 1).parts[0].solids, SizeIs(4));
  expect_box(bounds_of(type_of(spec, 1).parts[0].solids), 1, 3, 2, 3);
}

TEST_F(StageWorld, ZeroAndNegativeSizesOfBodiesAreErrors) {
  load(
      "model( size [1 0 1] )\nmodel( size [1 1 -1] )\nranger( sensor( size [-1 1 1] ) )\nmodel( size "
      "[1000000 "
      "1 1] )\nfiducial( block( points 3 point[0] [0 0] point[1] [1 0] point[2] "
      "[1 1] z [0 1] ) )\nposition( gripper( size [0.2 0.3 0] ) )");
  EXPECT_THAT(messages(),
              IsSupersetOf<std::string>(
                  {"w.world:1: error: \"size\" must be above 0 in x and y, found 0",
                   "w.world:2: error: \"size\" must be at least 0 in every direction, found -1",
                   "w.world:3: error: \"size\" must be at least 0 in every direction, found -1",
                   "w.world:4: error: \"size\" must be at most 100000 m, found 1000000",
                   "w.world:5: error: \"size\" must be above 0 in x and y, found 0",
                   "w.world:6: error: \"size\" of a gripper must be above 0 in every direction, found 0"}));
}

TEST_F(StageWorld, WhatHasNoBodyNeedsNoSize) {
  const auto spec = load(
      "position( size [0.4 0.4 0.2]\n"
      "  ranger( size [0 0 0] pose [0 0 0.1 0] sensor( size [0 0 0] ) model( size [0.1 0.1 0.1] ) )\n"
      "  fiducial( size [0 0 0] ) )\n"
      "model( noblocks 1 size [0 0 0] )\nmodel( size [4 4 0] obstacle_return 0 )\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:5: warning: \"size\" gives this model a height (third value) of 0, so "
                          "only bodies and beams exactly at the z of the model meet the model: give a height "
                          "above 0"));
  const engine::TypeSpec& robot = type_of(spec, 1);
  EXPECT_EQ(robot.parts[1].size, Eigen::Vector3d(0, 0, 0));
  EXPECT_NEAR(robot.devices[0].pose_body_device.z + transducer_pose(robot.devices[0], 0, "z"), 0.3, 1e-15);
  EXPECT_NEAR(robot.parts[2].pose_body_part.z, 0.3, 1e-15);  // it stands on nothing high
  EXPECT_EQ(type_of(spec, 3).parts[0].solids[0].z, (ZInterval{0, 0}));
}

// Frames.

TEST_F(StageWorld, PosesTakeTheFilesUnits) {
  const auto spec =
      load("unit_length \"cm\"\nmodel( pose [100 -50 10 0.5] size [200 100 50] )\nunit_angle \"radians\"\n");
  EXPECT_EQ(spec.bodies[1].pose_world_body, (Pose{1, -0.5, 0.1, 0.5}));
  EXPECT_EQ(type_of(spec, 1).parts[0].size, Eigen::Vector3d(2, 1, 0.5));
  EXPECT_NEAR(load("model( pose [0 0 0 270] )").bodies[1].pose_world_body.heading, -k_pi / 2, 1e-15);
}

TEST_F(StageWorld, HeadingsInDevicesAreWrappedUnlessTheWorldSaysNo) {
  const std::string robot = "unit_angle \"radians\"\nposition( ranger( sensor( pose [0 0 0 6] ) ) )";
  EXPECT_EQ(transducer_pose(type_of(load(robot), 1).devices[0], 0, "heading"), wrap_angle(6));
  EXPECT_EQ(transducer_pose(type_of(load("wrap_headings 1\n" + robot), 1).devices[0], 0, "heading"),
            wrap_angle(6));
  EXPECT_EQ(transducer_pose(type_of(load("wrap_headings 0\n" + robot), 1).devices[0], 0, "heading"), 6);
  EXPECT_THAT(messages(), IsEmpty());
}

TEST_F(StageWorld, OldTuplesAreReadWithAWarning) {
  const auto spec = load("model( pose [1 2 90] size [3 4] origin [0.5 0 0] )");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: warning: old syntax: the two values of \"size\" are read as [x y], with a "
                  "height of 1 m; write [x y z]",
                  "w.world:1: warning: old syntax: the three values of \"origin\" are read as [x y heading]; "
                  "write [x y z heading]",
                  "w.world:1: warning: old syntax: the three values of \"pose\" are read as [x y heading]; "
                  "write [x y z heading]"));
  EXPECT_EQ(spec.bodies[1].pose_world_body, (Pose{1, 2, 0, k_pi / 2}));
  EXPECT_EQ(type_of(spec, 1).parts[0].size, Eigen::Vector3d(3, 4, 1));
}

TEST_F(StageWorld, LongTuplesAreCutWithAWarning) {
  load("model( size [1 1 1 0] )\nposition( velocity_bounds [-1 1 -1 1 -1 1 -90 90 3] )");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: warning: \"size\" takes 3 values [x y z], found 4; the further values are ignored",
          "w.world:2: warning: \"velocity_bounds\" takes 8 values [xmin xmax ymin ymax "
          "zmin zmax amin amax], found 9; the further values are ignored"));
}

TEST_F(StageWorld, PlacesOutsideTheWorldAreErrors) {
  load("model( pose [200000 0 0 0] )\nmodel( model( pose [0 0 -100001 0] ) )");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: \"pose\" is outside the world, which reaches 100 km "
                                      "from its origin: found 200000 m",
                                      "w.world:2: error: \"pose\" is outside the world, which reaches 100 km "
                                      "from its origin: found -100001 m"));
}

// The limits are those of JSON worlds: each world that can be read can be converted.
TEST_F(StageWorld, LimitsOfJsonWorldsHold) {
  load(
      "unit_length \"cm\"\nmodel( size [15000000 1 1] )\nmodel( block( points 3 point[0] [0 0] point[1] "
      "[15000000 0] point[2] [0 1] z [0 1] ) )\n"
      "ranger( sensor( noise [1000000000000 0 0] ) )\n"
      "ranger( sensor( pose [0 0 10000000 0] size [1 1 2] ) )\n"
      "model( size [1 1 200] model( pose [0 0 10000000 0] ) )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:2: error: \"size\" must be at most 10000000, found 15000000",
          "w.world:3: error: \"point[1]\" must be at most 10000000, found 15000000",
          "w.world:4: error: \"noise\": the square root of the first number (variance) must be at most "
          "1000000, found 10000000",
          "w.world:5: error: the middle of this sensor is at a height of 100000.01 m, but coordinates must "
          "be "
          "from -100 to 100 km",
          "w.world:6: error: this model, with the height of the model that carries it, is at a height of "
          "100002 m, but coordinates must be from -100 to 100 km"));
}

TEST_F(StageWorld, ChildrenStackOnTheirParent) {
  const auto spec = load(
      "model( size [1 1 0.5] pose [9 9 2 0]\n"
      " model( pose [1 0 0.1 90] size [0.2 0.4 0.3] model( pose [1 0 0 0] ) )\n"
      " model( stack_children 0 model() ) )\n");
  const engine::TypeSpec& type = type_of(spec, 1);
  ASSERT_THAT(type.parts, SizeIs(5));
  EXPECT_EQ(type.parts[1].pose_body_part, (Pose{1, 0, 0.6, k_pi / 2}));
  EXPECT_NEAR(type.parts[2].pose_body_part.x, 1, 1e-15);
  EXPECT_NEAR(type.parts[2].pose_body_part.y, 1, 1e-15);
  EXPECT_NEAR(type.parts[2].pose_body_part.z, 0.9, 1e-15);
  EXPECT_EQ(type.parts[3].pose_body_part.z, 0.5);
  EXPECT_EQ(type.parts[4].pose_body_part.z, 0.5);
  // Solids are in the body's frame: a child turned by 90 degrees.
  expect_box(bounds_of(type.parts[1].solids), 0.8, 1.2, -0.1, 0.1);
  EXPECT_NEAR(type.parts[1].solids[0].z.min, 0.6, 1e-15);
  EXPECT_NEAR(type.parts[1].solids[0].z.max, 0.9, 1e-15);
}

TEST_F(StageWorld, OriginMovesTheBodyButNotItsChildren) {
  const auto spec = load("model( size [2 1 1] origin [-0.5 0.25 0.125 90] model( size [1 1 1] ) )");
  const engine::TypeSpec& type = type_of(spec, 1);
  expect_box(bounds_of(type.parts[0].solids), -1, 0, -0.75, 1.25);
  EXPECT_EQ(type.parts[0].solids[0].z, (ZInterval{0.125, 1.125}));
  EXPECT_EQ(type.parts[1].pose_body_part, (Pose{0, 0, 1, 0}));
}

TEST_F(StageWorld, ReturnsAndColours) {
  const auto spec = load(
      "model( obstacle_return 0 ranger_return 0.5 color \"DarkBlue\" color_rgba [1 1 1 1] )\n"
      "model( ranger_return -1 color_rgba [0.25 0.5 0.75 0.5] model( color \"green\" ) ranger( sensor() ) )\n"
      "model( color \"rde\" )\nmodel( color_rgba [0 0 0 2] )\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:3: warning: unknown colour \"rde\", replaced by red; colours are X11 "
                          "names (did you mean \"red\"?)",
                          "w.world:4: error: \"color_rgba\" needs values from 0 to 1, found 2"));
  EXPECT_FALSE(type_of(spec, 1).parts[0].returns.obstacle);
  EXPECT_EQ(type_of(spec, 1).parts[0].returns.ranger, 0.5f);
  EXPECT_EQ(spec.bodies[1].color, (Color{0, 0, 139 / 255.0f, 1}));
  EXPECT_EQ(type_of(spec, 2).parts[0].returns, (engine::Returns{true, -1}));
  EXPECT_EQ(spec.bodies[2].color, (Color{0.25f, 0.5f, 0.75f, 0.5f}));
  EXPECT_FALSE(type_of(spec, 2).parts[0].color);
  EXPECT_EQ(type_of(spec, 2).parts[1].color, (Color{0, 1, 0, 1}));
  EXPECT_EQ(type_of(spec, 2).parts[2].color, (Color{0, 0, 0.5f, 1}));
  const auto seen = load(
      "define m model()\nm( fiducial_return -7 fiducial_key 3 gripper_return 1 blob_return 0 )\nm()\n"
      "m( fiducial_return 3000000000 )\n");
  EXPECT_EQ(type_of(seen, 1).parts[0].returns,
            (engine::Returns{.fiducial = -7, .fiducial_key = 3, .gripper = true, .blob = false}));
  EXPECT_EQ(type_of(seen, 2).parts[0].returns, engine::Returns{});
  EXPECT_THAT(messages(), ElementsAre("w.world:4: error: \"fiducial_return\" must be a whole number from "
                                      "-2147483648 to 2147483647, found 3000000000"));
}

TEST_F(StageWorld, RandomColoursFollowFromSeedAndBody) {
  const std::string text =
      "define r model( color \"random\" )\nr()\nr()\nmodel( model( color \"random\" ) )\n";
  const auto spec = load(text);
  EXPECT_NE(spec.bodies[1].color, spec.bodies[2].color);
  EXPECT_EQ(spec.bodies[1].type, spec.bodies[2].type);
  const auto again = load("# another file\n" + text);
  for (const std::size_t b : {1u, 2u}) EXPECT_EQ(spec.bodies[b].color, again.bodies[b].color);
  EXPECT_EQ(type_of(spec, 3).parts[1].color, type_of(again, 3).parts[1].color);
  LoadOptions options;
  options.seed = 2;
  EXPECT_NE(load(text, options).bodies[1].color, spec.bodies[1].color);
}

// Rangers.

TEST_F(StageWorld, RangersBecomeSensors) {
  const auto spec = load(
      "position( size [0.4 0.4 0.2]\n"
      " ranger( name \"eyes\" pose [0.1 0 -0.05 90] origin [0.2 0 0 0] update_interval 250 alwayson 1\n"
      "  sensor( pose [0.01 0 0.1 -30] size [0.1 0.1 0.01] range [0.5 8] fov 180 samples 180 )\n"
      "  sensor() ) )\n");
  const engine::TypeSpec& type = type_of(spec, 1);
  ASSERT_THAT(type.devices, SizeIs(1));
  const engine::DeviceSpec& eyes = type.devices[0];
  EXPECT_EQ(eyes.name, "eyes");
  EXPECT_EQ(eyes.kind, "ranger");
  EXPECT_TRUE(eyes.active);
  EXPECT_EQ(eyes.period_s, 0.25);
  EXPECT_NEAR(eyes.pose_body_device.x, 0.1, 1e-15);
  EXPECT_NEAR(eyes.pose_body_device.y, 0.2, 1e-15);
  EXPECT_NEAR(eyes.pose_body_device.z, 0.15, 1e-15);
  EXPECT_NEAR(eyes.pose_body_device.heading, k_pi / 2, 1e-15);
  EXPECT_EQ(eyes.where.line, 2u);
  EXPECT_EQ(transducer_pose(eyes, 0, "x"), 0.01);
  EXPECT_NEAR(transducer_pose(eyes, 0, "z"), 0.105, 1e-15);  // half of the transducer's height is added
  EXPECT_NEAR(transducer_pose(eyes, 0, "heading"), -30 * k_degree, 1e-15);
  EXPECT_EQ(transducer(eyes, 0, "range_min").number(), 0.5);
  EXPECT_EQ(transducer(eyes, 0, "range_max").number(), 8);
  EXPECT_NEAR(transducer(eyes, 0, "fov").number(), k_pi, 1e-15);
  EXPECT_EQ(transducer(eyes, 0, "samples").integer(), 180);
  EXPECT_EQ(transducer_pose(eyes, 1, "z"), 0.01);
  EXPECT_EQ(transducer(eyes, 1, "range_max").number(), 5);
  EXPECT_EQ(transducer(eyes, 1, "fov").number(), 0.1);
  EXPECT_EQ(transducer(eyes, 1, "samples").integer(), 1);
  EXPECT_FALSE(get(ranger_table(), eyes.params, "intensity").boolean());
}

TEST_F(StageWorld, RangersRunAtStagesPaceUnlessTold) {
  const auto spec = load("position( ranger( sensor() ) )");
  EXPECT_FALSE(type_of(spec, 1).devices[0].active);
  EXPECT_EQ(type_of(spec, 1).devices[0].period_s, 0.1);
  EXPECT_EQ(type_of(spec, 1).drive->period_s, 0.1);
}

TEST_F(StageWorld, LasersAndSonarsAreRangers) {
  const auto spec = load(
      "unit_length \"cm\"\n"
      "position( laser() )\nposition( sonar() )\n"
      "position( laser( samples 181 fov 90 range_max 400 range_min 20 pose [10 0 0 45] size [1 1 10] ) )\n"
      "position( sonar( range [0 300] ) )\n"
      "position( laser( sensor( samples 4 ) sensor() ) )\n"
      "define laser ranger( sensor( samples 6 ) )\nposition( laser() )\n");
  EXPECT_THAT(messages(), IsEmpty());
  const auto sensor = [&](std::size_t body) { return type_of(spec, body).devices[0]; };
  EXPECT_THAT(part_names(type_of(spec, 1)), ElementsAre("", "ranger:0"));
  EXPECT_EQ(type_of(spec, 1).parts[1].kind, "ranger");
  EXPECT_EQ(sensor(1).kind, "ranger");
  EXPECT_EQ(transducer(sensor(1), 0, "samples").integer(), 180);
  EXPECT_EQ(transducer(sensor(1), 0, "fov").number(), k_pi);
  EXPECT_EQ(transducer(sensor(1), 0, "range_max").number(), 8);
  EXPECT_EQ(transducer_pose(sensor(1), 0, "z"), 0.01);
  EXPECT_EQ(transducer(sensor(2), 0, "samples").integer(), 1);
  EXPECT_EQ(transducer(sensor(2), 0, "range_max").number(), 5);
  EXPECT_EQ(transducer(sensor(3), 0, "samples").integer(), 181);
  EXPECT_EQ(transducer(sensor(3), 0, "fov").number(), k_pi / 2);
  EXPECT_EQ(transducer(sensor(3), 0, "range_min").number(), 0.2);
  EXPECT_EQ(transducer(sensor(3), 0, "range_max").number(), 4);
  EXPECT_EQ(transducer_pose(sensor(3), 0, "x"), 0);  // its pose is that of the model
  EXPECT_NEAR(sensor(3).pose_body_device.x, 0.1, 1e-15);
  EXPECT_EQ(transducer(sensor(4), 0, "range_max").number(), 3);
  EXPECT_EQ(transducer(sensor(5), 0, "samples").integer(), 4);  // with sensors it is a ranger like others
  EXPECT_EQ(get(ranger_table(), sensor(5).params, "transducers").records().size(), 2u);
  EXPECT_EQ(transducer(sensor(6), 0, "samples").integer(), 6);  // a macro of the name comes first
}

TEST_F(StageWorld, LasersAndSonarsHaveTheSameProperties) {
  for (const std::string_view alias : {"laser", "sonar"}) {
    const auto spec = load(fmt::format(
        "position( {0}( samples 7 fov 90 range_min 2 range_max 4 ) )\nposition( {0}( range [1 3] ) )\n",
        alias));
    const engine::DeviceSpec& limits = type_of(spec, 1).devices[0];
    EXPECT_EQ(transducer(limits, 0, "samples").integer(), 7) << alias;
    EXPECT_EQ(transducer(limits, 0, "fov").number(), k_pi / 2) << alias;
    EXPECT_EQ(transducer(limits, 0, "range_min").number(), 2) << alias;
    EXPECT_EQ(transducer(limits, 0, "range_max").number(), 4) << alias;
    const engine::DeviceSpec& range = type_of(spec, 2).devices[0];
    EXPECT_EQ(transducer(range, 0, "range_min").number(), 1) << alias;
    EXPECT_EQ(transducer(range, 0, "range_max").number(), 3) << alias;
  }
}

TEST_F(StageWorld, RefusesWrongLasersAndNoOtherNames) {
  load(
      "laser( samples 0 )\nsonar( range_max -1 )\nlaser( range_min 9 apply_range_min 1 )\nlaser( wibble 3 "
      ")\nmap()\n"
      "lasr()");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:4: warning: a laser has no property \"wibble\"; the property is ignored",
          "w.world:1: error: \"samples\" must be at least 1, found 0",
          "w.world:2: error: \"range_max\" must be above 0 m, found -1 m",
          "w.world:3: error: \"range_min\", 9 m, must be at most \"range_max\", 8 m",
          "w.world:5: error: \"map\" is a model type of older versions of Stage: write model( bitmap "
          "\"map.png\" size [16 16 0.6] boundary 1 ), or floorplan( ) after include \"map.inc\", a file of "
          "Stage",
          testing::AllOf(HasSubstr("w.world:6: error: \"lasr\" is neither a model type"),
                         HasSubstr("(did you mean \"laser\"?)"))));
}

TEST_F(StageWorld, RefusesWrongTransducers) {
  load(
      "ranger( sensor( samples 0 ) )\nranger( sensor( range [0 0] ) )\nranger( sensor( range [3 2] "
      "apply_range_min 1 ) )\n"
      "ranger( sensor( fov 361 samples 2 ) )\nranger( sensor( range 5 ) )\nranger( update_interval -1 "
      "sensor() )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: error: \"samples\" must be at least 1, found 0",
                  "w.world:2: error: \"range\": the maximum must be above 0 m, found 0 m",
                  "w.world:3: error: \"range\" needs [min max] with min at most max, found [3 2]",
                  "w.world:4: error: \"fov\" must be at most 360 deg, found 361 deg",
                  "w.world:5: error: \"range\" needs a tuple [min max], found 5",
                  "w.world:6: error: \"update_interval\" must be 0 (every tick) or above, in ms, found -1"));
}

TEST_F(StageWorld, AllThatIsWrongWithATransducerIsReported) {
  load(
      "ranger( sensor( pose [0 0]\n size [-1 1 1]\n range [-1 -2]\n fov 361\n samples 0 apply_range_min 1 ) "
      ")\n"
      "ranger( sensor( pose [1] range [3 2] apply_range_min 1 ) )\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:5: error: \"samples\" must be at least 1, found 0",
                          "w.world:1: error: \"pose\" needs 4 values [x y z heading], found 2",
                          "w.world:2: error: \"size\" must be at least 0 in every direction, found -1",
                          "w.world:3: error: \"range\": the minimum must be at least 0 m, found -1 m",
                          "w.world:3: error: \"range\": the maximum must be above 0 m, found -2 m",
                          "w.world:4: error: \"fov\" must be at most 360 deg, found 361 deg",
                          "w.world:6: error: \"pose\" needs 4 values [x y z heading], found 1",
                          "w.world:6: error: \"range\" needs [min max] with min at most max, found [3 2]"));
}

// Drives.

double drive_param(const engine::WorldSpec& spec, std::size_t body, std::string_view field) {
  const engine::DriveSpec& drive = *type_of(spec, body).drive;
  return get(test_registry().drive(drive.kind)->params, drive.params, field).number();
}

TEST_F(StageWorld, PositionsDrive) {
  const auto spec = load(
      "position()\nposition( drive \"omni\" velocity_bounds [-0.5 0.6 -0.1 0.2 0 0 -360 270] update_interval "
      "0 )\n"
      "position( drive \"car\" wheelbase 0.5 )\nmodel()");
  ASSERT_TRUE(type_of(spec, 1).drive);
  EXPECT_EQ(type_of(spec, 1).drive->kind, "diff");
  EXPECT_EQ(drive_param(spec, 1, "velocity_min_x"), -1);
  EXPECT_EQ(drive_param(spec, 1, "velocity_max_x"), 1);
  EXPECT_EQ(drive_param(spec, 1, "turn_max"), radians(90));
  EXPECT_EQ(type_of(spec, 2).drive->kind, "omni");
  EXPECT_EQ(drive_param(spec, 2, "velocity_max_x"), 0.6);
  EXPECT_EQ(drive_param(spec, 2, "velocity_min_y"), -0.1);
  EXPECT_EQ(drive_param(spec, 2, "velocity_max_y"), 0.2);
  EXPECT_NEAR(drive_param(spec, 2, "turn_min"), -2 * k_pi, 1e-15);  // a rate does not wrap
  EXPECT_NEAR(drive_param(spec, 2, "turn_max"), 1.5 * k_pi, 1e-15);
  EXPECT_EQ(type_of(spec, 2).drive->period_s, 0);
  EXPECT_EQ(drive_param(spec, 3, "wheelbase"), 0.5);
  EXPECT_FALSE(type_of(spec, 4).drive);
}

TEST_F(StageWorld, DrivesHaveAccelerationsAndAStart) {
  const auto spec = load(
      "unit_length \"cm\"\nposition( acceleration_bounds [-50 60 -10 20 0 0 -360 270] velocity [30 -20 0 "
      "450] update_interval 101 )\n"
      "position()");
  EXPECT_EQ(drive_param(spec, 1, "acceleration_min_x"), -0.5);
  EXPECT_EQ(drive_param(spec, 1, "acceleration_max_x"), 0.6);
  EXPECT_EQ(drive_param(spec, 1, "acceleration_min_y"), -0.1);
  EXPECT_EQ(drive_param(spec, 1, "acceleration_max_y"), 0.2);
  EXPECT_NEAR(drive_param(spec, 1, "turn_acceleration_min"), -2 * k_pi, 1e-15);
  EXPECT_NEAR(drive_param(spec, 1, "turn_acceleration_max"), 1.5 * k_pi, 1e-15);
  EXPECT_EQ(drive_param(spec, 1, "start_x"), 0.3);
  EXPECT_EQ(drive_param(spec, 1, "start_y"), -0.2);
  EXPECT_NEAR(drive_param(spec, 1, "start_turn"), 2.5 * k_pi, 1e-15);
  EXPECT_EQ(drive_param(spec, 2, "acceleration_max_x"), 1);
  EXPECT_EQ(drive_param(spec, 2, "turn_acceleration_max"), radians(90));
  EXPECT_EQ(drive_param(spec, 2, "start_x"), 0);
}

TEST_F(StageWorld, DrivesKnowWhereTheyAre) {
  const auto spec = load(
      "position( localization \"odom\" odom_error [0.1 0.2 0 0.3] )\n"
      "position( localization \"odom\" localization_origin [1 2 0 90] odom_heading \"old\" )\n"
      "position( localization_origin [1 2 0 90] gps_origin 1 )\n"
      "position( localization \"gps\" localization_origin [0 0 0 0] )\n"
      "position( localization_origin [1 2 0 90] )");
  const auto value = [&](std::size_t body, std::string_view name) {
    return engine::get(test_registry().drive("diff")->params, type_of(spec, body).drive->params, name);
  };
  using Numbers = std::vector<double>;
  EXPECT_EQ(value(1, "localization").text(), "odom");
  EXPECT_EQ(value(1, "odom_error").numbers(), (Numbers{0.1, 0.2, radians(0.3)}));  // an angle, as in Stage
  EXPECT_EQ(value(1, "localization_origin").numbers(), Numbers());
  EXPECT_EQ(value(1, "odom_heading").text(), "new");
  EXPECT_EQ(value(2, "localization_origin").numbers(), (Numbers{1, 2}));
  EXPECT_NEAR(value(2, "localization_origin_heading").number(), k_pi / 2, 1e-15);
  EXPECT_EQ(value(2, "odom_heading").text(), "old");
  EXPECT_EQ(value(3, "localization").text(), "gps");
  EXPECT_EQ(value(3, "localization_origin").numbers(), (Numbers{1, 2}));
  EXPECT_EQ(value(5, "localization_origin").numbers(), Numbers());
  EXPECT_THAT(messages(),
              ElementsAre("w.world:5: warning: \"localization_origin\" has no effect: as in Stage, poses of "
                          "\"gps\" are in the world frame; add \"gps_origin 1\" to apply the origin"));
}

TEST_F(StageWorld, GoalsHaveStagesSpeeds) {
  const auto spec =
      load("position( velocity_bounds [-3 3 -3 3 -1 1 -180 180] )\nposition( goal_bounds [2 90] )");
  EXPECT_EQ(drive_param(spec, 1, "goal_speed_max"), 0.4);
  EXPECT_EQ(drive_param(spec, 1, "goal_turn_max"), 1);
  EXPECT_EQ(drive_param(spec, 2, "goal_speed_max"), 2);
  EXPECT_EQ(drive_param(spec, 2, "goal_turn_max"), radians(90));
  EXPECT_THAT(messages(), ElementsAre());
}

TEST_F(StageWorld, BumpersFeelCrashesIfAsked) {
  const auto spec = load(
      "position( bumper( size [0.1 0.1 0.1] bcount 1 blength 0.1 ) )\nposition( bumper( size [0.1 0.1 0.1] "
      "bcount 1 blength 0.1 crashes 1 ) )");
  const auto crashes = [&](std::size_t body) {
    const engine::TypeSpec& type = spec.types[spec.bodies[body].type.index()];
    return engine::from_record<engine::BumperParams>(type.devices.front().params).crashes;
  };
  EXPECT_FALSE(crashes(1));
  EXPECT_TRUE(crashes(2));
}

TEST_F(StageWorld, RefusesGoalsAtNoSpeed) {
  load("position( goal_bounds [0 90] )");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: error: \"goal_bounds\" must be above 0 and at most 1e9 m/s and rad/s, found 0 and 90"));
}

TEST_F(StageWorld, RefusesWrongLocalisation) {
  load(
      "position( localization \"gsp\" )\nposition( odom_error [0.05 0.05 0.1] )\n"
      "position( odom_heading \"newer\" )\nposition( acceleration_bounds [1 -1 0 0 0 0 0 0] )\n"
      "position( velocity [1 0 0] )\nposition( localization \"odom\" odom_error [1001 0 0 -60000] )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: \"localization\" must be \"gps\" or \"odom\", found \"gsp\"",
                          "w.world:2: error: \"odom_error\" needs 4 values [x y z a], found 3",
                          "w.world:3: error: \"odom_heading\" must be \"old\" or \"new\", found \"newer\"",
                          "w.world:4: error: in \"acceleration_bounds\", each minimum must be at most the "
                          "maximum that follows it, found 1 and -1",
                          "w.world:5: error: \"velocity\" needs 4 values [x y z a], found 3",
                          "w.world:6: error: \"odom_error\" must be at most 1000, found 1001",
                          "w.world:6: error: \"odom_error\" must be at least -57295.8, found -60000"));
}

TEST_F(StageWorld, RefusesWrongDrives) {
  load(
      "position( drive \"onmi\" )\nposition( velocity_bounds [1 -1 0 0 0 0 0 0] )\nposition( drive \"car\" "
      "wheelbase 0 )");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: error: unknown drive \"onmi\"; known: car, diff, omni (did you mean \"omni\"?)",
                  "w.world:2: error: in \"velocity_bounds\", each minimum must be at most the "
                  "maximum that follows it, found 1 and -1",
                  "w.world:3: error: \"wheelbase\" must be above 0 m, found 0"));
}

TEST_F(StageWorld, TheLimitOfBodiesDoesNotApplyIfValuesAreSet) {
  LoadOptions options;
  options.most_bodies = 1;
  const std::string world = "model()\nmodel( pose [3 0 0 0] )\n";
  EXPECT_THAT(load(world, options).bodies, SizeIs(3));
  options.set = {{"/seed", "7"}};
  EXPECT_THAT(load(world, options).bodies, SizeIs(3));
}

TEST_F(StageWorld, APositionInsideAModelHasWheelsOfItsOwn) {
  const auto spec = load(
      "model( position() )\n"
      "position( position( pose [1 0 0 90] drive \"omni\" velocity_bounds [-2 2 0 0 0 0 -90 90]\n"
      "  localization \"odom\" model() ) )");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:3: warning: \"localization\" of a model of type position inside "
          "another model has no effect: such a model always knows its true pose: remove this property"));
  EXPECT_FALSE(type_of(spec, 1).drive);
  ASSERT_EQ(type_of(spec, 1).joints.size(), 1u);
  const engine::TypeSpec& type = type_of(spec, 2);
  EXPECT_TRUE(type.drive);
  ASSERT_THAT(type.devices, SizeIs(1));
  const engine::DeviceSpec& wheels = type.devices[0];
  EXPECT_EQ(wheels.kind, "wheels");
  EXPECT_EQ(wheels.name, "position:0");
  EXPECT_EQ(wheels.part, 1u);
  const engine::FieldTable& table = test_registry().device("wheels")->params;
  EXPECT_EQ(engine::get(table, wheels.params, "drive").text(), "omni");
  EXPECT_EQ(engine::get(table, wheels.params, "velocity_max_x").number(), 2);
  EXPECT_NEAR(type.joints[0].pose_body_joint.x, 1, 1e-12);
  EXPECT_EQ(type.parts[1].joint, 0);
  EXPECT_EQ(type.parts[2].joint, 0) << "what stands on it goes with it";
}

TEST_F(StageWorld, AValueOutsideItsLimitsWithoutEffectIsAWarning) {
  struct Case {
    std::string world, warning;
  };
  for (const auto& [world, warning] : std::vector<Case>{
           {"position( odom_error [0.02 0.02 999999 999999] )",
            "\"odom_error\" must be at most 57295.8, found 999999; it has no effect, because "
            "\"localization\" is "
            "\"gps\""},
           {"position( localization \"gps\" odom_error [-5000 0 0 0] )",
            "\"odom_error\" must be at least -1000, found -5000; it has no effect, because \"localization\" "
            "is "
            "\"gps\""},
           {"position( drive \"omni\" wheelbase -1 )",
            "\"wheelbase\" must be above 0 m, found -1; it has no effect, because \"drive\" is \"omni\""},
           {"position( velocity_bounds [-1 1 -1 1 1 0 -90 90] )",
            "in \"velocity_bounds\", each minimum must be at most the maximum that follows it, found 1 and "
            "0; it has no "
            "effect, because no model moves along z"},
           {"position( mass -2 )",
            "\"mass\" must be from 0 to 1000000, in kg, found -2; it has no effect, because only the power "
            "pack of a "
            "top-level position uses it"},
           {"position( watts -2 )",
            "\"watts\" must be from 0 to 1000000000, in W, found -2; it has no effect, because Troupe "
            "computes the "
            "power of a model of type position"},
           {"ranger( sensor( range [-0.1 5] ) )",
            "\"range\": the minimum must be at least 0 m, found -0.1 m; it has no effect, because "
            "\"apply_range_min\" "
            "is false"},
           {"ranger( sensor( range [6 5] ) )",
            "\"range\" needs [min max] with min at most max, found [6 5]; it has no effect, because the "
            "minimum counts "
            "only with \"apply_range_min 1\""},
           {"ranger( sensor( fov 400 ) )",
            "\"fov\" must be at most 360 deg, found 400 deg; it has no effect, because \"samples\" is 1"},
           {"fiducial( range_min -1 )",
            "\"range_min\" must be at least 0 m, found -1; it has no effect, because \"apply_range_min\" is "
            "false"}}) {
    load(world);
    EXPECT_THAT(messages(), ElementsAre("w.world:1: warning: " + warning)) << world;
  }
  // The same values are errors where they have an effect.
  for (const char* world :
       {"position( localization \"odom\" odom_error [0 0 0 999999] )",
        "position( drive \"car\" wheelbase -1 )", "position( velocity_bounds [1 -1 0 0 0 0 0 0] )",
        "position( joules 9 mass -2 )", "model( watts -2 )",
        "ranger( sensor( range [-0.1 5] apply_range_min 1 ) )",
        "ranger( sensor( range [6 5] apply_range_min 1 ) )", "ranger( sensor( fov 400 samples 2 ) )",
        "fiducial( range_min -1 apply_range_min 1 )"}) {
    load(world);
    EXPECT_THAT(messages(), ElementsAre(HasSubstr("w.world:1: error: "))) << world;
  }
}

TEST_F(StageWorld, AValueThatIsSetMayMakeAnotherOneEffective) {
  LoadOptions options;
  options.set = {{"/types/position/drive/localization", "odom"}};
  load("position( odom_error [0.02 0.02 999999 999999] )", options);
  EXPECT_THAT(
      messages(),
      ElementsAre(
          HasSubstr("w.world:1: warning: \"odom_error\" must be at most 57295.8"),
          HasSubstr("w.world:1: error: /types/position/drive/odom_error/2: must be from -1000 to 1000")));
  options.set = {{"/ranging", "grid"}};
  load("resolution 0", options);
  EXPECT_THAT(messages(),
              ElementsAre(HasSubstr("w.world:1: warning: \"resolution\" must be from 0.0001 to 100 m"),
                          HasSubstr("error: /resolution_m: must be from 0.0001 to 100 m, found 0")));
}

TEST_F(StageWorld, AnInitialVelocityNeedsALongUpdateInterval) {
  load(
      "position( velocity [0.5 0 0 20] )\nposition( velocity [0 0 0 0] )\nposition( velocity [1 0 0 0] "
      "update_interval "
      "3600000 )");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: warning: \"velocity\" has no effect: at its first update, after 100 ms and before "
          "the first motion, the drive replaces this initial speed; write update_interval 3600000 to "
          "keep it for an hour, or command the speed with a controller"));
}

TEST_F(StageWorld, OldWordsNameWhatToWriteToday) {
  load(
      "define ring ranger( scount 2 spose[0] [0.1 0.1 90]\n spose[1] [0.1 -0.1 -90] sview [0 5 15] ssize "
      "[0.01 0.05] )\n"
      "position( ring() ctrl \"wander\" )\n"
      "ranger( range_max 8 sensor( range_max 8 samples 3 ) )\n"
      "fiducialfinder()\nmodel( size [1 1] laser_return 1 )");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: warning: old syntax: \"scount\", \"spose[k]\", \"sview\" and \"ssize\" are ignored, as "
          "in "
          "Stage: write sensor( pose [0.1 0.1 0 90] range [0 5] fov 15 ) for the first transducer, and so on",
          "w.world:3: warning: a ranger without a sensor( ... ) measures nothing: add a sensor( ... )",
          "w.world:4: warning: old syntax: \"range_max\" is ignored, as in Stage: write sensor( range [0 8] "
          "), the "
          "minimum and the maximum",
          "w.world:4: warning: old syntax: \"range_max\" is ignored, as in Stage: write range [0 8], the "
          "minimum and "
          "the maximum",
          "w.world:6: warning: old syntax: \"laser_return\" is ignored, as in Stage: write ranger_return 1; "
          "below 0: "
          "rangers do not see the model",
          "w.world:6: warning: old syntax: the two values of \"size\" are read as [x y], with a height of 1 "
          "m; write "
          "[x y z]",
          "w.world:5: error: \"fiducialfinder\" is a model type of older versions of Stage: write fiducial( "
          "range_max "
          "8 fov 180 )"));
}

TEST_F(StageWorld, OldWordsAreListedWithTheErrors) {
  Diagnostics diagnostics;
  load_stage_world(folder() / "w.world", "ranger( scount 1 )\nmodel( wibble 1 )\nmodel( size [0 1 1] )\n",
                   test_registry(), {}, diagnostics);
  std::string text;
  try {
    diagnostics.throw_if_errors();
  } catch (const InputError& error) {
    text = error.what();
  }
  EXPECT_THAT(text, testing::AllOf(HasSubstr("w.world:1: warning: old syntax: \"scount\" is ignored"),
                                   HasSubstr("w.world:3: error: "), testing::Not(HasSubstr("wibble"))));
}

TEST_F(StageWorld, AStartVelocityOfAPositionInsideAModelIsAWarning) {
  load("position( position( velocity [1 0 0 0] ) )\nposition( velocity [1 0 0 0] update_interval 200 )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: warning: \"velocity\" of a model of type position inside another model "
                          "has no effect: the drive of such a model sets the velocity before the first "
                          "motion: remove this property"));
  EXPECT_EQ(test_registry().device("wheels")->params.find("start_x"), -1);
}

// Controllers.

TEST_F(StageWorld, ControllersTakeArgumentsByPlaceAndByName) {
  const auto spec = load(
      "position( ctrl \"expand 0.4 invert=1 cone_deg=45\" )\nposition( ctrl [ \"wander\" \"script wave\" ] "
      ")\n"
      "position( ctrl \"expand_swarm gain=2\" )\nposition( ctrl \"  expand   clearances=0.5,0.25  \" )");
  const engine::FieldTable& expand = test_registry().controller("expand")->params;
  const auto& first = type_of(spec, 1).controllers;
  ASSERT_THAT(first, SizeIs(1));
  EXPECT_EQ(first[0].kind, "expand");
  EXPECT_EQ(get(expand, first[0].params, "speed").number(), 0.4);
  EXPECT_EQ(get(expand, first[0].params, "gain").number(), 1);
  EXPECT_TRUE(get(expand, first[0].params, "invert").boolean());
  EXPECT_NEAR(get(expand, first[0].params, "cone").number(), k_pi / 4, 1e-15);
  const auto& second = type_of(spec, 2).controllers;
  ASSERT_THAT(second, SizeIs(2));
  EXPECT_EQ(second[0].kind, "wander");
  EXPECT_EQ(second[1].kind, "script");
  EXPECT_EQ(get(test_registry().controller("script")->params, second[1].params, "law").text(), "wave");
  const auto& third = type_of(spec, 3).controllers;
  EXPECT_EQ(third[0].kind, "expand");
  EXPECT_EQ(get(expand, third[0].params, "gain").number(), 2);
  EXPECT_THAT(get(expand, third[0].params, "clearances").numbers(), SizeIs(12));
  EXPECT_THAT(get(expand, type_of(spec, 4).controllers[0].params, "clearances").numbers(),
              ElementsAre(0.5, 0.25));
}

TEST_F(StageWorld, RefusesWrongArguments) {
  load(
      "position( ctrl \"\" )\nposition( ctrl \"wander 1 2 3 4 5 6\" )\nposition( ctrl \"expand spede=3\" )\n"
      "position( ctrl \"expand fast\" )\nposition( ctrl \"expand cone=-1\" )\nposition( ctrl \"expand "
      "invert=2\" )\n"
      "position( ctrl \"script wvae\" )\nposition( ctrl \"script legs=1\" )\nposition( ctrl \"expand "
      "clearances=1,,2\" )\n");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:1: error: \"ctrl\" is empty; it must name a controller: expand, expand_pioneer, "
          "expand_swarm, script, source, wander",
          "w.world:2: error: controller \"wander\" takes at most 5 arguments: remove \"6\"",
          "w.world:3: error: controller \"expand\" has no parameter \"spede\"; known: speed, gain, "
          "clearance, "
          "clearances, cone, invert, hold_on_axis (did you mean \"speed\"?)",
          "w.world:4: error: controller \"expand\": \"speed\" needs a number, found \"fast\"",
          "w.world:5: error: controller \"expand\": \"cone\" must be at least 0 rad, found \"-1\"",
          "w.world:6: error: controller \"expand\": \"invert\" needs true or false, found \"2\"",
          HasSubstr("w.world:7: error: controller \"script\": \"law\" must be one of timed, wave, line"),
          "w.world:8: error: controller \"script\": \"legs\" cannot be given in a .world file, only in JSON, "
          "found \"1\"",
          "w.world:9: error: controller \"expand\": \"clearances\" needs numbers separated by commas, "
          "without blanks, found \"1,,2\""));
}

TEST_F(StageWorld, AnArgumentThatIsGivenTwiceIsAWarning) {
  const auto spec = load("position( ctrl \"expand 0.4 gain=2 speed=0.2\" )");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: warning: controller \"expand\": \"speed\" is given twice; the "
                          "last value is used"));
  const auto& controllers = type_of(spec, 1).controllers;
  ASSERT_THAT(controllers, SizeIs(1));
  EXPECT_EQ(get(test_registry().controller("expand")->params, controllers[0].params, "speed").number(), 0.2);
}

TEST_F(StageWorld, ControllersThatDriveNeedATopLevelPosition) {
  load("model( ctrl \"wander\" )\nposition( ranger( sensor() ctrl \"wander\" ) )");
  EXPECT_THAT(messages(), ElementsAre("w.world:1: error: controller \"wander\" must be in a model of type "
                                      "position, which has a drive; this model is of type model",
                                      "w.world:2: error: controller \"wander\" must be in a model of type "
                                      "position, which has a drive; this model, inside another "
                                      "model, is of type ranger"));
}

// Types.

TEST_F(StageWorld, BodiesThatDifferInPoseNameAndColourShareTheirType) {
  const auto spec = load(
      "define rob position( ranger( sensor( samples 4 ) ) )\ndefine red rob( color \"red\" )\n"
      "define blue rob( color \"blue\" )\n"
      "red( pose [1 0 0 0] )\nblue( name \"x\" )\nposition( ranger( sensor( samples 4 ) ) color_rgba [0 0 0 "
      "1] )\n"
      "red( friction 3 )\nred( size [0.1 0.1 0.1] )\nred( ranger( sensor() ) )\nred( alwayson 1 )");
  EXPECT_THAT(messages(), SizeIs(1));
  ASSERT_THAT(spec.bodies, SizeIs(8));
  for (const std::size_t b : {2u, 3u, 4u, 7u}) EXPECT_EQ(spec.bodies[b].type, spec.bodies[1].type) << b;
  EXPECT_THAT(spec.types, SizeIs(4));
  EXPECT_EQ(type_of(spec, 1).name, "position");  // what the bodies' words have in common
  EXPECT_EQ(spec.bodies[2].pose_world_body, Pose{});
  EXPECT_EQ(load("define rob position()\ndefine red rob( color \"red\" )\nrob()\nred()").types[1].name,
            "rob");
}

TEST_F(StageWorld, BodiesWithNumbersOfTheirOwnShareTheirType) {
  std::string text = "define rob position( fiducial_return 1 model( fiducial_return 9 ) )\n";
  for (int i = 0; i < 100; ++i) text += fmt::format("rob( fiducial_return {} )\n", i - 50);
  const auto spec =
      load(text + "rob()\nrob( fiducial_return \"0.0\" )\nposition( model( fiducial_return 9 ) )\n");
  ASSERT_THAT(spec.bodies, SizeIs(104));
  EXPECT_THAT(spec.types, SizeIs(3));  // the ground, marked ones, others
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(fiducial_of(spec, BodyId(static_cast<std::size_t>(i) + 1), 0), i - 50) << i;
    EXPECT_EQ(spec.bodies[static_cast<std::size_t>(i) + 1].type, TypeId(i == 50 ? 2 : 1)) << i;
    EXPECT_EQ(fiducial_of(spec, BodyId(static_cast<std::size_t>(i) + 1), 1), 9) << i;
  }
  EXPECT_EQ(fiducial_of(spec, BodyId(101), 0), 1);
  EXPECT_EQ(fiducial_of(spec, BodyId(102), 0), 0);
  EXPECT_EQ(spec.bodies[102].type, spec.bodies[103].type);
}

TEST_F(StageWorld, TheSameWordsMayMeanSomethingElseLater) {
  const auto spec = load("position( ranger() )\ndefine ranger model()\nposition( ranger() )");
  EXPECT_THAT(messages(), SizeIs(1));
  EXPECT_EQ(type_of(spec, 1).parts[1].kind, "ranger");
  EXPECT_EQ(type_of(spec, 2).parts[1].kind, "model");
}

TEST_F(StageWorld, AHundredThousandRobotsLoadQuickly) {
  std::string text = "define bot position( size [0.1 0.1 0.1] color \"random\" ranger( ";
  for (int i = 0; i < 12; ++i) text += fmt::format("sensor( pose [0 0 0 {}] ) ", 30 * i);
  text += ") ctrl \"expand_swarm\" )\n";
  for (int i = 0; i < 100000; ++i)
    text += fmt::format("bot( name \"r{}\" pose [ {:.3f} {:.3f} 0 {} ] )\n", i, 0.25 * (i / 300),
                        0.25 * (i % 300), i % 360);
  const auto start = std::chrono::steady_clock::now();
  const auto spec = load(text);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  EXPECT_THAT(spec.bodies, SizeIs(100001));
  EXPECT_THAT(spec.types, SizeIs(2));
  // A second is usual; sanitizers and loaded machines take longer, quadratic code takes for ever.
  EXPECT_LT(time.count(), 60);
}

// Stage's own worlds.

class StageOwnWorld : public StageTest {
 protected:
  static inline const std::filesystem::path worlds = test::source_dir() / "../shared/stage-worlds";

  engine::WorldSpec open(const std::string& name, const engine::Registry& registry = test_registry()) {
    shorten(worlds.lexically_normal());
    const std::filesystem::path file = (worlds / name).lexically_normal();
    std::ifstream in(file);
    return read(file, {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()}, {}, registry);
  }

  void SetUp() override {
    if (!std::filesystem::exists(worlds)) GTEST_SKIP() << "Stage's data are not in " << worlds;
  }
};

TEST_F(StageOwnWorld, Simple) {
  const auto spec = open("simple.world");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "simple.world:12: warning: properties without effect on the run, because only Stage's window uses "
          "them: "
          "paused, gui_nose, gui_grid, gui_move, gui_outline, trail_length, color_rgba of a sensor"));
  EXPECT_EQ(spec.quit_time_s, 3600);
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "cave", "r0", "r1"));
  EXPECT_EQ(spec.bodies[2].type, spec.bodies[3].type);
  EXPECT_EQ(spec.bodies[2].pose_world_body, (Pose{-6.946, -6.947, 0, radians(45)}));

  const engine::PartSpec& cave = type_of(spec, 1).parts[0];
  ASSERT_THAT(cave.solids, SizeIs(5));  // the bitmap and four walls
  EXPECT_THAT(cave.solids[0].contours, SizeIs(15));
  expect_box(bounds_of(cave.solids), -8, 8, -8, 8);
  EXPECT_FALSE(cave.returns.obstacle);
  EXPECT_EQ(cave.returns.ranger, 0.5f);

  const engine::TypeSpec& robot = type_of(spec, 2);
  EXPECT_EQ(robot.name, "pioneer2dx");
  EXPECT_THAT(part_names(robot), ElementsAre("", "ranger:0", "ranger:1"));
  // The octagon's corners after normalisation, moved by the origin.
  expect_box(bounds_of(robot.parts[0].solids), -0.26, 0.18, -0.19, 0.19);
  EXPECT_EQ(robot.parts[0].solids[0].z, (ZInterval{0, 0.22}));
  ASSERT_THAT(robot.devices, SizeIs(2));
  EXPECT_NEAR(robot.devices[0].pose_body_device.z + transducer_pose(robot.devices[0], 3, "z"), 0.195, 1e-12);
  EXPECT_NEAR(robot.devices[1].pose_body_device.z + transducer_pose(robot.devices[1], 0, "z"), 0.33, 1e-12);
  EXPECT_EQ(transducer(robot.devices[1], 0, "samples").integer(), 180);
  EXPECT_NEAR(robot.parts[2].solids[0].z.max, 0.41, 1e-12);
  ASSERT_THAT(robot.controllers, SizeIs(1));
  EXPECT_EQ(robot.controllers[0].kind, "wander");
  EXPECT_EQ(drive_param(spec, 2, "velocity_max_x"), 0.5);
}

TEST_F(StageOwnWorld, PioneerWalle) {
  const auto spec = open("pioneer_walle.world");
  EXPECT_THAT(
      messages(),
      ElementsAre("walle.inc:14: warning: old syntax: \"laser_return\" is ignored, as in Stage: write "
                  "ranger_return 1; "
                  "below 0: rangers do not see the model",
                  "walle.inc:16: warning: old syntax: \"blobfinder_return\" is ignored, as in Stage: write "
                  "blob_return 1",
                  "pioneer_walle.world:10: warning: properties without effect on the run, because only "
                  "Stage's window uses "
                  "them: paused, gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"));
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "cave", "r0", "walle"));
  EXPECT_THAT(type_of(spec, 2).parts[0].solids, SizeIs(7));
  expect_box(bounds_of(type_of(spec, 2).parts[0].solids), -0.26, 0.18, -0.19, 0.19);
  EXPECT_THAT(type_of(spec, 2).parts[2].solids, SizeIs(4));
  EXPECT_THAT(type_of(spec, 3).parts[0].solids, SizeIs(15));
  EXPECT_TRUE(type_of(spec, 3).drive);
}

TEST_F(StageOwnWorld, Roomba) {
  const auto spec = open("roomba.world");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "irobot.inc:29: warning: \"size\" takes 3 values [x y z], found 4; the further values are ignored",
          "roomba.world:11: warning: properties without effect on the run, because only Stage's window uses "
          "them: paused, gui_nose, gui_grid, gui_move, gui_outline"));
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "cave", "r0"));
  EXPECT_THAT(part_names(type_of(spec, 2)), ElementsAre("", "bumper:0"));
  EXPECT_THAT(type_of(spec, 2).parts[0].solids[0].contours[0], SizeIs(16));
  EXPECT_EQ(spec.bodies[2].color, (Color{127 / 255.0f, 127 / 255.0f, 127 / 255.0f, 1}));
}

TEST_F(StageOwnWorld, SensorNoiseDemo) {
  const auto spec = open("sensor_noise_demo.world");
  EXPECT_THAT(messages(),
              ElementsAre("map.inc:13: warning: properties without effect on the run, because "
                          "only Stage's window uses "
                          "them: gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"));
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "cave", "position:0"));
  const engine::TypeSpec& robot = type_of(spec, 2);
  EXPECT_FALSE(robot.devices[0].active);
  EXPECT_TRUE(robot.devices[1].active);
  EXPECT_THAT(robot.controllers, IsEmpty());
}

TEST_F(StageOwnWorld, Cave) {
  const auto spec = open("benchmark/cave.world");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "benchmark/cave.world:52: warning: macro \"greenrob\" is already defined at line 48; this later "
          "definition is ignored: remove it",
          "benchmark/cave.world:15: warning: properties without effect (docs/stage-worlds.md says why): "
          "threads",
          "benchmark/cave.world:13: warning: properties without effect on the run, because only Stage's "
          "window uses "
          "them: paused, interval of a window, gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a "
          "sensor"));
  ASSERT_THAT(spec.bodies, SizeIs(102));
  ASSERT_THAT(spec.types, SizeIs(3));  // 100 robots in ten colours share one
  EXPECT_EQ(spec.types[2].name, "rob");
  EXPECT_EQ(name_of(spec, 2), "position:0");
  EXPECT_EQ(name_of(spec, 101), "position:99");
  for (std::size_t b = 2; b < 102; ++b) EXPECT_EQ(spec.bodies[b].type, TypeId(2));
  EXPECT_NE(spec.bodies[2].color, spec.bodies[12].color);
  const engine::TypeSpec& robot = spec.types[2];
  EXPECT_THAT(robot.parts[0].solids, SizeIs(7));
  ASSERT_THAT(robot.devices, SizeIs(2));
  EXPECT_THAT(get(ranger_table(), robot.devices[0].params, "transducers").records(), SizeIs(16));
  EXPECT_THAT(spec.types[1].parts[0].solids[0].contours, SizeIs(8));
  EXPECT_EQ(robot.controllers[0].kind, "expand");
}

TEST_F(StageOwnWorld, Hospital) {
  const auto spec = open("benchmark/hospital.world");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "benchmark/hospital.world:16: warning: properties without effect (docs/stage-worlds.md says why): "
          "threads",
          "benchmark/hospital.world:13: warning: properties without effect on the run, because only Stage's "
          "window uses "
          "them: paused, interval of a window, gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a "
          "sensor"));
  ASSERT_THAT(spec.bodies, SizeIs(1002));
  EXPECT_THAT(spec.types, SizeIs(3));
  EXPECT_EQ(name_of(spec, 1), "model:1");
  EXPECT_EQ(spec.quit_time_s, 60);
  for (std::size_t i = 0; i < 1000; ++i) {
    const engine::BodySpec& body = spec.bodies[i + 2];
    EXPECT_EQ(name_of(spec, i + 2), fmt::format("r{}", i));
    EXPECT_NEAR(body.pose_world_body.x, -59 + 0.25 * static_cast<double>(i / 5), 1e-9);
    EXPECT_NEAR(body.pose_world_body.y, -15 + 0.25 * static_cast<double>(i % 5), 1e-9);
  }
  const engine::TypeSpec& robot = spec.types[2];
  EXPECT_EQ(robot.name, "swarmbot");
  EXPECT_THAT(get(ranger_table(), robot.devices[0].params, "transducers").records(), SizeIs(12));
  EXPECT_NEAR(robot.devices[0].pose_body_device.z + transducer_pose(robot.devices[0], 0, "z"), 0.06, 1e-12);
  expect_box(bounds_of(spec.types[1].parts[0].solids), -70, 70, -30, 30);
  EXPECT_THAT(spec.types[1].parts[0].solids[0].contours, SizeIs(979));
}

TEST_F(StageOwnWorld, LspTest) {
  const auto spec = open("lsp_test.world");
  EXPECT_THAT(
      messages(),
      ElementsAre("lsp_test.world:9: warning: old syntax: \"interval_real\" is ignored, as in Stage: write "
                  "speedup 1, "
                  "with troupe run --rate world",
                  "lsp_test.world:46: warning: old syntax: \"channel_count\" and \"channels\" are ignored, "
                  "as in Stage: "
                  "write colors_count 2 colors [\"red\" \"green\"]",
                  "lsp_test.world:33: warning: a ranger without a sensor( ... ) measures nothing: add a "
                  "sensor( ... )",
                  "lsp_test.world:11: warning: properties without effect on the run, because only Stage's "
                  "window uses "
                  "them: paused, gui_nose, gui_grid, gui_move, gui_outline, color_rgba of a sensor"));
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "cave", "r0", "r1"));
  EXPECT_EQ(spec.bodies[2].type, spec.bodies[3].type) << "only their fiducial_return differs";
  EXPECT_EQ(fiducial_of(spec, BodyId(2), 0), 1);
  EXPECT_EQ(fiducial_of(spec, BodyId(3), 0), 2);
  EXPECT_THAT(part_names(type_of(spec, 2)),
              ElementsAre("", "ranger:0", "ranger:1", "ranger:2", "fiducial:0", "blobfinder:0"));
}

TEST_F(StageOwnWorld, PioneerFlocking) {
  open("pioneer_flocking.world");
  EXPECT_THAT(messages(),
              testing::Contains("pioneer_flocking.world:40: error: unknown controller \"pioneer_flocking\"; "
                                "known: expand, expand_pioneer, expand_swarm, script, source, wander"));

  engine::Registry registry = test_registry();
  registry.presets.push_back({.name = "pioneer_flocking", .kind = "expand"});
  const auto spec = open("pioneer_flocking.world", registry);
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "pioneer_flocking.world:16: warning: properties without effect (docs/stage-worlds.md says why): "
          "threads",
          "pioneer_flocking.world:10: warning: properties without effect on the run, because only Stage's "
          "window uses "
          "them: paused, gui_nose, gui_grid, gui_move, gui_outline"));
  EXPECT_THAT(spec.bodies, SizeIs(102));
  EXPECT_THAT(spec.types, SizeIs(3));
  EXPECT_EQ(spec.types[2].name, "flocker");
}

// Worlds of our own in Stage's syntax, with includes, macros, bitmaps and units. What is expected follows
// from the numbers in their files; StageStyles (tests/troupe) tells what loading the styles warns of.

class StageLikeWorld : public StageTest {
 protected:
  engine::WorldSpec open(const std::string& name) {
    static const engine::Registry registry = make_registry();
    const std::filesystem::path file = test::source_dir() / "tests" / name;
    std::ifstream in(file);
    return read(file, {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()}, {}, registry);
  }
  static double beam_height(const engine::DeviceSpec& ranger, std::size_t number = 0) {
    return ranger.pose_body_device.z + transducer_pose(ranger, number, "z");
  }
};

TEST_F(StageLikeWorld, Quarry) {
  const auto spec = open("stage_like/quarry.world");
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_EQ(spec.quit_time_s, 6);
  EXPECT_EQ(spec.resolution_m, 0.02);
  EXPECT_THAT(body_names(spec),
              ElementsAre("_ground_model", "plan", "stump", "post", "glass", "a", "b", "c", "stuck"));
  EXPECT_EQ(spec.bodies[5].pose_world_body, (Pose{-3.713, 1.291, 0, radians(10.5)}));
  for (std::size_t robot = 6; robot <= 8; ++robot) EXPECT_EQ(spec.bodies[robot].type, spec.bodies[5].type);

  const engine::PartSpec& plan = type_of(spec, 1).parts[0];
  ASSERT_THAT(plan.solids, SizeIs(5));               // the bitmap and four walls
  EXPECT_THAT(plan.solids[0].contours, SizeIs(12));  // stage_like/bitmaps.txt
  EXPECT_EQ(plan.solids[0].z, (ZInterval{0, 0.6}));
  expect_box(bounds_of({plan.solids[0]}), -6, 6, -4, 4);
  expect_box(bounds_of(plan.solids), -6, 6, -4, 4);
  EXPECT_FALSE(plan.returns.obstacle);
  EXPECT_EQ(plan.returns.ranger, 0.5f);
  EXPECT_TRUE(type_of(spec, 3).parts[0].returns.obstacle);
  EXPECT_EQ(type_of(spec, 3).parts[0].returns.ranger, 0.7f);
  EXPECT_EQ(type_of(spec, 4).parts[0].returns.ranger, -1);

  const engine::TypeSpec& robot = type_of(spec, 5);
  EXPECT_EQ(robot.name, "waving");
  EXPECT_THAT(part_names(robot), ElementsAre("", "ranger:0", "ranger:1"));
  // The hull fills 0.5 x 0.4 m, whatever its points' scale, and lies 0.03 m back.
  expect_box(bounds_of(robot.parts[0].solids), -0.28, 0.22, -0.2, 0.2);
  EXPECT_EQ(robot.parts[0].solids[0].z, (ZInterval{0, 0.25}));
  EXPECT_THAT(robot.parts[1].solids, IsEmpty());
  EXPECT_NEAR(robot.parts[2].solids[0].z.min, 0.25, 1e-12);
  EXPECT_NEAR(robot.parts[2].solids[0].z.max, 0.4, 1e-12);
  expect_box(bounds_of(robot.parts[2].solids), -0.01, 0.11, -0.05, 0.05);
  ASSERT_THAT(robot.devices, SizeIs(2));
  EXPECT_THAT(get(ranger_table(), robot.devices[0].params, "transducers").records(), SizeIs(10));
  EXPECT_NEAR(beam_height(robot.devices[0], 3), 0.21, 1e-12);
  EXPECT_NEAR(transducer_pose(robot.devices[0], 3, "heading"), radians(-25), 1e-12);
  EXPECT_NEAR(beam_height(robot.devices[1]), 0.34, 1e-12);
  EXPECT_EQ(transducer(robot.devices[1], 0, "samples").integer(), 41);
  EXPECT_NEAR(transducer(robot.devices[1], 0, "fov").number(), radians(200), 1e-12);
  EXPECT_EQ(transducer(robot.devices[1], 0, "range_max").number(), 7);
  ASSERT_THAT(robot.controllers, SizeIs(1));
  EXPECT_EQ(robot.controllers[0].kind, "script");
  EXPECT_EQ(drive_param(spec, 5, "velocity_max_x"), 0.5);
}

TEST_F(StageLikeWorld, YardInCentimetresAndRadians) {
  const auto spec = open("stage_like/yard.world");
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_EQ(spec.resolution_m, 0.05);
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "plan", "a", "b", "c"));
  EXPECT_NEAR(spec.bodies[1].pose_world_body.x, 0.123, 1e-12);
  EXPECT_NEAR(spec.bodies[1].pose_world_body.heading, 0.37, 1e-12);
  const engine::PartSpec& plan = type_of(spec, 1).parts[0];
  ASSERT_THAT(plan.solids, SizeIs(1));
  EXPECT_THAT(plan.solids[0].contours, SizeIs(9));
  expect_box(bounds_of(plan.solids), -4.5, 4.5, -3, 3);
  EXPECT_EQ(spec.bodies[2].type, spec.bodies[3].type) << "only the colour differs";
  EXPECT_NE(spec.bodies[2].type, spec.bodies[4].type);
  const engine::TypeSpec& robot = type_of(spec, 4);
  EXPECT_THAT(part_names(robot), ElementsAre("", "ranger:0", "model:0", "model:0.ranger:0"));
  expect_box(bounds_of(robot.parts[0].solids), -0.1, 0.1, -0.08, 0.08);
  ASSERT_THAT(robot.devices, SizeIs(2));
  EXPECT_THAT(get(ranger_table(), robot.devices[0].params, "transducers").records(), SizeIs(12));
  EXPECT_NEAR(transducer_pose(robot.devices[0], 7, "heading"), -2.61799388, 1e-12);
  EXPECT_EQ(transducer(robot.devices[0], 0, "range_max").number(), 2.5);
  EXPECT_NEAR(robot.devices[1].pose_body_device.heading, 0.5, 1e-12);
  EXPECT_NEAR(beam_height(robot.devices[1]), 0.44, 1e-12);
  EXPECT_NEAR(drive_param(spec, 4, "velocity_max_x"), 1, 1e-12);
}

TEST_F(StageLikeWorld, BodiesOfManyBlocks) {
  const auto spec = open("troupe/stage_styles/blocks.world");
  EXPECT_THAT(messages(), SizeIs(3));
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "cave", "r0", "still"));
  EXPECT_THAT(type_of(spec, 1).parts[0].solids[0].contours, SizeIs(5));  // stage_like/bitmaps.txt
  expect_box(bounds_of(type_of(spec, 1).parts[0].solids), -8, 8, -8, 8);
  const engine::TypeSpec& robot = type_of(spec, 2);
  EXPECT_THAT(part_names(robot), ElementsAre("", "ranger:0", "ranger:1"));
  EXPECT_THAT(robot.parts[0].solids, SizeIs(7));
  expect_box(bounds_of(robot.parts[0].solids), -0.26, 0.18, -0.19, 0.19);
  EXPECT_EQ(robot.parts[0].solids[1].contours[0].size(), 9u);
  EXPECT_THAT(robot.parts[2].solids, SizeIs(4));
  EXPECT_NEAR(beam_height(robot.devices[0]), 0.22 - 0.03 + 0.005, 1e-12);
  EXPECT_TRUE(type_of(spec, 3).drive);
}

TEST_F(StageLikeWorld, RoundRobotsWithBumpers) {
  const auto spec = open("troupe/stage_styles/disc.world");
  EXPECT_THAT(messages(), SizeIs(2));
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "cave", "r0"));
  EXPECT_THAT(part_names(type_of(spec, 2)), ElementsAre("", "bumper:0"));
  EXPECT_THAT(type_of(spec, 2).parts[0].solids[0].contours[0], SizeIs(16));
  expect_box(bounds_of({type_of(spec, 2).parts[0].solids}), -0.165, 0.165, -0.165, 0.165);
  EXPECT_EQ(spec.bodies[2].color, (Color{127 / 255.0f, 127 / 255.0f, 127 / 255.0f, 1}));
}

TEST_F(StageLikeWorld, ASensorThatRunsWithoutASubscriber) {
  const auto spec = open("troupe/stage_styles/noise.world");
  EXPECT_THAT(messages(), SizeIs(1));
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "cave", "position:0"));
  const engine::TypeSpec& robot = type_of(spec, 2);
  ASSERT_THAT(robot.devices, SizeIs(1));
  EXPECT_TRUE(robot.devices[0].active);
  EXPECT_NEAR(transducer(robot.devices[0], 0, "noise_stddev").number(), std::sqrt(0.005), 1e-12);
  EXPECT_THAT(robot.controllers, IsEmpty());
}

TEST_F(StageLikeWorld, ASwarmOfOneType) {
  const auto spec = open("stage_like/swarm.world");
  EXPECT_THAT(messages(), SizeIs(1));  // of threads
  ASSERT_THAT(spec.bodies, SizeIs(26));
  EXPECT_THAT(spec.types, SizeIs(3));
  EXPECT_EQ(name_of(spec, 1), "model:1");
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_EQ(name_of(spec, i + 2), fmt::format("r{}", i));
    EXPECT_NEAR(spec.bodies[i + 2].pose_world_body.x, -1.9 + 0.4 * static_cast<double>(i / 6), 1e-9);
    EXPECT_NEAR(spec.bodies[i + 2].pose_world_body.y, -1 + 0.4 * static_cast<double>(i % 6), 1e-9);
  }
  EXPECT_EQ(spec.types[2].name, "swarmbot");
  EXPECT_THAT(get(ranger_table(), spec.types[2].devices[0].params, "transducers").records(), SizeIs(12));
  EXPECT_NEAR(beam_height(spec.types[2].devices[0]), 0.06, 1e-12);
  EXPECT_EQ(spec.types[2].controllers[0].kind, "expand");
}

TEST_F(StageLikeWorld, RobotsOfManyDevicesWithOlderAliases) {
  const auto spec = open("troupe/stage_styles/odometry.world");
  EXPECT_THAT(messages(), SizeIs(10));
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "cave", "r0", "r1", "r2"));
  EXPECT_THAT(part_names(type_of(spec, 2)),
              ElementsAre("", "ranger:0", "ranger:1", "ranger:2", "fiducial:0", "blobfinder:0"));
  EXPECT_EQ(transducer(type_of(spec, 2).devices[1], 0, "samples").integer(), 361);
  EXPECT_EQ(fiducial_of(spec, BodyId(2), 0), 1);
  EXPECT_EQ(fiducial_of(spec, BodyId(3), 0), 3);
}

// Choosing the reader.

TEST_F(StageTest, WorldsAreReadByTheirEnding) {
  const auto load_file = [this](const std::filesystem::path& file, const LoadOptions& options = {}) {
    Diagnostics diagnostics;
    auto spec = load_world(file, test_registry(), options, diagnostics);
    keep(diagnostics);
    return spec;
  };
  write("deep/a.world", "model()");
  EXPECT_THAT(load_file(folder() / "deep/a.world").bodies, SizeIs(2));
  LoadOptions options;
  options.search_path = {folder() / "deep"};
  EXPECT_THAT(load_file(folder() / "a.world", options).bodies, SizeIs(2));
  EXPECT_THAT(messages(), IsEmpty());
  load_file(folder() / "a.world");
  EXPECT_THAT(messages(), ElementsAre("a.world: error: there is no such file"));
  load_file(folder() / "deep.world");
  load_file(folder() / "a.txt");
  EXPECT_THAT(
      messages(),
      ElementsAre("deep.world: error: there is no such file",
                  "a.txt: error: the name of a world file must end in .world (Stage's syntax) or .json, "
                  "found \"a.txt\""));
  load_file(folder() / "deep");
  EXPECT_THAT(messages(), ElementsAre("deep: error: this is a folder, not a file"));
}

}  // namespace
}  // namespace troupe::worldio::stage_world_test
