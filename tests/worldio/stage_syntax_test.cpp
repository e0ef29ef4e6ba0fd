#include "engine/spec/names.hpp"
#include "tests/worldio/stage_fixture.hpp"

#include <fmt/format.h>

namespace troupe::worldio::stage_syntax_test {
namespace {

using engine::get;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Rules of Stage's syntax beside those of its parser's own tests (stage_parser_test.cpp).
class StageSyntax : public StageTest {};

// Tokens.

TEST_F(StageSyntax, OnlyBlanksAndTabsAreWhiteSpace) {
  EXPECT_THAT(load("\tmodel\t(\t)").bodies, SizeIs(2));
  load("model(\f)\n\v\n");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: error: unexpected byte 0x0c: this byte may be only in strings and comments",
                  "w.world:2: error: unexpected byte 0x0b: this byte may be only in strings and comments"));
}

TEST_F(StageSyntax, WordsHoldDigitsDotsDashesAndBrackets) {
  const auto spec = load("define a.b-c_d[0]9 model( name \"x\" )\na.b-c_d[0]9()\n");
  EXPECT_THAT(messages(), IsEmpty());
  EXPECT_EQ(name_of(spec, 1), "x");
  load("_a()");
  EXPECT_THAT(messages(),
              testing::Contains(
                  "w.world:1: error: unexpected '_': this character may be only in strings and comments"));
}

TEST_F(StageSyntax, TokensMayTouch) {
  const auto spec = load("model(name\"x\"pose [1 2 3 90]noblocks 1)model(name\"y\"#c\n)#d");
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "x", "y"));
  EXPECT_EQ(spec.bodies[1].pose_world_body.x, 1);
  EXPECT_THAT(type_of(spec, 1).parts[0].solids, IsEmpty());
}

TEST_F(StageSyntax, StringsHoldEverythingButALineEnd) {
  EXPECT_EQ(name_of(load("model( name \"gr\xc3\xb6\xc3\x9f \\e # ( ] {,;'\" )"), 1),
            "gr\xc3\xb6\xc3\x9f \\e # ( ] {,;'");
}

TEST_F(StageSyntax, TokensMayBeLong) {
  const std::string name(engine::k_most_name_bytes, 'n');
  const auto spec = load(fmt::format("# {0}{0}\ndefine {0} model( name \"{0}\" )\n{0}()\n", name));
  EXPECT_EQ(name_of(spec, 1), name);
}

// Properties.

TEST_F(StageSyntax, QuotedNumbersAreNumbers) {
  const auto spec = load("interval_sim \"50\"\nmodel( pose [\"1\" 2 \"3\" 0] )");
  EXPECT_EQ(spec.tick_s, 0.05);
  EXPECT_EQ(spec.bodies[1].pose_world_body, (Pose{1, 2, 3, 0}));
  load("interval_sim \"\"");
  EXPECT_THAT(messages(), ElementsAre(HasSubstr("\"interval_sim\" needs a number")));
}

TEST_F(StageSyntax, ATupleReplacesTheWholeOfAnEarlierOne) {
  const auto spec = load("define box model( size [1 2 3] )\nbox( size [4 5] )");
  EXPECT_THAT(messages(), ElementsAre(HasSubstr("with a height of 1 m")));
  EXPECT_EQ(type_of(spec, 1).parts[0].size, Eigen::Vector3d(4, 5, 1));
}

TEST_F(StageSyntax, NamesAreCaseSensitive) {
  load("Model()\nmodel( Color \"blue\" )");
  EXPECT_THAT(
      messages(),
      ElementsAre(
          "w.world:2: warning: a model has no property \"Color\"; the property is ignored (did you mean "
          "\"color\"?)",
          testing::AllOf(HasSubstr("w.world:1: error: \"Model\" is neither a model type"),
                         HasSubstr("(did you mean \"model\"?)"))));
}

TEST_F(StageSyntax, PropertiesAndChildrenMayMix) {
  const auto spec = load("model( model() name \"a\" model() size [1 1 2] model() )");
  EXPECT_THAT(part_names(type_of(spec, 1)), ElementsAre("", "model:0", "model:1", "model:2"));
  EXPECT_EQ(type_of(spec, 1).parts[1].pose_body_part.z, 2);  // what stands behind counts, too
  EXPECT_EQ(name_of(spec, 1), "a");
}

TEST_F(StageSyntax, TheParsersDebuggingAidIsAccepted) {
  load("test 1");
  EXPECT_THAT(
      messages(),
      ElementsAre("w.world:1: warning: properties without effect (docs/stage-worlds.md says why): test"));
}

// Macros.

TEST_F(StageSyntax, LaterLayersOverrideEarlierOnes) {
  const auto spec = load(
      "define base model( name \"base\" size [1 1 1] ranger_return 0.1 model( name \"b\" ) )\n"
      "define derived base( name \"derived\" size [2 2 2] model( name \"d\" ) )\n"
      "derived( name \"own\" model( name \"o\" ) )\nderived()\nbase()\n");
  EXPECT_THAT(body_names(spec), ElementsAre("_ground_model", "own", "derived", "base"));
  const engine::TypeSpec& own = type_of(spec, 1);
  EXPECT_EQ(own.parts[0].size, Eigen::Vector3d(2, 2, 2));
  EXPECT_EQ(own.parts[0].returns.ranger, 0.1f);
  EXPECT_THAT(part_names(own), ElementsAre("", "b", "d", "o"));  // children add up, the base's first
  EXPECT_EQ(own.parts[0].kind, "model");
}

TEST_F(StageSyntax, MacrosMayBeChildren) {
  const auto spec =
      load("define eye ranger( sensor( samples 3 ) )\ndefine bot position( eye() )\nbot( eye() )");
  EXPECT_THAT(part_names(type_of(spec, 1)), ElementsAre("", "ranger:0", "ranger:1"));
  EXPECT_EQ(alias(spec, "position:0"), BodyId());
  EXPECT_EQ(name_of(spec, 1), "position:0");  // the macro leaves no trace
}

// Includes.

TEST_F(StageSyntax, AbsoluteIncludesAreTakenAsTheyStand) {
  write("deep/a.inc", "include \"b.inc\"\n");  // relative to the world, not to the file that includes it
  write("b.inc", "model( name \"b\" )\n");
  EXPECT_EQ(name_of(load(fmt::format("include \"{}\"\n", (folder() / "deep/a.inc").string())), 1), "b");
  load("include \"~/a.inc\"\n");
  EXPECT_THAT(messages(),
              ElementsAre("w.world:1: error: cannot read the included file ~/a.inc: there is no such file"));
}

TEST_F(StageSyntax, AFileMayBeIncludedTwice) {
  write("a.inc", "model()\n");
  EXPECT_THAT(load("include \"a.inc\"\ninclude \"a.inc\"\n").bodies, SizeIs(3));
}

// Units.

TEST_F(StageSyntax, UnitsReachEveryValueThatHasOne) {
  const std::string text =
      "position( pose [{0} {0} {0} {1}] size [{0} {0} {0}] origin [{0} {0} {0} {1}] wheelbase {0} drive "
      "\"car\"\n"
      "  velocity_bounds [-{0} {0} 0 0 0 0 -{1} {1}]\n"
      "  ranger( sensor( pose [{0} {0} {0} {1}] size [{0} {0} {0}] range [{0} {0}] fov {1} ) ) )\n"
      "interval_sim 50 resolution 0.5 quit_time 3\n";
  const auto in_meters = load(fmt::format(fmt::runtime("unit_angle \"radians\"\n" + text), 2, 0.5));
  const auto in_cm =
      load(fmt::format(fmt::runtime("unit_length \"cm\" unit_angle \"radians\"\n" + text), 200, 0.5));
  const auto in_mm =
      load(fmt::format(fmt::runtime("unit_length \"mm\" unit_angle \"degrees\"\n" + text), 2000, 90 / k_pi));
  const auto same = [](const Pose& a, const Pose& b) {
    EXPECT_NEAR(a.x, b.x, 1e-12);
    EXPECT_NEAR(a.y, b.y, 1e-12);
    EXPECT_NEAR(a.z, b.z, 1e-12);
    EXPECT_NEAR(a.heading, b.heading, 1e-5);  // the text has six digits
  };
  for (const auto* other : {&in_cm, &in_mm}) {
    same(other->bodies[1].pose_world_body, in_meters.bodies[1].pose_world_body);
    const engine::TypeSpec& a = type_of(in_meters, 1);
    const engine::TypeSpec& b = type_of(*other, 1);
    EXPECT_TRUE(a.parts[0].size.isApprox(b.parts[0].size));
    EXPECT_NEAR(a.parts[0].solids[0].z.max, b.parts[0].solids[0].z.max, 1e-12);
    EXPECT_NEAR(a.parts[0].solids[0].contours[0][1].x(), b.parts[0].solids[0].contours[0][1].x(), 1e-4);
    const engine::FieldTable& drive = test_registry().drive("car")->params;
    for (const char* field : {"wheelbase", "velocity_min_x", "velocity_max_x", "turn_max"})
      EXPECT_NEAR(get(drive, a.drive->params, field).number(), get(drive, b.drive->params, field).number(),
                  1e-5)
          << field;
    // None of these is in a unit of the file's.
    EXPECT_EQ(other->tick_s, 0.05);
    EXPECT_EQ(other->resolution_m, 0.5);
    EXPECT_EQ(other->quit_time_s, 3);
  }
}

// Older files.

TEST_F(StageSyntax, ShortTuplesOfOlderRobotsAreRead) {
  const auto spec = load(
      "position( pose [1 2 90] size [0.5 0.4] origin [0.1 0 0]\n"
      "  ranger( pose [0.1 0 45] size [0.1 0.1] origin [0 0.1 0]\n"
      "    sensor( pose [0.01 0.02 30] size [0.01 0.05] ) ) )\n");
  std::vector<std::string> found = messages();
  EXPECT_THAT(found, testing::Each(HasSubstr("warning: old syntax: ")));
  EXPECT_EQ(spec.bodies[1].pose_world_body, (Pose{1, 2, 0, radians(90)}));
  const engine::TypeSpec& type = type_of(spec, 1);
  EXPECT_EQ(type.parts[0].size, Eigen::Vector3d(0.5, 0.4, 1));
  EXPECT_EQ(type.parts[1].size, Eigen::Vector3d(0.1, 0.1, 0.2));  // a ranger's height
  EXPECT_NEAR(type.parts[1].pose_body_part.heading, radians(45), 1e-15);
}

}  // namespace
}  // namespace troupe::worldio::stage_syntax_test
