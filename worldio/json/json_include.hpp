#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_node.hpp"

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// The keys that an included file may have besides `troupe`, the version of the format.
inline constexpr std::array<std::string_view, 3> k_included_keys{"$schema", "include", "types"};

/// Greatest number of files, each of which includes the next one. The limit is needed because the reader is
/// recursive: without it, a longer chain of files would exhaust the stack.
inline constexpr std::size_t k_most_nested_includes = 100;

/// Replaces the key `include`, a list of files, in the JSON object of a world: the types of these files are
/// added in front of the types of the world. A type describes bodies of the same construction. Does nothing
/// if the world has no key `include`. `file` is the path of the world file. Every node keeps its file and
/// line.
/// - An included file is a JSON object with the keys `types`, `include`, `troupe` and `$schema`, all of them
///   optional.
/// - The path of an included file is relative to the folder of the including file.
/// - Paths of images in an included file are relative to the folder of this file. The function changes them:
///   afterwards they are relative to the folder of the world.
/// - A file that is included several times counts once.
///
/// These are errors: a file that cannot be read or is not a JSON object, files that include each other in a
/// circle or in a chain of more than k_most_nested_includes files, an unknown key or a wrong value in an
/// included file, and two types with the same key.
void resolve_includes(JsonNode& world, const std::filesystem::path& file, Diagnostics& diagnostics);

/// Greatest number of types from which a type may inherit, directly or through other types. The limit bounds
/// the time of Diagnostics::error() and warning(), which follow the chain of these types.
inline constexpr std::size_t k_most_bases = 1000;
/// Greatest number of JSON values that all types of a world together may inherit. Each number, text, list and
/// object counts, including those in lists and objects. The limit is needed because the values multiply: if
/// many types extend a large type, a short file could ask for any amount of memory.
inline constexpr std::size_t k_most_inherited_values = 5000000;

/// Replaces the key `extends` of each type in the JSON object of a world. The value of the key names another
/// type, the base type. The type inherits the keys of the base type that it does not have itself. Rules:
/// - If the value of a key is an object in both types, the two objects are merged by these rules. But if both
///   objects have a key `kind` and the kinds differ, nothing is inherited from the object of the base type.
/// - In the lists `sensors`, `devices` and `parts`, entries of the same name are merged by these rules. The
///   other entries of the type follow those of the base type.
/// - A key with the value null removes the inherited key. Only `"joint": null` is kept, which means that
///   there is no joint.
/// - A key of the type replaces an inherited key of the same quantity in another unit. `controller` and
///   `controllers` also replace each other.
/// - The key `name` of a type is not inherited.
///
/// Every node keeps its file and line. Reports an error for an unknown base type, and for types that extend
/// each other in a circle. To avoid a second error about keys that such a type would have inherited, the key
/// `extends` and all keys that may be incomplete, such as `drive`, are removed from it. If the type then has
/// no size, it gets the size 1 m x 1 m x 1 m. Types that extend such a type, or a base that is no object,
/// are treated in the same way. Returns whether there were no such types. If it returns false, errors about
/// the meaning of the world, such as an unknown device, may be untrue.
///
/// A type may inherit from at most k_most_bases types, and all types together may inherit at most
/// k_most_inherited_values values. If they inherit more, reports an error at the first type that exceeds the
/// limit, and throws InputError with all errors that were reported so far.
///
/// bases: if not null, the list to which the names of all base types are added, once for each type that
/// extends the base type.
/// has_all_types: whether resolve_includes() found no error. If not, an unknown base type may be one of a
/// file that could not be included, so it is not reported.
bool resolve_extends(JsonNode& world, Diagnostics& diagnostics, std::vector<std::string>* bases = nullptr,
                     bool has_all_types = true);

}  // namespace troupe::worldio
