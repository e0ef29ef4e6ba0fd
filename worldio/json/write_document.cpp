#include "worldio/json/write_document.hpp"

#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_text.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace troupe::worldio {
namespace {

using engine::Value;

/// Returns a pose with x, y and heading even if they are at their defaults, because users look for them and
/// edit them.
JsonNode place_node(const engine::Record& pose) {
  const std::vector<engine::Field>& fields = engine::pose_fields().fields;
  JsonNode::Object object;
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].name != "z" || !same_bits(pose[i], fields[i].fallback))
      write_field(fields[i], pose[i], object);
  return json_node(std::move(object));
}

/// Writes one struct as a JSON object, key by key, as the table of the struct lists the keys.
class ObjectWriter {
 public:
  ObjectWriter(const DocumentTable& table, const void* object, const engine::Registry& registry)
      : table_(table), object_(object), registry_(registry) {}

  JsonNode write() {
    if (table_.kinds) find_kind();
    for (const DocumentKey& key : table_.keys) {
      const std::size_t before = written_.size();
      write_key(key);
      if (written_.size() == before || !placed().says(key.field.name)) continue;
      JsonMember& member = written_.back();
      member.where = member.node.where = placed().where_of(key.field.name);
    }
    return json_node(std::move(written_), placed().where);
  }

 private:
  const Placed& placed() const { return table_.placed(const_cast<void*>(object_)); }
  template <class M>
  const M& member(const DocumentKey& key) const {
    return *static_cast<const M*>(key.find(object_));
  }

  void find_kind() {
    for (const DocumentKey& key : table_.keys)
      if (key.form == Form::kind) name_ = &member<std::string>(key);
    if (const auto kind = table_.kinds->find(registry_, *name_)) kind_ = *kind;
  }

  void write_key(const DocumentKey& key);
  void write_value(const DocumentKey& key);
  JsonNode node(const DocumentKey& key) const;
  JsonNode entries(const DocumentKey& key) const;
  /// Whether the writer omits the key, because its member has no value or the default. Not for Form::value.
  bool is_missing(const DocumentKey& key) const;

  const DocumentTable& table_;
  const void* object_;
  const engine::Registry& registry_;
  const std::string* name_ = nullptr;
  DocumentKind kind_;
  JsonNode::Object written_;
};

void ObjectWriter::write_key(const DocumentKey& key) {
  if (key.is_resolved) return;
  switch (key.form) {
    case Form::value: return write_value(key);
    case Form::version: return add_member(written_, key.field.name, k_format_version);
    case Form::parameters:
      if (kind_.params) write_parameters(member<engine::Record>(key), *kind_.params, written_);
      return;
    case Form::kind:
      if (!table_.is_kind_implied || !table_.is_kind_implied(object_))
        add_member(written_, key.field.name, *name_);
      return;
    case Form::faults:
      for (const FaultDocument::Impairment& one : member<std::vector<FaultDocument::Impairment>>(key)) {
        JsonNode::Object params;
        if (const engine::FaultKind* kind = registry_.fault(one.kind))
          write_fields(one.params, kind->params, params);
        add_member(written_, one.kind, std::move(params));
      }
      return;
    case Form::heading:
      if (is_missing(key)) return;
      if (const auto& heading = member<HeadingDocument>(key); heading.is_random)
        add_member(written_, key.field.name, std::string("random"));
      else
        write_field(heading_field(), heading.rad, written_);
      return;
    default:
      if (!is_missing(key)) add_node(written_, key.field.name, node(key));
  }
}

void ObjectWriter::write_value(const DocumentKey& key) {
  const engine::Field& field = field_of(key, kind_.params);
  Value value = engine::get(field, object_);
  if (!value.given() || (!key.always && same_bits(value, engine::get(field, table_.usual)))) return;
  if (key.is_float) value = short_number(static_cast<float>(value.number()));
  if (key.always && field.type == engine::FieldType::record)
    return add_node(written_, field.name, place_node(value.records().front()));
  write_field(field, value, written_);
}

bool ObjectWriter::is_missing(const DocumentKey& key) const {
  const void* value = key.find(object_);
  if (!value) return true;
  if (key.always || key.is_optional) return false;
  switch (key.form) {
    case Form::choice:
      return *static_cast<const std::uint8_t*>(value) ==
             *static_cast<const std::uint8_t*>(key.find(table_.usual));
    case Form::name:
    case Form::model_kind: return static_cast<const std::string*>(value)->empty();
    case Form::names: return static_cast<const std::vector<std::string>*>(value)->empty();
    case Form::list:
    case Form::map: return key.size(value) == 0;
    default: return false;
  }
}

JsonNode ObjectWriter::node(const DocumentKey& key) const {
  switch (key.form) {
    case Form::choice: return json_node(std::string(key.field.choices[member<std::uint8_t>(key)]));
    case Form::seed: return json_node(member<std::uint64_t>(key));
    case Form::name:
    case Form::model_kind: return json_node(member<std::string>(key));
    case Form::names: {
      JsonNode::List list;
      for (const std::string& name : member<std::vector<std::string>>(key)) list.push_back(json_node(name));
      return json_node(std::move(list));
    }
    case Form::color: return color_node(member<Color>(key));
    case Form::color_or_random: {
      const auto& color = member<ColorDocument>(key);
      return color.is_random ? json_node(std::string("random")) : color_node(color.color);
    }
    case Form::points: return points_node(member<Ring>(key));
    case Form::box: {
      const Box& box = member<Box>(key);
      return points_node(std::array{box.min, box.max});
    }
    case Form::contours: {
      JsonNode::List list;
      for (const Ring& contour : member<std::vector<Ring>>(key)) list.push_back(points_node(contour));
      return json_node(std::move(list));
    }
    case Form::joint: {
      const JointName& joint = member<JointName>(key);
      return joint.name ? json_node(*joint.name) : json_node(std::monostate());
    }
    case Form::comparison: {
      const auto& is = member<ComparisonDocument>(key);
      return json_node(
          fmt::format("{} {}", engine::k_comparisons[static_cast<std::size_t>(is.how)], is.with));
    }
    case Form::kept: return member<JsonNode>(key);
    case Form::block: {
      JsonNode::Object block;
      write_fields(member<engine::Record>(key), *key.block, block);
      return json_node(std::move(block));
    }
    case Form::object: return write_described(key.table(), key.find(object_), registry_);
    case Form::list:
    case Form::map: return entries(key);
    default: return {};  // the other forms are written by write_key()
  }
}

JsonNode ObjectWriter::entries(const DocumentKey& key) const {
  const void* all = key.find(object_);
  JsonNode::List list;
  JsonNode::Object map;
  for (std::size_t i = 0; i < key.size(all); ++i) {
    JsonNode one = write_described(key.table(), key.item(all, i), registry_);
    if (key.form == Form::map)
      add_node(map, *key.item_name(all, i), std::move(one));
    else
      list.push_back(std::move(one));
  }
  return key.form == Form::map ? json_node(std::move(map)) : json_node(std::move(list));
}

}  // namespace

JsonNode write_described(const DocumentTable& table, const void* object, const engine::Registry& registry) {
  if (table.shorthand)
    if (auto text = table.shorthand->write(object, registry))
      return json_node(std::move(*text), table.placed(const_cast<void*>(object)).where);
  return ObjectWriter(table, object, registry).write();
}

}  // namespace troupe::worldio
