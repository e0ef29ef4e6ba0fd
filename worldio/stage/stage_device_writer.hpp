#pragma once

#include "engine/kinds/kinds.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/stage/stage_text.hpp"

#include <string>

/// Functions that write devices, drives and controllers as properties of models in a `.world` file of Stage,
/// an older robot simulator. The units of the file are metres and radians. A position model is a robot, or a
/// part with wheels of its own. A spec is the description that the engine uses. These functions are the
/// inverse of StageKinds (worldio/stage/stage_kinds.hpp), which reads these properties. A parameter for which
/// Stage has no property is omitted; check_stage_round_trip(), which reads the written file again, reports it
/// later.
namespace troupe::worldio {

/// Writes the properties of a device into the model that the caller has begun in `text`.
void write_stage_device(const engine::DeviceSpec& device, const engine::DeviceKind& kind, StageText& text);
/// Writes the properties of a drive into the position model that the caller has begun in `text`.
void write_stage_drive(const engine::DriveSpec& drive, const engine::DriveKind& kind, StageText& text);
/// Writes the drive of a position model that is inside another model. In a spec, such a drive is a device of
/// kind "wheels". `period_s` is the period, s, of the controllers of the position model. Writes nothing if
/// the kind of the drive is not in `registry`.
void write_stage_wheels(const engine::DeviceSpec& wheels, double period_s, const engine::Registry& registry,
                        StageText& text);
/// Returns the value of the property `ctrl` for a controller, such as `script law=wave`: its name, and the
/// parameters that differ from their defaults, in SI units. Parameters that this syntax cannot express are
/// omitted.
std::string stage_call(const engine::ControllerSpec& controller, const engine::ControllerKind& kind);
/// Returns the value of the property `update_interval`, ms, for a period of `seconds`. The reader converts
/// the value back to exactly this period, if possible, else to a period that differs by rounding.
double stage_milliseconds(double seconds);

}  // namespace troupe::worldio
