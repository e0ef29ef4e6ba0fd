#include "worldio/stage/stage_properties.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <tuple>

namespace troupe::worldio {
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
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(TROUPE_SOURCE_DIR) / "tests")) {
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

TEST(StageProperties, WhatIsHonouredNamesATestThatThereIs) {
  const std::set<std::string> tests = names_of_tests();
  ASSERT_TRUE(tests.contains("StageProperties.WhatIsHonouredNamesATestThatThereIs"));
  for (const StageRow& row : stage_rows()) {
    const bool is_honoured = row.support == StageSupport::honoured || row.support == StageSupport::fixed;
    if (is_honoured)
      EXPECT_TRUE(tests.contains(std::string(row.test)))
          << row.type << " " << row.name << " names the test \"" << row.test << "\"";
    else
      EXPECT_EQ(row.test, "") << row.type << " " << row.name << " has no effect that could be tested";
  }
}

TEST(StageProperties, TheDocumentShowsTheTable) {
  std::ifstream in(std::string(TROUPE_SOURCE_DIR) + "/docs/stage-worlds.md");
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_NE(text.find("\n\n" + stage_property_table() + "\n"), std::string::npos)
      << "the table in docs/stage-worlds.md must be:\n\n"
      << stage_property_table();
}

}  // namespace
}  // namespace troupe::worldio
