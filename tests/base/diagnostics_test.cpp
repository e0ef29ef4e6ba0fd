#include "base/diagnostics.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::diagnostics_test {
namespace {

using testing::ElementsAre;

std::string thrown_by(const Diagnostics& diagnostics) {
  try {
    diagnostics.throw_if_errors();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SourceFiles, TheSameNameGivesTheSameNumber) {
  SourceFiles files;
  const std::uint32_t maze = files.add("maze.world");
  const std::uint32_t robots = files.add("robots.inc");
  EXPECT_NE(maze, robots);
  EXPECT_EQ(files.add("maze.world"), maze);
  EXPECT_EQ(files.name(maze), "maze.world");
  EXPECT_EQ(files.name(robots), "robots.inc");
}

// Comparing each name with all others would take minutes.
TEST(SourceFiles, ManyNamesAreFoundFast) {
  constexpr std::uint32_t k_names = 400000;
  SourceFiles files;
  for (std::uint32_t i = 0; i < k_names; ++i)
    ASSERT_EQ(files.add(fmt::format("the/same/long/folder/{:06}.json", i)), i);
  EXPECT_EQ(files.add("the/same/long/folder/399999.json"), k_names - 1);
  EXPECT_EQ(files.size(), k_names);
}

TEST(Diagnostics, NothingFoundThrowsNothing) {
  Diagnostics diagnostics;
  diagnostics.warning({}, "odd");
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_NO_THROW(diagnostics.throw_if_errors());
}

TEST(Diagnostics, AnErrorNamesFileAndLine) {
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.files()->add("maze.world");
  diagnostics.error({file, 41}, "robot \"r3\": unknown drive \"hover\"; known: car, diff, omni");
  EXPECT_TRUE(diagnostics.has_errors());
  EXPECT_EQ(thrown_by(diagnostics),
            "maze.world:41: error: robot \"r3\": unknown drive \"hover\"; known: car, diff, omni");
}

TEST(Diagnostics, LineZeroIsTheFileAsAWhole) {
  Diagnostics diagnostics;
  diagnostics.error({diagnostics.files()->add("maze.world"), 0}, "cannot be read");
  EXPECT_EQ(thrown_by(diagnostics), "maze.world: error: cannot be read");
}

TEST(Diagnostics, WithoutAFileOnlyTheMessageStands) {
  Diagnostics diagnostics;
  diagnostics.error({}, "no end: give --for");
  EXPECT_EQ(thrown_by(diagnostics), "error: no end: give --for");
}

TEST(Diagnostics, AllErrorsAreThrownInOrderWithoutTheWarnings) {
  Diagnostics diagnostics;
  const std::uint32_t a = diagnostics.files()->add("a.world");
  const std::uint32_t b = diagnostics.files()->add("b.inc");
  diagnostics.error({a, 7}, "one");
  diagnostics.warning({a, 8}, "between");
  diagnostics.error({b, 2}, "two");
  EXPECT_EQ(thrown_by(diagnostics), "a.world:7: error: one\nb.inc:2: error: two");
  EXPECT_THAT(diagnostics.warnings(), ElementsAre("a.world:8: warning: between"));
  EXPECT_EQ(diagnostics.findings().size(), 3u);
}

TEST(Diagnostics, ManyErrorsAreCounted) {
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.files()->add("a.world");
  for (std::uint32_t line = 1; line <= 50; ++line) diagnostics.error({file, line}, "bad");
  EXPECT_TRUE(thrown_by(diagnostics).ends_with("a.world:50: error: bad"));
  diagnostics.error({file, 51}, "bad");
  EXPECT_TRUE(thrown_by(diagnostics).ends_with("a.world:50: error: bad\n... and 1 more error"));
  diagnostics.error({file, 52}, "bad");
  EXPECT_TRUE(thrown_by(diagnostics).ends_with("a.world:50: error: bad\n... and 2 more errors"));
}

TEST(Diagnostics, ALongMessageIsCutBetweenTwoCharacters) {
  std::string letters;
  while (letters.size() < 9000) letters += "\u00e9";  // two bytes
  for (const std::string_view start : {"", "a"}) {
    Diagnostics diagnostics;
    diagnostics.error({}, std::string(start) + letters);
    EXPECT_EQ(thrown_by(diagnostics),
              fmt::format("error: {}{} ...", start, letters.substr(0, start.empty() ? 8000 : 7998)));
  }
}

TEST(FirstCharacters, AreWhole) {
  EXPECT_EQ(first_characters("a\u00e9\u20ac", 6), "a\u00e9\u20ac");
  EXPECT_EQ(first_characters("a\u00e9\u20ac", 5), "a\u00e9");
  EXPECT_EQ(first_characters("a\u00e9\u20ac", 3), "a\u00e9");
  EXPECT_EQ(first_characters("a\u00e9\u20ac", 2), "a");
  EXPECT_EQ(first_characters("a\u00e9\u20ac", 0), "");
}

TEST(Diagnostics, AWarningForManyPlacesIsReportedOnce) {
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.files()->add("a.world");
  for (std::uint32_t line = 1; line <= 100; ++line) {
    diagnostics.warning_once({file, line}, "property \"mass\" is not supported yet");
    if (line == 3) diagnostics.warning_once({file, 3}, "property \"watts\" is not supported yet");
    if (line < 3) diagnostics.warning({file, line}, "odd");
  }
  EXPECT_THAT(diagnostics.warnings(),
              ElementsAre("a.world:1: warning: property \"mass\" is not supported yet (and 99 more such "
                          "warnings)",
                          "a.world:1: warning: odd", "a.world:2: warning: odd",
                          "a.world:3: warning: property \"watts\" is not supported yet"));
}

constexpr std::array<std::string_view, 5> k_drives = {"car", "diff", "omni", "tricycle", "velocity"};

TEST(DidYouMean, NamesTheNearest) {
  EXPECT_EQ(did_you_mean("onmi", k_drives), " (did you mean \"omni\"?)");          // neighbours swapped
  EXPECT_EQ(did_you_mean("omn", k_drives), " (did you mean \"omni\"?)");           // one missing
  EXPECT_EQ(did_you_mean("difff", k_drives), " (did you mean \"diff\"?)");         // one too many
  EXPECT_EQ(did_you_mean("tricicle", k_drives), " (did you mean \"tricycle\"?)");  // one wrong
  EXPECT_EQ(did_you_mean("valocety", k_drives), " (did you mean \"velocity\"?)");  // two wrong of eight
}

TEST(DidYouMean, IsSilentWhenNothingIsNear) {
  EXPECT_EQ(did_you_mean("hover", k_drives), "");
  EXPECT_EQ(did_you_mean("", k_drives), "");
  EXPECT_EQ(did_you_mean("omni", {}), "");
  constexpr std::array<std::string_view, 2> k_axes = {"x", "y"};
  EXPECT_EQ(did_you_mean("z", k_axes), "");
}

TEST(DidYouMean, OfEquallyNearNamesTakesTheFirst) {
  constexpr std::array<std::string_view, 2> k_names = {"laser_b", "laser_a"};
  EXPECT_EQ(did_you_mean("laser_c", k_names), " (did you mean \"laser_b\"?)");
}

// The time to compare two names grows with the product of their lengths: here it would be hours.
TEST(DidYouMean, DoesNotCompareLongNames) {
  const std::string word(1'000'000, 'a');
  const std::string long_name = word + 'b';
  const std::string longest_compared(100, 'a');
  const std::vector<std::string_view> known = {long_name, longest_compared};
  EXPECT_EQ(did_you_mean(word, known), "");
  EXPECT_EQ(did_you_mean(longest_compared.substr(1), known),
            fmt::format(" (did you mean \"{}\"?)", longest_compared));
}

TEST(DidYouMean, OverlooksUpperAndLowerCase) {
  constexpr std::array<std::string_view, 4> k_names = {"ges", "gps", "odom", "x"};
  EXPECT_EQ(did_you_mean("GPS", k_names), " (did you mean \"gps\"?)");
  EXPECT_EQ(did_you_mean("X", k_names), " (did you mean \"x\"?)");
  EXPECT_EQ(did_you_mean("GPX", k_names), "");
}

TEST(DidYouMean, ComparesNamesWordByWordAndByTheirUnits) {
  constexpr std::array<std::string_view, 8> k_names = {
      "velocity_min_x_mps", "velocity_max_x_mps", "turn_min_radps", "turn_max_radps",
      "turn_max_degps",     "range_min_m",        "range_max_m",    "goal_speed_max_mps"};
  EXPECT_EQ(did_you_mean("velocity_max_turn_rps", k_names), " (did you mean \"turn_max_radps\"?)");
  EXPECT_EQ(did_you_mean("max_range_m", k_names), " (did you mean \"range_max_m\"?)");
  EXPECT_EQ(did_you_mean("range_maximum_meters", k_names), " (did you mean \"range_max_m\"?)");
  EXPECT_EQ(did_you_mean("turn_rate_max_dps", k_names), " (did you mean \"turn_max_radps\"?)");
  EXPECT_EQ(did_you_mean("velocity_max_y_mps", k_names),
            " (did you mean \"velocity_max_x_mps\"?)");  // one letter
  EXPECT_EQ(did_you_mean("speed_max_mps", k_names), " (did you mean \"goal_speed_max_mps\"?)");
  EXPECT_EQ(did_you_mean("battery_capacity_J", k_names), "");
  EXPECT_EQ(did_you_mean("max_payload_kg", k_names), "");
}

TEST(UnknownName, ListsFewNamesOrASuggestion) {
  std::vector<std::string> names;
  for (int i = 10; i < 35; ++i) names.push_back(fmt::format("key_{}", i));
  std::vector<std::string_view> known(names.begin(), names.end());
  EXPECT_EQ(unknown_name("key", "kee_12", known), "unknown key \"kee_12\" (did you mean \"key_12\"?)");
  EXPECT_THAT(unknown_name("key", "wibble", known),
              testing::StartsWith("unknown key \"wibble\"; known: key_10, "));
  known.pop_back();
  EXPECT_THAT(unknown_name("key", "kee_12", known),
              testing::StartsWith("unknown key \"kee_12\"; known: key_10, "));
}

TEST(Diagnostics, WarningsThatExplainErrorsAreListedWithThem) {
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.files()->add("a.world");
  diagnostics.explain({file, 1}, "old syntax");
  diagnostics.warning({file, 2}, "odd");
  EXPECT_NO_THROW(diagnostics.throw_if_errors());
  diagnostics.error({file, 3}, "needs a ranger");
  diagnostics.explain({file, 4}, "old syntax");  // listed once
  try {
    diagnostics.throw_if_errors();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "a.world:1: warning: old syntax\na.world:3: error: needs a ranger");
  }
  EXPECT_THAT(diagnostics.warnings(),
              testing::ElementsAre("a.world:1: warning: old syntax (and 1 more such warning)",
                                   "a.world:2: warning: odd"));
}

TEST(CommaList, JoinsNames) {
  EXPECT_EQ(comma_list(k_drives), "car, diff, omni, tricycle, velocity");
  EXPECT_EQ(comma_list({}), "");
}

TEST(Diagnostics, ThoroughOnesListEveryPlaceOnce) {
  Diagnostics diagnostics(true);
  const std::uint32_t file = diagnostics.files()->add("a.world");
  for (const std::uint32_t line : {3u, 4u, 3u}) diagnostics.warning_once({file, line}, "odd");
  EXPECT_TRUE(diagnostics.thorough());
  EXPECT_EQ(diagnostics.findings().size(), 2u);
  EXPECT_EQ(diagnostics.text(diagnostics.findings()[0]), "a.world:3: warning: odd");
  EXPECT_EQ(diagnostics.text(diagnostics.findings()[1]), "a.world:4: warning: odd");
}

TEST(Diagnostics, AnInheritedFindingIsReportedOnceForTheBase) {
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.files()->add("maze.json");
  const Inheritable base{"/types/base", "Base", {file, 2}};
  const Inheritable middle{"/types/middle", "middle", {file, 5}};
  const Inheritable small{"/types/small", "small", {file, 8}};
  const Inheritable tall{"/types/tall", "tall", {file, 9}};
  diagnostics.inherits(small, middle);
  diagnostics.inherits(middle, base);
  diagnostics.inherits(tall, base);
  diagnostics.error({file, 3}, "/types/small: unknown key \"x\"");  // the heir may come first
  diagnostics.error({file, 3}, "/types/base: unknown key \"x\"");
  diagnostics.error({file, 3}, "/types/tall: unknown key \"x\"");
  diagnostics.error({file, 3}, "/types/tall: unknown key \"y\"");
  diagnostics.error({file, 3}, "/types/smaller: unknown key \"x\"");  // not an heir
  diagnostics.warning({file, 4}, "sensor \"eye\" of \"small\" sees nothing");
  diagnostics.warning({file, 4}, "sensor \"eye\" of \"tall\" sees nothing");
  for (int i = 0; i < 3; ++i) diagnostics.warning_once({file, 4}, "device \"eye\" is slow");
  diagnostics.warning_once({file, 4}, "sensor \"eye\" of \"middle\" sees nothing");
  diagnostics.warning_once({file, 4}, "sensor \"eye\" of \"middle\" sees nothing");
  // Each of these is about content of the heir's own.
  diagnostics.warning({file, 5}, "/types/middle/drive: slow");
  diagnostics.warning({file, 9}, "/types/small/drive: slow");
  diagnostics.warning({file, 9}, "/types/tall/drive: slow");
  std::vector<std::string> found;
  for (const Finding& finding : diagnostics.findings()) found.push_back(diagnostics.text(finding));
  EXPECT_THAT(found, ElementsAre("maze.json:3: error: /types/base: unknown key \"x\"",
                                 "maze.json:3: error: /types/tall: unknown key \"y\"",
                                 "maze.json:3: error: /types/smaller: unknown key \"x\"",
                                 "maze.json:4: warning: sensor \"eye\" of \"middle\" sees nothing",
                                 "maze.json:4: warning: device \"eye\" is slow",
                                 "maze.json:5: warning: /types/middle/drive: slow",
                                 "maze.json:9: warning: /types/small/drive: slow",
                                 "maze.json:9: warning: /types/tall/drive: slow"));
}

TEST(Diagnostics, ALongInheritedFindingIsReportedOnceAndCut) {
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.files()->add("maze.json");
  diagnostics.inherits({"/types/heir", "heir", {file, 2}}, {"/types/b", "b", {file, 1}});
  const std::string message = ": unknown key \"" + std::string(9000, 'x') + "\"";
  diagnostics.error({file, 3}, "/types/heir" + message);
  diagnostics.error({file, 3}, "/types/b" + message);
  diagnostics.error({file, 3}, "/types/heir" + message);
  ASSERT_EQ(diagnostics.findings().size(), 1u);
  EXPECT_EQ(diagnostics.findings()[0].message, ("/types/b" + message).substr(0, 8000) + " ...");
}

TEST(Diagnostics, AFindingIsAboutThePartWithTheLongestPathOrName) {
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.files()->add("maze.json");
  const Inheritable base{"/types/b", "b", {file, 1}};
  diagnostics.inherits({"/types/a", "a", {file, 2}}, base);
  diagnostics.inherits({"/types/a:c", "a\"c", {file, 3}}, base);
  diagnostics.inherits({"/types/a:c:d", "aa", {file, 4}}, base);
  diagnostics.warning({file, 9}, "/types/b/drive: slow");
  for (const std::string path : {"/types/a", "/types/a:c", "/types/a:c:d"})
    diagnostics.warning({file, 9}, path + "/drive: slow");
  diagnostics.warning({file, 9}, "type \"b\" is odd");
  for (const std::string name : {"a", "a\"c", "aa"})
    diagnostics.warning({file, 9}, "type \"" + name + "\" is odd");
  diagnostics.warning({file, 9}, "type \"ab\" is odd");  // not an heir
  EXPECT_THAT(diagnostics.warnings(), ElementsAre("maze.json:9: warning: /types/b/drive: slow",
                                                  "maze.json:9: warning: type \"b\" is odd",
                                                  "maze.json:9: warning: type \"ab\" is odd"));
}

// If each finding were compared with all parts and all findings, this test would run for minutes.
TEST(Diagnostics, FindingsAboutManyHeirs) {
  constexpr std::uint32_t k_heirs = 50000;
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.files()->add("maze.json");
  const auto heir = [&](std::uint32_t i) {
    return Inheritable{"/types/h" + std::to_string(i), "h" + std::to_string(i), {file, i + 2}};
  };
  for (std::uint32_t i = 0; i < k_heirs; ++i)
    diagnostics.inherits(heir(i), {"/types/base", "base", {file, 1}});
  for (std::uint32_t i = 0; i < k_heirs; ++i) {
    diagnostics.warning({file, 1}, heir(i).path + ": slow");  // inherited: reported for the first heir only
    diagnostics.warning(heir(i).where, heir(i).path + ": slow");
    diagnostics.warning(heir(i).where, "type \"" + heir(i).name + "\" is never used");
  }
  EXPECT_EQ(diagnostics.findings().size(), 2 * k_heirs + 1);
}

TEST(ExceptionText, SaysThatMemoryIsMissing) {
  EXPECT_EQ(exception_text(std::bad_alloc()), "not enough memory");
  EXPECT_EQ(exception_text(std::runtime_error("no clock")), "no clock");
}

TEST(Diagnostics, AFindingThatQuotesTwoPartsIsAboutTheFirst) {
  Diagnostics diagnostics;
  const std::uint32_t file = diagnostics.files()->add("maze.json");
  diagnostics.inherits({"/types/docked", "docked", {file, 2}}, {"/types/dock", "dock", {file, 3}});
  diagnostics.inherits({"/types/small", "small", {file, 4}}, {"/types/bot", "bot", {file, 5}});
  diagnostics.warning({file, 5}, "\"bot\" does not fit \"dock\"");
  diagnostics.warning({file, 5}, "\"small\" does not fit \"dock\"");
  diagnostics.warning({file, 5}, "\"bot\" does not fit \"docked\"");
  EXPECT_THAT(diagnostics.warnings(), ElementsAre("maze.json:5: warning: \"bot\" does not fit \"dock\"",
                                                  "maze.json:5: warning: \"bot\" does not fit \"docked\""));
}

}  // namespace
}  // namespace troupe::diagnostics_test
