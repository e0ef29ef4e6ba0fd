#pragma once

#include "base/result.hpp"
#include "engine/kinds/registry.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/stage/stage_text.hpp"

#include <string>

/// Writes devices, drives and controllers as properties of models in a `.world` file. Such files belong to
/// Stage, an older robot simulator. The class StageKinds (worldio/stage/stage_kinds.hpp) reads these
/// properties. The properties `unit_length` and `unit_angle` of the file must be metres and radians. A
/// position model is a robot, or a part with wheels of its own. A spec is the description of a world that the
/// engine uses.
///
/// A parameter for which Stage has no property is omitted without an error. When the file is complete, its
/// writer reads it again and reports what is missing (check_stage_round_trip()).
namespace troupe::worldio {

/// Writes the properties of a device into the model that the caller has opened in `text`.
void write_stage_device(const engine::DeviceSpec& device, const engine::DeviceKind& kind, StageText& text);
/// Writes the properties of a drive into the position model that the caller has opened in `text`.
void write_stage_drive(const engine::DriveSpec& drive, const engine::DriveKind& kind, StageText& text);
/// Writes the drive of a position model that is inside another model. In a spec, such a drive is a device of
/// kind "wheels". `period_s` is the period, s, of the model's controllers; it is written as the property
/// `update_interval` of the model. Writes nothing if `registry` does not have the kind of the drive.
void write_stage_wheels(const engine::DeviceSpec& wheels, double period_s, const engine::Registry& registry,
                        StageText& text);
/// Returns a controller as a value of the property `ctrl`, such as `script law=wave`. The value has the name
/// of the controller's kind and the parameters that differ from their defaults, in SI units. Parameters that
/// this syntax cannot express are omitted. If the controller needs such a parameter, returns an error that
/// names it.
Result<std::string> stage_call(const engine::ControllerSpec& controller, const engine::ControllerKind& kind);
/// Returns the value of the property `update_interval`, ms, for a period of `seconds`. The result divided by
/// 1000 is exactly `seconds`, if there is such a number; otherwise it differs from `seconds` by rounding.
double stage_milliseconds(double seconds);

}  // namespace troupe::worldio
