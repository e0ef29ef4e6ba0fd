#pragma once

#include "base/result.hpp"
#include "engine/kinds/kinds.hpp"

#include <string_view>

namespace troupe::worldio {

// The parameters of a kind are keys of the same JSON object as `name`, `pose` and the other keys that all
// objects of such kinds have. check_parameter_names() checks that no parameter has the name of one of these
// keys.

/// The JSON objects of devices, drives, controllers and measures have certain keys, such as "kind", whatever
/// their kind is. Each of these functions returns success if no parameter of the kind has the name of one of
/// these keys: only then can JSON worlds use the kind. As an exception, a parameter may have the name of a
/// key that has a second name for this case (DocumentKey::other). The error continues a sentence about the
/// kind: `has a parameter "name", but ...`.
///@{
Result<> check_parameter_names(const engine::DeviceKind& kind);
Result<> check_parameter_names(const engine::DriveKind& kind);
Result<> check_parameter_names(const engine::ControllerKind& kind);
Result<> check_parameter_names(const engine::MeasureKind& kind);
///@}

/// Returns success if device and controller kinds may have this name. They may not have the name of a
/// component that the engine defines (engine::k_engine_components), nor the name "alive", because checkpoints
/// and recordings could not store both. The error continues a sentence about the kind: `has the name of ...`.
Result<> check_kind_name(std::string_view name);

/// Checks all device, drive, controller and measure kinds of a registry with check_parameter_names(), and the
/// names of devices and controllers with check_kind_name(). The error is that of the first wrong kind, and
/// names this kind.
Result<> check_kinds(const engine::Registry& registry);

}  // namespace troupe::worldio
