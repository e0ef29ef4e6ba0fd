#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/load.hpp"

#include <filesystem>
#include <optional>

namespace troupe::worldio {

/// Applies LoadOptions::set and LoadOptions::robots to a document.
void change_json_world(JsonNode& document, const LoadOptions& options, Diagnostics& diagnostics);

/// Reads the nodes of a JSON world. Reports all errors, each at its line; wrong values count as absent.
WorldDocument read_json_document(const JsonNode& document, const engine::Registry& registry,
                                 const LoadOptions& options, Diagnostics& diagnostics);

/// Reads the text of a JSON world, with the changes of the command line. Empty if the text is not JSON.
std::optional<WorldDocument> load_json_document(const std::filesystem::path& file, const std::string& text,
                                                const engine::Registry& registry, const LoadOptions& options,
                                                Diagnostics& diagnostics);

/// The world that a document describes: reads its images and places its bodies. `file` is its name and the
/// base of relative paths. Reports errors, also for a document that already had some, but places bodies only
/// if there are none.
engine::WorldSpec expand(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, const LoadOptions& options,
                         Diagnostics& diagnostics);

/// The node that reads back as this document. Values without a place get `file` as theirs.
JsonNode json_world_node(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, Diagnostics& diagnostics);
/// Like load_json_world(), from the nodes of a world instead of its text.
engine::WorldSpec load_json_node(JsonNode document, const std::filesystem::path& file,
                                 const engine::Registry& registry, const LoadOptions& options,
                                 Diagnostics& diagnostics);

/// Reads and expands a document, without the changes of the command line. `file` is its name and the base of
/// relative paths.
engine::WorldSpec read_json_world(const std::filesystem::path& file, const JsonNode& document,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// The document that reads back as this world to the last bit when it is the content of `file`. Populations
/// are written body by body, and angles in degrees where that is exact. Images stay images, with paths
/// relative to the file, if they give the same solids; else they become outlines. `overlaps` and `same_names`
/// are "warn" only if the world needs it. Nodes have the places of the spec. The result is read back as a
/// check. Empty, with errors, if JSON cannot express the world.
std::optional<JsonNode> write_json_world(const engine::WorldSpec& spec, const std::filesystem::path& file,
                                         const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
