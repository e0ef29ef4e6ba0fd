#pragma once

#include "base/result.hpp"
#include "engine/kinds/kinds.hpp"

#include <string_view>

namespace troupe::worldio {

// A kind is a sort of drive, device, controller or measure, with its own parameters. The parameters of a kind
// are keys of the same JSON object as `name`, `pose` and the other keys that all objects of such kinds have.
// check_parameter_names() checks that no parameter has the name of one of these keys.

/// The JSON object of a device, drive, controller or measure can have certain keys, such as "kind", whatever
/// its kind is. Each of these functions returns success if no parameter of the kind has the name of one of
/// these keys: only then can JSON worlds use the kind. As an exception, a parameter may have the name of a
/// key that has a second name for this case: DocumentKey::other in worldio/json/document_table.hpp. The error
/// continues a sentence about the kind: `has a parameter "name", but ...`.
///@{
Result<> check_parameter_names(const engine::DeviceKind& kind);
Result<> check_parameter_names(const engine::DriveKind& kind);
Result<> check_parameter_names(const engine::ControllerKind& kind);
Result<> check_parameter_names(const engine::MeasureKind& kind);
///@}

/// Returns success if device and controller kinds may have this name. The names of components (parts of the
/// state of a world, such as "pose") that the engine itself defines are not allowed, nor is "alive":
/// checkpoints and recordings store the data of a kind under the name of the kind, next to these components.
/// engine::k_engine_components lists the components. The error continues a sentence about the kind: `has the
/// name of ...`.
Result<> check_kind_name(std::string_view name);

/// Checks all device, drive, controller and measure kinds of a registry with check_parameter_names(), and the
/// names of devices and controllers with check_kind_name(). The error is that of the first wrong kind, and
/// names this kind.
Result<> check_kinds(const engine::Registry& registry);

}  // namespace troupe::worldio
