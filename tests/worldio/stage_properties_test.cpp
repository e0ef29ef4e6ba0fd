#include "worldio/stage_properties.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <tuple>

namespace troupe::worldio {
namespace {

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
  EXPECT_TRUE(is_without_effect("mass"));
  EXPECT_TRUE(is_without_effect("friction"));
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

TEST(StageProperties, TheDocumentShowsTheTable) {
  std::ifstream in(std::string(TROUPE_SOURCE_DIR) + "/docs/stage-worlds.md");
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_NE(text.find("\n\n" + stage_property_table() + "\n"), std::string::npos)
      << "the table in docs/stage-worlds.md must be:\n\n"
      << stage_property_table();
}

}  // namespace
}  // namespace troupe::worldio
