#include "tests/apps/program.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/slow_build.hpp"

#include <fmt/format.h>

#include <utility>

namespace troupe::apps::lint_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

class LintTest : public ProgramTest {
 protected:
  /// The lines that a lint prints of a world in which it finds something.
  std::vector<std::string> findings(const std::string& name, std::string_view world) {
    write(name, world);
    const Outcome outcome = troupe({"lint", name});
    EXPECT_EQ(outcome.code, 1) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, IsEmpty());
    return lines_of(outcome.out);
  }
  void expect_nothing(const std::string& name, std::string_view world) {
    write(name, world);
    const Outcome outcome = troupe({"lint", name});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.out, name + ": nothing found\n");
    EXPECT_THAT(outcome.err, IsEmpty());
  }
};

/// A bitmap of three pixels, those on the left and on the right solid.
constexpr std::string_view k_gate("P5\n3 1\n255\n\0\377\0", 14);

/// A type of robot whose sensor a case describes, in a world with a wall of `wall` m and another robot.
std::string json_world(const std::string& sensor, const std::string& wall = "1") {
  return R"({ "troupe": 1, "types": {
    "wall": {"size_m": [0.2, 4, )" +
         wall + R"(]},
    "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}, "sensors": [
)" + sensor +
         R"( ]} },
  "models": [
    {"name": "wall", "type": "wall", "pose": {"x_m": 3}},
    {"name": "r0", "type": "bot"} ] })";
}

TEST_F(LintTest, FindsNothingInAWorldThatIsRight) {
  expect_nothing("eye.json", json_world(R"({"kind": "ranger", "transducers": [{"range_max_m": 5}]})"));
  expect_nothing("room.world",
                 "define bot position( size [0.4 0.4 0.3] ranger( sensor( range [0 5] ) alwayson 1 ) )\n"
                 "model( name \"wall\" pose [3 0 0 0] size [0.2 4 1] )\nbot( name \"r0\" )\n");
}

TEST_F(LintTest, MeasuresAndRecordedFieldsThatNoRunCanHaveAreErrors) {
  for (const auto& [keys, message] : std::vector<std::pair<std::string, std::string>>{
           {R"("measures": ["stalls:zz"])", "w.json:1: error: /measures/0: "},
           {R"("measures": ["stalls", "stalls"])", "w.json:1: error: /measures/1: "},
           {R"("stop_when": ["stalls:zz >= 1"])",
            "w.json:1: error: /stop_when/0: unknown type or population of robots \"zz\""},
           {R"("measures": [{"kind": "state_mean", "component": "lamp", "field": "x"}])",
            "w.json:1: error: /measures/0: "},
           {R"("record": {"file": "../run.h5"})",
            "w.json:1: error: /record/file: must be a file in or below "},
           {R"("record": {"fields": ["pose", "pos"]})", "w.json:1: error: /record/fields: "}}) {
    write("w.json", R"({"troupe": 1, "types": {"b": {"size_m": [1, 1, 1], "drive": {"kind": "diff"}}}, )"
                    R"("models": [{"name": "x", "type": "b"}], )" +
                        keys + "}");
    const Outcome outcome = troupe({"lint", "w.json"});
    EXPECT_EQ(outcome.code, 2) << keys << outcome.out;
    EXPECT_THAT(outcome.err, StartsWith(message));
  }
}

TEST_F(LintTest, ATypeThatGivesItsKindInheritsAllTheSame) {
  expect_nothing("kinds.json", R"({"troupe": 1, "types": {
    "base": {"kind": "position", "size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}},
    "bot": {"extends": "base", "kind": "model"}}, "models": [{"name": "r0", "type": "bot"}]})");
}

TEST_F(LintTest, FindsNothingInTheWorldsThatAreShipped) {
  for (const scenes::Run& run : scenes::runs_of("lint")) {
    const Outcome outcome = troupe({"lint", run.file().string()});
    EXPECT_EQ(outcome.code, 0) << outcome.out;
  }
}

TEST_F(LintTest, ReportsEachOverlapAndWhoStandsInAWall) {
  EXPECT_THAT(findings("w.world",
                       "position( name \"a\" )\n"
                       "position( name \"b\" pose [0.2 0 0 0] )\n"
                       "position( name \"c\" pose [0.3 0 0 0] )\n"
                       "model( name \"wall\" pose [5 0 0 0] size [2 2 1] )\n"
                       "position( name \"d\" pose [5 0 0 0] )\n"),
              ElementsAre("w.world:1: warning: \"a\" overlaps \"b\" at the start",
                          "w.world:1: warning: \"a\" overlaps \"c\" at the start",
                          "w.world:2: warning: \"b\" overlaps \"c\" at the start",
                          "w.world:5: warning: \"d\" overlaps the static body \"wall\" at the start",
                          "w.world: 4 findings"));
}

TEST_F(LintTest, CountsOverlapsBeyondAHundred) {
  std::string world;
  for (int i = 0; i < 20; ++i) world += "position( pose [0 0 0 0] )\n";
  const std::vector<std::string> lines = findings("w.world", world);
  EXPECT_EQ(lines.size(), 102u);
  EXPECT_THAT(lines, Contains(HasSubstr("90 more pairs of bodies overlap at the start")));
}

TEST_F(LintTest, ReportsFloorPlansThatBlockNothingAndWhoStandsInThem) {
  write("gate.pgm", k_gate);
  EXPECT_THAT(
      findings("w.world",
               "model( name \"cave\"\n  size [4 4 1] bitmap \"gate.pgm\"\n  obstacle_return 0 )\n"
               "position( name \"out\" )\n"
               "position( name \"in\" pose [-1.5 0 0 0] )\n"),
      ElementsAre(
          "w.world:1: warning: floor plan \"cave\" blocks no robot: it is not an obstacle",
          "w.world:5: warning: \"in\" overlaps a wall of floor plan \"cave\" at the start, and can drive "
          "through the wall, because the plan is no obstacle: move the robot, or make the plan an obstacle",
          "w.world: 2 findings"));
  EXPECT_THAT(
      findings("high.world",
               "model( name \"cave\" pose [5 0 3 0] size [4 4 1] bitmap \"gate.pgm\" )\n"
               "position( size [0.4 0.4 0.25] )\n"),
      ElementsAre(
          "high.world:1: warning: floor plan \"cave\" blocks no robot: its walls are at a height of 3 to 4 "
          "m, but the robots are at 0 to 0.25 m",
          "high.world: 1 finding"));
  EXPECT_THAT(
      findings("ghost.world",
               "model( name \"cave\" pose [5 0 0 0] size [4 4 1] bitmap \"gate.pgm\" )\n"
               "position( obstacle_return 0 )\n"),
      Contains("ghost.world:1: warning: floor plan \"cave\" blocks no robot: no robot is an obstacle, and "
               "only obstacles block one another"));
  expect_nothing("right.world", "model( size [4 4 1] bitmap \"gate.pgm\" )\nposition()\n");
}

TEST_F(LintTest, ReportsAWindowThatFollowsNoModel) {
  EXPECT_THAT(
      findings("w.world", "position( name \"r0\" )\nwindow( follow_model \"r1\" )\n"),
      ElementsAre("w.world: warning: the window follows the model \"r1\", but there is no such model: "
                  "correct the name",
                  "w.world: 1 finding"));
  expect_nothing("right.world", "position( name \"r0\" )\nwindow( follow_model \"r0\" )\n");
}

TEST_F(LintTest, ReportsFloorPlansInJson) {
  write("gate.pgm", k_gate);
  EXPECT_THAT(
      findings("w.json",
               R"({ "troupe": 1, "floorplans": [
  {"name": "cave", "bitmap": "gate.pgm", "size_m": [4, 4, 1], "margins": "keep", "obstacle": false} ],
  "types": {"bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}}},
  "models": [ {"name": "r0", "type": "bot"},
    {"name": "r1", "type": "bot", "pose": {"x_m": -1.5}} ] })"),
      ElementsAre(
          "w.json:2: warning: floor plan \"cave\" blocks no robot: it is not an obstacle",
          "w.json:5: warning: \"r1\" overlaps a wall of floor plan \"cave\" at the start, and can drive "
          "through the wall, because the plan is no obstacle: move the robot, or make the plan an obstacle",
          "w.json: 2 findings"));
}

TEST_F(LintTest, ReportsSensorsThatCanMeetNothing) {
  const std::string high =
      R"({"name": "eye", "kind": "ranger", "pose": {"z_m": 1.5}, "transducers": [{"range_max_m": 5}]})";
  EXPECT_THAT(findings("high.json", json_world(high)),
              ElementsAre("high.json:4: warning: sensor \"eye\" of \"bot\" sees nothing: it is at a height "
                          "of 1.5 m, but bodies that rangers see are at 0 to 1 m",
                          "high.json: 1 finding"));
  expect_nothing("tall.json", json_world(high, "2"));

  EXPECT_THAT(findings("near.json", json_world(R"({"name": "eye", "kind": "ranger", "pose": {"z_m": 0.1},
      "transducers": [{"range_max_mm": 5, "samples": 3}]})")),
              Contains(HasSubstr("sees nothing: its beams of at most 0.005 m end inside its own body")));

  EXPECT_THAT(findings("none.json", json_world(R"({"name": "eye", "kind": "ranger", "transducers": []})")),
              ElementsAre("none.json:4: warning: sensor \"eye\" of \"bot\" sees nothing: it has no beams",
                          "none.json: 1 finding"));

  // No robot sees itself; it does see another robot of its kind.
  const std::string alone =
      "define bot position( size [0.4 0.4 0.3]\n"
      "  ranger( pose [0 0 -0.2 0] sensor( range [0 5] ) ) )\nbot()\n";
  EXPECT_THAT(findings("alone.world", alone),
              ElementsAre("alone.world:2: warning: sensor \"ranger:0\" of \"bot\" sees nothing: no other "
                          "body that rangers see is at the height of the sensor, 0.11 m",
                          "alone.world: 1 finding"));
  expect_nothing("two.world", alone + "bot( pose [2 0 0 0] )\n");
  EXPECT_THAT(
      findings("invisible.world", alone + "model( pose [2 0 0 0] ranger_return -1 )\n"),
      Contains(HasSubstr("sees nothing: no other body that rangers see is at the height of the sensor")));
}

TEST_F(LintTest, ReportsRadiosThatCanHearNothing) {
  const auto world = [](const std::string& channel, int dogs) {
    return R"({ "troupe": 1, "types": {
    "dog": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}, "sensors": [
      {"name": "mouth", "kind": "radio", "range_m": 5, "channel": "bark"} ]},
    "sheep": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}, "sensors": [
      {"name": "ear", "kind": "radio", "range_m": 5, "channel": ")" +
           channel + R"("} ]} },
  "populations": [
    {"name": "d", "type": "dog", "count": )" +
           std::to_string(dogs) +
           R"(, "place": {"rule": "uniform", "region_m": [[0, 0], [9, 1]]}},
    {"name": "s", "type": "sheep", "count": 1, "place": {"rule": "uniform", "region_m": [[0, 4], [9, 9]]}} ] })";
  };
  expect_nothing("same.json", world("bark", 1));
  EXPECT_THAT(
      findings("other.json", world("barks", 2)),
      ElementsAre("other.json:5: warning: radio \"ear\" of \"sheep\" hears nothing: no other body has a "
                  "radio on the channel \"barks\"; other channels: \"bark\"",
                  "other.json: 1 finding"));
}

TEST_F(LintTest, ReportsWhatNamesATypeThatOnlyOtherTypesHaveAsTheirBase) {
  const auto world = [](const std::string& type, const std::string& robot) {
    return R"({ "troupe": 1, "quit_time_s": 60, "types": {
    "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}},
    "scout": {"extends": "bot"} },
  "models": [ {"name": ")" +
           robot + R"(", "type": "scout"} ],
  "at": [
    {"time_s": 1, "disable": {"type": ")" +
           type + R"("}},
    {"time_s": 2, "set": {"type": ")" +
           type + R"(", "drive": {"velocity_max_x_mps": 0.1}}} ],
  "faults": [
    {"type": ")" +
           type + R"(", "slow_wheels": {"factor": 0.5}} ],
  "measures": [
    "stalls:)" +
           type + R"("],
  "stop_when": [
    "stalls:)" +
           type + R"( > 0"] })";
  };
  expect_nothing("scout.json", world("scout", "r0"));
  const std::string why = ": no body has the type \"bot\"; bodies of a type that extends it do not count";
  const std::vector<std::string> of_groups{
      "bot.json:6: warning: this entry of \"at\" has no effect" + why,
      "bot.json:7: warning: this entry of \"at\" has no effect" + why,
      "bot.json:9: warning: this entry of \"faults\" has no effect" + why,
  };
  std::vector<std::string> all = of_groups;
  all.push_back("bot.json:11: warning: the measure \"stalls:bot\" covers no robot" + why);
  all.push_back("bot.json:13: warning: the condition on \"stalls:bot\" covers no robot" + why);
  all.emplace_back("bot.json: 5 findings");
  EXPECT_EQ(findings("bot.json", world("bot", "r0")), all);
  std::vector<std::string> without_measures = of_groups;
  without_measures.emplace_back("bot.json: 3 findings");
  EXPECT_EQ(findings("bot.json", world("bot", "bot1")), without_measures)
      << "a measure also finds the population of this name";
}

TEST_F(LintTest, ReportsGrippersThatCanHoldNothing) {
  const auto world = [](const std::string& puck, const std::string& bot) {
    return R"({ "troupe": 1, "types": {
    "bot": {"size_m": [0.4, 0.4, 0.3])" +
           bot + R"(, "drive": {"kind": "diff"}, "devices": [
      {"name": "hand", "kind": "gripper", "pose": {"x_m": 0.3}} ]},
    "puck": {"disc": {"radius_m": 0.05, "height_m": 0.1})" +
           puck + R"(} },
  "models": [
    {"name": "r0", "type": "bot"},
    {"name": "puck", "type": "puck", "pose": {"x_m": 3}} ] })";
  };
  const std::string is_gripped = R"(, "gripper_return": true)";
  expect_nothing("grip.json", world(is_gripped, ""));
  const std::string warning =
      "w.json:3: warning: gripper \"hand\" of \"bot\" can hold nothing: no other body has \"gripper_return\"";
  EXPECT_THAT(findings("w.json", world("", "")), ElementsAre(warning, "w.json: 1 finding"));
  EXPECT_THAT(findings("w.json", world("", is_gripped)), ElementsAre(warning, "w.json: 1 finding"))
      << "a gripper does not hold its own body";
}

TEST_F(LintTest, ReportsFiducialFindersThatCanFindNothing) {
  const auto world = [](const std::string& post, const std::string& finder, const std::string& z = "0") {
    return R"({ "troupe": 1, "types": {
    "post": {"size_m": [0.1, 0.1, 0.5])" +
           post + R"(},
    "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}, "fiducial_return": 1, "sensors": [
      {"name": "eye", "kind": "fiducial")" +
           finder + R"(} ]} },
  "models": [
    {"name": "post", "type": "post", "pose": {"x_m": 3, "z_m": )" +
           z + R"(}},
    {"name": "r0", "type": "bot"} ] })";
  };
  // No finder finds its own body.
  EXPECT_THAT(findings("none.json", world("", "")),
              ElementsAre("none.json:4: warning: sensor \"eye\" of \"bot\" sees nothing: no other body with "
                          "a fiducial_return has the fiducial_key of the finder, 0",
                          "none.json: 1 finding"));
  const std::string marked = ", \"fiducial_return\": 2";
  expect_nothing("post.json", world(marked, ""));
  EXPECT_THAT(
      findings("key.json", world(marked, ", \"key\": 3")),
      Contains(HasSubstr("no other body with a fiducial_return has the fiducial_key of the finder, 3")));
  expect_nothing("keys.json", world(marked + ", \"fiducial_key\": 3", ", \"key\": 3"));

  const std::string high = R"(, "pose": {"z_m": 0.9})";
  EXPECT_THAT(
      findings("high.json", world(marked, high)),
      Contains(HasSubstr(
          "sees nothing: it is at a height of 0.9 m, but bodies with a fiducial_return are at 0 to 0.5 m")));
  expect_nothing("flat.json", world(marked, high + ", \"ignore_zloc\": true"));
  // At this height there is but its own mark.
  EXPECT_THAT(
      findings("own.json", world(marked, R"(, "pose": {"z_m": 0.2})", "0.6")),
      Contains(HasSubstr(
          "sees nothing: no other body with a fiducial_return is at the height of the sensor, 0.2 m")));
}

// A finder counts only its own body once, at whatever heights other bodies of its type are.
TEST_F(LintTest, FiducialFindersFindBodiesOfTheirTypeAtOtherHeights) {
  expect_nothing("w.world",
                 "define bot position( size [0.4 0.4 0.3] fiducial_return 1\n"
                 "  fiducial( pose [0 0 -0.05 0] range_max 5 ) )\n"
                 "bot()\nbot( pose [2 0 0.2 0] )\n");
}

// If the heights of all marks were collected for each finder, this would take minutes.
TEST_F(LintTest, ManyFindersAmongManyMarksAreCheckedQuickly) {
  constexpr int k_types = test::k_slow_build ? 20 : 200;
  constexpr int k_posts = test::k_slow_build ? 100 : 1'000;
  std::string marks;
  std::string finders;
  for (int i = 0; i < 100; ++i) {
    marks += fmt::format(
        R"({}{{"name": "p{}", "size_m": [0.1, 0.1, 0.1], "obstacle": false, "fiducial_return": 1}})",
        i == 0 ? "" : ",", i);
    finders += fmt::format(R"({}{{"name": "f{}", "kind": "fiducial"}})", i == 0 ? "" : ",", i);
  }
  std::string types =
      fmt::format(R"("post": {{"size_m": [0.1, 0.1, 0.1], "obstacle": false, "parts": [{}]}})", marks);
  std::string models = R"({"name": "end", "type": "post"})";
  for (int i = 0; i < k_types; ++i) {
    types += fmt::format(R"(, "t{}": {{"size_m": [0.1, 0.1, 0.1], "sensors": [{}]}})", i, finders);
    models += fmt::format(R"(, {{"name": "r{0}", "type": "t{0}", "pose": {{"y_m": {1}}}}})", i, i + 1);
  }
  for (int i = 1; i < k_posts; ++i)
    models += fmt::format(R"(, {{"name": "m{0}", "type": "post", "pose": {{"x_m": {0}, "z_m": {1:.6f}}}}})",
                          i, 1e-6 * i);
  expect_nothing("marks.json",
                 fmt::format(R"({{"troupe": 1, "types": {{{}}}, "models": [{}]}})", types, models));
}

// A joint, here a lift, changes the heights of sensors and of bodies that sensors see.
TEST_F(LintTest, HeightsThatJointsMayChangeAreNotReported) {
  const std::string lift =
      "  actuator( name \"lift\" type \"linear\" axis [0 0 1] min_position 0 max_position 2 max_speed 1\n"
      "    size [0.2 0.2 0.1] ";
  const std::string robot = "position( size [0.4 0.4 0.4] stack_children 0\n";
  expect_nothing("ranger.world", robot + lift +
                                     "noblocks 1 start_position 1.5\n    ranger( pose [0 0 0.5 0] sensor( "
                                     "range [0 5] ) ) ) )\n"
                                     "model( pose [2 0 2 0] size [0.1 2 0.5] )\n");
  const std::string gate =
      "position( pose [2 0 0 0] size [0.4 0.4 0.4] stack_children 0\n" + lift + "fiducial_return 3 ) )\n";
  expect_nothing("seen.world", robot + "  ranger( pose [0 0 1 0] sensor( range [0 5] ) ) )\n" + gate);
  expect_nothing("marked.world", robot + "  fiducial( pose [0 0 1 0] ) )\n" + gate);
  // A robot does not see its own lift.
  EXPECT_THAT(findings("own.world", robot + "  ranger( pose [0 0 1 0] sensor( range [0 5] ) )\n" + lift +
                                        ") )\nmodel( pose [2 0 0 0] )\n"),
              Contains(HasSubstr("sees nothing: it is at a height of 1")));
}

TEST_F(LintTest, ReportsDefinitionsThatAreNotUsed) {
  EXPECT_THAT(findings("w.json", R"({ "troupe": 1, "types": {
    "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}},
    "crate": {"size_m": [1, 1, 1]} },
  "models": [ {"name": "r0", "type": "bot"} ] })"),
              ElementsAre("w.json:3: warning: type \"crate\" is never used", "w.json: 1 finding"));
  write("types.json", R"({"types": {"base": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}},
    "other": {"size_m": [1, 1, 1]}}})");
  write("unused.json", R"({"types": {"third": {"size_m": [1, 1, 1]}}})");
  EXPECT_THAT(findings("w.json", R"({ "troupe": 1, "include": ["types.json", "unused.json"], "types": {
    "middle": {"name": "half", "extends": "base"}, "bot": {"extends": "middle"}, "crate": {"size_m": [1, 1, 1]} },
  "models": [ {"name": "r0", "type": "bot"} ] })"),
              ElementsAre("w.json:2: warning: type \"crate\" is never used",
                          "unused.json:1: warning: type \"third\" is never used", "w.json: 2 findings"));

  write("parts.inc", "define wheel model( size [0.1 0.1 0.1] )\ndefine hub model( size [0.1 0.1 0.1] )\n");
  write("more.inc", "define nut model( size [0.1 0.1 0.1] )\ndefine bolt model( size [0.1 0.1 0.1] )\n");
  EXPECT_THAT(
      findings("w.world",
               "include \"parts.inc\"\ninclude \"more.inc\"\n"
               "define bot position( nut( pose [0 0 0 0] ) )\n"
               "define fast bot( velocity_bounds [-9 9 -9 9 -9 9 -90 90] )\n"
               "define slow bot( velocity_bounds [-1 1 -1 1 -1 1 -90 90] )\nslow()\n"),
      ElementsAre(
          "w.world:4: warning: macro \"fast\" is never used",
          "parts.inc: warning: nothing in this included file is used; the file defines 2 macros: remove the "
          "include",
          "w.world: 2 findings"));
}

TEST_F(LintTest, ReportsAFindingOfABaseTypeOnce) {
  EXPECT_THAT(findings("w.json", R"({ "troupe": 1, "types": {
    "base": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"},
      "sensors": [{"name": "eye", "kind": "ranger", "pose": {"z_m": 2}, "transducers": [{"range_max_m": 5}]}]},
    "a": {"extends": "base", "name": "Alpha"},
    "b": {"extends": "base", "size_m": [0.3, 0.3, 0.2]} },
  "models": [ {"name": "a0", "type": "a"},
    {"name": "b0", "type": "b", "pose": {"x_m": 3}} ] })"),
              ElementsAre(StartsWith("w.json:3: warning: sensor \"eye\" of \"Alpha\" sees nothing: "),
                          "w.json: 1 finding"));
}

TEST_F(LintTest, ReportsPropertiesWithoutEffectEachWhereItStands) {
  EXPECT_THAT(
      findings("w.world",
               "paused 1\n"
               "position( name \"a\" size [1 1 1]\n  blobs 3 friction 1\n  size [0.4 0.4 0.4] )\n"
               "position( name \"b\" pose [2 0 0 0] friction 1\n  wheelbase 2 )\n"
               "position( name \"c\" pose [4 0 0 0] drive \"car\" wheelbase 2 )\n"
               "model( pose [6 0 0 0] color \"blue\"\n  color_rgba [0 1 0 1]\n  alwayson 1\n"
               "  update_interval 200\n  scount 3 )\n"
               "fiducial( pose [8 0 0 0] alwayson 1 update_interval 200 )\n"),
      ElementsAre(
          "w.world:1: warning: paused: this property affects only Stage's window",
          "w.world:2: warning: \"size\" has no effect: line 4 sets it again",
          "w.world:3: warning: a position has no property \"blobs\"; the property is ignored",
          "w.world:3: warning: friction: this property has no effect in Troupe",
          "w.world:5: warning: friction: this property has no effect in Troupe",
          "w.world:6: warning: \"wheelbase\" has no effect: only a model with drive \"car\" has a wheelbase",
          "w.world:9: warning: \"color_rgba\" has no effect: \"color\" is also given",
          "w.world:10: warning: \"alwayson\" has no effect: this model is not a sensor itself (set it in the "
          "sensor)",
          "w.world:11: warning: \"update_interval\" has no effect: this model is not a device itself and has "
          "no "
          "drive (set it in the device)",
          "w.world:12: warning: old syntax: \"scount\" is ignored, as in Stage: write a sensor( pose [0.1 0 "
          "0 90] "
          "range [0 5] fov 15 ) for each transducer",
          "w.world:13: warning: sensor \"fiducial\" sees nothing: no other body with a fiducial_return has "
          "the fiducial_key of the finder, 0",
          "w.world: 11 findings"));
}

TEST_F(LintTest, ReportsTheMarginsThatAreCutFromAPlan) {
  // 6 x 4 pixels, of which the solid ones are within 3 columns and 4 rows.
  const std::string plan =
      "P2\n6 4\n255\n255 0 0 0 255 255\n255 0 255 0 255 255\n255 0 255 0 255 255\n255 0 0 0 255 255\n";
  write("plan.pgm", plan);
  const std::string robot = "position( name \"r\" pose [9 9 0 0] size [0.4 0.4 0.4] )\n";
  EXPECT_THAT(
      findings("w.world", robot + "model( bitmap \"plan.pgm\" size [12 8 1] )\n"),
      ElementsAre(
          "w.world:2: warning: the white margins of the image plan.pgm are cut off, as in Stage: 3 of its "
          "6 columns; the walls grow by a factor of 2 in x; \"bitmap_margins 1\" keeps the margins",
          "w.world: 1 finding"));
  expect_nothing("kept.world", robot + "model( bitmap \"plan.pgm\" size [12 8 1] bitmap_margins 1 )\n");
  expect_nothing("meant.world", robot + "model( bitmap \"plan.pgm\" size [12 8 1] bitmap_margins 0 )\n");
  write("full.pgm", "P5 2 2 255\n" + std::string("\0\377\377\0", 4));
  expect_nothing("full.world", robot + "model( bitmap \"full.pgm\" size [12 8 1] )\n");
  const auto json = [](const std::string& margins) {
    return R"({"troupe": 1, "floorplans": [{"name": "f", "bitmap": "plan.pgm", "size_m": [12, 8, 1])" +
           margins + "}]}";
  };
  EXPECT_THAT(
      findings("w.json", json("")),
      ElementsAre(
          "w.json:1: warning: /floorplans/0/bitmap: the white margins of the image plan.pgm are cut off, "
          "as in Stage: 3 of its 6 columns; the walls grow by a factor of 2 in x; \"margins\": \"keep\" "
          "keeps the margins",
          "w.json: 1 finding"));
  expect_nothing("kept.json", json(R"(, "margins": "keep")"));
  expect_nothing("meant.json", json(R"(, "margins": "trim")"));
}

TEST_F(LintTest, ReportsPropertiesThatNeedAnother) {
  write("again.inc", "size [0.4 0.4 0.4]\n");
  EXPECT_THAT(
      findings("w.world",
               "define eye sensor( range [0 5] pose [0 0 -0.2 0] )\n"
               "position( pose [0 0 0 0] size [0.4 0.4 0.4]\n"
               "  laser( noise [0.1 0 0]\n    beam_width 3\n    apply_range_min 1\n    eye() ) )\n"
               "position( pose [2 0 0 0] size [0.4 0.4 0.4] odom_error [0.1 0.1 0 1]\n"
               "  gps_origin 1\n  bitmap_margins 1\n  bitmap_unknown 1 )\n"
               "position( pose [4 0 0 0] size [0.4 0.4 0.4] localization \"odom\"\n"
               "  gps_origin 1 odom_error [0.1 0.1 0 1]\n"
               "  blobfinder( colors [\"red\"] )\n  blobfinder( colors_count 1 ) )\n"
               "position( pose [6 0 0 0] size [1 1 1]\ninclude \"again.inc\"\n)\n"
               "window( size [100 100] )\nwindow( size [200 200] )\n"),
      ElementsAre(
          "w.world:3: warning: \"noise\" has no effect: in a model with sensor( ) blocks, only the "
          "properties "
          "in these blocks count",
          "w.world:4: warning: \"beam_width\" has no effect: in a model with sensor( ) blocks, only the "
          "properties in these blocks count",
          "w.world:5: warning: \"apply_range_min\" has no effect: in a model with sensor( ) blocks, only the "
          "properties in these blocks count",
          "w.world:7: warning: \"odom_error\" has no effect: only a model with localization \"odom\" has "
          "errors of odometry",
          "w.world:8: warning: \"gps_origin\" has no effect: \"localization_origin\" is not given",
          "w.world:9: warning: \"bitmap_margins\" has no effect: this model has no \"bitmap\"",
          "w.world:10: warning: \"bitmap_unknown\" has no effect: this model has no \"bitmap\"",
          "w.world:12: warning: \"gps_origin\" has no effect: only a model with localization \"gps\" has a "
          "\"gps_origin\"",
          "w.world:13: warning: \"colors\" has no effect: it needs \"colors_count\", the number of these "
          "colours that the blobfinder reports",
          "w.world:14: warning: \"colors_count\" has no effect: \"colors\" is not given",
          "w.world:15: warning: \"size\" has no effect: again.inc:1 sets it again",
          "w.world:19: warning: this window has no effect: the first window, at line 18, is used",
          "w.world: 12 findings"));
}

TEST_F(LintTest, ReportsEveryWindowAfterTheFirst) {
  EXPECT_THAT(
      findings("w.world",
               "position( size [0.4 0.4 0.4] )\n"
               "window( size [100 100] )\n"
               "window( size [100 100] show_flags 1 )\nwindow( size [100 100] )\n"),
      ElementsAre("w.world:3: warning: show_flags of a window: this property affects only Stage's window",
                  "w.world:3: warning: this window has no effect: the first window, at line 2, is used",
                  "w.world:4: warning: this window has no effect: the first window, at line 2, is used",
                  "w.world: 3 findings"));
}

TEST_F(LintTest, EverySensorAndDeviceMayRunByItselfAtItsOwnPace) {
  expect_nothing("w.world",
                 "position( size [0.4 0.4 0.4]\n"
                 "  fiducial( alwayson 1 update_interval 200 )\n"
                 "  blobfinder( alwayson 1 update_interval 200 size [0.1 0.1 0.1] )\n"
                 "  bumper( alwayson 1 update_interval 200 size [0.1 0.1 0.1] bcount 1 blength 0.1 )\n"
                 "  camera( alwayson 1 update_interval 200 )\n"
                 "  gripper( alwayson 1 update_interval 200 pose [0.4 0 0 0] )\n"
                 "  actuator( alwayson 1 update_interval 200 pose [-0.1 0 1 0] size [0.1 0.1 0.1] )\n"
                 "  blinkenlight( alwayson 1 update_interval 200 pose [-0.1 0.1 0 0] ) )\n"
                 "model( pose [5 0 0 0] fiducial_return 1 gripper_return 1 )\n");
  expect_nothing("energy.world",
                 "position( size [0.4 0.4 0.4] joules_capacity 100 alwayson 1\n"
                 "  model( size [0.1 0.1 0.1] take_watts 50 alwayson 1 ) )\n"
                 "position( pose [2 0 0 0] size [0.4 0.4 0.4] kjoules_capacity 1 alwayson 1\n"
                 "  model( size [0.1 0.1 0.1] give_watts 50 alwayson 1 ) )\n");
}

TEST_F(LintTest, RunsTellOnceWhatALintTellsEachTime) {
  write("w.world",
        "define unused model()\nposition( name \"a\" friction 1 )\nposition( name \"b\" pose [2 0 0 0] "
        "friction 1 )\n");
  const Outcome outcome = troupe({"run", "w.world", "--for", "0"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, Not(HasSubstr("unused")));
  EXPECT_THAT(outcome.err, HasSubstr("w.world:2: warning: properties without effect"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("w.world:3")));
}

TEST_F(LintTest, AWorldThatCannotBeLoadedIsNoFinding) {
  write("bad.world", "position( size [0 1 1] )\n");
  Outcome outcome = troupe({"lint", "bad.world"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, HasSubstr("bad.world:1: error: \"size\" must be above 0"));

  write("overlap.json", R"({ "troupe": 1, "types": {"bot": {"size_m": [1, 1, 1], "pushable": true}},
  "models": [ {"name": "a", "type": "bot"}, {"name": "b", "type": "bot"} ] })");
  outcome = troupe({"lint", "overlap.json"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("overlap.json:2: error: /models/1: \"b\" overlaps \"a\" by 0.5 m at the start"));

  write("blind.json", json_world(R"({"kind": "ranger", "transducers": [{"range_max_m": 0}]})"));
  outcome = troupe({"lint", "blind.json"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("blind.json:4: error: "));

  EXPECT_EQ(troupe({"lint", "none.world"}).code, 2);
  EXPECT_EQ(troupe({"lint"}).code, 2);
  EXPECT_EQ(troupe({"lint", "bad.world", "--for", "3"}).code, 2);
}

TEST_F(LintTest, ReportsInterventionsAfterTheEndOfTheRun) {
  const auto world = [](const std::string& time_s) {
    return R"({ "troupe": 1, "tick_s": 0.1, "quit_time_s": 10,
  "types": {"dog": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}}},
  "models": [{"name": "rex", "type": "dog"}],
  "at": [
    {"time_s": 3, "disable": {"model": "rex"}},
    {"time_s": )" +
           time_s + R"(, "enable": {"model": "rex"}} ] })";
  };
  expect_nothing("in_time.json", world("10"));
  EXPECT_THAT(
      findings("late.json", world("12.5")),
      ElementsAre(
          "late.json:6: warning: this entry of \"at\" has no effect unless --for makes the run longer: "
          "its time is 12.5 s, but \"quit_time_s\" ends the run at 10 s",
          "late.json: 1 finding"));
  const std::string whole = world("10");
  const std::string late =
      whole.substr(0, whole.rfind('}')) +
      R"(, "faults": [{"model": "rex", "from_s": 11, "slow_wheels": {"factor": 0.5}}] })";
  EXPECT_THAT(
      findings("late_fault.json", late),
      ElementsAre(
          HasSubstr("this entry of \"faults\" has no effect unless --for makes the run longer: it begins "
                    "at 11 s, but \"quit_time_s\" ends the run at 10 s"),
          "late_fault.json: 1 finding"));
}

TEST_F(LintTest, ReportsPeriodsOfControllersThatHaveNoEffect) {
  const auto world = [](const std::string& period, const std::string& of_sensor) {
    return R"({ "troupe": 1, "tick_s": 0.1, "types": {"bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"},
  "sensors": [{"name": "eye", "kind": "ranger", "period_s": )" +
           of_sensor +
           R"(, "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 5, "fov_deg": 90, "samples": 9}]}],
  "controller": {"kind": "wander", "period_s": )" +
           period + R"(} }},
  "models": [{"name": "r0", "type": "bot"}, {"name": "r1", "type": "bot", "pose": {"x_m": 3}}] })";
  };
  expect_nothing("same.json", world("0.5", "0.5"));
  expect_nothing("none.json", world("0", "0.5"));
  EXPECT_THAT(
      findings("other.json", world("0.5", "0.2")),
      ElementsAre("other.json:3: warning: the period of 0.5 s of the controller \"wander\" of \"bot\" has no "
                  "effect: the controller runs whenever its first device \"eye\" has run, every 0.2 s",
                  "other.json: 1 finding"));
}

TEST_F(LintTest, ReportsInterventionsThatAddSeveralBodiesAtOnePose) {
  const auto world = [](const std::string& count, const std::string& obstacle = "true") {
    return R"({ "troupe": 1, "tick_s": 0.1,
  "types": {"dog": {"size_m": [0.4, 0.4, 0.3], "obstacle": )" +
           obstacle + R"(, "drive": {"kind": "diff"}}},
  "populations": [{"name": "d", "type": "dog", "count": 1, "reserve": 5,
    "place": {"rule": "grid", "region_m": [[0, 0], [0, 0]], "pitch_m": 1}}],
  "at": [
    {"time_s": 3, "add": {"population": "d", )" +
           count + R"("pose": {"x_m": 4}}} ] })";
  };
  expect_nothing("one.json", world("\"count\": 1, "));
  expect_nothing("through.json", world("", "false"));
  for (const auto& [count, number] : {std::pair("", "5"), std::pair("\"count\": 2, ", "2")})
    EXPECT_THAT(
        findings("many.json", world(count)),
        ElementsAre(fmt::format("many.json:6: warning: this entry of \"at\" would add {} bodies at the "
                                "same pose, where only one has room: give \"count\": 1, or "
                                "\"region_m\" in place of \"pose\"",
                                number),
                    "many.json: 1 finding"));
}

TEST_F(LintTest, ReportsControllersThatReactBeyondTheRangeOfTheirRanger) {
  const auto world = [](const std::string& controller) {
    return R"({ "troupe": 1, "types": {"zone": {"size_m": [1, 1, 0.001], "obstacle": false, "ranger_return": -1},
  "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}, "sensors": [{"name": "eye", "kind": "ranger", "pose": {"z_m": 0.1},
    "transducers": [{"range_max_m": 0.5, "fov_deg": 180, "samples": 11}]},
    {"name": "radio", "kind": "radio", "range_m": 5}, {"name": "floor", "kind": "ground"}],
  "controller": {"kind": )" +
           controller + R"(} }},
  "models": [{"name": "z", "type": "zone"}, {"name": "r0", "type": "bot"}, {"name": "r1", "type": "bot", "pose": {"x_m": 3}}] })";
  };
  for (const std::string kind : {"beeclust", "chain", "clustering", "collective_perception", "gradient",
                                 "informed_aggregation", "wander"}) {
    SCOPED_TRACE(kind);
    const std::string named = "\"" + kind + "\", \"min_front_m\": ";
    expect_nothing("near.json", world(named + "0.5"));
    EXPECT_THAT(
        findings("far.json", world(named + "0.6")),
        ElementsAre(fmt::format("far.json:5: warning: the controller \"{}\" of \"bot\" always sees an "
                                "obstacle ahead: it turns away while a reading ahead is below its "
                                "\"min_front\" of 0.6 m, but its ranger reads at most 0.5 m there",
                                kind),
                    "far.json: 1 finding"));
  }
  EXPECT_THAT(
      findings("stop.json", world(R"("wander", "min_front_m": 0.4, "stop_m": 0.6)")),
      Contains(HasSubstr("is below its \"stop\" of 0.6 m, but its ranger reads at most 0.5 m there")));

  // A reading must exceed the clearance.
  expect_nothing("expand.json", world(R"("expand", "clearance_m": 0.49)"));
  EXPECT_THAT(
      findings("wide.json", world(R"("expand", "clearance_m": 0.5)")),
      ElementsAre(
          "wide.json:5: warning: the controller \"expand\" of \"bot\" never drives: it drives only while "
          "the reading of each beam exceeds the clearance of the beam, but a beam with a clearance of "
          "0.5 m reads at most 0.5 m",
          "wide.json: 1 finding"));
  EXPECT_THAT(findings("list.json", world(R"("expand", "clearances_m": [0.8])")),
              Contains(HasSubstr("a beam with a clearance of 0.8 m reads at most 0.5 m")));
}

TEST_F(LintTest, ReportsDrivesThatCannotStandStill) {
  const auto world = [](const std::string& drive) {
    return R"({ "troupe": 1, "types": {"bot": {"size_m": [0.4, 0.4, 0.3],
    "drive": {)" +
           drive + R"(} }},
  "models": [{"name": "r0", "type": "bot"}] })";
  };
  expect_nothing("one_way.json",
                 world(R"("kind": "diff", "velocity_min_x_mps": 0, "velocity_max_x_mps": 0.2)"));
  expect_nothing("turret.json", world(R"("kind": "diff", "velocity_min_x_mps": 0, "velocity_max_x_mps": 0)"));
  EXPECT_THAT(findings("zero.json", world(R"("kind": "diff", "velocity_max_x_mps": 0)")),
              ElementsAre("zero.json:2: warning: the drive \"diff\" of \"bot\" can only drive backwards: its "
                          "limits exclude forward speeds",
                          "zero.json: 1 finding"));
  EXPECT_THAT(findings("back.json", world(R"("kind": "diff", "velocity_max_x_mps": -0.5)")),
              ElementsAre("back.json:2: warning: the drive \"diff\" of \"bot\" cannot stand still: if the "
                          "command is 0, its limits give a forward speed of -0.5 m/s",
                          "back.json: 1 finding"));
  EXPECT_THAT(
      findings("plane.json", world(R"("kind": "omni", "velocity_min_y_mps": 0.25, "turn_min_radps": 0.5)")),
      Contains(HasSubstr("its limits give a speed to the left of 0.25 m/s and a turn rate of 0.5 rad/s")));
  EXPECT_THAT(findings("car.json", world(R"("kind": "car", "velocity_min_x_mps": 0.5)")),
              Contains(HasSubstr("the drive \"car\" of \"bot\" cannot stand still: if the command is 0, its "
                                 "limits give a forward speed of 0.5 m/s")));
}

TEST_F(LintTest, NamesABodyThatIsItselfADeviceByItsType) {
  EXPECT_THAT(
      findings("own.json", R"({ "troupe": 1, "types": {
    "mast": {"size_m": [0.2, 0.2, 1], "device": {"kind": "radio", "range_m": 5, "channel": "c"}},
    "hand": {"device": {"kind": "gripper"}},
    "cell": {"size_m": [0.2, 0.2, 0.2], "device": {"kind": "power_pack"}},
    "eye": {"size_m": [0.2, 0.2, 0.2], "device": {"kind": "fiducial"}} },
  "models": [{"name": "m", "type": "mast"}, {"name": "h", "type": "hand", "pose": {"x_m": 1}},
             {"name": "c", "type": "cell", "pose": {"x_m": 2}}, {"name": "e", "type": "eye", "pose": {"x_m": 3}}] })"),
      ElementsAre(
          HasSubstr(":2: warning: radio of \"mast\" hears nothing: no other body has a radio on the channel"),
          HasSubstr(":3: warning: gripper of \"hand\" can hold nothing: "),
          HasSubstr(":4: warning: power_pack of \"cell\" can hold no energy: "),
          HasSubstr(":5: warning: sensor \"eye\" sees nothing: "), "own.json: 4 findings"));
}

TEST_F(LintTest, ReportsPowerPacksThatCanHoldNoEnergy) {
  const auto world = [](const std::string& pack) {
    return R"({ "troupe": 1, "types": {"bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"},
    "devices": [{"name": "pack", "kind": "power_pack", "mass_kg": 1)" +
           pack + R"(}] }},
  "models": [{"name": "r0", "type": "bot"}] })";
  };
  EXPECT_THAT(
      findings("none.json", world("")),
      ElementsAre("none.json:2: warning: \"pack\" of \"bot\" can hold no energy: its capacity is 0 J, "
                  "so everything that it supplies is stopped for the whole run",
                  "none.json: 1 finding"));
  expect_nothing("full.json", world(R"(, "capacity_J": 100)"));
  expect_nothing("empty.json", world(R"(, "capacity_J": 100, "stored_J": 0)"));  // it may be charged
  expect_nothing("infinite.json", world(R"(, "infinite": true)"));
  expect_nothing("stage.json", world(R"(, "when_empty": "nothing")"));
}

TEST_F(LintTest, ReportsPowerContactsThatExchangeNothing) {
  const auto world = [](const std::string& dock, const std::string& bot, const std::string& keys = "") {
    return R"({ "troupe": 1, "tick_s": 0.1, "types": {
    "dock": {"size_m": [0.4, 0.4, 0.1], "obstacle": false, "devices": [{"name": "mains", "kind": "power_pack", "infinite": true}
      )" + dock +
           R"(]},
    "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}, "devices": [{"name": "pack", "kind": "power_pack", "capacity_J": 9}],
      "parts": [{"name": "tip")" +
           bot + R"(}]} },
  "models": [{"name": "d", "type": "dock", "pose": {"x_m": 3}}, {"name": "r0", "type": "bot"}])" +
           keys + " }";
  };
  const auto contact = [](const std::string& powers) {
    return R"({"name": "contact", "kind": "power_contact")" + powers + "}";
  };
  const auto on_tip = [&](const std::string& powers,
                          const std::string& size = R"(, "size_m": [0.1, 0.1, 0.1])") {
    return size + R"(, "devices": [)" + contact(powers) + "]";
  };
  const std::string gives = ", " + contact(R"(, "give_W": 5)");
  const std::string takes = R"(, "take_W": 5)";
  expect_nothing("right.json", world(gives, on_tip(takes)));
  const std::string of_dock =
      "w.json:3: warning: power contact \"contact\" of \"dock\" exchanges no energy: ";
  const std::string of_bot = "w.json:5: warning: power contact \"contact\" of \"bot\" exchanges no energy: ";
  EXPECT_THAT(
      findings("w.json", world(gives, "")),
      ElementsAre(of_dock + "no other body has a power contact with \"take_W\"", "w.json: 1 finding"));
  EXPECT_THAT(findings("w.json", world("", on_tip(takes))),
              ElementsAre(of_bot + "no other body has a power contact with \"give_W\"", "w.json: 1 finding"));
  EXPECT_THAT(findings("w.json", world("", on_tip(takes + R"(, "give_W": 5)"))),
              ElementsAre(of_bot + "no other body has a power contact", "w.json: 1 finding"));
  EXPECT_THAT(
      findings("w.json", world(gives + R"(, {"name": "more", "kind": "power_contact"})", on_tip(takes))),
      ElementsAre("w.json:3: warning: power contact \"more\" of \"dock\" exchanges no energy: it has neither "
                  "\"give_W\" nor \"take_W\"",
                  "w.json: 1 finding"));
  expect_nothing(
      "later.json",
      world(
          gives, on_tip(""),
          R"(, "at": [{"time_s": 1, "set": {"type": "bot", "device": {"name": "contact", "take_W": 5}}}])"));
  EXPECT_THAT(
      findings("w.json", world(gives, on_tip(takes, ""))),
      ElementsAre(of_bot +
                      "the part that carries it has no shape, so that nothing touches it: give the part a "
                      "size, or mount the contact on another part",
                  "w.json: 1 finding"));
  EXPECT_THAT(
      findings("own.json", R"({ "troupe": 1, "types": {
    "dock": {"device": {"kind": "power_contact", "give_W": 5}, "devices": [{"kind": "power_pack", "infinite": true}]},
    "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}, "devices": [
      {"kind": "power_pack", "capacity_J": 9}, {"kind": "power_contact", "take_W": 5}]} },
  "models": [{"name": "d", "type": "dock"}, {"name": "r0", "type": "bot"}] })"),
      ElementsAre(HasSubstr("power contact of \"dock\" exchanges no energy: the part that carries it has no "
                            "shape"),
                  "own.json: 1 finding"));
}

TEST_F(LintTest, ReportsSensorsWithoutLightsGroundAndColours) {
  const auto world = [](const std::string& other, const std::string& z = "0") {
    return R"({ "troupe": 1, "types": {
    "other": {"size_m": [0.4, 0.4, 0.05], )" +
           other + R"(},
    "bot": {"size_m": [0.4, 0.4, 0.3], "color": "red", "drive": {"kind": "diff"}, "sensors": [
      {"name": "bright", "kind": "light_sensor"},
      {"name": "floor", "kind": "ground"},
      {"name": "eye", "kind": "blobfinder", "colors": ["blue"]} ]} },
  "models": [{"name": "o", "type": "other", "pose": {"x_m": 3, "z_m": )" +
           z + R"(}}, {"name": "r0", "type": "bot"}] })";
  };
  const std::string light = R"(, "devices": [{"kind": "blinkenlight"}])";
  expect_nothing("right.json", world(R"("color": "blue")" + light));
  EXPECT_THAT(
      findings("w.json", world(R"("color": "blue")")),
      ElementsAre("w.json:4: warning: sensor \"bright\" of \"bot\" sees nothing: no other body has a light, "
                  "such as a \"blinkenlight\"",
                  "w.json: 1 finding"));
  EXPECT_THAT(
      findings("w.json", world(R"("color": "blue")" + light, "0.01")),
      ElementsAre(
          "w.json:5: warning: sensor \"floor\" of \"bot\" sees only the bare floor: no other body has a "
          "part whose top is at most 0.05 m above the floor, its \"height\"",
          "w.json: 1 finding"));
  EXPECT_THAT(
      findings("w.json", world(R"("color": "green")" + light)),
      ElementsAre(
          "w.json:6: warning: sensor \"eye\" of \"bot\" sees nothing: no body has one of the colours in "
          "its \"colors\"",
          "w.json: 1 finding"));
  expect_nothing("led.json", world(R"("devices": [{"kind": "blinkenlight"}, {"kind": "led"}])"));
}

TEST_F(LintTest, ReportsColoursThatADeviceHides) {
  const auto world = [](const std::string& type, const std::string& model = "") {
    return R"({ "troupe": 1, "types": {
    "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}, )" +
           type + R"(} },
  "models": [{"name": "r0", "type": "bot")" +
           model + R"(}, {"name": "r1", "type": "bot", "pose": {"x_m": 2}}] })";
  };
  const std::string lamp = R"("devices": [
    {"name": "lamp", "kind": "led"}])";
  const std::string hidden =
      "w.json:3: warning: the \"color\" [1, 0, 0] has no effect on the part with led \"lamp\" of \"bot\", "
      "which gives the part its own colour, [1, 1, 1] at the start: give the device the colour, or a part of "
      "its own";
  EXPECT_THAT(findings("w.json", world(R"("color": "red", )" + lamp)),
              ElementsAre(hidden, "w.json: 1 finding"));
  EXPECT_THAT(findings("w.json", world(lamp, R"(, "color": "red")")),
              ElementsAre(hidden, "w.json: 1 finding"));
  EXPECT_THAT(findings("w.json", world(R"("color": "blue", "parts": [{"name": "top", "color": "red",
    "size_m": [0.1, 0.1, 0.1], "devices": [{"name": "lamp", "kind": "led"}]}])")),
              ElementsAre(hidden, "w.json: 1 finding"));
  // The default colour, that of the LED, an LED with a chosen colour, and a colour that another part shows.
  expect_nothing("w.json", world(lamp));
  expect_nothing("w.json", world(R"("color": "white", )" + lamp));
  expect_nothing("w.json", world(R"("color": "red", "devices": [{"kind": "led", "shows": [0, 0, 1]}])"));
  expect_nothing("w.json",
                 world(R"("color": "red", "parts": [{"name": "top", "size_m": [0.1, 0.1, 0.1]}], )" + lamp));
  expect_nothing("w.json", world(R"("color": "red", "parts": [{"name": "top", "size_m": [0.1, 0.1, 0.1],
    "devices": [{"kind": "led"}]}])"));
}

TEST_F(LintTest, InterventionsMayChangeWhatSensorsAndControllersLookFor) {
  const auto world = [](const std::string& setting) {
    return R"({ "troupe": 1, "bounds_m": [[-5, -5], [5, 5]], "types": {
    "other": {"size_m": [0.4, 0.4, 0.1], "color": "green", "fiducial_return": 3},
    "bot": {"size_m": [0.4, 0.4, 0.3], "color": "red", "drive": {"kind": "diff"}, "sensors": [
      {"name": "floor", "kind": "ground", "height_m": 0.06},
      {"name": "eye", "kind": "blobfinder", "colors": ["blue"]},
      {"name": "finder", "kind": "fiducial", "key": 2},
      {"name": "ray", "kind": "ranger", "transducers": [{"range_max_m": 0.1}]} ],
      "controller": {"kind": "waypoints", "goals": [{"x_m": 7}]} } },
  "models": [{"name": "o", "type": "other", "pose": {"x_m": 3}}, {"name": "r0", "type": "bot"}],
  "at": [{"time_s": 5, "set": {"type": "bot", )" +
           setting + "}}] }";
  };
  const auto device = [](const std::string& name, const std::string& params) {
    return R"("device": {"name": ")" + name + "\", " + params + "}";
  };
  const std::string goal = "\"waypoints\" of \"bot\" never reaches its goal 1";
  const std::vector<std::pair<std::string, std::string>> cases{
      {device("floor", R"("height_m": 1)"), "\"floor\" of \"bot\" sees only the bare floor"},
      {device("eye", R"("colors": ["green"])"), "no body has one of the colours"},
      {device("finder", R"("key": 0)"), "has the fiducial_key of the finder, 2"},
      {device("ray", R"("transducers": [{"range_max_m": 9}])"),
       "beams of at most 0.1 m end inside its own body"},
      {R"("controller": {"kind": "waypoints", "goals": [{"x_m": 3}]})", goal}};
  for (const auto& [setting, changed] : cases) {
    const std::vector<std::string> lines = findings("w.json", world(setting));
    EXPECT_EQ(lines.size(), cases.size()) << setting;  // four findings and the line that counts them
    EXPECT_THAT(lines, Not(Contains(HasSubstr(changed))));
  }
  // Another parameter of the same device changes nothing of the finding.
  EXPECT_THAT(findings("w.json", world(device("eye", R"("range_m": 3)"))),
              Contains(HasSubstr("no body has one of the colours")));
}

TEST_F(LintTest, InterventionsMayChangeRadiosDrivesAndDistances) {
  const auto world = [](const std::string& at) {
    return R"({ "troupe": 1, "types": {
    "a": {"size_m": [0.4, 0.4, 0.3], "sensors": [{"name": "r", "kind": "radio", "channel": "x"}]},
    "b": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff", "velocity_min_x_mps": 0.1}, "sensors": [
        {"name": "r", "kind": "radio", "channel": "y"},
        {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 0.5, "fov_deg": 90, "samples": 9}]}],
      "controller": {"kind": "wander", "min_front_m": 0.8}}},
  "models": [{"name": "p", "type": "a", "pose": {"x_m": 3}}, {"name": "r0", "type": "b"}],
  "at": [)" +
           at + "] }";
  };
  EXPECT_THAT(findings("w.json", world("")),
              ElementsAre(HasSubstr("radio \"r\" of \"a\" hears nothing"), HasSubstr("cannot stand still"),
                          HasSubstr("radio \"r\" of \"b\" hears nothing"),
                          HasSubstr("always sees an obstacle ahead"), "w.json: 4 findings"));
  expect_nothing("set.json", world(R"(
    {"time_s": 0, "set": {"type": "a", "device": {"name": "r", "channel": "y"}}},
    {"time_s": 0, "set": {"type": "b", "controller": {"kind": "wander", "min_front_m": 0.3}}},
    {"time_s": 0, "set": {"type": "b", "drive": {"velocity_min_x_mps": 0}}})"));
}

TEST_F(LintTest, InterventionsMayMoveBodiesToOtherHeights) {
  const auto world = [](const std::string& event) {
    return R"({ "troupe": 1, "bounds_m": [[-5, -5], [5, 5]], "types": {
    "plate": {"size_m": [0.4, 0.4, 0.02], "gripper_return": true},
    "bot": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"},
            "sensors": [{"name": "floor", "kind": "ground"},
                        {"name": "ray", "kind": "ranger", "pose": {"z_m": 0.15},
                         "transducers": [{"range_max_m": 9}]}]} },
  "models": [{"name": "p", "type": "plate", "pose": {"x_m": 3, "z_m": 1}}, {"name": "r0", "type": "bot"}],
  "populations": [{"name": "low", "type": "plate", "count": 0, "reserve": 4,
                   "place": {"rule": "uniform", "z_m": 1}}],
  "at": [{"time_s": 5, )" +
           event + "}] }";
  };
  const auto moved = [](const std::string& model, const std::string& z) {
    return R"("move": {"model": ")" + model + R"(", "pose": {"x_m": 2, "z_m": )" + z + "}}";
  };
  EXPECT_THAT(findings("same.json", world(moved("p", "1"))),
              ElementsAre(HasSubstr("\"floor\" of \"bot\" sees only the bare floor"),
                          HasSubstr("\"ray\" of \"bot\" sees nothing"), "same.json: 2 findings"));
  EXPECT_THAT(findings("down.json", world(moved("p", "0"))),
              ElementsAre(HasSubstr("\"ray\" of \"bot\" sees nothing"), "down.json: 1 finding"));
  EXPECT_THAT(
      findings("beam.json", world(moved("p", "0.14"))),
      ElementsAre(HasSubstr("\"floor\" of \"bot\" sees only the bare floor"), "beam.json: 1 finding"));
  // A robot cannot see itself at the height to which it is moved.
  for (const char* z : {"0", "0.1"})
    EXPECT_THAT(findings("alone.json", world(moved("r0", z))),
                ElementsAre(HasSubstr("\"floor\" of \"bot\" sees only the bare floor"),
                            HasSubstr("\"ray\" of \"bot\" sees nothing"), "alone.json: 2 findings"));
  EXPECT_THAT(findings("added.json",
                       world(R"("add": {"population": "low", "count": 1, "pose": {"x_m": 2, "z_m": 0}})")),
              ElementsAre(HasSubstr("\"ray\" of \"bot\" sees nothing"), "added.json: 1 finding"));
}

TEST_F(LintTest, ReportsDevicesThatNeverRun) {
  const auto world = [](const std::string& drive, const std::string& eye) {
    return R"({ "troupe": 1, "tick_s": 0.1, "quit_time_s": 60, "types": {"bot": {"size_m": [0.4, 0.4, 0.3],
  "drive": {"kind": "diff")" +
           drive + R"(},
  "sensors": [{"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 5}])" +
           eye + R"(}] }},
  "models": [{"name": "r0", "type": "bot"}, {"name": "r1", "type": "bot", "pose": {"x_m": 3}}] })";
  };
  expect_nothing("once.json", world(R"(, "period_s": 60)", R"(, "period_s": 60)"));
  const std::string end = "is 100 s, but \"quit_time_s\" ends the run at 60 s";
  EXPECT_THAT(
      findings("never.json", world(R"(, "period_s": 100)", R"(, "period_s": 100)")),
      ElementsAre(
          "never.json:2: warning: the drive \"diff\" of \"bot\" never runs unless --for makes the run "
          "longer: its period " +
              end,
          "never.json:3: warning: the ranger \"eye\" of \"bot\" never runs unless --for makes the run "
          "longer: its period " +
              end,
          "never.json: 2 findings"));
}

TEST_F(LintTest, ListsFindingsAboutOneLineBySubject) {
  const std::string world =
      R"({"troupe": 1, "bounds_m": [[-5, -5], [5, 5]], "types": {"bot": {"size_m": [0.4, 0.4, 0.3], "drive": )"
      R"({"kind": "diff", "velocity_min_x_mps": 0.1}, "devices": [{"name": "hand", "kind": "gripper"}, )"
      R"({"name": "plug", "kind": "power_contact"}, {"name": "pack", "kind": "power_pack"}], "sensors": [)"
      R"({"name": "ear", "kind": "radio"}, {"name": "eye", "kind": "blobfinder", "colors": ["pink"]}, )"
      R"({"name": "floor", "kind": "ground", "height_m": 0.01}, {"name": "sun", "kind": "light_sensor"}, )"
      R"({"name": "mark", "kind": "fiducial"}, {"name": "ray", "kind": "ranger", "transducers": []}], )"
      R"("controllers": [{"kind": "waypoints", "goals": [{"x_m": 7}], "period_s": 3}]}}, )"
      R"("models": [{"name": "r0", "type": "bot"}]})";
  EXPECT_THAT(
      findings("w.json", world),
      ElementsAre(HasSubstr("the drive \"diff\""), HasSubstr("\"pack\""), HasSubstr("\"plug\""),
                  HasSubstr("the period of 3 s"), HasSubstr("its goal 1"), HasSubstr("\"mark\""),
                  HasSubstr("\"ray\""), HasSubstr("\"sun\""), HasSubstr("\"floor\""), HasSubstr("\"eye\""),
                  HasSubstr("\"ear\""), HasSubstr("\"hand\""), "w.json: 12 findings"));
}

TEST_F(LintTest, ReportsGoalsOutOfBounds) {
  const auto world = [](const std::string& goal, const std::string& drive = "") {
    return R"({ "troupe": 1, "bounds_m": [[-5, -5], [5, 5]], "types": {"bot": {"size_m": [0.4, 0.4, 0.3],
  "drive": {"kind": "diff")" +
           drive + R"(},
  "controller": {"kind": "waypoints", "goals": [{"x_m": 1}, )" +
           goal + R"(]} }},
  "models": [{"name": "r0", "type": "bot"}] })";
  };
  expect_nothing("near.json", world(R"({"x_m": 5.1})"));
  EXPECT_THAT(
      findings("far.json", world(R"({"x_cm": 512, "y_m": 2})")),
      ElementsAre(
          "far.json:3: warning: the controller \"waypoints\" of \"bot\" never reaches its goal 2 (counted "
          "from 1): the goal is at (5.12, 2) m, outside of the bounds of the world, (-5, -5) to (5, 5) m",
          "far.json: 1 finding"));
  expect_nothing("odom.json", world(R"({"x_m": 6})", R"(, "localization": "odom")"));
  expect_nothing("origin.json", world(R"({"x_m": 6})", R"(, "localization_origin_m": [-2, 0])"));
  expect_nothing("wheels.json", R"({ "troupe": 1, "bounds_m": [[-5, -5], [5, 5]], "types": {"bot": {
  "size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"},
  "parts": [{"name": "cart", "size_m": [0.1, 0.1, 0.1], "device": {"kind": "wheels"},
             "controllers": [{"kind": "waypoints", "goals": [{"x_m": 6}]}]}] }},
  "models": [{"name": "r0", "type": "bot"}] })");
}

TEST_F(LintTest, ReportsAConditionWithOtherParametersThanTheListedMeasure) {
  const auto world = [](const std::string& measure, const std::string& condition) {
    return R"({ "troupe": 1, "bounds_m": [[-5, -5], [5, 5]],
  "types": {"dog": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}}},
  "models": [{"name": "rex", "type": "dog"}],
  "measures": ["stalls", )" +
           measure + R"(],
  "stop_when": ["stalls > 9", )" +
           condition + "] }";
  };
  const std::string fine = R"({"kind": "coverage", "cell_m": 0.5})";
  EXPECT_THAT(findings("w.json", world(fine, R"("coverage >= 0.9")")),
              ElementsAre("w.json:5: warning: the condition on \"coverage\" has the default parameters, not "
                          "those of /measures/1: to give it the same parameters, give that entry a \"name\" "
                          "of its own, and use the name in the condition",
                          "w.json: 1 finding"));
  expect_nothing("usual.json", world(R"("coverage")", R"("coverage >= 0.9")"));
  expect_nothing("of.json", world(fine, R"("coverage:rex >= 0.9")"));
  expect_nothing("own.json",
                 world(fine, R"({"measure": {"kind": "coverage", "cell_m": 2}, "is": ">= 0.9"})"));
  expect_nothing("named.json",
                 world(R"({"kind": "coverage", "cell_m": 0.5, "name": "fine"})", R"("fine >= 0.9")"));
}

TEST_F(LintTest, ReportsInterventionsAndFaultsThatSelectNoBody) {
  const auto world = [](const std::string& keys) {
    return R"({ "troupe": 1, "tick_s": 0.1,
  "types": {"dog": {"size_m": [0.4, 0.4, 0.3], "drive": {"kind": "diff"}}},
  "populations": [{"name": "d", "type": "dog", "count": 20, "reserve": 20,
    "place": {"rule": "grid", "region_m": [[0, 0], [9, 9]], "pitch_m": 1}}],
)" + keys + " }";
  };
  const auto slow = [&](const std::string& selects) {
    return world(R"("faults": [{"population": "d", )" + selects + R"(, "slow_wheels": {"factor": 0.5}}])");
  };
  expect_nothing("half.json", slow(R"("share": 0.025)"));
  expect_nothing("one.json", slow(R"("count": 1)"));
  EXPECT_THAT(findings("less.json", slow(R"("share": 0.024)")),
              ElementsAre("less.json:5: warning: this entry of \"faults\" has no effect: its \"share\" of "
                          "0.024 selects none of 20 bodies: the least share that selects a body is 0.025",
                          "less.json: 1 finding"));
  EXPECT_THAT(findings("none.json", slow(R"("count": 0)")),
              ElementsAre("none.json:5: warning: this entry of \"faults\" has no effect: its \"count\" is 0",
                          "none.json: 1 finding"));
  // When an intervention selects, bodies of the reserve may have been added.
  const auto disable = [&](const std::string& share) {
    return world(R"("at": [{"time_s": 1, "disable": {"population": "d", "share": )" + share + "}}]");
  };
  expect_nothing("later.json", disable("0.0125"));
  EXPECT_THAT(findings("never.json", disable("0.012")),
              Contains(HasSubstr("this entry of \"at\" has no effect: its \"share\" of 0.012 selects none of "
                                 "40 bodies: the least share that selects a body is 0.0125")));
}

TEST_F(LintTest, ChecksTheWorldWithTheValuesThatAreSet) {
  write("eye.json", json_world(R"({"kind": "ranger", "transducers": [{"range_max_m": 5}]})"));
  const std::string range = "/types/bot/sensors/0/transducers/0/range_max_m";
  const Outcome outcome = troupe({"lint", "eye.json", "--set", range + "=0.005"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("sees nothing: its beams of at most 0.005 m end inside its own body"));
  const Outcome wrong = troupe({"lint", "eye.json", "--set", range + "=far"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, StartsWith("--set " + range + ": error: "));
}

TEST_F(LintTest, HelpTellsWhatIsReportedAndTheExitCodes) {
  const Outcome outcome = troupe({"lint", "--help"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("Exit codes: 0 nothing found; 1 findings; 2"));
  EXPECT_THAT(troupe({"--help"}).out, HasSubstr("lint"));
}

}  // namespace
}  // namespace troupe::apps::lint_test
