#pragma once

#include "base/result.hpp"
#include "engine/observing/frame.hpp"
#include "engine/world/world.hpp"
#include "troupe/picture_source.hpp"

#include <string>
#include <vector>

namespace troupe {

/// Finds a value of the state by name: COMPONENT.FIELD or COMPONENT.FIELD.COLUMN, such as `velocity.x` or
/// `ranger/ir.ranges.3`. A component is a table of the state. COMPONENT may be shortened to the kind of the
/// component or to the name of its device: `wander.turn_left_s` is a field of the component `wander/0`, and
/// `ir.ranges.3` is the same as `ranger/ir.ranges.3`. If there is no such value, the error lists the known
/// values; if only the column does not exist, the error states the columns of the field. If the value belongs
/// to a sensor that runs on no robot, ChosenValue::text says so.
Result<ChosenValue> find_value(const engine::World& world, const std::string& name);
/// Returns one number per body of Frame::mobile (the bodies that are not static): the chosen value of the
/// body, or NaN if the body does not have this value or its sensor does not run.
std::vector<double> values_of(const engine::World& world, const ChosenValue& value,
                              const engine::Frame& frame);

/// Returns the poses and beams of all rangers of all body types, for FrameScene::rangers. They are ordered by
/// type and then by device; the scans of add_scans() contain indices in this list.
std::vector<engine::FrameRanger> frame_rangers(const engine::World& world);
/// Appends the readings of all running rangers of the bodies of Frame::mobile to Frame::scans and
/// Frame::ranges. At tick 0, before any sensor has run, it appends nothing.
void add_scans(const engine::World& world, engine::Frame& frame);
/// Appends to Frame::sights, Frame::blobs or Frame::grips, depending on `layer`: calls DeviceKind::draw for
/// each device whose kind belongs to this layer. Skips sensors that do not run. At tick 0, before any sensor
/// has run, it skips all sensors.
void add_layer(const engine::World& world, engine::FrameLayer layer, engine::Frame& frame);
/// Appends to Frame::links a line from each body that carries others to each body that it carries directly,
/// m, world frame.
void add_links(const engine::World& world, engine::Frame& frame);
/// Fills Frame::charges: for each body of Frame::mobile the charge of its first power pack, as a fraction of
/// the capacity (1 for an infinite pack); NaN for bodies without a power pack.
void add_charges(const engine::World& world, engine::Frame& frame);
/// Appends the names of the bodies of Frame::mobile to Frame::names, in the order of these bodies.
void add_names(const engine::World& world, engine::Frame& frame);

}  // namespace troupe
