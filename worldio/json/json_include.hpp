#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_node.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace troupe::worldio {

/// Removes the key `include`, a list of files, from the JSON object of a world, and adds the types of these
/// files in front of the types of the world. A type describes bodies of the same construction. An included
/// file is a JSON object that can have the keys `types`, `include`, `troupe` and `$schema`. Its path is
/// relative to the folder of the including file. Paths of images in it are relative to its own folder, and
/// are changed to be relative to the folder of the world. A file that is included several times counts once.
/// `file` is the path of the world file. Each node keeps its file and line. Reports an error for a file that
/// cannot be read or is not a JSON object, for files that include each other in a circle, for a key that an
/// included file must not have or whose value is wrong, and for two types with the same key. Does nothing if
/// the world has no key `include`.
void resolve_includes(JsonNode& world, const std::filesystem::path& file, Diagnostics& diagnostics);

/// Replaces the key `extends` of each type in the JSON object of a world with the keys of the base type,
/// which is the type that `extends` names:
/// - A key that the type has itself replaces the key of the base type.
/// - A key whose value is null removes the key that the type would inherit. The exception is `joint`, where
///   null means that there is no joint.
/// - If both values of a key are objects, they are merged key by key. If both objects have a `kind` and the
///   kinds differ, the type inherits nothing of the base object. The key `kind` of the type itself has no
///   such effect: it names a model type of Stage, an older robot simulator.
/// - In the lists `sensors`, `devices` and `parts`, entries of the same name are merged. The other entries of
///   the type follow those of the base type.
/// - A key of the type replaces an inherited key of the same quantity in another unit. `controller` replaces
///   an inherited `controllers`, and `controllers` an inherited `controller`.
/// - `name` is not inherited.
/// Each node keeps its file and line. Reports an error for an unknown base type, and for types that extend
/// each other in a circle. A type with such an error loses its key `extends`. If this type has no shape, it
/// gets the size 1 m x 1 m x 1 m, so that the reader does not also report the lack of a shape.
/// bases: if not null, the list to which the names of all base types are added. A name is added once for each
/// type that extends the base type.
void resolve_extends(JsonNode& world, Diagnostics& diagnostics, std::vector<std::string>* bases = nullptr);

}  // namespace troupe::worldio
