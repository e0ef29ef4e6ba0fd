#pragma once

#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <filesystem>
#include <optional>
#include <string>

/// Converts types between documents and specs. A type describes bodies of the same construction. A document
/// is a struct with the content of a JSON object (worldio/json/world_document.hpp). A spec is the description
/// that the engine uses (engine/spec/world_spec.hpp). A part is a rigid piece of a body. The engine::Registry
/// lists the kinds (sorts) of drives, devices and controllers that a type may have.
namespace troupe::worldio {

/// Converts the document of a type to a spec. `key` is the key of the type in the object `types`, and also
/// its name if the document has no name. `at` is the path of the document, for errors. `images` reads the
/// images of the type. `is_whole` says that the document was read without errors; otherwise, references to
/// devices and joints of the type are not checked. Do not use the result if errors are reported.
engine::TypeSpec expand_type(const TypeDocument& document, const std::string& key, const DocumentPath& at,
                             const engine::Registry& registry, ImageFolder& images, bool is_whole);

/// Converts the spec of a type to the document from which expand_type() makes the same spec. The document
/// omits values that expand_type() sets by default.
/// - `key` is the key that the type will have in the object `types`.
/// - `color` is the colour of the type in the document, because a TypeSpec has no colour; empty: none.
/// - If `folder` is not null, the document has the paths of images, relative to this folder. If it is null,
///   the document has outlines instead of images.
///
/// Throws std::runtime_error if the kind of a device is not in `registry`.
TypeDocument contract_type(const engine::TypeSpec& type, const std::string& key,
                           const std::optional<Color>& color, const engine::Registry& registry,
                           const std::filesystem::path* folder);

/// Whether a device of this kind moves its own part. (A part can itself be a device: PartDocument::device.)
/// True for an actuator, whose joint moves the part. False for a gripper, whose joints move only its paddles,
/// and for a device without a joint.
inline bool moves_itself(const engine::DeviceKind& kind) { return !kind.joints.empty() && !kind.body; }

}  // namespace troupe::worldio
