#include "worldio/convert.hpp"

#include "worldio/files.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/stage/stage_files.hpp"
#include "worldio/stage/stage_writer.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace troupe::worldio {
namespace {

std::size_t count_types(const engine::WorldSpec& spec) {
  std::vector<bool> is_used(spec.types.size(), false);
  for (std::size_t b = 1; b < spec.bodies.size(); ++b) is_used[spec.bodies[b].type.index()] = true;
  return static_cast<std::size_t>(std::ranges::count(is_used, true));
}

/// The parsed document of a JSON world, which knows the line of each key. Returns nothing for a `.world`
/// file, or if the file cannot be read.
std::optional<WorldDocument> document_of(const std::filesystem::path& file, const engine::Registry& registry,
                                         const LoadOptions& options, const Diagnostics& diagnostics) {
  if (file.extension() != ".json") return std::nullopt;
  Diagnostics reported(diagnostics.files());  // ignored: load_world() has reported the same errors
  const std::optional<std::string> text = read_file(file);
  return text ? load_json_document(file, *text, registry, options, reported) : std::nullopt;
}

}  // namespace

ConvertedWorld convert_world(const std::filesystem::path& from, const std::filesystem::path& to,
                             const engine::Registry& registry, const LoadOptions& options,
                             Diagnostics& diagnostics,
                             const std::function<void(const engine::WorldSpec&)>& loaded) {
  if (const Result<> ending = check_world_ending(to); !ending) {
    diagnostics.error({diagnostics.files()->add(to.string()), 0}, ending.error().text);
    return {};
  }
  engine::WorldSpec spec = load_world(from, registry, options, diagnostics);
  if (diagnostics.has_errors()) return {};
  if (loaded) loaded(spec);
  // The file that load_world() has read.
  const std::filesystem::path file = find_stage_file(from, options.search_path).value_or(from);
  // The title of a Stage world without a name is its file name. This title is replaced by the name of the new
  // file.
  if (spec.title == file.string() || spec.title == file.stem().string()) spec.title = to.stem().string();
  ConvertedWorld converted{.bodies = spec.bodies.size() - 1, .types = count_types(spec)};
  const auto source = document_of(file, registry, options, diagnostics);
  if (to.extension() == ".world")
    converted.text = write_stage_world(spec, to, source ? &*source : nullptr, registry, diagnostics);
  else if (const auto document = write_json_world(spec, to, registry, diagnostics))
    converted.text = json_text(*document);
  return converted;
}

}  // namespace troupe::worldio
