#pragma once

#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/world_document.hpp"
#include "worldio/load.hpp"

#include <filesystem>
#include <optional>

/// Reads and writes JSON worlds. Words of this file:
/// - A document (WorldDocument) is a struct with the content of a JSON world.
/// - A spec (engine::WorldSpec) is the description from which the engine builds a world.
/// - A type describes bodies of the same construction. It can inherit from another type, which its key
///   `extends` names.
/// - A population is a group of bodies of one type that are placed by a rule, for example on a grid.
/// - A kind is a sort of drive, device, controller, measure or fault. The engine::Registry lists the kinds
///   that a world may use.
/// - A place (Where) is the file and the line of a value, for error messages.
namespace troupe::worldio {

/// Prepares the JSON nodes of a world for read_json_document(), in three steps:
/// - It adds the types of included files. The paths of these files are relative to the folder of `file`.
/// - It makes the changes that a user asks for on the command line: new values (LoadOptions::set) and new
///   numbers of bodies of populations (LoadOptions::robots).
/// - It merges each type with the type that it extends. A change of a type in the second step therefore also
///   affects the types that extend it.
///
/// If LoadOptions::base_types is not null, adds the names of the types that other types extend to this list.
/// Reports an error for each step that fails, for example if an included file cannot be read, a population is
/// unknown, or types extend each other in a circle. resolve_includes() and resolve_extends()
/// (worldio/json/json_include.hpp) describe the first and the third step. Returns whether these two steps
/// found no error. If it returns false, types may be missing or incomplete, so that errors about the meaning
/// of the world may be untrue.
bool change_json_world(JsonNode& document, const std::filesystem::path& file, const LoadOptions& options,
                       Diagnostics& diagnostics);

/// Converts the JSON nodes of a world to a document. Reports all errors, each at its line. A wrong value is
/// treated as absent, with the exceptions that read_described() lists (worldio/json/read_document.hpp). Of
/// `options`, the function uses only `most_bodies`. Throws InputError if a `ring` (a key that repeats an
/// object in a circle) makes too many objects (check_rings()).
WorldDocument read_json_document(const JsonNode& document, const engine::Registry& registry,
                                 const LoadOptions& options, Diagnostics& diagnostics);

/// Parses `text`, and calls change_json_world() and read_json_document(). `file` is the path of the world:
/// errors name it, and the paths of included files are relative to its folder. If the text is not JSON, or if
/// change_json_world() returns false, reports errors and returns nothing.
std::optional<WorldDocument> load_json_document(const std::filesystem::path& file, const std::string& text,
                                                const engine::Registry& registry, const LoadOptions& options,
                                                Diagnostics& diagnostics);

/// Converts a document to a spec: reads the images of the world and places its bodies. `file` is the path of
/// the document; the paths in the document are relative to its folder. Of `options`, the function uses
/// `seed`, `threads`, `most_bodies`, `place_again` and `populations`. Reports all errors that it finds. If
/// `diagnostics` then has errors, including errors from before the call, places no bodies: the spec is
/// incomplete and must not be used.
engine::WorldSpec expand(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, const LoadOptions& options,
                         Diagnostics& diagnostics);

/// Converts a document to JSON. Returns the root node, from which read_json_document() makes an equal
/// document. Each node gets the place that the document has for its value. If the document has none, the node
/// gets the place of the enclosing node; for the root, that is the whole file `file`. Reports no errors:
/// `diagnostics` is only needed for its table of file names (Diagnostics::files()).
JsonNode json_world_node(const WorldDocument& document, const std::filesystem::path& file,
                         const engine::Registry& registry, Diagnostics& diagnostics);
/// Like load_json_world() (worldio/load.hpp), but for a world that is already parsed: `document` is its root
/// node. Reports keys that occur twice in an object, as the parser of load_json_world() does.
engine::WorldSpec load_json_node(JsonNode document, const std::filesystem::path& file,
                                 const engine::Registry& registry, const LoadOptions& options,
                                 Diagnostics& diagnostics);

/// Converts the JSON nodes of a world to a spec: calls read_json_document() and expand(). Does not call
/// change_json_world(), so the caller must have done so if the world has the keys `include` or `extends`.
/// `file` is the path of the world; the paths in the world are relative to its folder.
engine::WorldSpec read_json_world(const std::filesystem::path& file, const JsonNode& document,
                                  const engine::Registry& registry, const LoadOptions& options,
                                  Diagnostics& diagnostics);

/// Converts a spec to a JSON world and returns its root node. `file` is the path that the JSON world will
/// have; the paths in it are relative to the folder of `file`. The function also reads the JSON world back,
/// and checks that spec_difference() finds no difference from `spec`. If JSON cannot express the world,
/// reports errors and returns nothing.
/// - The members of populations are written one by one, as entries of `models`.
/// - An angle is written in degrees if a number of at most nine digits converts back to the same radians,
///   else in radians.
/// - An image is written as its path if reading the image again gives the same shape. Otherwise the outlines
///   of the shape are written.
/// - The key `same_names` is "warn" if several bodies have the same name. The key `overlaps` is "warn" if
///   bodies overlap. Without these values, reading the world back would be an error.
/// - Each node gets the place that the spec has for its value, or else that of the enclosing node.
std::optional<JsonNode> write_json_world(const engine::WorldSpec& spec, const std::filesystem::path& file,
                                         const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
