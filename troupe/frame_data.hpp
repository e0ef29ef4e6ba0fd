#pragma once

#include "base/result.hpp"
#include "engine/frame.hpp"
#include "engine/world.hpp"
#include "troupe/picture_source.hpp"

#include <string>
#include <vector>

namespace troupe {

/// Resolves `velocity.x`, `ranger/ir.ranges.3`, or a component by its kind: `wander.turn_left_s`. The error
/// names the unknown part and lists the known ones.
Result<ChosenValue> find_value(const engine::World& world, const std::string& name);
/// One value per body of the frame; NaN for bodies without it.
std::vector<double> values_of(const engine::World& world, const ChosenValue& value,
                              const engine::Frame& frame);

/// All rangers of all types.
std::vector<engine::FrameRanger> frame_rangers(const engine::World& world);
/// Fills Frame::scans and ranges with the readings of all running rangers.
void add_scans(const engine::World& world, engine::Frame& frame);
/// Fills Frame::sights, blobs or grips with what the devices of a layer show (DeviceKind::show).
void add_layer(const engine::World& world, engine::FrameLayer layer, engine::Frame& frame);
/// Fills Frame::links: which body carries which.
void add_links(const engine::World& world, engine::Frame& frame);
/// Fills Frame::charges of devices that store energy.
void add_charges(const engine::World& world, engine::Frame& frame);
/// Fills Frame::names.
void add_names(const engine::World& world, engine::Frame& frame);

}  // namespace troupe
