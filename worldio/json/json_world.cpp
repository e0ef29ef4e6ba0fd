#include "worldio/json/json_world.hpp"

#include "base/diagnostics.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_include.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/json_ring.hpp"
#include "worldio/json/read_document.hpp"
#include "worldio/json/write_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::WorldSpec;

/// Returns the index of the population that `--robots` changes: the population with this name or, if `name`
/// is empty, the only population. Empty, with an error at `where`, if there is no such population.
std::optional<std::size_t> population_index(const JsonNode& document, const std::string& name, Where where,
                                            Diagnostics& diagnostics) {
  const JsonNode* node = document.find("populations");
  const JsonNode::List* populations = node ? node->list() : nullptr;
  std::vector<std::string_view> names;
  if (populations)
    for (const JsonNode& population : *populations) {
      const JsonNode* its_name = population.find("name");
      names.push_back(its_name && its_name->text() ? std::string_view(*its_name->text())
                                                   : std::string_view());
    }
  if (names.empty()) {
    diagnostics.error(
        where, "the number of robots can be set only for a population, but the world has no populations");
    return std::nullopt;
  }
  if (name.empty()) {
    if (names.size() == 1) return 0;
    diagnostics.error(
        where, fmt::format("the world has {} populations: name one of them, as in --robots NAME=N; known: {}",
                           names.size(), comma_list(names)));
    return std::nullopt;
  }
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  diagnostics.error(where, unknown_name("population", name, names));
  return std::nullopt;
}

void set_robots(JsonNode& document, const std::string& name, std::size_t count, Diagnostics& diagnostics) {
  const std::string option =
      name.empty() ? fmt::format("--robots {}", count) : fmt::format("--robots {}={}", name, count);
  const Where where{diagnostics.files()->add(option), 0};
  const auto index = population_index(document, name, where, diagnostics);
  if (!index) return;
  JsonNode& population = std::get<JsonNode::List>(document.find("populations")->value)[*index];
  auto* members = std::get_if<JsonNode::Object>(&population.value);
  if (!members) return;  // the reader will report it
  JsonNode* node = population.find("count");
  if (!node) node = &members->emplace_back(JsonMember{"count", where, {}}).node;
  node->value = static_cast<std::uint64_t>(count);
  if (count <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
    node->value = static_cast<std::int64_t>(count);
  node->where = where;
}

WorldSpec empty_world(const Diagnostics& diagnostics) {
  WorldSpec nothing;
  nothing.files = diagnostics.files();
  return nothing;
}

}  // namespace

bool change_json_world(JsonNode& document, const std::filesystem::path& file, const LoadOptions& options,
                       Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.error_count();
  resolve_includes(document, file, diagnostics);
  const bool has_all_types = diagnostics.error_count() == before;
  for (const auto& [pointer, value] : options.set) set_json_value(document, pointer, value, diagnostics);
  for (const auto& [name, count] : options.robots) set_robots(document, name, count, diagnostics);
  report_nul({document, diagnostics});
  return resolve_extends(document, diagnostics, options.base_types, has_all_types) && has_all_types;
}

WorldDocument read_json_document(const JsonNode& document, const engine::Registry& registry,
                                 const LoadOptions& options, Diagnostics& diagnostics) {
  const JsonCursor root(document, diagnostics);
  check_rings(root);
  auto read = read_document<WorldDocument>(root, {registry, options.most_bodies});
  read.files = diagnostics.files();
  return read;
}

WorldSpec read_json_world(const std::filesystem::path& file, const JsonNode& document,
                          const engine::Registry& registry, const LoadOptions& options,
                          Diagnostics& diagnostics) {
  return expand(read_json_document(document, registry, options, diagnostics), file, registry, options,
                diagnostics);
}

JsonNode json_world_node(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, Diagnostics& diagnostics) {
  JsonNode node = write_document(document, registry);
  place_nodes(node, {diagnostics.files()->add(file.string()), 0});
  return node;
}

WorldSpec load_json_node(JsonNode document, const std::filesystem::path& file,
                         const engine::Registry& registry, const LoadOptions& options,
                         Diagnostics& diagnostics) {
  report_repeated_keys(document, diagnostics);
  const bool has_whole_types = change_json_world(document, file, options, diagnostics);
  const WorldDocument read = read_json_document(document, registry, options, diagnostics);
  return has_whole_types ? expand(read, file, registry, options, diagnostics) : empty_world(diagnostics);
}

std::optional<WorldDocument> load_json_document(const std::filesystem::path& file, const std::string& text,
                                                const engine::Registry& registry, const LoadOptions& options,
                                                Diagnostics& diagnostics) {
  const Where start{diagnostics.files()->add(file.string()), 0};
  std::optional<JsonNode> document = parse_json(text, start, false, diagnostics);
  if (!document) return std::nullopt;
  if (const JsonNode* study = document->find("troupe_study"); study && !document->find("troupe")) {
    diagnostics.error(study->where, "this is a study, not a world: `troupe sweep` makes its runs");
    return std::nullopt;
  }
  const bool has_whole_types = change_json_world(*document, file, options, diagnostics);
  WorldDocument read = read_json_document(*document, registry, options, diagnostics);
  if (!has_whole_types) return std::nullopt;
  return read;
}

WorldSpec load_json_world(const std::filesystem::path& file, const std::string& text,
                          const engine::Registry& registry, const LoadOptions& options,
                          Diagnostics& diagnostics) {
  if (const auto document = load_json_document(file, text, registry, options, diagnostics))
    return expand(*document, file, registry, options, diagnostics);
  return empty_world(diagnostics);
}

}  // namespace troupe::worldio
