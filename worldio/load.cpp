#include "worldio/load.hpp"

#include "worldio/files.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/stage/stage_files.hpp"
#include "worldio/wrong_file.hpp"

#include <fmt/format.h>

#include <system_error>

namespace troupe::worldio {
namespace {

engine::WorldSpec fail(const std::filesystem::path& file, Diagnostics& diagnostics, const Error& error) {
  diagnostics.error({diagnostics.files()->add(file.string()), 0}, error.text);
  engine::WorldSpec spec;
  spec.files = diagnostics.files();
  return spec;
}

}  // namespace

Result<> check_world_ending(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".world" || ending == ".json") return {};
  return Error{
      fmt::format("the name of a world file must end in .world (Stage's syntax) or .json, found \"{}\"",
                  file.filename().string())};
}

engine::WorldSpec load_world(const std::filesystem::path& file, const engine::Registry& registry,
                             const LoadOptions& options, Diagnostics& diagnostics) {
  const auto found = find_stage_file(file, options.search_path);
  if (found && check_readable(*found)) {
    const std::string start = start_of(*found, k_wrong_file_bytes);
    const bool may_be_read =
        check_readable(*found, k_most_input_bytes) || start.starts_with(k_hdf5_signature);
    if (auto wrong = may_be_read ? wrong_file_text(start) : std::nullopt)
      return fail(*found, diagnostics, {*std::move(wrong)});
  }
  if (const Result<> ending = check_world_ending(file); !ending) {
    std::error_code ignored;
    const bool is_folder = std::filesystem::is_directory(file, ignored);
    return fail(file, diagnostics, is_folder ? check_readable(file).error() : ending.error());
  }
  if (!found) return fail(file, diagnostics, check_readable(file).error());
  if (const Result<> readable = check_readable(*found, k_most_input_bytes); !readable)
    return fail(file, diagnostics, readable.error());
  auto text = read_file(*found);
  if (!text) return fail(file, diagnostics, {"cannot be read"});
  return load_world_text(*found, std::move(*text), registry, options, diagnostics);
}

engine::WorldSpec load_world_text(const std::filesystem::path& file, std::string text,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics) {
  if (const Result<> ending = check_world_ending(file); !ending)
    return fail(file, diagnostics, ending.error());
  if (auto wrong = wrong_file_text(text)) return fail(file, diagnostics, {*std::move(wrong)});
  return file.extension() == ".world"
             ? load_stage_world(file, std::move(text), registry, options, diagnostics)
             : load_json_world(file, text, registry, options, diagnostics);
}

}  // namespace troupe::worldio
