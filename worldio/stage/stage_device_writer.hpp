#pragma once

#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/stage/stage_text.hpp"

#include <string>

/// Writes devices, drives and controllers as properties of Stage models: the inverse of StageKinds, for a
/// file in metres and radians. A parameter without a property is omitted; check_stage_round_trip() reports
/// it.
namespace troupe::worldio {

void write_stage_device(const engine::DeviceSpec& device, const engine::DeviceKind& kind, StageText& text);
void write_stage_drive(const engine::DriveSpec& drive, const engine::DriveKind& kind, StageText& text);
/// Writes the drive of a position model inside another model; `period_s` is that of its controllers.
void write_stage_wheels(const engine::DeviceSpec& wheels, double period_s, const engine::Registry& registry,
                        StageText& text);
/// A `ctrl` string such as `script law=wave`: the name and the parameters that differ from their defaults.
std::string stage_call(const engine::ControllerSpec& controller, const engine::ControllerKind& kind);
/// The `update_interval`, ms, that reads back as exactly these seconds.
double stage_milliseconds(double seconds);

}  // namespace troupe::worldio
