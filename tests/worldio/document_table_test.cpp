#include "worldio/json/document_table.hpp"

#include "engine/kinds/kinds.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/kind_keys.hpp"
#include "worldio/json/world_document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace troupe::worldio {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

TEST(KindKeys, ParametersMayNotBeCalledLikeTheKeysOfAllDevices) {
  for (const char* parameter : {"name", "kind", "pose", "joint", "active", "on", "period", "reach"}) {
    engine::DeviceKind kind{.name = parameter};
    kind.params.fields.push_back({.name = parameter, .fallback = 0.0});
    // `period` is allowed, because the key is then called `update_period`.
    const bool is_allowed = kind.name == "period" || kind.name == "reach";
    const Result<> names = check_parameter_names(kind);
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

TEST(KindKeys, ParametersOfShippedKindsAreNotCalledLikeKeys) {
  const Result<> kinds = check_kinds(make_registry());
  EXPECT_TRUE(kinds) << kinds.error().text;
}

}  // namespace
}  // namespace troupe::worldio
