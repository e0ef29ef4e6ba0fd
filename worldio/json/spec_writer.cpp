#include "worldio/characters.hpp"
#include "worldio/json/experiment_json.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/spec_fields.hpp"
#include "worldio/json/spec_json.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Value;
using OrderedJson = nlohmann::ordered_json;

double finite(double x, const Field& field) {
  if (!std::isfinite(x))
    throw std::runtime_error(fmt::format(
        "\"{}\" of the world is {}, which JSON cannot represent: give a finite number", key_of(field), x));
  return x;
}

/// Returns a text as JSON. Names of files may be in any encoding, so a text that is not UTF-8 is written as
/// {"latin1": ...}, with one character per byte.
OrderedJson text_json(const std::string& text) {
  OrderedJson json = text;
  try {
    static_cast<void>(json.dump());
    return json;
  } catch (const OrderedJson::type_error&) {
  }
  OrderedJson other;
  other["latin1"] = latin1_to_utf8(text);
  return other;
}

/// Whether the reader of stored worlds accepts the value of a parameter. The reader refuses values outside
/// the limits of the parameter, even a default that is outside them because it means "not given".
bool takes(const Field& field, const Value& value) {
  switch (field.type) {
    case FieldType::integer: return is_within(field, integer_number(field, value));
    case FieldType::number: return is_within(field, value.number());
    case FieldType::text:
      return field.choices.empty() || std::ranges::find(field.choices, value.text()) != field.choices.end();
    case FieldType::numbers:
      return (field.columns == 0 || value.numbers().size() == field.columns) &&
             std::ranges::all_of(value.numbers(), [&field](double x) { return is_within(field, x); });
    default: return true;
  }
}

OrderedJson params_json(const Record& record, const FieldTable& table);

OrderedJson value_json(const Value& value, const Field& field) {
  switch (field.type) {
    case FieldType::boolean: return value.boolean();
    case FieldType::integer: return value.integer();
    case FieldType::number: return finite(value.number(), field);
    case FieldType::text: return value.text();
    case FieldType::texts: return value.texts();
    case FieldType::numbers:
    case FieldType::color: {
      OrderedJson list = OrderedJson::array();
      list.get_ref<OrderedJson::array_t&>().reserve(value.numbers().size());
      for (const double x : value.numbers()) list.push_back(finite(x, field));
      return list;
    }
    case FieldType::colors: {
      OrderedJson list = OrderedJson::array();
      const std::vector<double>& parts = value.numbers();
      for (std::size_t i = 0; i + 2 < parts.size(); i += 3)
        list.push_back({finite(parts[i], field), finite(parts[i + 1], field), finite(parts[i + 2], field)});
      return list;
    }
    case FieldType::record: return params_json(value.records().front(), *field.record);
    case FieldType::records: break;
  }
  OrderedJson list = OrderedJson::array();
  for (const Record& record : value.records()) list.push_back(params_json(record, *field.record));
  return list;
}

OrderedJson params_json(const Record& record, const FieldTable& table) {
  OrderedJson json = OrderedJson::object();
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const Field& field = table.fields[i];
    const Value& value = record[i];
    if (!value.given() || (value == field.fallback && !takes(field, value))) continue;
    json[key_of(field)] = value_json(value, field);
  }
  return json;
}

/// Appends to `list` all numbers of a struct that consists only of numbers.
void list_numbers(const FieldTable& table, const void* object, OrderedJson& list) {
  for (const Field& field : table.fields) {
    if (field.type == FieldType::record) {
      list_numbers(*field.record, member_of(field, object), list);
      continue;
    }
    OrderedJson value = value_json(engine::get(field, object), field);
    if (field.type == FieldType::numbers)
      list.insert(list.end(), value.begin(), value.end());
    else
      list.push_back(std::move(value));
  }
}

/// Converts the structs of a WorldSpec to JSON, field by field, as the FieldTable of each struct lists them.
class SpecWriter {
 public:
  SpecWriter(const engine::WorldSpec& spec, const engine::Registry& registry)
      : spec_(spec), registry_(registry) {}

  OrderedJson object(const FieldTable& table, const void* object) const {
    OrderedJson json = OrderedJson::object();
    for (const Field& field : table.fields) {
      if (field.member == nullptr || field.record == &engine::experiment_fields())
        write_apart(field.name, json);
      else if (std::optional<OrderedJson> member = member_json(field, table, object))
        json[key_of(field)] = *std::move(member);
    }
    return json;
  }

 private:
  std::optional<OrderedJson> member_json(const Field& field, const FieldTable& table,
                                         const void* object) const;
  OrderedJson list_json(const Field& field, const engine::MemberType& type, const void* list) const;
  OrderedJson struct_json(const FieldTable& table, const void* object) const;
  /// Writes a member of the world that has a format of its own: files, words, names of parts, experiment.
  void write_apart(std::string_view name, OrderedJson& json) const;
  void write_part_names(OrderedJson& json) const;
  void write_experiment(OrderedJson& json) const;

  const engine::WorldSpec& spec_;
  const engine::Registry& registry_;
};

/// Returns a member of a struct as JSON. Empty if the member is omitted, because it has no value or is sparse
/// (Field::sparse) and at its default.
std::optional<OrderedJson> SpecWriter::member_json(const Field& field, const FieldTable& table,
                                                   const void* object) const {
  const engine::MemberType& type = *field.member;
  const void* member = member_of(field, object);
  if (field.type == FieldType::records || type.each != nullptr) {
    if (field.sparse && type.size(member) == 0) return std::nullopt;
    return list_json(field, type, member);
  }
  if (field.type == FieldType::record && field.record != nullptr) {
    if (type.size(member) == 0) return std::nullopt;
    return struct_json(*field.record, block_of(type, member, 0));
  }
  const Value value = type.get(member);
  if (!value.given() || (field.sparse && value == field.fallback)) return std::nullopt;
  if (field.type == FieldType::record) {
    const Result<const FieldTable*> parameters = parameters_of(table, object, registry_);
    if (!parameters) throw std::runtime_error("the world cannot be stored: " + parameters.error().text);
    return params_json(value.records().front(), **parameters);
  }
  if (field.type == FieldType::text) return text_json(value.text());
  if (field.type == FieldType::texts) {
    OrderedJson list = OrderedJson::array();
    for (const std::string& text : value.texts()) list.push_back(text_json(text));
    return list;
  }
  if (type.is_unsigned) return static_cast<std::uint64_t>(value.integer());
  return value_json(value, field);
}

OrderedJson SpecWriter::list_json(const Field& field, const engine::MemberType& type,
                                  const void* list) const {
  OrderedJson json = OrderedJson::array();
  const std::size_t size = type.size(list);
  json.get_ref<OrderedJson::array_t&>().reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    const void* entry = block_of(type, list, i);
    if (type.each == nullptr)
      json.push_back(struct_json(*field.record, entry));
    else if (type.each->each == nullptr)
      json.push_back(value_json(type.each->get(entry), field));
    else
      json.push_back(list_json(field, *type.each, entry));
  }
  return json;
}

OrderedJson SpecWriter::struct_json(const FieldTable& table, const void* object) const {
  if (!is_listed(table)) return this->object(table, object);
  OrderedJson list = OrderedJson::array();
  list_numbers(table, object, list);
  return list;
}

void SpecWriter::write_apart(std::string_view name, OrderedJson& json) const {
  if (name == "files") {
    json["files"] = OrderedJson::array();
    for (std::uint32_t i = 0; spec_.files && i < spec_.files->size(); ++i)
      json["files"].push_back(text_json(spec_.files->name(i)));
  } else if (name == "words") {
    json["words"] = OrderedJson::array();
    for (const std::string& word : spec_.names.words()) json["words"].push_back(text_json(word));
  } else if (name == "part_names") {
    write_part_names(json);
  } else if (name == "experiment") {
    write_experiment(json);
  }  // bodies and aliases are written as BodyColumns
}

void SpecWriter::write_part_names(OrderedJson& json) const {
  json["part_names"] = OrderedJson::array();
  const std::map<std::string, engine::PartName> sorted(spec_.part_aliases.begin(), spec_.part_aliases.end());
  for (const auto& [name, place] : sorted) {
    const auto& [body, part] = place;
    json["part_names"].push_back(
        {{"name", text_json(name)}, {"body", body.value}, {"part", text_json(part)}});
  }
}

/// Writes the experiment in the format of JSON worlds, except that types are named by their numbers.
void SpecWriter::write_experiment(OrderedJson& json) const {
  if (spec_.experiment.empty()) return;
  JsonNode::Object object;
  worldio::write_experiment(spec_, numbers_of_types(spec_), registry_, object);
  json.update(OrderedJson::parse(json_text(json_node(std::move(object)))));
}

}  // namespace

std::vector<std::string> numbers_of_types(const engine::WorldSpec& spec) {
  std::vector<std::string> numbers;
  for (std::size_t t = 0; t < spec.types.size(); ++t) numbers.push_back(std::to_string(t));
  return numbers;
}

std::string spec_to_json(const engine::WorldSpec& spec, const engine::Registry& registry) {
  const OrderedJson json = SpecWriter(spec, registry).object(engine::world_fields(), &spec);
  try {
    return json.dump();
  } catch (const OrderedJson::type_error&) {
    throw std::runtime_error(
        "a text among the parameters of the world is not UTF-8, which JSON requires: write texts in UTF-8");
  }
}

BodyColumns body_columns(const engine::WorldSpec& spec) {
  BodyColumns columns;
  const std::size_t count = spec.bodies.size();
  for (auto* column : {&columns.word, &columns.number, &columns.type, &columns.file, &columns.line})
    column->reserve(count);
  columns.pose.reserve(4 * count);
  columns.color.reserve(4 * count);
  columns.fiducial.reserve(count);
  for (const engine::BodySpec& body : spec.bodies) {
    const auto& [name, type, pose_world_body, color, fiducial, where] = body;
    const auto& [x, y, z, heading] = pose_world_body;
    const auto& [r, g, b, a] = color;
    columns.word.push_back(name.word);
    columns.number.push_back(name.number);
    columns.type.push_back(type.value);
    columns.pose.insert(columns.pose.end(), {x, y, z, heading});
    columns.color.insert(columns.color.end(), {r, g, b, a});
    columns.fiducial.push_back(fiducial);
    columns.file.push_back(where.file);
    columns.line.push_back(where.line);
  }
  if (std::ranges::all_of(columns.fiducial, [](std::int32_t mark) { return mark == 0; }))
    columns.fiducial.clear();
  for (const engine::NamedBody& alias : spec.aliases) {
    const auto& [name, body] = alias;
    columns.alias_word.push_back(name.word);
    columns.alias_number.push_back(name.number);
    columns.alias_body.push_back(body.value);
  }
  return columns;
}

StoredSpec store_spec(const engine::WorldSpec& spec, const engine::Registry& registry) {
  return {spec_to_json(spec, registry), body_columns(spec)};
}

}  // namespace troupe::worldio
