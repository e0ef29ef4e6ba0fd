#pragma once

#include "base/diagnostics.hpp"
#include "worldio/json/json_node.hpp"

#include <filesystem>

namespace troupe::worldio {

/// Replaces the key `include` of a world by the types of the files that it names, before its own types. A
/// file is an object with the keys `types`, `include`, `troupe` and `$schema`; its path is relative to the
/// file that includes it, and so are the paths of images in its types. A file that is included several times
/// counts once. `file` is the file of the world. Each node keeps its file and line. Reports files that
/// cannot be read, circles of includes, other keys, and types of the same name.
void resolve_includes(JsonNode& world, const std::filesystem::path& file, Diagnostics& diagnostics);

/// Replaces the key `extends` of each type of a world by the keys of the type that it names:
/// - A key that the type gives itself replaces that of the other type. A key that is null is removed, except
///   `joint`, where null means that there is no joint.
/// - An object is merged key by key, unless both have a `kind` and the kinds differ.
/// - In the lists `sensors`, `devices` and `parts`, entries of the same name are merged; others are appended.
/// - A quantity in one unit replaces the same quantity in another unit. `controller` replaces `controllers`,
///   and the reverse; `name` is not inherited.
/// Each node keeps its file and line. Reports unknown types and circles.
void resolve_extends(JsonNode& world, Diagnostics& diagnostics);

}  // namespace troupe::worldio
