#include "worldio/json/measures_json.hpp"

#include "worldio/json/experiment_json.hpp"
#include "worldio/json/read_document.hpp"
#include "worldio/load.hpp"

namespace troupe::worldio {

std::optional<engine::MeasureSpec> read_measure(const JsonCursor& at, const engine::Registry& registry) {
  const std::size_t before = at.diagnostics().findings().size();
  const auto measure = read_document<MeasureDocument>(at, {registry, LoadOptions().most_bodies});
  if (at.diagnostics().findings().size() > before) return std::nullopt;
  return expand_measure(measure);
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
