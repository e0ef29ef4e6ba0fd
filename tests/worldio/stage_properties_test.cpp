#include "worldio/stage/stage_properties.hpp"

#include "tests/support/paths.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <tuple>

namespace troupe::worldio::stage_properties_test {
namespace {

namespace fs = std::filesystem;

TEST(StageProperties, EachStandsOnce) {
  std::set<std::tuple<std::string_view, std::string_view>> met;
  for (const StageRow& row : stage_rows())
    EXPECT_TRUE(met.emplace(row.type, row.name).second) << row.type << row.name;
}

TEST(StageProperties, OwnRowsComeBeforeThoseOfEveryModel) {
  EXPECT_EQ(find_stage_row("fiducial", "range_max")->type, "fiducial");
  EXPECT_EQ(find_stage_row("blobfinder", "range")->support, StageSupport::honoured);
  EXPECT_EQ(find_stage_row("position", "range")->support, StageSupport::obsolete);
  EXPECT_EQ(find_stage_row("position", "mass")->type, "model");
  EXPECT_EQ(find_stage_row("sensor", "mass"), nullptr);
  EXPECT_EQ(find_stage_row("world", "pose"), nullptr);
}

TEST(StageProperties, NumbersInNamesDoNotMatter) {
  EXPECT_EQ(find_stage_row("block", "point[123]")->name, "point[k]");
  EXPECT_EQ(find_stage_row("model", "polygon[0].point[3]")->name, "polygon[k].point[k]");
  EXPECT_EQ(find_stage_row("block", "point[]"), nullptr);
  EXPECT_EQ(find_stage_row("block", "point["), nullptr);
}

TEST(StageProperties, OnlyWhatHasNoEffectAnywhereIsWithoutEffect) {
  EXPECT_TRUE(is_without_effect("map_resolution"));
  EXPECT_FALSE(is_without_effect("mass"));
  EXPECT_FALSE(is_without_effect("fiducial_return"));
  EXPECT_FALSE(is_without_effect("size"));
  EXPECT_FALSE(is_without_effect("wibble"));
}

TEST(StageProperties, WhatIsHonouredWithAFixOrHasNoEffectSaysHow) {
  for (const StageRow& row : stage_rows()) {
    const bool needs_a_note = row.support == StageSupport::fixed || row.support == StageSupport::no_effect;
    EXPECT_FALSE(needs_a_note && row.note.empty()) << row.name;
  }
}

/// "Suite.Name" of every test in the folders of tests.
std::set<std::string> names_of_tests() {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(test::source_dir() / "tests")) {
    if (!entry.path().filename().string().ends_with("_test.cpp")) continue;
    std::ifstream in(entry.path());
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    for (std::size_t at = 0; (at = text.find("\nTEST", at)) != text.npos;) {
      const std::size_t open = text.find('(', at);
      const std::size_t close = text.find(')', at);
      at = open;
      std::string name;
      for (const char c : text.substr(open + 1, close - open - 1))
        if (c != ' ' && c != '\n') name += c == ',' ? '.' : c;
      names.insert(name);
    }
  }
  return names;
}

/// Of each property that is honoured: the test that fails when it is ignored, "Suite.Name".
struct Tested {
  std::string_view type;
  std::string_view name;
  std::string_view test;
};
constexpr Tested k_tests[] = {
    {"world", "name", "StageWorld.TakesItsPropertiesFromTheTopLevel"},
    {"world", "interval_sim", "StageWorld.TakesItsPropertiesFromTheTopLevel"},
    {"world", "quit_time", "StageWorld.TakesItsPropertiesFromTheTopLevel"},
    {"world", "unit_length", "StageWorld.PosesTakeTheFilesUnits"},
    {"world", "unit_angle", "StageWorld.PosesTakeTheFilesUnits"},
    {"world", "wrap_headings", "StageWorld.HeadingsInDevicesAreWrappedUnlessTheWorldSaysNo"},
    {"world", "seed", "StageWorld.TakesItsPropertiesFromTheTopLevel"},
    {"world", "resolution", "StageWorld.TheResolutionIsOfTheGridEngine"},
    {"world", "show_clock", "Watch.ShowClockTellsTheTimeAsOftenAsTheWorldSays"},
    {"world", "show_clock_interval", "Watch.ShowClockTellsTheTimeAsOftenAsTheWorldSays"},
    {"world", "speedup", "Watch.TheWorldsOwnRateHoldsBackWhoAsksForIt"},
    {"model", "name", "Conformance07.Names"},
    {"model", "pose", "StageWorld.ChildrenStackOnTheirParent"},
    {"model", "size", "StageWorld.DefaultBodiesAreBoxesOfTheirSize"},
    {"model", "origin", "StageWorld.OriginMovesTheBodyButNotItsChildren"},
    {"model", "update_interval", "StageWorld.RangersBecomeSensors"},
    {"model", "color", "StageWorld.ReturnsAndColours"},
    {"model", "color_rgba", "StageWorld.ReturnsAndColours"},
    {"model", "bitmap", "StageWorld.ABitmapIsOneSolidStretchedToItsSize"},
    {"model", "bitmap_margins", "StageWorld.BitmapMarginsAreKeptForWhoAsks"},
    {"model", "bitmap_unknown", "StageWorld.AMapOfRosLiesWhereItSays"},
    {"model", "noblocks", "StageWorld.DefaultBodiesAreBoxesOfTheirSize"},
    {"model", "boundary", "StageWorld.BoundaryIsFourWallsWithin"},
    {"model", "stack_children", "StageWorld.ChildrenStackOnTheirParent"},
    {"model", "obstacle_return", "StageWorld.ReturnsAndColours"},
    {"model", "ranger_return", "StageWorld.ReturnsAndColours"},
    {"model", "fiducial_return", "StageWorld.ReturnsAndColours"},
    {"model", "fiducial_key", "StageWorld.ReturnsAndColours"},
    {"model", "gripper_return", "StageGrip.AutosnatchClosesOnWhatBreaksABeam"},
    {"model", "blob_return", "StageWorld.ReturnsAndColours"},
    {"model", "ctrl", "StageWorld.ControllersTakeArgumentsByPlaceAndByName"},
    {"model", "alwayson", "StageWorld.RangersBecomeSensors"},
    {"model", "mass", "StagePowerTest.WhatModelsDrawGoesToTheNearestPack"},
    {"model", "watts", "StagePowerTest.WhatModelsDrawGoesToTheNearestPack"},
    {"model", "joules", "StagePowerTest.JoulesAreStoredAndCapacityInTheOrderInWhichStageReadsThem"},
    {"model", "kjoules", "StagePowerTest.JoulesAreStoredAndCapacityInTheOrderInWhichStageReadsThem"},
    {"model", "joules_capacity", "StagePowerTest.JoulesAreStoredAndCapacityInTheOrderInWhichStageReadsThem"},
    {"model", "kjoules_capacity", "StagePowerTest.JoulesAreStoredAndCapacityInTheOrderInWhichStageReadsThem"},
    {"model", "when_empty", "StagePowerTest.AnEmptyPackMayBeWithoutEffect"},
    {"model", "give_watts", "StagePowerTest.GiversAndTakersHaveContacts"},
    {"model", "take_watts", "StagePowerTest.GiversAndTakersHaveContacts"},
    {"block", "points", "StageWorld.BlocksAreStretchedTogetherAndTurnLeft"},
    {"block", "point[k]", "StageWorld.BlocksAreStretchedTogetherAndTurnLeft"},
    {"block", "z", "StageWorld.BlocksAreStretchedTogetherAndTurnLeft"},
    {"position", "drive", "StageWorld.PositionsDrive"},
    {"position", "velocity_bounds", "StageWorld.PositionsDrive"},
    {"position", "wheelbase", "StageWorld.PositionsDrive"},
    {"position", "velocity", "Driving.StartingVelocitiesActUntilTheFirstUpdate"},
    {"position", "acceleration_bounds", "StageWorld.DrivesHaveAccelerationsAndAStart"},
    {"position", "localization", "StageWorld.DrivesKnowWhereTheyAre"},
    {"position", "localization_origin", "Driving.WhatStageWorldsSayOfOriginsHolds"},
    {"position", "gps_origin", "Driving.WhatStageWorldsSayOfOriginsHolds"},
    {"position", "odom_error", "StageWorld.DrivesKnowWhereTheyAre"},
    {"position", "odom_heading", "StageWorld.DrivesKnowWhereTheyAre"},
    {"position", "goal_bounds", "StageWorld.GoalsHaveStagesSpeeds"},
    {"bumper", "crashes", "StageWorld.BumpersFeelCrashesIfAsked"},
    {"ranger", "intensity", "StageSensors.NoiseIsAVarianceAShareAndAPartOfTheAngleBetweenBeams"},
    {"sensor", "pose", "StageWorld.RangersBecomeSensors"},
    {"sensor", "size", "StageWorld.RangersBecomeSensors"},
    {"sensor", "range", "StageWorld.RangersBecomeSensors"},
    {"sensor", "fov", "StageWorld.RangersBecomeSensors"},
    {"sensor", "samples", "StageWorld.RangersBecomeSensors"},
    {"sensor", "noise", "StageSensors.NoiseIsAVarianceAShareAndAPartOfTheAngleBetweenBeams"},
    {"sensor", "beam_width", "StageSensors.NoiseIsAVarianceAShareAndAPartOfTheAngleBetweenBeams"},
    {"sensor", "apply_range_min", "StageSensors.NoiseIsAVarianceAShareAndAPartOfTheAngleBetweenBeams"},
    {"laser", "samples", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"laser", "fov", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"laser", "range", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"laser", "range_min", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"laser", "range_max", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"sonar", "samples", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"sonar", "fov", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"sonar", "range", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"sonar", "range_min", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"sonar", "range_max", "StageWorld.LasersAndSonarsHaveTheSameProperties"},
    {"fiducial", "range_min", "StageSensors.AFiducialFinderStandsOnItsParentWithUnitsAndKey"},
    {"fiducial", "apply_range_min", "StageSensors.AFiducialFinderStandsOnItsParentWithUnitsAndKey"},
    {"fiducial", "range_max", "StageSensors.AFiducialFinderStandsOnItsParentWithUnitsAndKey"},
    {"fiducial", "range_max_id", "StageSensors.AFiducialFinderStandsOnItsParentWithUnitsAndKey"},
    {"fiducial", "fov", "StageSensors.AFiducialFinderStandsOnItsParentWithUnitsAndKey"},
    {"fiducial", "ignore_zloc", "StageSensors.AFiducialFinderStandsOnItsParentWithUnitsAndKey"},
    {"radio", "essid", "StageSensors.ARadioIsAsThoseOfStage2"},
    {"radio", "model", "StageSensors.ARadioIsAsThoseOfStage2"},
    {"radio", "power", "StageSensors.ARadioIsAsThoseOfStage2"},
    {"radio", "sensitivity", "StageSensors.ARadioIsAsThoseOfStage2"},
    {"radio", "plc", "StageSensors.ARadioIsAsThoseOfStage2"},
    {"radio", "ple", "StageSensors.ARadioIsAsThoseOfStage2"},
    {"radio", "wall_factor", "StageSensors.ARadioIsAsThoseOfStage2"},
    {"radio", "range", "StageSensors.ARadioIsAsThoseOfStage2"},
    {"radio", "hears", "StageSensors.ARadioSaysInAWorldWhatItSaysInJson"},
    {"radio", "walls", "StageSensors.ARadioSaysInAWorldWhatItSaysInJson"},
    {"radio", "bodies", "StageSensors.ARadioSaysInAWorldWhatItSaysInJson"},
    {"radio", "frequency", "StageSensors.ARadioSaysInAWorldWhatItSaysInJson"},
    {"radio", "payload", "StageSensors.ARadioSaysInAWorldWhatItSaysInJson"},
    {"radio", "most_heard", "StageSensors.ARadioSaysInAWorldWhatItSaysInJson"},
    {"radio", "drop_rate", "StageSensors.ARadioSaysInAWorldWhatItSaysInJson"},
    {"radio", "beacon", "StageSensors.ARadioSaysInAWorldWhatItSaysInJson"},
    {"blobfinder", "image", "StageSensors.ABlobfinderFiltersByAsManyColoursAsItCounts"},
    {"blobfinder", "range", "StageSensors.ABlobfinderFiltersByAsManyColoursAsItCounts"},
    {"blobfinder", "fov", "StageSensors.ABlobfinderFiltersByAsManyColoursAsItCounts"},
    {"blobfinder", "pan", "StageSensors.ABlobfinderFiltersByAsManyColoursAsItCounts"},
    {"blobfinder", "colors_count", "StageSensors.ABlobfinderFiltersByAsManyColoursAsItCounts"},
    {"blobfinder", "colors", "StageSensors.WrongColoursAreErrors"},
    {"bumper", "bcount", "StageSensors.WrongBumpersAreErrors"},
    {"bumper", "blength", "StageSensors.BumpersHaveALengthInCommonOrTheirOwn"},
    {"bumper", "blength[k]", "StageSensors.BumpersHaveALengthInCommonOrTheirOwn"},
    {"bumper", "bpose[k]", "StageSensors.BumpersHaveALengthInCommonOrTheirOwn"},
    {"gripper", "paddle_size", "StageGrip.TheGripperIsABaseAndTwoPaddlesThatMove"},
    {"gripper", "paddle_state", "StageGrip.TheGripperIsABaseAndTwoPaddlesThatMove"},
    {"gripper", "autosnatch", "StageGrip.AutosnatchClosesOnWhatBreaksABeam"},
    {"actuator", "type", "StageGrip.ActuatorsMoveWhatStandsOnThem"},
    {"actuator", "axis", "StageGrip.ActuatorsMoveWhatStandsOnThem"},
    {"actuator", "min_position", "StageGrip.ActuatorsMoveWhatStandsOnThem"},
    {"actuator", "max_position", "StageGrip.ActuatorsMoveWhatStandsOnThem"},
    {"actuator", "max_speed", "StageGrip.ActuatorsMoveWhatStandsOnThem"},
    {"actuator", "start_position", "StageGrip.ActuatorsMoveWhatStandsOnThem"},
    {"camera", "resolution", "StageSensors.ACameraIsWrittenInDegrees"},
    {"camera", "range", "StageSensors.ACameraIsWrittenInDegrees"},
    {"camera", "fov", "StageSensors.ACameraIsWrittenInDegrees"},
    {"camera", "pantilt", "StageSensors.ACameraIsWrittenInDegrees"},
    {"blinkenlight", "period", "StageSensors.ABlinkenlightHasItsPeriodInMilliseconds"},
    {"blinkenlight", "dutycycle", "StageSensors.ABlinkenlightHasItsPeriodInMilliseconds"},
    {"blinkenlight", "enabled", "StageSensors.ABlinkenlightHasItsPeriodInMilliseconds"},
};

TEST(StageProperties, WhatIsHonouredHasATest) {
  const std::set<std::string> tests = names_of_tests();
  ASSERT_TRUE(tests.contains("StageProperties.WhatIsHonouredHasATest"));
  std::set<std::tuple<std::string_view, std::string_view>> tested;
  for (const Tested& row : k_tests) {
    EXPECT_TRUE(tested.emplace(row.type, row.name).second) << row.type << " " << row.name << " stands twice";
    EXPECT_TRUE(tests.contains(std::string(row.test)))
        << row.type << " " << row.name << " names the test \"" << row.test << "\"";
  }
  for (const StageRow& row : stage_rows()) {
    const bool is_honoured = row.support == StageSupport::honoured || row.support == StageSupport::fixed;
    EXPECT_EQ(tested.erase({row.type, row.name}) == 1, is_honoured)
        << row.type << " " << row.name
        << (is_honoured ? " is honoured: name the test that fails when it is ignored"
                        : " has no effect that could be tested");
  }
  for (const auto& [type, name] : tested) ADD_FAILURE() << type << " " << name << " is no property";
}

std::string_view status_text(const StageRow& row) {
  if (row.type == "type") return "error, obsolete";
  switch (row.support) {
    case StageSupport::honoured: return "honoured";
    case StageSupport::fixed: return "honoured, with a fix";
    case StageSupport::no_effect: return "accepted, no effect";
    case StageSupport::window_camera: return "honoured by `--camera window`";
    case StageSupport::window_only: return "accepted, window only";
    case StageSupport::obsolete: break;
  }
  return "accepted, obsolete";
}

TEST(StageProperties, TheDocumentShowsTheTable) {
  std::string table = "| in | property | status | notes |\n|---|---|---|---|\n";
  for (const StageRow& row : stage_rows())
    table += fmt::format("| {} | `{}` | {} | {} |\n", row.type, row.name, status_text(row), row.note);
  std::ifstream in(test::source_dir().string() + "/docs/stage-worlds.md");
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_NE(text.find("\n\n" + table + "\n"), std::string::npos)
      << "the table in docs/stage-worlds.md must be:\n\n"
      << table;
}

}  // namespace
}  // namespace troupe::worldio::stage_properties_test
