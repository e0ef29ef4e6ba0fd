#include "worldio/json/read_document.hpp"

#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_ring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;

/// Reads one JSON object into a struct, key by key, as the table of the struct lists the keys.
class ObjectReader {
 public:
  ObjectReader(JsonObject& keys, const DocumentTable& table, const DocumentReading& reading, void* object)
      : at_(keys.at()), keys_(keys), table_(table), reading_(reading), object_(object) {}

  void read();
  void read_keys() {
    for (const DocumentKey& key : table_.keys)
      if (applies(key)) read_key(key);
  }

 private:
  bool find_kind();
  /// Returns the bit in DocumentKey::variants for the value that this object has for the key
  /// DocumentTable::variant. 0 if that value is missing or wrong.
  std::uint32_t find_variant();
  bool applies(const DocumentKey& key) const;
  void read_key(const DocumentKey& key);
  std::string unused_reason(const Field& field) const;
  void read_value(const DocumentKey& key);
  void read_choice(const DocumentKey& key);
  void read_heading(const DocumentKey& key);
  void read_faults(const DocumentKey& key);
  void read_node(const DocumentKey& key, const JsonCursor& at);
  void check_version(const DocumentKey& key, const JsonCursor& at) const;
  void read_seed(const DocumentKey& key, const JsonCursor& at);
  void read_model_kind(const DocumentKey& key, const JsonCursor& at);
  void read_color_or_random(const DocumentKey& key, const JsonCursor& at);
  void read_joint(const DocumentKey& key, const JsonCursor& at);
  void read_names(const DocumentKey& key, const JsonCursor& at);
  void read_contours(const DocumentKey& key, const JsonCursor& at);
  void read_list(const DocumentKey& key, const JsonCursor& at);
  void read_map(const DocumentKey& key, const JsonCursor& at);
  void check_rule(const DocumentRule& rule) const;
  void note(const DocumentKey& key, Where where) {
    table_.placed(object_).keys.push_back({key.field.name, where});
  }
  const FieldTable* params() const { return kind_ ? kind_->params : nullptr; }
  template <class M>
  M& member(const DocumentKey& key) {
    return *static_cast<M*>(key.make(object_));
  }

  const JsonCursor& at_;
  JsonObject& keys_;
  const DocumentTable& table_;
  const DocumentReading& reading_;
  void* object_;
  std::optional<DocumentKind> kind_;
  std::uint32_t variant_ = ~0u;
};

void ObjectReader::read() {
  table_.placed(object_).where = at_.where();
  if (table_.kinds && !find_kind()) return;
  if (!table_.variant.empty()) variant_ = find_variant();
  read_keys();
  if (variant_ != 0) keys_.finish();  // without a variant, the valid keys are not known
  if (!keys_.is_object()) return;
  for (const DocumentRule& rule : table_.rules) check_rule(rule);
  for (const DocumentKey& key : table_.keys)
    if (key.form == Form::faults &&
        static_cast<const std::vector<FaultDocument::Impairment>*>(key.find(object_))->empty())
      at_.error(fmt::format("the entry names no fault: add at least one of the keys {}",
                            comma_list(name_list(reading_.registry.faults))));
  if (table_.check) table_.check(object_, at_);
}

/// Finds the kind of the object. False, with an error, if the object has no known kind. The object is then
/// not read, because its valid keys depend on its kind.
bool ObjectReader::find_kind() {
  const DocumentKinds& kinds = *table_.kinds;
  const engine::Registry& registry = reading_.registry;
  const JsonNode* node = keys_.find("kind");
  if (!node && kinds.implied && at_.parent()) {
    kind_ = kinds.implied(registry, at_.parent()->node());
    if (kind_) return true;
  }
  if (!node) {
    const std::string hint(kinds.hint.empty() ? fmt::format("one of {}", comma_list(kinds.known(registry)))
                                              : std::string(kinds.hint));
    keys_.missing("kind", hint);
    return false;
  }
  const JsonCursor at(at_, "kind", *node);
  const std::string* name = read_text(
      at, kinds.expects.empty() ? fmt::format("the name of a {}", kinds.what) : std::string(kinds.expects));
  if (!name) return false;
  const auto found = kinds.find(registry, *name);
  if (!found) {
    at.error(found.error().text);
    return false;
  }
  kind_ = *found;
  return true;
}

std::uint32_t ObjectReader::find_variant() {
  const DocumentKey& key = *table_.find(table_.variant);
  const JsonNode* node = at_.node().find(key.field.name);
  const std::string* name = node ? node->text() : nullptr;
  const auto& choices = key.field.choices;
  const auto found = name ? std::ranges::find(choices, *name) : choices.end();
  return found == choices.end() ? 0 : 1u << static_cast<unsigned>(found - choices.begin());
}

bool ObjectReader::applies(const DocumentKey& key) const {
  if (key.variants != ~0u && (key.variants & variant_) == 0) return false;
  if (key.is_there && !key.is_there(at_.node())) return false;
  return !key.is_of || (kind_ && key.is_of(kind_->kind));
}

void ObjectReader::read_key(const DocumentKey& key) {
  if (key.is_resolved) {  // find() marks the key as known
    if (const JsonNode* node = keys_.find(key.field.name))
      JsonCursor(at_, key.field.name, *node)
          .error("this key cannot be set from outside the world file: write it in the file");
    return;
  }
  switch (key.form) {
    case Form::value: return read_value(key);
    case Form::choice: return read_choice(key);
    case Form::heading: return read_heading(key);
    case Form::faults: return read_faults(key);
    case Form::parameters:
      member<engine::Record>(key) = read_parameters(keys_, *params(), kind_->presets);
      return;
    case Form::kind: member<std::string>(key) = kind_->name; break;  // the place of the key is set below
    default: break;
  }
  const JsonNode* node = keys_.find(key.field.name);
  if (node) {
    note(key, node->where);
    read_node(key, JsonCursor(at_, key.field.name, *node));
  } else if (key.required && key.form != Form::kind) {
    keys_.missing(key.field.name, key.missing_hint());
  }
}

/// Returns why a key with a condition on another key, which is a choice, has no effect in this object; empty
/// if it has one.
std::string ObjectReader::unused_reason(const Field& field) const {
  const engine::FieldCondition& condition = field.used_if;
  if (condition.field.empty()) return {};
  const JsonNode* node = at_.node().find(condition.field);
  const std::string* text = node ? node->text() : nullptr;
  const std::string_view value = text ? *text : table_.find(condition.field)->field.choices.front();
  if ((value == condition.value) == condition.is) return {};
  return fmt::format("\"{}\" is \"{}\"", condition.field, value);
}

/// Reads a value. The value has one possible key for each of its units, such as `fov_rad` and `fov_deg`.
void ObjectReader::read_value(const DocumentKey& key) {
  const Field& field = field_of(key, params());
  FoundField found;
  if (key.counts_bodies) {
    Field limited = field;
    limited.max = std::min(field.max, reading_.most_bodies);
    found = find_field(keys_, limited);
  } else {
    found = find_field(keys_, field, unused_reason(field));
  }
  if (found.where) note(key, *found.where);
  if (found.value.given())
    engine::set(field, object_, found.value);
  else if (!found.where && key.required && keys_.is_object())
    at_.error(fmt::format("missing {}: {}", quoted_keys(field), key.missing_hint()));
}

void ObjectReader::read_choice(const DocumentKey& key) {
  const FoundField found = find_field(keys_, key.field);
  if (found.where) note(key, *found.where);
  const auto& choices = key.field.choices;
  if (found.value.given())
    member<std::uint8_t>(key) =
        static_cast<std::uint8_t>(std::ranges::find(choices, found.value.text()) - choices.begin());
  else if (!found.where && key.required)
    keys_.missing(key.field.name, key.missing_hint());
}

/// Reads `"heading": "random"` or an angle.
void ObjectReader::read_heading(const DocumentKey& key) {
  const Field& angle = heading_field();
  const JsonNode* word = at_.node().find(key.field.name);
  if (word && word->text() && *word->text() == "random") {
    keys_.find(key.field.name);
    note(key, word->where);
    member<HeadingDocument>(key).is_random = true;
    for (const engine::UnitSuffix& suffix : engine::unit_suffixes(angle.unit))
      if (keys_.find(fmt::format("{}{}", angle.name, suffix.suffix)))
        at_.error_at(word->where,
                     fmt::format("give only one of \"heading\": \"random\", {}", quoted_keys(angle)));
    return;
  }
  const FoundField found = find_field(keys_, angle);
  if (found.where) note(key, *found.where);
  if (found.value.given()) member<HeadingDocument>(key).rad = found.value.number();
}

void ObjectReader::read_faults(const DocumentKey& key) {
  for (const engine::FaultKind& kind : reading_.registry.faults)
    if (auto params = read_block(keys_, kind.name, kind.params))
      member<std::vector<FaultDocument::Impairment>>(key).push_back(
          {std::string(kind.name), std::move(*params)});
}

void ObjectReader::read_node(const DocumentKey& key, const JsonCursor& at) {
  switch (key.form) {
    case Form::version: return check_version(key, at);
    case Form::seed: return read_seed(key, at);
    case Form::name:
      if (const std::string* name = read_name(at, key.expects)) member<std::string>(key) = *name;
      return;
    case Form::model_kind: return read_model_kind(key, at);
    case Form::names: return read_names(key, at);
    case Form::color:
      if (const auto color = read_color(at)) member<Color>(key) = *color;
      return;
    case Form::color_or_random: return read_color_or_random(key, at);
    case Form::points: {
      Ring points = read_points(at, key.least, key.most);
      if (!points.empty()) member<Ring>(key) = std::move(points);
      return;
    }
    case Form::box:
      if (const auto box = read_box(at)) member<Box>(key) = *box;
      return;
    case Form::contours: return read_contours(key, at);
    case Form::joint: return read_joint(key, at);
    case Form::comparison:
      if (const std::string* text = read_text(at, key.expects))
        if (const auto comparison = read_comparison(at, *text)) member<ComparisonDocument>(key) = *comparison;
      return;
    case Form::kept: member<JsonNode>(key) = at.node(); return;
    case Form::block: {
      JsonObject block(at);
      member<engine::Record>(key) = read_fields(block, *key.block);
      return block.finish();
    }
    case Form::object: return read_described(at, key.table(), reading_, key.make(object_));
    case Form::list: return read_list(key, at);
    case Form::map: return read_map(key, at);
    default: return;  // the other forms are read by read_key()
  }
}

void ObjectReader::check_version(const DocumentKey& key, const JsonCursor& at) const {
  const auto* version = std::get_if<std::int64_t>(&at.node().value);
  if (!version)
    at.expected(key.missing_hint());
  else if (*version != k_format_version)
    at.error(
        fmt::format("unknown format version {}: this program reads version {}", *version, k_format_version));
}

void ObjectReader::read_seed(const DocumentKey& key, const JsonCursor& at) {
  const auto* small = std::get_if<std::int64_t>(&at.node().value);
  const auto* big = std::get_if<std::uint64_t>(&at.node().value);
  const auto* real = std::get_if<double>(&at.node().value);  // 1e+05, as a study writes a computed seed
  constexpr double k_exact = 9007199254740992.0;             // 2^53: larger doubles are not exact integers
  if (big)
    member<std::uint64_t>(key) = *big;
  else if (real && *real >= 0 && *real <= k_exact && *real == std::floor(*real))
    member<std::uint64_t>(key) = static_cast<std::uint64_t>(*real);
  else if (small && *small >= 0)
    member<std::uint64_t>(key) = static_cast<std::uint64_t>(*small);
  else
    at.expected("a whole number from 0 to 2^64 - 1");
}

/// Reads the name of a model kind. An unknown name is an error, but is stored.
void ObjectReader::read_model_kind(const DocumentKey& key, const JsonCursor& at) {
  const std::string* name = read_text(at, "the name of a model kind");
  if (!name) return;
  member<std::string>(key) = *name;
  if (reading_.registry.model(*name)) return;
  at.error(unknown_name("model kind", *name, name_list(reading_.registry.models)));
}

void ObjectReader::read_color_or_random(const DocumentKey& key, const JsonCursor& at) {
  const std::string* word = at.node().text();
  if (word && *word == "random")
    member<ColorDocument>(key).is_random = true;
  else if (const auto color = read_color(at))
    member<ColorDocument>(key).color = *color;
}

void ObjectReader::read_joint(const DocumentKey& key, const JsonCursor& at) {
  if (std::holds_alternative<std::monostate>(at.node().value))
    member<JointName>(key).name.reset();
  else if (const std::string* name = read_text(at, "the name of a joint, or null"))
    member<JointName>(key).name = *name;
}

void ObjectReader::read_names(const DocumentKey& key, const JsonCursor& at) {
  const JsonNode::List* list = worldio::read_list(at);
  if (!list) return;
  auto& names = member<std::vector<std::string>>(key);
  for (std::size_t i = 0; i < list->size(); ++i)
    if (const std::string* name = read_name(JsonCursor(at, i, (*list)[i]), key.expects))
      names.push_back(*name);
  if (list->size() < key.least) at.expected(fmt::format("at least one {}", key.expects.substr(4)));
}

/// Reads outlines without checking them for crossings.
void ObjectReader::read_contours(const DocumentKey& key, const JsonCursor& at) {
  const JsonNode::List* list = worldio::read_list(at);
  if (!list) return;
  std::vector<Ring> contours;
  for (std::size_t i = 0; i < list->size(); ++i) {
    Ring ring = read_points(JsonCursor(at, i, (*list)[i]), key.least, key.most);
    if (!ring.empty()) contours.push_back(std::move(ring));
  }
  if (list->empty()) at.expected("at least one outline, such as [[[0, 0], [1, 0], [0, 1]]]");
  if (!list->empty() && contours.size() == list->size()) member<std::vector<Ring>>(key) = std::move(contours);
}

void ObjectReader::read_list(const DocumentKey& key, const JsonCursor& at) {
  const JsonNode::List* nodes = worldio::read_list(at);
  if (!nodes) return;
  if (key.least > 0) refuse_empty(at, key.by_default);
  void* list = key.make(object_);
  const DocumentKey* ring = key.table().find("ring");
  for (std::size_t i = 0; i < nodes->size(); ++i) {
    const JsonCursor entry(at, i, (*nodes)[i]);
    const auto read = [&](const JsonNode& node) {
      read_described(JsonCursor(at, i, node), key.table(), reading_, key.append(list, {}));
    };
    if (!ring || !has_ring(entry.node())) {
      read(entry.node());
    } else {
      const std::size_t before = at.diagnostics().findings().size();
      for (const JsonNode& copy : expand_ring(entry)) {
        read(copy);
        if (at.diagnostics().findings().size() > before) break;  // the other copies have the same errors
      }
    }
  }
}

void ObjectReader::read_map(const DocumentKey& key, const JsonCursor& at) {
  const JsonNode::Object* members = at.node().object();
  if (!members)
    return at.expected(fmt::format("an object whose keys are the names of the {}", key.field.name));
  void* map = key.make(object_);
  for (const JsonMember& one : *members)
    if (check_name(at, one.key))
      read_described(JsonCursor(at, one.key, one.node), key.table(), reading_, key.append(map, one.key));
}

void ObjectReader::check_rule(const DocumentRule& rule) const {
  const Placed& placed = table_.placed(object_);
  std::size_t given = 0;
  for (const std::string_view name : rule.keys) {
    if (!placed.says(name)) continue;
    if (++given > 1 && rule.how != DocumentRule::How::any_of && rule.at_key)
      at_.error_at(placed.where_of(name), rule.several);
  }
  if (given == 0 && rule.how != DocumentRule::How::not_both) at_.error(rule.none);
  if (given > 1 && rule.how != DocumentRule::How::any_of && !rule.at_key)
    at_.error(rule.several.empty() ? rule.none : rule.several);
}

/// Returns what the error for a value that is no object says is expected. A text in place of the object may
/// be its kind, as in `"drive": "diff"`, or its variant, as in `"place": "uniform"`.
std::string expected_object(const JsonNode& found, const DocumentTable& table,
                            const engine::Registry& registry) {
  const std::string_view key = table.kinds ? "kind" : table.variant;
  const std::string* text = key.empty() ? nullptr : found.text();
  if (!text) return "an object";
  const auto is_in = [&](const auto& names) { return std::ranges::find(names, *text) != names.end(); };
  if (!(table.kinds ? is_in(table.kinds->known(registry)) : is_in(table.find(key)->field.choices)))
    return "an object";
  return fmt::format("an object such as {{\"{}\": \"{}\"}}", key, *text);
}

}  // namespace

void read_described(const JsonCursor& at, const DocumentTable& table, const DocumentReading& reading,
                    void* object) {
  if (!table.shorthand || at.node().object()) {
    JsonObject keys(at, expected_object(at.node(), table, reading.registry));
    return ObjectReader(keys, table, reading, object).read();
  }
  table.placed(object).where = at.where();
  if (const std::string* text = read_text(at, table.shorthand->expects))
    table.shorthand->read(at, *text, reading.registry, object);
}

void read_described_keys(JsonObject& keys, const DocumentTable& table, const DocumentReading& reading,
                         void* object) {
  table.placed(object).where = keys.at().where();
  ObjectReader(keys, table, reading, object).read_keys();
}

}  // namespace troupe::worldio
