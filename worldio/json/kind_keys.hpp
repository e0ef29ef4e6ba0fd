#pragma once

#include "base/result.hpp"
#include "engine/kinds/kinds.hpp"

#include <string_view>

namespace troupe::worldio {

// A kind is a sort of drive, device, controller or measure, with its own parameters. The parameters of a kind
// are keys of the same JSON object as `name`, `pose` and the other keys that all objects of such kinds have.
// check_parameter_names() checks that no parameter has the name of one of these keys.

/// Checks that JSON worlds can use a kind. Returns an error if a parameter of the kind has the name of a key
/// that every device (or drive, controller, measure) has in JSON worlds, such as `kind` or `name`. A few keys
/// are exempt, because they get another name in this case (DocumentKey::other in
/// worldio/json/document_table.hpp). The text of the error is a predicate, in front of which the caller puts
/// the kind: `has a parameter "name", but ...`.
///@{
Result<> check_parameter_names(const engine::DeviceKind& kind);
Result<> check_parameter_names(const engine::DriveKind& kind);
Result<> check_parameter_names(const engine::ControllerKind& kind);
Result<> check_parameter_names(const engine::MeasureKind& kind);
///@}

/// Checks the name of a device kind or a controller kind. Checkpoints and recordings store the data of a kind
/// under this name, next to the parts of the state that the engine itself defines, such as "pose". Returns an
/// error if the name is one of theirs (engine::k_engine_components) or "alive". The text of the error is a
/// predicate, in front of which the caller puts the kind: `has the name of ...`.
Result<> check_kind_name(std::string_view name);

/// Calls check_parameter_names() for all device, drive, controller and measure kinds of a registry, and
/// check_kind_name() for the names of its device and controller kinds. Returns the first error, with the kind
/// in front: `the drive kind "tank" has a parameter "name", but ...`.
Result<> check_kinds(const engine::Registry& registry);

}  // namespace troupe::worldio
