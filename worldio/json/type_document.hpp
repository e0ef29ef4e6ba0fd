#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <filesystem>
#include <optional>
#include <string>

/// Converts body types between JSON documents and specs. A type describes bodies of the same construction. A
/// document is a struct with the content of a JSON object (worldio/json/world_document.hpp). A spec is the
/// description that the engine uses (engine/spec/world_spec.hpp). The engine::Registry lists the kinds
/// (sorts) of drives, devices and controllers that a type may have.
namespace troupe::worldio {

/// Returns the type that a document describes. `key` is its key in the object `types`, and also its name if
/// the document has no name. `at` is the path of the document, for errors. `images` reads the images of the
/// type. Do not use the result if errors are reported.
engine::TypeSpec expand_type(const TypeDocument& document, const std::string& key, const DocumentPath& at,
                             const engine::Registry& registry, ImageFolder& images);

/// The inverse of expand_type(): returns the document that describes this type under `key`, without the
/// values that expand_type() assumes by default. `color` becomes the colour of the type; if `color` is empty,
/// the document has no colour. Paths of images become relative to `folder`; if `folder` is null, images are
/// written as outlines. Throws std::runtime_error if the kind of a device is not in `registry`.
TypeDocument contract_type(const engine::TypeSpec& type, const std::string& key,
                           const std::optional<Color>& color, const engine::Registry& registry,
                           const std::filesystem::path* folder);

/// A part (rigid piece of a body) can itself be a device: PartDocument::device. Returns whether the joint of
/// a device of this kind then moves that part. True for actuators. False for grippers, because only their
/// paddles move, and for devices without a joint.
inline bool moves_itself(const engine::DeviceKind& kind) { return !kind.joints.empty() && !kind.body; }

}  // namespace troupe::worldio
