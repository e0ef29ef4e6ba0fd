#pragma once

#include "base/result.hpp"
#include "engine/kinds/registry.hpp"

#include <string_view>
#include <vector>

namespace troupe::worldio {

// A kind is a sort of drive, device, controller, measure or fault, with its own parameters. The parameters of
// a kind are keys of the same JSON object as `name`, `pose` and the other keys of objects of such kinds.

/// Checks that worlds can use a kind of a plug-in or of a program. Returns an error if
/// - the kind has no name, or its name is not one word (engine::is_name());
/// - a hook that every such kind must have is null, such as `prepare`;
/// - a parameter has the name of a key that every device (or drive, controller, measure) has in JSON worlds,
///   such as `kind` or `name`. A few keys are exempt, because they get another name in this case
///   (DocumentKey::other in worldio/json/document_table.hpp).
///
/// The text of the error is a predicate, in front of which the caller puts the kind: `has a parameter "name",
/// but ...`.
///@{
Result<> check_kind(const engine::DeviceKind& kind);
Result<> check_kind(const engine::DriveKind& kind);
Result<> check_kind(const engine::ControllerKind& kind);
Result<> check_kind(const engine::MeasureKind& kind);
Result<> check_kind(const engine::FaultKind& kind);
///@}

/// Checks the name of a device kind or a controller kind. Checkpoints and recordings store the data of a kind
/// under this name, next to the parts of the state that the engine itself defines, such as "pose". Returns an
/// error if the name is one of theirs (engine::k_engine_components) or "alive". The text of the error is a
/// predicate, in front of which the caller puts the kind: `has the name of ...`.
Result<> check_kind_name(std::string_view name);

/// Checks that all names in a list differ. `what` says what the names belong to. The text of the error is a
/// predicate: `has two kinds with the name "idle", each a controller: rename one`.
Result<> check_different(std::vector<std::string_view> names, std::string_view what);

/// Calls check_kind() for all kinds of a registry, check_kind_name() for the names of its device and
/// controller kinds, and check_different() for the names of each list; presets and controller kinds are one
/// list. Also checks that the controller kind of each preset, if the registry contains it, has the parameters
/// that the preset sets. Returns the first error: `the drive kind "tank" has a parameter "name", but ...`.
Result<> check_kinds(const engine::Registry& registry);

}  // namespace troupe::worldio
