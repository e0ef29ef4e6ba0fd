#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_node.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace troupe::worldio {

/// Removes the key `include` of a world, which lists files, and adds the types of these files in front of the
/// types of the world. An included file is an object with the keys `types`, `include`, `troupe` and
/// `$schema`. Its path is relative to the file that includes it; paths of images in it are relative to its
/// own folder. A file that is included several times counts once. `file` is the file of the world. Each node
/// keeps its file and line. Reports files that cannot be read, files that include each other in a circle,
/// keys that an included file must not have, and two types of one name.
void resolve_includes(JsonNode& world, const std::filesystem::path& file, Diagnostics& diagnostics);

/// Replaces the key `extends` of each type of a world, which names another type, by the keys of that base
/// type:
/// - A key that the type has itself replaces the key of the base type. A key that is null is removed, except
///   `joint`, where null means that there is no joint.
/// - If both values of a key are objects, they are merged key by key, unless both have a `kind` and the kinds
///   differ.
/// - In the lists `sensors`, `devices` and `parts`, entries of the same name are merged; others are appended.
/// - A quantity in one unit replaces the same quantity in another unit. `controller` replaces `controllers`,
///   and the reverse; `name` is not inherited.
/// Each node keeps its file and line. Reports unknown types, and types that extend each other in a circle.
/// bases: if not null, the list to which the names of all base types are added.
void resolve_extends(JsonNode& world, Diagnostics& diagnostics, std::vector<std::string>* bases = nullptr);

}  // namespace troupe::worldio
