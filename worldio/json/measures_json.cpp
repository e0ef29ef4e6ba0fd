#include "worldio/json/measures_json.hpp"

#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace troupe::worldio {
namespace {

constexpr std::string_view k_what = "the name of a measure, or {\"kind\": ..., ...}";

const engine::MeasureKind* find_kind(const JsonCursor& at, const std::string& name,
                                     const engine::Registry& registry) {
  if (const engine::MeasureKind* kind = registry.measure(name)) return kind;
  std::vector<std::string_view> known;
  for (const engine::MeasureKind& kind : registry.measures) known.push_back(kind.name);
  at.error(unknown_name("measure", name, known));
  return nullptr;
}

/// A column's name stands in the first line of a table, and is typed by people.
bool is_plain(std::string_view name) {
  constexpr std::string_view k_plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.:";
  return name.find_first_not_of(k_plain) == name.npos;
}

std::optional<engine::MeasureSpec> read_object(const JsonCursor& at, const engine::Registry& registry) {
  JsonObject object(at);
  engine::MeasureSpec spec{.where = at.where()};
  const JsonNode* kind_node = object.require("kind", "the name of a measure");
  const std::string* kind_name =
      kind_node ? read_text(JsonCursor(at, "kind", *kind_node), "the name of a measure") : nullptr;
  if (!kind_name) return std::nullopt;
  const engine::MeasureKind* kind = find_kind(JsonCursor(at, "kind", *kind_node), *kind_name, registry);
  if (!kind) return std::nullopt;
  spec.kind = *kind_name;
  if (const JsonNode* node = object.find("name")) {
    const JsonCursor cursor(at, "name", *node);
    const std::string* name = read_text(cursor, "the name of the column");
    if (name && !is_plain(*name))
      cursor.error(
          fmt::format("\"{}\" is no name of a column: letters, digits and _ - . : may stand in it", *name));
    if (name) spec.name = *name;
  }
  if (const JsonNode* node = object.find("of")) {
    const std::string* of =
        read_text(JsonCursor(at, "of", *node), "the name of a type, a population or a robot");
    if (of) spec.of = *of;
  }
  spec.params = read_fields(object, kind->params);
  object.finish();
  return spec;
}

}  // namespace

std::optional<engine::MeasureSpec> read_measure(const JsonCursor& at, const engine::Registry& registry) {
  if (at.node().object()) return read_object(at, registry);
  const std::string* text = read_text(at, k_what);
  if (!text) return std::nullopt;
  engine::MeasureSpec spec{.where = at.where()};
  const std::size_t colon = text->find(':');
  spec.kind = text->substr(0, colon);
  if (colon != text->npos) {
    spec.of = text->substr(colon + 1);
    if (spec.of.empty()) {
      at.error(
          fmt::format("\"{}\": the name of a type, a population or a robot stands behind the colon", *text));
      return std::nullopt;
    }
  }
  const engine::MeasureKind* kind = find_kind(at, spec.kind, registry);
  if (!kind) return std::nullopt;
  spec.params = kind->params.defaults();
  if (!std::ranges::all_of(spec.params, &engine::Value::given)) {
    at.error(fmt::format("\"{}\" has parameters that must be given: {{\"kind\": \"{}\", ...}}", kind->name,
                         kind->name));
    return std::nullopt;
  }
  return spec;
}

JsonNode measure_node(const engine::MeasureSpec& measure, const engine::Registry& registry) {
  JsonNode::Object object;
  add_member(object, "kind", measure.kind);
  if (!measure.of.empty()) add_member(object, "of", measure.of);
  if (!measure.name.empty()) add_member(object, "name", measure.name);
  if (const engine::MeasureKind* kind = registry.measure(measure.kind))
    write_fields(measure.params, kind->params, object);
  return json_node(std::move(object), measure.where);
}

std::optional<engine::MeasureSpec> parse_measure(const std::string& text, const std::string& source,
                                                 const engine::Registry& registry, Diagnostics& diagnostics) {
  const Where where{diagnostics.files()->add(source), 0};
  std::optional<JsonNode> node(std::in_place);
  node->where = where;
  if (text.starts_with('{'))
    node = parse_json(text, where, true, diagnostics);
  else
    node->value = text;
  return node ? read_measure(JsonCursor(*node, diagnostics), registry) : std::nullopt;
}

}  // namespace troupe::worldio
