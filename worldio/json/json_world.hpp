#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/load.hpp"

#include <filesystem>
#include <optional>

namespace troupe::worldio {

/// Makes the changes that the command line asks for: LoadOptions::set and LoadOptions::robots.
void change_json_world(JsonNode& document, const LoadOptions& options, Diagnostics& diagnostics);

/// What the text of a JSON world says. What is wrong is reported, all of it, at its line; such values are as
/// if they were not there.
WorldDocument read_json_document(const JsonNode& document, const engine::Registry& registry,
                                 const LoadOptions& options, Diagnostics& diagnostics);

/// The same of its text, with what the command line changes in it. Empty where the text is no JSON.
std::optional<WorldDocument> load_json_document(const std::filesystem::path& file, const std::string& text,
                                                const engine::Registry& registry, const LoadOptions& options,
                                                Diagnostics& diagnostics);

/// The world that a document describes: its images are read, its bodies are placed. `file` names it and is
/// the base of relative paths. What is wrong is reported, also of a document in which something was wrong
/// before: bodies are placed only in one that is otherwise right.
engine::WorldSpec expand(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, const LoadOptions& options,
                         Diagnostics& diagnostics);

/// The node that reads back as this document; what has no place is placed in `file`.
JsonNode json_world_node(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, Diagnostics& diagnostics);
/// What load_json_world() does with the text of a world, with its nodes.
engine::WorldSpec load_json_node(JsonNode document, const std::filesystem::path& file,
                                 const engine::Registry& registry, const LoadOptions& options,
                                 Diagnostics& diagnostics);

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
