#include "worldio/json/document_keys.hpp"

#include "base/diagnostics.hpp"
#include "engine/kinds/components.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/world/world.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/kind_checks.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

namespace troupe::worldio::document_table_test {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// Adds a table and all tables of its keys.
void add_tables(const DocumentTable& table, std::set<const DocumentTable*>& all) {
  if (!all.insert(&table).second) return;
  for (const DocumentKey& key : table.keys)
    if (key.table != nullptr) add_tables(key.table(), all);
}

TEST(DocumentTable, EveryMemberOfADocumentHasAKey) {
  std::set<const DocumentTable*> tables;
  add_tables(document_table<WorldDocument>(), tables);
  EXPECT_GT(tables.size(), 20u);
  for (const DocumentTable* table : tables) EXPECT_THAT(table->incomplete, IsEmpty());
}

struct Forgetful : Placed {
  double kept = 0;
  bool forgotten = false;
  static void describe(DocumentKeys<Forgetful>& d) { d.value<&Forgetful::kept>("kept"); }
};

struct Thoughtful : Forgetful {
  bool also = false;
  static void describe(DocumentKeys<Thoughtful>& d) {
    d.value<&Thoughtful::kept>("kept");
    d.value<&Thoughtful::also>("also");
    d.no_key<&Thoughtful::forgotten>();
  }
};

TEST(DocumentTable, AMemberWithoutAKeyIsFound) {
  EXPECT_THAT(document_table<Forgetful>().incomplete, ElementsAre(HasSubstr("Forgetful")));
  EXPECT_THAT(document_table<Thoughtful>().incomplete, IsEmpty());
}

/// A sensor with the required hook and no parameters.
engine::DeviceKind named_device(std::string_view name) {
  engine::DeviceKind kind{.name = name};
  kind.prepare = [](const engine::Record&, const Pose&) { return engine::DeviceKind::Prepared(); };
  return kind;
}

TEST(KindKeys, ParametersMayNotBeCalledLikeTheKeysOfAllDevices) {
  for (const char* parameter : {"name", "kind", "pose", "joint", "active", "on", "period", "reach"}) {
    engine::DeviceKind kind = named_device(parameter);
    kind.params.fields.push_back({.name = parameter, .fallback = 0.0});
    // `period` is allowed, because the key is then called `update_period`.
    const bool is_allowed = kind.name == "period" || kind.name == "reach";
    const Result<> names = check_kind(kind);
    EXPECT_EQ(static_cast<bool>(names), is_allowed) << kind.name;
    engine::Registry registry = make_registry();
    registry.devices.push_back(kind);
    const Result<> all = check_kinds(registry);
    ASSERT_EQ(static_cast<bool>(all), is_allowed) << kind.name;
    if (is_allowed) continue;
    const std::string name(kind.name);
    EXPECT_EQ(all.error().text, "the device kind \"" + name + "\" has a parameter \"" + name + "\", but \"" +
                                    name +
                                    "\" is a key that every sensor has in JSON worlds: rename the parameter");
  }
}

TEST(KindKeys, KindsMayNotBeCalledLikeComponentsOfTheEngine) {
  engine::Registry registry = make_registry();
  registry.controllers.push_back(*registry.controller("wander"));
  registry.controllers.back().name = "pose";
  EXPECT_EQ(
      check_kinds(registry).error().text,
      "the controller kind \"pose\" has the name of a component of the state that Troupe defines: rename "
      "it; all names except alive, carrier, command, condition, contact, joint, life, odometry, pose, stall, "
      "velocity are allowed");
  registry.controllers.back().name = "posture";
  EXPECT_TRUE(check_kinds(registry));
  registry.devices.push_back(named_device("alive"));
  EXPECT_THAT(check_kinds(registry).error().text, StartsWith("the device kind \"alive\" has the name of "));
}

TEST(KindKeys, KindsHaveDifferentNames) {
  const auto error = [](auto change) {
    engine::Registry registry = make_registry();
    change(registry);
    const Result<> checked = check_kinds(registry);
    return checked ? std::string() : checked.error().text;
  };
  using engine::Registry;
  const auto twice = [](std::string_view name, std::string_view what) {
    return "the registry has two kinds with the name \"" + std::string(name) + "\", each a " +
           std::string(what) + ": rename one";
  };
  EXPECT_EQ(error([](Registry& r) { r.devices.push_back(*r.device("ranger")); }), twice("ranger", "device"));
  EXPECT_EQ(error([](Registry& r) { r.drives.push_back(*r.drive("diff")); }), twice("diff", "drive"));
  EXPECT_EQ(error([](Registry& r) { r.controllers.push_back(*r.controller("wander")); }),
            twice("wander", "controller"));
  EXPECT_EQ(error([](Registry& r) { r.controllers.back().name = r.presets.front().name; }),
            twice(make_registry().presets.front().name, "controller"));
  EXPECT_EQ(error([](Registry& r) { r.measures.push_back(r.measures.front()); }),
            twice(make_registry().measures.front().name, "measure"));
  EXPECT_EQ(error([](Registry& r) { r.faults.push_back(r.faults.front()); }),
            twice(make_registry().faults.front().name, "fault"));
}

TEST(KindKeys, KindsHaveNamesAndTheHooksThatTheEngineCalls) {
  const auto error = [](auto kind, auto change) {
    change(kind);
    const Result<> checked = check_kind(kind);
    return checked ? std::string() : checked.error().text;
  };
  const engine::Registry all = make_registry();
  const std::string invalid =
      "has an invalid name: give one word that does not begin with a dot and contains none of : = / \\ and "
      "quotation marks";
  for (const char* name : {"", "a b", ".a", "a/b", "a:b"})
    EXPECT_EQ(error(named_device(name), [](auto&) {}), invalid) << name;
  EXPECT_EQ(error(all.drives.front(), [](auto& kind) { kind.name = ""; }), invalid);
  const auto unset = [](std::string_view hook) {
    return "does not set its member `" + std::string(hook) + "`";
  };
  EXPECT_EQ(error(all.devices.front(), [](auto& kind) { kind.prepare = nullptr; }), unset("prepare"));
  EXPECT_EQ(error(all.drives.front(), [](auto& kind) { kind.prepare = nullptr; }), unset("prepare"));
  EXPECT_EQ(error(all.drives.front(), [](auto& kind) { kind.check = nullptr; }), unset("check"));
  EXPECT_EQ(error(all.drives.front(), [](auto& kind) { kind.drive = nullptr; }), unset("drive"));
  EXPECT_EQ(error(all.controllers.front(), [](auto& kind) { kind.prepare = nullptr; }), unset("prepare"));
  EXPECT_EQ(error(all.controllers.front(), [](auto& kind) { kind.decide = nullptr; }), unset("decide"));
  EXPECT_EQ(error(all.measures.front(), [](auto& kind) { kind.make = nullptr; }), unset("make"));
  EXPECT_EQ(error(all.faults.front(), [](auto& kind) { kind.prepare = nullptr; }), unset("prepare"));
  engine::ControllerKind remembering = *all.controller("wander");
  remembering.memory.resize(1);
  EXPECT_EQ(error(remembering, [](auto& kind) { kind.start = nullptr; }), unset("start"));
  engine::Registry registry = all;
  registry.devices.push_back({.name = "eye"});
  EXPECT_EQ(check_kinds(registry).error().text, "the device kind \"eye\" does not set its member `prepare`");
}

/// A world with all components that the engine defines.
constexpr const char* k_all_components =
    R"({"troupe": 1, "mortal": true, "contacts": true, "arena": {"size_m": [4, 4]}, "types": {"bot": {
  "size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff", "localization": "odom"},
  "devices": [{"name": "hand", "kind": "gripper", "size_m": [0.2, 0.4, 0.1]}]}},
  "populations": [{"name": "r", "type": "bot", "count": 1, "reserve": 1, "place": {"rule": "uniform"}}]})";

TEST(KindKeys, TheComponentsOfTheEngineAreListed) {
  Diagnostics diagnostics;
  const engine::Registry registry = make_registry();
  const engine::WorldSpec spec = load_json_world("w.json", k_all_components, registry, {}, diagnostics);
  diagnostics.throw_if_errors();
  const engine::World world(spec, registry, {}, diagnostics);
  std::set<std::string> found;
  for (const engine::StateTable& table : world.tables()) {
    const std::string kind = table.component().substr(0, table.component().find('/'));
    if (registry.device(kind) == nullptr) found.insert(kind);
  }
  EXPECT_THAT(found, ElementsAreArray(engine::k_engine_components));
}

TEST(KindKeys, ParametersOfShippedKindsAreNotCalledLikeKeys) {
  const Result<> kinds = check_kinds(make_registry());
  EXPECT_TRUE(kinds) << kinds.error().text;
}

}  // namespace
}  // namespace troupe::worldio::document_table_test
