#pragma once

#include "base/result.hpp"
#include "engine/frame.hpp"
#include "engine/world.hpp"
#include "troupe/picture_source.hpp"

#include <string>
#include <vector>

namespace troupe {

/// Finds a value of the state by name: COMPONENT.FIELD or COMPONENT.FIELD.COLUMN, such as `velocity.x` or
/// `ranger/ir.ranges.3`. A kind may stand for the component: `wander.turn_left_s`. The error states which
/// part of the name is unknown, and lists the known ones.
Result<ChosenValue> find_value(const engine::World& world, const std::string& name);
/// One value per body of the frame; NaN for bodies that do not have this value.
std::vector<double> values_of(const engine::World& world, const ChosenValue& value,
                              const engine::Frame& frame);

/// All rangers of all types of bodies in the world.
std::vector<engine::FrameRanger> frame_rangers(const engine::World& world);
/// Fills Frame::scans and ranges with the readings of all running rangers.
void add_scans(const engine::World& world, engine::Frame& frame);
/// Fills Frame::sights, blobs or grips, depending on `layer`, with what the devices report for this layer
/// (DeviceKind::show).
void add_layer(const engine::World& world, engine::FrameLayer layer, engine::Frame& frame);
/// Fills Frame::links: which body carries which.
void add_links(const engine::World& world, engine::Frame& frame);
/// Fills Frame::charges with the charges of all devices that store energy.
void add_charges(const engine::World& world, engine::Frame& frame);
/// Fills Frame::names.
void add_names(const engine::World& world, engine::Frame& frame);

}  // namespace troupe
