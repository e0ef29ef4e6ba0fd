#include "worldio/load.hpp"

#include "worldio/stage_files.hpp"

#include <fmt/format.h>

namespace troupe::worldio {

engine::WorldSpec load_world(const std::filesystem::path& file, const engine::Registry& registry,
                             const LoadOptions& options, Diagnostics& diagnostics) {
  const auto fail = [&](const std::string& message) {
    diagnostics.error({diagnostics.files()->add(file.string()), 0}, message);
    engine::WorldSpec spec;
    spec.files = diagnostics.files();
    return spec;
  };
  const std::string ending = file.extension().string();
  if (ending != ".world" && ending != ".json")
    return fail(
        fmt::format("a world's file name ends in .world (Stage's syntax) or .json, not in \"{}\"", ending));
  const auto found = find_stage_file(file, options.search_path);
  if (!found)
    return fail(std::filesystem::exists(file) ? "this is no file that can be read" : "there is no such file");
  auto text = read_file(*found);
  if (!text) return fail("the file cannot be read");
  return ending == ".world" ? load_stage_world(*found, std::move(*text), registry, options, diagnostics)
                            : load_json_world(*found, *text, registry, options, diagnostics);
}

}  // namespace troupe::worldio
