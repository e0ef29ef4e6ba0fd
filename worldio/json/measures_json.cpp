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

std::string misspelled_measure(const std::string& name, std::vector<std::string_view> listed,
                               const engine::Registry& registry) {
  const std::vector<std::string_view> kinds = name_list(registry.measures);
  if (did_you_mean(name, listed).empty() || !did_you_mean(name, kinds).empty()) return {};
  for (std::size_t end = name.find(':'); end != name.npos; end = name.find(':', end + 1))
    if (registry.find_measure(name.substr(0, end))) return {};  // "stalls:leaders", "plug_in:measure:leaders"
  if (registry.find_measure(name)) return {};
  listed.insert(listed.end(), kinds.begin(), kinds.end());
  return unknown_name("measure", name, std::move(listed));
}

}  // namespace troupe::worldio
