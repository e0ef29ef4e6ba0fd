#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/load.hpp"

#include <filesystem>
#include <optional>

/// Reads and writes JSON worlds. A type describes bodies of the same construction, and can inherit from
/// another type with the key `extends`. A population is a group of bodies that a rule places. A WorldDocument
/// is a struct with the content of a JSON world. A spec (engine::WorldSpec) is the description of a world
/// from which the engine builds it. The engine::Registry lists the kinds (sorts) of drives, devices,
/// controllers, measures and faults that a world may use. A place (Where) is a file and a line.
namespace troupe::worldio {

/// Completes the JSON nodes of a world before they are read. First it adds the types of included files, whose
/// paths are relative to the folder of `file` (worldio/json/json_include.hpp). Then it applies the changes of
/// the command line: the values of LoadOptions::set (`--set POINTER=VALUE`) and the numbers of bodies of
/// LoadOptions::robots (`--robots NAME=COUNT`). Last, it merges each type with the type that it extends. A
/// changed type therefore also changes the types that extend it. It adds the names of the types that other
/// types extend to LoadOptions::base_types, unless that is null. Reports an error for each file that cannot
/// be included, value that cannot be set, unknown population, unknown base type, and circle of types that
/// extend each other.
void change_json_world(JsonNode& document, const std::filesystem::path& file, const LoadOptions& options,
                       Diagnostics& diagnostics);

/// Converts the JSON nodes of a world to a WorldDocument. Reports all errors, each at its line. Most wrong
/// values are treated as absent; read_described() (worldio/json/read_document.hpp) lists the exceptions. The
/// function uses only the member `most_bodies` of `options`.
WorldDocument read_json_document(const JsonNode& document, const engine::Registry& registry,
                                 const LoadOptions& options, Diagnostics& diagnostics);

/// Parses `text`, applies the changes in `options` with change_json_world(), and reads the result with
/// read_json_document(). `file` is the path of the world in error messages; included files are relative to
/// its folder. If the text is not JSON, reports errors and returns nothing.
std::optional<WorldDocument> load_json_document(const std::filesystem::path& file, const std::string& text,
                                                const engine::Registry& registry, const LoadOptions& options,
                                                Diagnostics& diagnostics);

/// Returns the spec of the world that a document describes. Reads the images of the document and places its
/// bodies. `file` is the file of the document; relative paths are relative to its folder. The function uses
/// the members `seed`, `threads`, `most_bodies` and `place_again` of `options`. Reports all errors that it
/// finds, even if reading the document has already reported some. Places the bodies only if `diagnostics` has
/// no errors at all.
engine::WorldSpec expand(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, const LoadOptions& options,
                         Diagnostics& diagnostics);

/// Returns the JSON node that reads back as this document. A node whose value has no place in a file (Where)
/// gets the place of the node that contains it; the root gets `file`.
JsonNode json_world_node(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, Diagnostics& diagnostics);
/// Like load_json_world() (worldio/load.hpp), for a world that is already parsed: `document` is its root
/// node. Reports repeated keys and applies the changes in `options` with change_json_world().
engine::WorldSpec load_json_node(JsonNode document, const std::filesystem::path& file,
                                 const engine::Registry& registry, const LoadOptions& options,
                                 Diagnostics& diagnostics);

/// Reads a document with read_json_document() and returns the world that expand() makes of it. Does not apply
/// LoadOptions::set and LoadOptions::robots. `file` is the file of the document; relative paths are relative
/// to its folder.
engine::WorldSpec read_json_world(const std::filesystem::path& file, const JsonNode& document,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// Returns the root node of a JSON document that describes this world. Loading the document as the content of
/// `file` gives a world in which spec_difference() finds no bit that differs. The function loads the document
/// to check this. If JSON cannot express the world, the function reports errors and returns nothing.
/// - The bodies of populations are written one by one, as entries of `models`.
/// - An angle is written in degrees if at most nine digits of degrees convert back to the same radians.
/// - An image is written as its path, relative to the folder of `file`, if reading it again gives the same
///   solids (extruded outlines). Otherwise the outlines are written.
/// - The keys `overlaps` and `same_names` are "warn" only if reading the world back would otherwise fail,
///   because bodies overlap or have the same name.
/// - Each node has the place in a file (Where) that the spec has for its value.
std::optional<JsonNode> write_json_world(const engine::WorldSpec& spec, const std::filesystem::path& file,
                                         const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
