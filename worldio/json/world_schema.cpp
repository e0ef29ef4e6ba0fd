#include "worldio/json/world_schema.hpp"

#include "engine/fields/description.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_include.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/key_row.hpp"
#include "worldio/json/world_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Unit;
using engine::UnitSuffix;
using Members = JsonNode::Object;

JsonNode object_of(std::initializer_list<std::pair<std::string_view, JsonNode>> members) {
  Members object;
  for (const auto& [key, node] : members) add_node(object, key, node);
  return json_node(std::move(object));
}

JsonNode list_of(std::vector<JsonNode> nodes) { return json_node(JsonNode::List(std::move(nodes))); }

JsonNode text(std::string_view value) { return json_node(std::string(value)); }

template <class Names>
JsonNode texts(const Names& names) {
  JsonNode::List list;
  for (const auto& name : names) list.push_back(text(name));
  return json_node(std::move(list));
}

JsonNode type(std::string_view name) { return object_of({{"type", text(name)}}); }

JsonNode reference(std::string_view name) {
  return object_of({{"$ref", text(fmt::format("#/definitions/{}", name))}});
}

JsonNode array_of(JsonNode items) {
  return object_of({{"type", text("array")}, {"items", std::move(items)}});
}

JsonNode array_of(JsonNode items, std::size_t count) {
  return object_of({{"type", text("array")},
                    {"items", std::move(items)},
                    {"minItems", json_node(static_cast<std::int64_t>(count))},
                    {"maxItems", json_node(static_cast<std::int64_t>(count))}});
}

JsonNode choice(std::vector<JsonNode> nodes, std::string_view how = "anyOf") {
  return object_of({{how, list_of(std::move(nodes))}});
}

JsonNode described(JsonNode schema, std::string_view about) {
  if (!about.empty()) add_node(std::get<Members>(schema.value), "description", text(about));
  return schema;
}

double rounded_to_digits(double x) {
  constexpr int k_digits = 10;
  std::array<char, 32> digits{};
  const auto [end, error] =
      std::to_chars(digits.data(), digits.data() + digits.size(), x, std::chars_format::general, k_digits);
  double rounded = 0;
  std::from_chars(digits.data(), end, rounded);
  return rounded;
}

/// Converts the limit `si` from SI units to the unit of the key suffix `suffix`, such as "_deg". The limit is
/// rounded to ten digits, in the direction in which the schema is not stricter than the reader. `outward` is
/// 1 for a maximum and -1 for a minimum.
double limit_in(const UnitSuffix& suffix, double si, double outward) {
  if (suffix.to_si == 1) return si;
  constexpr double k_digits = 1e-9;
  const double limit = si / suffix.to_si;
  const double rounded = rounded_to_digits(limit);
  const bool is_tighter = (limit - rounded) * outward > 0;
  return is_tighter ? rounded_to_digits(limit + outward * k_digits * std::abs(limit)) : rounded;
}

void add_limits(const Field& field, const UnitSuffix& suffix, Members& schema) {
  if (std::isfinite(field.min))
    add_member(schema, field.above_min ? "exclusiveMinimum" : "minimum", limit_in(suffix, field.min, -1));
  if (std::isfinite(field.max)) add_member(schema, "maximum", limit_in(suffix, field.max, 1));
}

JsonNode number_schema(const Field& field, const UnitSuffix& suffix, std::string_view name) {
  Members schema;
  add_member(schema, "type", std::string(name));
  add_limits(field, suffix, schema);
  return json_node(std::move(schema));
}

JsonNode table_schema(const FieldTable& table);
JsonNode entry_schema(const FieldTable& table);

JsonNode value_schema(const Field& field, const UnitSuffix& suffix) {
  switch (field.type) {
    case FieldType::boolean: return type("boolean");
    case FieldType::integer: return number_schema(field, suffix, "integer");
    case FieldType::number: return number_schema(field, suffix, "number");
    case FieldType::text:
      return field.choices.empty() ? type("string") : object_of({{"enum", texts(field.choices)}});
    case FieldType::texts: return array_of(type("string"));
    case FieldType::numbers: {
      const bool is_whole = engine::has_whole_numbers(field) && suffix.to_si == 1;
      JsonNode numbers = number_schema(field, suffix, is_whole ? "integer" : "number");
      return field.columns > 0 ? array_of(std::move(numbers), field.columns) : array_of(std::move(numbers));
    }
    case FieldType::color: return reference("color");
    case FieldType::colors: return array_of(reference("color"));
    case FieldType::record:
      return field.record == &engine::pose_fields() ? reference("pose") : table_schema(*field.record);
    case FieldType::records: return array_of(entry_schema(*field.record));
  }
  return {};
}

void add_default(const Field& field, const UnitSuffix& suffix, Members& schema) {
  if (suffix.to_si != 1 || field.is_without_limit() ||
      std::holds_alternative<std::vector<engine::Record>>(field.fallback.v))
    return;
  Members one;
  Field bare = field;
  bare.unit = Unit::none;
  write_field(bare, field.usual_in_json(), one);
  if (!one.empty()) add_node(schema, "default", std::move(one.front().node));
}

/// Builds the schema of an object that has certain keys and no others.
class ObjectSchema {
 public:
  ObjectSchema& member(std::string_view key, JsonNode schema, std::string_view about = {}) {
    add_node(properties_, key, described(std::move(schema), about));
    return *this;
  }

  /// Replaces the schema of an existing key.
  ObjectSchema& replace(std::string_view key, JsonNode schema) {
    std::ranges::find(properties_, key, &JsonMember::key)->node = std::move(schema);
    return *this;
  }

  ObjectSchema& required(std::string_view key, JsonNode schema, std::string_view about = {}) {
    required_.push_back(text(key));
    return member(key, std::move(schema), about);
  }

  /// Adds one key for each unit of a field, such as `fov_rad` and `fov_deg`. An object has at most one of
  /// these keys, or exactly one if `required`.
  ObjectSchema& field(const Field& field, bool required) {
    const auto suffixes = engine::unit_suffixes(field.unit);
    std::vector<JsonNode> one_of;
    for (const UnitSuffix& suffix : suffixes) {
      const std::string key = fmt::format("{}{}", field.name, suffix.suffix);
      JsonNode schema = described(value_schema(field, suffix), meaning_text(field));
      add_default(field, suffix, std::get<Members>(schema.value));
      add_node(properties_, key, std::move(schema));
      one_of.push_back(object_of({{"required", texts(std::array{key})}}));
    }
    if (suffixes.size() == 1) {
      if (required) required_.push_back(text(fmt::format("{}{}", field.name, suffixes.front().suffix)));
      return *this;
    }
    if (!required) one_of.push_back(object_of({{"not", choice(one_of)}}));
    rules_.push_back(choice(std::move(one_of), "oneOf"));
    return *this;
  }

  ObjectSchema& fields(const FieldTable& table, bool with_defaults = true) {
    const engine::Record defaults = table.defaults();
    for (std::size_t i = 0; i < table.fields.size(); ++i)
      field(table.fields[i], with_defaults && !defaults[i].given());
    return *this;
  }

  ObjectSchema& rule(JsonNode schema) {
    rules_.push_back(std::move(schema));
    return *this;
  }

  JsonNode done() {
    Members schema;
    add_member(schema, "type", std::string("object"));
    add_member(schema, "properties", std::move(properties_));
    add_member(schema, "additionalProperties", false);
    if (!required_.empty()) add_member(schema, "required", std::move(required_));
    if (!rules_.empty()) add_member(schema, "allOf", std::move(rules_));
    return json_node(std::move(schema));
  }

 private:
  Members properties_;
  JsonNode::List required_;
  JsonNode::List rules_;
};

JsonNode table_schema(const FieldTable& table) { return ObjectSchema().fields(table).done(); }

/// Returns the schema of an entry of a list, which may have the key `ring` if it has a pose.
JsonNode entry_schema(const FieldTable& table) {
  ObjectSchema entry;
  if (table.find("pose") >= 0)
    entry.member("ring", reference("ring"),
                 "replaces this entry by several copies on a circle around its position");
  return entry.fields(table).done();
}

/// Returns the description of a number without a unit.
Field plain_number(double min, double max) { return {.name = "", .min = min, .max = max}; }

JsonNode color_schema() {
  JsonNode level = number_schema(plain_number(0, 1), {"", "", 1}, "number");
  return choice(
      {object_of({{"type", text("string")}, {"description", text("X11 name: red, SteelBlue, gray30, ...")}}),
       object_of({{"type", text("array")},
                  {"description", text("[red, green, blue] or [red, green, blue, opacity]")},
                  {"items", std::move(level)},
                  {"minItems", json_node(std::int64_t{3})},
                  {"maxItems", json_node(std::int64_t{4})}})});
}

JsonNode kind_of(std::string_view name) { return object_of({{"const", text(name)}}); }

JsonNode has_key(std::string_view key) { return object_of({{"required", texts(std::array{key})}}); }

/// Returns the schema of an object whose kind comes from a plug-in: its name is not in `known`, and its
/// parameters are not checked, because only the plug-in knows them.
JsonNode kind_of_a_plug_in(std::string_view what, std::string_view page,
                           const std::vector<std::string_view>& known) {
  const JsonNode other =
      object_of({{"not", object_of({{"enum", texts(known)}})},
                 {"type", text("string")},
                 {"description",
                  text(fmt::format("the name of a {} that a plug-in defines; see docs/{}.md", what, page))}});
  return object_of({{"type", text("object")},
                    {"properties", object_of({{"kind", other}})},
                    {"required", texts(std::array{"kind"})}});
}

/// Adds DocumentKey::least, the minimum number of entries, to the schema `list` and returns this schema.
JsonNode counted(JsonNode list, const DocumentKey& key) {
  if (key.least > 0)
    add_member(std::get<Members>(list.value), "minItems", static_cast<std::int64_t>(key.least));
  return list;
}

/// Makes the schemas of structs that have a DocumentTable. The schema of a struct whose table has a
/// definition name is stored once, under "definitions", and referenced everywhere else.
class DocumentSchema {
 public:
  explicit DocumentSchema(const engine::Registry& registry) : registry_(registry) {}

  JsonNode of(const DocumentTable& table) const {
    std::vector<JsonNode> choices;
    if (table.shorthand && table.shorthand->before_object) add_shorthand(table, choices);
    if (table.kinds)
      add_kinds(table, choices);
    else if (!table.variant.empty())
      for (std::size_t i = 0; i < table.find(table.variant)->field.choices.size(); ++i)
        choices.push_back(object(table, nullptr, i));
    else
      choices.push_back(object(table, nullptr, k_no_variant));
    if (table.shorthand && !table.shorthand->before_object) add_shorthand(table, choices);
    const bool is_one = !table.kinds && table.variant.empty() && !table.shorthand;
    return is_one ? std::move(choices.front()) : choice(std::move(choices));
  }

 private:
  static constexpr std::size_t k_no_variant = ~std::size_t{0};

  void add_shorthand(const DocumentTable& table, std::vector<JsonNode>& choices) const {
    for (JsonNode& schema : table.shorthand->schemas(registry_)) choices.push_back(std::move(schema));
  }

  void add_kinds(const DocumentTable& table, std::vector<JsonNode>& choices) const {
    const DocumentKinds& kinds = *table.kinds;
    for (const DocumentKind& kind : kinds.all(registry_))
      choices.push_back(object(table, &kind, k_no_variant));
    if (!kinds.page.empty())
      choices.push_back(kind_of_a_plug_in(kinds.what, kinds.page, kinds.named(registry_)));
  }

  JsonNode reference_to(const DocumentTable& table) const {
    return table.definition.empty() ? of(table) : reference(table.definition);
  }

  JsonNode object(const DocumentTable& table, const DocumentKind* kind, std::size_t variant) const {
    ObjectSchema schema;
    for (const DocumentKey& key : table.keys) {
      if (variant != k_no_variant && (key.variants >> variant & 1) == 0) continue;
      if (key.is_of && !(kind && key.is_of(kind->kind))) continue;
      add_key(table, key, kind, schema);
      if (variant != k_no_variant && key.field.name == table.variant)
        schema.replace(key.field.name, kind_of(key.field.choices[variant]));
    }
    for (const DocumentRule& rule : table.rules) add_rule(table, rule, schema);
    return schema.done();
  }

  void add_key(const DocumentTable& table, const DocumentKey& key, const DocumentKind* kind,
               ObjectSchema& schema) const {
    std::string about(key.field.text);
    if (!key.by_default.empty())
      about += fmt::format("{}default: {}", about.empty() ? "" : "; ", key.by_default);
    switch (key.form) {
      case Form::value:
      case Form::choice: {
        Field field = key.form == Form::value ? field_of(key, kind ? kind->params : nullptr) : key.field;
        field.text = about;
        if (key.form == Form::value && !key.required && !key.is_optional)
          field.fallback = engine::get(field, table.usual);
        schema.field(field, key.required);
        return;
      }
      case Form::heading:
        schema.member(key.field.name, object_of({{"const", text("random")}})).field(heading_field(), false);
        return;
      case Form::parameters: schema.fields(*kind->params, kind->preset_of.empty()); return;
      case Form::faults: {
        std::vector<JsonNode> any;
        for (const engine::FaultKind& fault : registry_.faults) {
          any.push_back(has_key(fault.name));
          schema.member(fault.name, table_schema(fault.params), fault.text);
        }
        schema.rule(choice(std::move(any)));
        return;
      }
      case Form::kind:
        if (key.required)
          schema.required(key.field.name, kind_of(kind->name), kind->text);
        else
          schema.member(key.field.name, kind_of(kind->name), kind->text);
        return;
      default: break;
    }
    if (key.required)
      schema.required(key.field.name, value(key), about);
    else
      schema.member(key.field.name, value(key), about);
  }

  JsonNode value(const DocumentKey& key) const {
    switch (key.form) {
      case Form::version: return object_of({{"const", json_node(k_format_version)}});
      case Form::seed: return object_of({{"type", text("integer")}, {"minimum", json_node(std::int64_t{0})}});
      case Form::names: return counted(array_of(type("string")), key);
      case Form::model_kind: {
        std::vector<std::string_view> kinds;
        for (const engine::ModelKind& kind : registry_.models) kinds.push_back(kind.name);
        return object_of({{"enum", texts(kinds)}});
      }
      case Form::color:
      case Form::color_or_random: return reference("color");
      case Form::points: return counted(array_of(reference("point_m")), key);
      case Form::box: return reference("box_m");
      case Form::contours: return array_of(counted(array_of(reference("point_m")), key));
      case Form::joint: return choice({type("string"), type("null")});
      case Form::comparison:
        return object_of({{"type", text("string")}, {"pattern", text(comparison_pattern())}});
      case Form::kept: {
        JsonNode kept = type("object");
        if (!key.expects.empty())
          add_node(std::get<Members>(kept.value), "required", texts(std::array{key.expects}));
        return kept;
      }
      case Form::block: return table_schema(*key.block);
      case Form::object: return reference_to(key.table());
      case Form::list: return counted(array_of(reference_to(key.table())), key);
      case Form::map: {
        JsonNode entry = reference_to(key.table());
        // A type with the key "extends" inherits keys, so it may lack required keys: any object with
        // "extends" is valid.
        if (key.table().find("extends")) entry = choice({has_key("extends"), std::move(entry)});
        return object_of({{"type", text("object")}, {"additionalProperties", std::move(entry)}});
      }
      default: return type("string");
    }
  }

  static void add_rule(const DocumentTable& table, const DocumentRule& rule, ObjectSchema& schema) {
    if (rule.how == DocumentRule::How::not_both) {
      schema.rule(object_of({{"not", object_of({{"required", texts(rule.keys)}})}}));
      return;
    }
    std::vector<JsonNode> have;
    for (const std::string_view name : rule.keys) {
      const DocumentKey* key = table.find(name);
      const Unit unit = key->form == Form::value ? key->field.unit : Unit::none;
      for (const UnitSuffix& suffix : engine::unit_suffixes(unit))
        have.push_back(has_key(fmt::format("{}{}", name, suffix.suffix)));
    }
    schema.rule(choice(std::move(have), rule.how == DocumentRule::How::one_of ? "oneOf" : "anyOf"));
  }

  const engine::Registry& registry_;
};

JsonNode definitions(const engine::Registry& registry) {
  const DocumentSchema schema(registry);
  JsonNode point =
      array_of(number_schema(plain_number(-k_max_size_m, k_max_size_m), {"", "", 1}, "number"), 2);
  return object_of(
      {{"color", color_schema()},
       {"pose", table_schema(engine::pose_fields())},
       {"point_m", std::move(point)},
       {"box_m", described(array_of(reference("point_m"), 2), "[[x_min, y_min], [x_max, y_max]]")},
       {"block", schema.of(document_table<BlockDocument>())},
       {"disc", schema.of(document_table<DiscDocument>())},
       {"ring", schema.of(document_table<RingDocument>())},
       {"drive", schema.of(document_table<DriveDocument>())},
       {"sensor", schema.of(document_table<SensorDocument>())},
       {"device", schema.of(document_table<DeviceDocument>())},
       {"own_device", schema.of(document_table<OwnDeviceDocument>())},
       {"controller", schema.of(document_table<ControllerDocument>())},
       {"group", schema.of(document_table<GroupDocument>())},
       {"part", schema.of(document_table<PartDocument>())},
       {"type", schema.of(document_table<TypeDocument>())}});
}

}  // namespace

std::string world_schema(const engine::Registry& registry) {
  JsonNode schema = DocumentSchema(registry).of(document_table<WorldDocument>());
  Members& members = std::get<Members>(schema.value);
  Members head;
  add_member(head, "$schema", std::string("http://json-schema.org/draft-07/schema#"));
  add_member(head, "title", std::string("A world of Troupe"));
  members.insert(members.begin(), head.begin(), head.end());
  // A file with only the keys of an included file may be one, and may then lack the keys that a world needs.
  const auto required = std::ranges::find(members, "required", &JsonMember::key);
  required->key = "else";
  required->node = object_of({{"required", required->node}});
  Members condition;
  add_node(condition, "if", object_of({{"propertyNames", object_of({{"enum", texts(k_included_keys)}})}}));
  members.insert(required, condition.front());
  add_node(members, "definitions", definitions(registry));
  return json_text(schema);
}

}  // namespace troupe::worldio
