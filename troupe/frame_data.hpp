#pragma once

#include "base/result.hpp"
#include "engine/frame.hpp"
#include "engine/world.hpp"
#include "troupe/picture_source.hpp"

#include <string>
#include <vector>

namespace troupe {

/// `velocity.x`, `ranger/ir.ranges.3`, or a component by its kind: `wander.turn_left_s`. Where there is no
/// such thing the error says so, and what there is.
Result<ChosenValue> find_value(const engine::World& world, const std::string& name);
/// A value each of the frame's bodies; NaN for those that lack it.
std::vector<double> values_of(const engine::World& world, const ChosenValue& value,
                              const engine::Frame& frame);

/// The rangers of all types.
std::vector<engine::FrameRanger> frame_rangers(const engine::World& world);
/// What they read, of those that run: fills Frame::scans and ranges.
void add_scans(const engine::World& world, engine::Frame& frame);
/// What the devices of a layer show (DeviceKind::show): fills Frame::sights, blobs or grips.
void add_layer(const engine::World& world, engine::FrameLayer layer, engine::Frame& frame);
/// Who carries whom: fills Frame::links.
void add_links(const engine::World& world, engine::Frame& frame);
/// What devices store that store energy: fills Frame::charges.
void add_charges(const engine::World& world, engine::Frame& frame);
void add_names(const engine::World& world, engine::Frame& frame);

}  // namespace troupe
