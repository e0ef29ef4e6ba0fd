#include "base/number_text.hpp"
#include "base/split.hpp"
#include "worldio/json/experiment_json.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/spec_fields.hpp"
#include "worldio/json/spec_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::SettingSpec;
using engine::Value;

std::vector<std::string_view> tokens_of(std::string_view pointer) {
  if (!pointer.starts_with('/')) return {};
  return split(pointer.substr(1), '/');
}

/// Whether a pointer is in k_changeable.
bool is_changeable(std::string_view pointer) {
  const std::vector<std::string_view> tokens = tokens_of(pointer);
  const auto token = [&tokens](std::size_t i) { return i < tokens.size() ? tokens[i] : std::string_view(); };
  if (tokens.size() == 1)
    return token(0) == "seed" || token(0) == "quit_time_s" || token(0) == "stop_when" ||
           token(0) == "ranging" || token(0) == "resolution_m" || token(0) == "bounds_m";
  if (token(0) == "bounds_m") return tokens.size() == 2;
  if (token(0) != "types") return false;
  const bool is_drive = token(2) == "drive";
  if (!is_drive && token(2) != "sensors" && token(2) != "controllers") return false;
  const std::size_t at = is_drive ? 3 : 4;
  if (token(at) == "params") return tokens.size() > at + 1;
  if (tokens.size() != at + 1 || token(2) == "controllers") return false;
  return token(at) == "period_s" || (token(at) == "active" && !is_drive);
}

/// Reads a text as spec_to_json() writes it: a JSON text, or {"latin1": ...} with one character per byte.
/// Empty if the node is neither.
std::optional<std::string> text_of(const JsonNode& node) {
  if (const std::string* text = node.text()) return *text;
  const JsonNode* latin1 = node.find("latin1");
  const std::string* characters = latin1 ? latin1->text() : nullptr;
  if (!characters) return std::nullopt;
  std::string bytes;
  for (std::size_t i = 0; i < characters->size(); ++i) {
    const auto first = static_cast<unsigned char>((*characters)[i]);
    if (first < 0x80) {
      bytes += static_cast<char>(first);
      continue;
    }
    if (first > 0xc3 || ++i == characters->size()) return std::nullopt;
    bytes += static_cast<char>((first & 3) << 6 | ((*characters)[i] & 0x3f));
  }
  return bytes;
}

/// Reads a list of texts, each as spec_to_json() writes it.
std::vector<std::string> texts_of(const JsonCursor& at, std::string_view what) {
  std::vector<std::string> texts;
  const JsonNode::List* list = read_list(at);
  for (std::size_t i = 0; list && i < list->size(); ++i) {
    const JsonCursor entry(at, i, (*list)[i]);
    std::optional<std::string> text = text_of(entry.node());
    if (!text) entry.expected(what);
    texts.push_back(std::move(text).value_or(""));
  }
  return texts;
}

/// Returns the description of a list of `columns` numbers with the limits of `field`.
Field numbers_like(const Field& field, std::size_t columns) {
  return {
      .name = field.name, .type = FieldType::numbers, .min = field.min, .max = field.max, .columns = columns};
}

/// Reads a member that is neither a struct, nor a record of parameters, nor a list of structs or points. If
/// the value is wrong, reports an error and returns a value that is not given.
Value scalar(const JsonCursor& at, const Field& field) {
  if (field.type == FieldType::texts) return texts_of(at, "a text");
  if (field.type == FieldType::color)
    return read_value(at, numbers_like(field, 4));  // stored worlds have no colour names
  if (field.type == FieldType::text && field.choices.empty()) {
    if (std::optional<std::string> text = text_of(at.node())) return *std::move(text);
    at.expected("a text");
    return {};
  }
  if (!field.member->is_unsigned || std::isfinite(field.max)) return read_value(at, field);
  const auto* small = std::get_if<std::int64_t>(&at.node().value);
  const auto* big = std::get_if<std::uint64_t>(&at.node().value);
  if (big) return static_cast<std::int64_t>(*big);  // only the type changes, not the bits
  if (small && *small >= 0) return *small;
  at.expected("a whole number from 0 to 2^64 - 1");
  return {};
}

/// Fills a struct, which must consist only of numbers, with the first elements of `numbers`, and removes
/// these elements from the span.
void set_numbers(const FieldTable& table, void* object, std::span<const double>& numbers) {
  for (const Field& field : table.fields) {
    if (field.type == FieldType::record) {
      set_numbers(*field.record, member_of(field, object), numbers);
      continue;
    }
    const std::size_t count = std::max<std::size_t>(field.columns, 1);
    const std::span<const double> own = numbers.first(count);
    if (field.type == FieldType::numbers)
      engine::set(field, object, std::vector<double>(own.begin(), own.end()));
    else
      engine::set(field, object, own.front());
    numbers = numbers.subspan(count);
  }
}

/// An entry of WorldSpec::part_aliases: a name by which programs can look up a part, the body that has the
/// part, and the name of the part in its type.
struct NamedPart {
  std::string name;
  BodyId body{0};
  std::string part;

  static constexpr void describe(engine::Description<NamedPart>& d) {
    d.member<&NamedPart::name>("name");
    d.member<&NamedPart::body>("body");
    d.member<&NamedPart::part>("part");
  }
};

/// Reads the JSON that spec_to_json() writes, and the columns of the bodies. If errors are reported, the spec
/// is incomplete and must not be used.
class SpecReader {
 public:
  SpecReader(const engine::Registry& registry, Where file, Diagnostics& diagnostics)
      : registry_(registry), file_(file), diagnostics_(diagnostics) {}

  engine::WorldSpec read(const JsonNode& document);
  void add_bodies(engine::WorldSpec& spec, const BodyColumns& columns);

 private:
  void read_object(const JsonCursor& at, const FieldTable& table, void* object);
  void read_member(const JsonCursor& at, const Field& field, const FieldTable& table, void* object);
  void read_list(const JsonCursor& at, const Field& field, const engine::MemberType& type, void* list);
  void read_struct(const JsonCursor& at, const Field& field, const FieldTable& table, void* object);
  void read_numbers(const JsonCursor& at, const Field& field, const FieldTable& table, void* object);
  void read_place(const JsonCursor& at, Where& where);
  void read_parameters(const JsonCursor& at, const Field& field, const FieldTable& table, void* object);
  /// Reads a member of the world that has a format of its own: words, names of parts, experiment.
  void read_apart(JsonObject& object, std::string_view name);
  void read_files(const JsonCursor& at);
  void read_words(const JsonCursor& at);
  void read_part_names(const JsonCursor& at);

  /// Converts a place of the stored world: its file number becomes the number that the file has in this
  /// program.
  Where here(std::uint32_t file, std::uint32_t line) const {
    return {file < files_.size() ? files_[file] : Where::k_no_file, line};
  }
  void error(const std::string& message) const { diagnostics_.error(file_, message); }

  const engine::Registry& registry_;
  Where file_;
  Diagnostics& diagnostics_;
  engine::WorldSpec spec_;
  std::vector<std::uint32_t> files_;  // for each file of the stored world, its number in this program
};

constexpr std::string_view k_always = "every checkpoint has this value";

/// Whether a stored world may omit a member of a struct. The member then keeps its default.
bool may_be_missing(const Field& field) {
  const bool is_block = field.type == FieldType::record && field.record != nullptr;
  return field.sparse || field.optional || (is_block && !is_listed(*field.record));
}

void SpecReader::read_object(const JsonCursor& at, const FieldTable& table, void* object) {
  JsonObject json(at);
  for (const Field& field : table.fields) {
    if (field.member == nullptr || field.record == &engine::experiment_fields()) {
      read_apart(json, field.name);
      continue;
    }
    const std::string key = key_of(field);
    if (const JsonNode* node = json.find(key))
      read_member(JsonCursor(at, key, *node), field, table, object);
    else if (!may_be_missing(field))
      json.missing(key, k_always);
  }
  json.finish();
}

void SpecReader::read_member(const JsonCursor& at, const Field& field, const FieldTable& table,
                             void* object) {
  const engine::MemberType& type = *field.member;
  void* member = member_of(field, object);
  if (field.type == FieldType::records || type.each != nullptr) return read_list(at, field, type, member);
  if (field.type == FieldType::record && field.record == nullptr)
    return read_parameters(at, field, table, object);
  if (field.type == FieldType::record) {
    if (type.resize != nullptr) type.resize(member, 1);
    return read_struct(at, field, *field.record, type.block(member, 0));
  }
  if (const Value value = scalar(at, field); value.given()) type.set(member, value);
}

void SpecReader::read_list(const JsonCursor& at, const Field& field, const engine::MemberType& type,
                           void* list) {
  const JsonNode::List* entries = worldio::read_list(at);
  if (!entries) return;
  type.resize(list, entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const JsonCursor entry(at, i, (*entries)[i]);
    void* block = type.block(list, i);
    if (type.each == nullptr) {
      read_struct(entry, field, *field.record, block);
    } else if (type.each->each != nullptr) {
      read_list(entry, field, *type.each, block);
    } else {
      const Value point = read_value(entry, numbers_like(field, type.each->columns));
      if (point.given()) type.each->set(block, point);
    }
  }
}

void SpecReader::read_struct(const JsonCursor& at, const Field& field, const FieldTable& table,
                             void* object) {
  if (&table == &engine::place_fields()) return read_place(at, *static_cast<Where*>(object));
  if (is_listed(table)) return read_numbers(at, field, table, object);
  read_object(at, table, object);
}

/// Reads a struct that consists only of numbers. Each number must be within the limits of `field`.
void SpecReader::read_numbers(const JsonCursor& at, const Field& field, const FieldTable& table,
                              void* object) {
  const Value value = read_value(at, numbers_like(field, numbers_in(table)));
  if (!value.given()) return;
  std::span<const double> numbers = value.numbers();
  set_numbers(table, object, numbers);
}

void SpecReader::read_place(const JsonCursor& at, Where& where) {
  const JsonNode::List* list = worldio::read_list(at);
  if (!list) return;
  const auto entry = [&](std::size_t i) -> std::uint32_t {
    const auto* x = i < list->size() ? std::get_if<std::int64_t>(&(*list)[i].value) : nullptr;
    if (x && *x >= 0 && *x <= std::numeric_limits<std::uint32_t>::max())
      return static_cast<std::uint32_t>(*x);
    at.expected("a position in a file, [file, line]");
    return Where::k_no_file;
  };
  const std::uint32_t file = entry(0);
  where = here(file, entry(1));
}

void SpecReader::read_parameters(const JsonCursor& at, const Field& field, const FieldTable& table,
                                 void* object) {
  const Result<const FieldTable*> parameters = parameters_of(table, object, registry_);
  if (!parameters) return at.parent()->error(parameters.error().text);
  JsonObject json(at);
  engine::Record record = read_fields(json, **parameters);
  json.finish();
  field.member->set(member_of(field, object), std::vector<engine::Record>{std::move(record)});
}

void SpecReader::read_apart(JsonObject& object, std::string_view name) {
  if (name == "experiment") return read_experiment(object, numbers_of_types(spec_), registry_, spec_);
  if (name != "files" && name != "words" && name != "part_names")
    return;  // the other names are those of BodyColumns
  const JsonNode* node = object.require(name, k_always);
  if (!node) return;
  const JsonCursor at(object.at(), name, *node);
  if (name == "words") read_words(at);
  if (name == "part_names") read_part_names(at);
}

void SpecReader::read_files(const JsonCursor& at) {
  for (const std::string& name : texts_of(at, "the name of a file"))
    files_.push_back(diagnostics_.files()->add(name));
}

void SpecReader::read_words(const JsonCursor& at) {
  try {
    spec_.names = engine::Names(texts_of(at, "a word"));
  } catch (const std::invalid_argument& error) {
    at.error(error.what());
  }
}

void SpecReader::read_part_names(const JsonCursor& at) {
  const JsonNode::List* list = worldio::read_list(at);
  for (std::size_t i = 0; list && i < list->size(); ++i) {
    const JsonCursor entry(at, i, (*list)[i]);
    NamedPart named;
    read_object(entry, engine::described<NamedPart>(), &named);
    spec_.part_aliases[std::move(named.name)] = {named.body, std::move(named.part)};
  }
}

engine::WorldSpec SpecReader::read(const JsonNode& document) {
  spec_.files = diagnostics_.files();
  const JsonCursor root(document, diagnostics_);
  if (const JsonNode* files = document.find("files")) read_files(JsonCursor(root, "files", *files));
  read_object(root, engine::world_fields(), &spec_);
  return std::move(spec_);
}

void SpecReader::add_bodies(engine::WorldSpec& spec, const BodyColumns& c) {
  const std::size_t count = c.type.size();
  const std::size_t aliases = c.alias_body.size();
  if (c.word.size() != count || c.number.size() != count || c.pose.size() != 4 * count ||
      c.color.size() != 4 * count || (!c.fiducial.empty() && c.fiducial.size() != count) ||
      c.file.size() != count || c.line.size() != count || c.alias_word.size() != aliases ||
      c.alias_number.size() != aliases)
    return error("the file is damaged: the columns of the bodies differ in length");
  if (count == 0)
    return error("the file is damaged: it has no bodies, but every world has at least the ground");
  const FieldTable& table = engine::body_fields();
  const Field& pose = table.at("pose");
  // Only the poses are checked, and only against their two limits. The limits are finite, so NaN and infinity
  // fail too. Checking all other values of the bodies would take a fifth of the time of loading a large
  // world.
  const auto beyond = std::ranges::find_if(
      c.pose, [low = pose.min, high = pose.max](double x) { return !(low <= x && x <= high); });
  if (beyond != c.pose.end()) {
    const auto at = static_cast<std::size_t>(beyond - c.pose.begin());
    constexpr std::array<std::string_view, 4> k_parts{"x", "y", "z", "heading"};
    return error(fmt::format("the file is damaged: bodies[{}].pose.{}: must be {}, found {}", at / 4,
                             k_parts[at % 4], limits_text(pose, engine::unit_suffixes(pose.unit).front()),
                             exact_number(*beyond)));
  }

  spec.bodies.reserve(count);
  for (std::size_t b = 0; b < count; ++b)
    spec.bodies.push_back(
        {.name = {c.word[b], c.number[b]},
         .type = TypeId(c.type[b]),
         .pose_world_body = {c.pose[4 * b], c.pose[4 * b + 1], c.pose[4 * b + 2], c.pose[4 * b + 3]},
         .color = {c.color[4 * b], c.color[4 * b + 1], c.color[4 * b + 2], c.color[4 * b + 3]},
         .fiducial = c.fiducial.empty() ? 0 : c.fiducial[b],
         .where = here(c.file[b], c.line[b])});
  for (std::size_t a = 0; a < aliases; ++a)
    spec.aliases.push_back({{c.alias_word[a], c.alias_number[a]}, BodyId(c.alias_body[a])});
}

/// Whether a pointer, for which is_changeable() is true, names a parameter of a kind.
bool is_parameter(std::string_view pointer) { return pointer.find("/params/") != pointer.npos; }

/// Returns the change of a parameter to its value in `changed`, a spec with the new value.
SettingSpec setting_at(std::string_view pointer, const engine::WorldSpec& changed,
                       const engine::Registry& registry) {
  const std::vector<std::string_view> tokens = tokens_of(pointer);
  const auto index = [&](std::size_t token) {
    std::uint32_t number = 0;
    std::from_chars(tokens[token].data(), tokens[token].data() + tokens[token].size(), number);
    return number;
  };
  SettingSpec setting{.type = TypeId(index(1))};
  const engine::TypeSpec& type = changed.types[setting.type.index()];
  const engine::Record* params = nullptr;
  const FieldTable* table = nullptr;
  if (tokens[2] == "drive") {
    params = &type.drive->params;
    table = &registry.drive(type.drive->kind)->params;
  } else {
    setting.index = index(3);
    if (tokens[2] == "sensors") {
      setting.of = SettingSpec::Of::device;
      params = &type.devices[setting.index].params;
      table = &registry.device(type.devices[setting.index].kind)->params;
    } else {
      setting.of = SettingSpec::Of::controller;
      params = &type.controllers[setting.index].params;
      table = &registry.controller(type.controllers[setting.index].kind)->params;
    }
  }
  setting.params.resize(params->size());
  const std::string_view key = tokens[setting.of == SettingSpec::Of::drive ? 4 : 5];
  for (std::size_t f = 0; f < table->fields.size(); ++f)
    if (key == key_of(table->fields[f])) setting.params[f] = (*params)[f];
  return setting;
}

/// Adds a change of a parameter to `changes`, to the entry of its drive, device or controller.
void add_change(const std::string& pointer, SettingSpec setting, std::vector<ParameterChange>& changes) {
  const auto same = std::ranges::find_if(changes, [&](const ParameterChange& each) {
    return each.setting.type == setting.type && each.setting.of == setting.of &&
           each.setting.index == setting.index;
  });
  if (same == changes.end())
    changes.push_back({pointer, std::move(setting)});
  else
    same->setting.params = changed(same->setting.params, setting);
}

/// Changes bounds in the form of a world file, [[x_min, y_min], [x_max, y_max]], to the form of a stored
/// world, [x_min, y_min, x_max, y_max].
void flatten_bounds(JsonNode& document) {
  JsonNode* bounds = document.find("bounds_m");
  const JsonNode::List* corners = bounds ? bounds->list() : nullptr;
  if (!corners || corners->size() != 2) return;
  JsonNode::List flat;
  for (const JsonNode& corner : *corners) {
    const JsonNode::List* numbers = corner.list();
    if (!numbers || numbers->size() != 2) return;
    std::ranges::copy(*numbers, std::back_inserter(flat));
  }
  bounds->value = std::move(flat);
}

}  // namespace

engine::WorldSpec restore_spec(const StoredSpec& stored, const engine::Registry& registry,
                               std::span<const std::pair<std::string, std::string>> changes, Where where,
                               Diagnostics& diagnostics, std::vector<ParameterChange>& parameters) {
  std::optional<JsonNode> document = parse_json(stored.json, where, true, diagnostics);
  if (!document) return {};
  for (const auto& [pointer, value] : changes) {
    if (!is_changeable(pointer))
      diagnostics.error(
          {diagnostics.files()->add("--set " + pointer), 0},
          fmt::format("this value of the world in a checkpoint cannot be changed; these values can: {}",
                      k_changeable));
    else if (!is_parameter(pointer))
      set_json_value(*document, pointer, value, diagnostics);
  }
  if (diagnostics.has_errors()) return {};
  flatten_bounds(*document);
  SpecReader reader(registry, where, diagnostics);
  engine::WorldSpec spec = reader.read(*document);
  if (std::ranges::any_of(changes, [](const auto& change) { return is_parameter(change.first); })) {
    for (const auto& [pointer, value] : changes)
      if (is_parameter(pointer)) set_json_value(*document, pointer, value, diagnostics);
    if (diagnostics.has_errors()) return {};
    const engine::WorldSpec changed = SpecReader(registry, where, diagnostics).read(*document);
    if (diagnostics.has_errors()) return {};
    for (const auto& [pointer, value] : changes)
      if (is_parameter(pointer)) add_change(pointer, setting_at(pointer, changed, registry), parameters);
  }
  if (!diagnostics.has_errors()) reader.add_bodies(spec, stored.bodies);
  if (!diagnostics.has_errors())
    engine::check_rules(spec, [&](Where, const std::string& error) { diagnostics.error(where, error); });
  return spec;
}

}  // namespace troupe::worldio
