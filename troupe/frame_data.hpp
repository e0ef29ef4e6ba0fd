#pragma once

#include "engine/frame.hpp"
#include "engine/world.hpp"
#include "troupe/picture_source.hpp"

#include <optional>
#include <string>
#include <vector>

namespace troupe {

/// `velocity.x`, `ranger/ir.ranges.3`, or a component by its kind: `wander.turn_left_s`. Where there is no
/// such thing `fault` says so, and what there is.
std::optional<ChosenValue> find_value(const engine::World& world, const std::string& name,
                                      std::string& fault);
/// A value each of the frame's bodies; NaN for those that lack it.
std::vector<double> values_of(const engine::World& world, const ChosenValue& value,
                              const engine::Frame& frame);

/// The rangers of all types.
std::vector<engine::FrameRanger> frame_rangers(const engine::World& world);
/// What they read, of those that run: fills Frame::scans and ranges.
void add_scans(const engine::World& world, engine::Frame& frame);
/// What fiducial finders have found: fills Frame::sights.
void add_sights(const engine::World& world, engine::Frame& frame);
/// What blob finders see: fills Frame::blobs.
void add_blobs(const engine::World& world, engine::Frame& frame);
/// The light beams of grippers, and what they hold: fills Frame::grips.
void add_grips(const engine::World& world, engine::Frame& frame);
/// Who carries whom: fills Frame::links.
void add_links(const engine::World& world, engine::Frame& frame);
/// What power packs hold: fills Frame::charges.
void add_charges(const engine::World& world, engine::Frame& frame);
void add_names(const engine::World& world, engine::Frame& frame);

}  // namespace troupe
