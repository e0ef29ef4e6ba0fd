#include "worldio/json/document_table.hpp"

#include <algorithm>

namespace troupe::worldio {

const DocumentKey* DocumentTable::find(std::string_view name) const {
  const auto found =
      std::ranges::find_if(keys, [&](const DocumentKey& key) { return key.field.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

const engine::Field& heading_field() { return engine::pose_fields().at("heading"); }

const engine::Field& field_of(const DocumentKey& key, const engine::FieldTable* params) {
  return key.other && params && params->find(key.field.name) >= 0 ? *key.other : key.field;
}

}  // namespace troupe::worldio
