#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/load.hpp"

#include <filesystem>
#include <optional>

namespace troupe::worldio {

/// Applies LoadOptions::set (--set) and LoadOptions::robots (--robots) to the document of a world.
void change_json_world(JsonNode& document, const LoadOptions& options, Diagnostics& diagnostics);

/// Reads the nodes of a JSON world. Reports all errors, each at its line, and treats a wrong value as absent.
WorldDocument read_json_document(const JsonNode& document, const engine::Registry& registry,
                                 const LoadOptions& options, Diagnostics& diagnostics);

/// Reads the text of a JSON world and applies the changes in `options` (change_json_world()). Empty, with
/// errors, if the text is not JSON.
std::optional<WorldDocument> load_json_document(const std::filesystem::path& file, const std::string& text,
                                                const engine::Registry& registry, const LoadOptions& options,
                                                Diagnostics& diagnostics);

/// Returns the world that a document describes: reads its images and places its bodies. `file` is the file of
/// the document; relative paths are relative to its folder. Reports errors, even if reading the document has
/// already reported some, but places bodies only if there are no errors.
engine::WorldSpec expand(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, const LoadOptions& options,
                         Diagnostics& diagnostics);

/// Returns the JSON node that reads back as this document. Values without a place get `file` as their place.
JsonNode json_world_node(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, Diagnostics& diagnostics);
/// Like load_json_world(), from the nodes of a world instead of its text.
engine::WorldSpec load_json_node(JsonNode document, const std::filesystem::path& file,
                                 const engine::Registry& registry, const LoadOptions& options,
                                 Diagnostics& diagnostics);

/// Reads and expands a document without applying LoadOptions::set and LoadOptions::robots. `file` is the file
/// of the document; relative paths are relative to its folder.
engine::WorldSpec read_json_world(const std::filesystem::path& file, const JsonNode& document,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// Returns the document that, as the content of `file`, reads back as this world to the last bit. The result
/// is read back to check this. Empty, with errors, if JSON cannot express the world.
/// - Populations are written body by body, and angles in degrees where that is exact.
/// - Images stay images, with paths relative to the folder of `file`, if they still give the same solids;
///   otherwise they become outlines.
/// - `overlaps` and `same_names` are "warn" only if the world would otherwise have errors.
/// - Nodes have the places that the spec has for its values.
std::optional<JsonNode> write_json_world(const engine::WorldSpec& spec, const std::filesystem::path& file,
                                         const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
