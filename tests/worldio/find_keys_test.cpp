#include "worldio/json/find_keys.hpp"

#include "troupe/registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio::find_keys_test {
namespace {

using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const engine::Registry& registry() {
  static const engine::Registry made = make_registry();
  return made;
}

/// The paths of all keys to which a name refers.
std::vector<std::string> paths(std::string_view name) {
  std::vector<std::string> all;
  for (const FoundKey& found : find_keys(registry(), name))
    all.insert(all.end(), found.paths.begin(), found.paths.end());
  return all;
}

TEST(FindKeys, AKeyOfAListHasTheKeysOfItsObjects) {
  const std::vector<FoundKey> found = find_keys(registry(), "populations");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].paths, ElementsAre("populations[]"));
  EXPECT_EQ(found[0].row.value, "list");
  EXPECT_THAT(found[0].row.meaning, StartsWith("groups of many bodies"));
  EXPECT_THAT(found[0].keys, Contains(testing::Field(&KeyRow::names, "place")));
  EXPECT_THAT(found[0].what, IsEmpty());
}

TEST(FindKeys, AKeyOfObjectsWithKindsHasTheNamesOfTheKinds) {
  const std::vector<FoundKey> found = find_keys(registry(), "types.drive");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].what, "drive");
  EXPECT_THAT(found[0].kinds, ElementsAre("car", "diff", "omni"));
}

TEST(FindKeys, AKeyIsFoundWithAndWithoutItsUnit) {
  for (const char* name : {"tick", "tick_s", "tick_ms"})
    EXPECT_THAT(paths(name), ElementsAre("tick_s")) << name;
  const std::vector<FoundKey> found = find_keys(registry(), "tick");
  EXPECT_EQ(found[0].row.names, "tick_s (_ms)");
  EXPECT_EQ(found[0].row.usual, "0.1 s");
  EXPECT_THAT(paths("place.heading_deg"), ElementsAre("populations[].place.heading"));
}

TEST(FindKeys, SeveralNamesLeadToAKey) {
  for (const char* name : {"populations.place.pitch", "place.pitch_cm", "populations[0].place.pitch_m",
                           "/populations/0/place/pitch_m"})
    EXPECT_THAT(paths(name), ElementsAre("populations[].place.pitch_m")) << name;
  EXPECT_THAT(paths("populations.pitch"), IsEmpty()) << "it is a key of place";
  EXPECT_THAT(paths("/place/pitch_m"), IsEmpty()) << "a pointer begins at the top level";
}

TEST(FindKeys, APointerContainsTheNamesAndIndicesOfEntries) {
  EXPECT_THAT(paths("/types/bot/drive"), ElementsAre("types{}.drive"));
  EXPECT_THAT(paths("/types/7/drive"), ElementsAre("types{}.drive"));
  EXPECT_THAT(paths("/types/bot"), ElementsAre("types{}"));
  EXPECT_THAT(paths("/populations/0/place/region_m/1"), ElementsAre("populations[].place.region_m"));
  EXPECT_THAT(paths("/populations/0/place/region_m/x"), IsEmpty());
}

TEST(FindKeys, ParametersOfKindsAreKeys) {
  EXPECT_THAT(
      paths("/types/bot/sensors/0/range_m"),
      ElementsAre("types{}.sensors[].range_m (kind blobfinder)", "types{}.sensors[].range_m (kind radio)"));
  EXPECT_THAT(paths("sensors.transducers.samples"),
              ElementsAre("types{}.sensors[].transducers[].samples (kind ranger)",
                          "types{}.parts[].sensors[].transducers[].samples (kind ranger)"));
  EXPECT_THAT(paths("faults.rate"), Not(IsEmpty()));
  EXPECT_THAT(paths("faults.rate"), Each(StartsWith("faults[].")));
}

TEST(FindKeys, KeysOfParametersFollowTheirKind) {
  for (const char* name : {"ranger.transducers.samples", "ranger.samples"})
    EXPECT_THAT(paths(name), ElementsAre("types{}.device.transducers[].samples (kind ranger)",
                                         "types{}.sensors[].transducers[].samples (kind ranger)"))
        << name;
  EXPECT_THAT(paths("ranger.payload"), IsEmpty()) << "it is a parameter of radios";
  EXPECT_THAT(paths("expand_swarm.clearance"), Not(IsEmpty()));
  EXPECT_THAT(paths("expand_swarm.clearance"), Each(EndsWith(" (kind expand)")));
  for (const char* name : {"slow_wheels.factor", "faults.slow_wheels.factor", "/faults/0/slow_wheels/factor"})
    EXPECT_THAT(paths(name), ElementsAre("faults[].slow_wheels.factor")) << name;
  EXPECT_THAT(names_near(registry(), "ranger.smaples"), Contains("ranger.samples"));
  EXPECT_THAT(names_near(registry(), "ranger.smaples"), Not(Contains("ranger.payload")));

  std::size_t nested = 0;
  const auto expect_found = [&](const auto& kinds) {
    for (const auto& kind : kinds)
      for (const engine::Field& field : kind.params.fields) {
        const std::string outer = std::string(kind.name) + "." + std::string(field.name);
        EXPECT_THAT(paths(outer), Contains(EndsWith(" (kind " + std::string(kind.name) + ")"))) << outer;
        if (field.record == nullptr) continue;
        for (const engine::Field& inner : field.record->fields) {
          const std::string inner_name = "." + std::string(inner.name);
          EXPECT_THAT(paths(outer + inner_name), Not(IsEmpty())) << outer << inner_name;
          EXPECT_THAT(paths(std::string(kind.name) + inner_name), Not(IsEmpty())) << kind.name << inner_name;
          ++nested;
        }
      }
  };
  expect_found(registry().devices);
  expect_found(registry().drives);
  expect_found(registry().controllers);
  EXPECT_GT(nested, 5u);
}

TEST(FindKeys, ParametersOfAPresetHaveItsDefaults) {
  const auto usual = [](std::string_view name) {
    const std::vector<FoundKey> found = find_keys(registry(), name);
    return found.size() == 1 ? found.front().row.usual : std::to_string(found.size()) + " keys";
  };
  EXPECT_EQ(usual("expand.speed"), "0.3 m/s");
  EXPECT_EQ(usual("expand_pioneer.speed"), "0.2 m/s");
  EXPECT_EQ(usual("expand_swarm.speed"), "0.3 m/s") << "the preset does not change it";
  EXPECT_EQ(usual("expand_pioneer.clearances"), "[0, 0.1875, 0.375, 0.75, 0.75, 0.375, 0.1875] m");
}

TEST(FindKeys, KeysWithTheSameDescriptionHaveSeveralPaths) {
  EXPECT_THAT(find_keys(registry(), "types.color").size(), 1u);
  EXPECT_THAT(paths("alias"), Contains("types{}.parts[].alias"));
  bool is_shared = false;
  for (const FoundKey& found : find_keys(registry(), "size_m"))
    is_shared = is_shared || (testing::Value(found.paths, Contains("types{}.size_m")) &&
                              testing::Value(found.paths, Contains("types{}.parts[].size_m")));
  EXPECT_TRUE(is_shared);
}

TEST(FindKeys, ThereMayBeNone) {
  for (const char* name :
       {"", "/", ".", "nothing", "populations.nothing", "0", "populations..nothing", "[", "/7"})
    EXPECT_THAT(find_keys(registry(), name), IsEmpty()) << name;
}

TEST(FindKeys, AKindMayFollowTheKeyOfObjectsWithKinds) {
  EXPECT_EQ(kind_in_path(registry(), "sensors.ranger"), "ranger");
  EXPECT_EQ(kind_in_path(registry(), "types.drive.diff"), "diff");
  EXPECT_EQ(kind_in_path(registry(), "faults.drop_out"), "drop_out");
  EXPECT_EQ(kind_in_path(registry(), "sensors.nothing"), "nothing");
  for (const char* name : {"ranger", "populations.ranger", "nothing.ranger", ""})
    EXPECT_THAT(kind_in_path(registry(), name), IsEmpty()) << name;
}

TEST(FindKeys, NamesForSuggestionsAreThoseAtThePlace) {
  EXPECT_THAT(names_near(registry(), "populations.plase"), Contains("populations.place"));
  EXPECT_THAT(names_near(registry(), "populations.plase"), Each(StartsWith("populations.")));
  EXPECT_THAT(names_near(registry(), "/populations/0/plase"), Contains("/populations/0/place"));
  EXPECT_THAT(names_near(registry(), "popualtions"), Contains("populations"));
  EXPECT_THAT(names_near(registry(), "popualtions.place"), Contains("tick_s"));
  const std::vector<std::string> names = key_names(registry());
  EXPECT_THAT(names, ::testing::IsSupersetOf({"populations", "tick_s"}));
  for (const std::string& name : names) EXPECT_FALSE(find_keys(registry(), name).empty()) << name;
}

}  // namespace
}  // namespace troupe::worldio::find_keys_test
