#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/stage/stage_text.hpp"

#include <string>

/// Devices, drives and controllers as properties of Stage's models, the way back from StageKinds, in a file
/// of metres and radians. What has no property is left out, for check_stage_round_trip() to find.
namespace troupe::worldio {

void write_stage_device(const engine::DeviceSpec& device, const engine::DeviceKind& kind, StageText& text);
void write_stage_drive(const engine::DriveSpec& drive, const engine::DriveKind& kind, StageText& text);
/// The drive of a position inside another model; `period_s`: of its controllers.
void write_stage_wheels(const engine::DeviceSpec& wheels, double period_s, const engine::Registry& registry,
                        StageText& text);
/// `script law=wave`: the name and what is not as by default.
std::string stage_call(const engine::ControllerSpec& controller, const engine::ControllerKind& kind);
/// What `update_interval` turns into just these seconds.
double stage_milliseconds(double seconds);

}  // namespace troupe::worldio
