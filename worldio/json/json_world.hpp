#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/load.hpp"

#include <filesystem>
#include <optional>

namespace troupe::worldio {

/// Reads a document as load_json_world() does the text of one. `file` names it and is the base of relative
/// paths.
engine::WorldSpec read_json_world(const std::filesystem::path& file, const JsonNode& document,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// The document that reads back as this world, to the last bit, where it lies in `file`: populations are
/// listed one by one, angles are in degrees where that loses nothing, images stay images, with paths relative
/// to the file, where they make the same solids again; overlaps and repeated names are errors again unless
/// there are any. Its nodes stand where the spec's do. It is read to make sure; empty, with errors, where
/// JSON has no words for something.
std::optional<JsonNode> write_json_world(const engine::WorldSpec& spec, const std::filesystem::path& file,
                                         const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
