#pragma once

#include "base/result.hpp"
#include "engine/observing/frame.hpp"
#include "engine/world/world.hpp"
#include "troupe/picture_source.hpp"

#include <string>
#include <vector>

namespace troupe {

/// Finds a value of the state by name: COMPONENT.FIELD or COMPONENT.FIELD.COLUMN, such as `velocity.x` or
/// `ranger/ir.ranges.3`. A component is a table of the state with named fields. COMPONENT may be shortened to
/// the part before its slash, the kind of controller or device: `wander.turn_left_s` is a field of the
/// component `wander/0`, the memory of a controller. For a device, COMPONENT may also be shortened to the
/// part after the slash, the name of the device: `ir.ranges.3` is the same as `ranger/ir.ranges.3`, a range
/// of the range sensor `ir`. If there is no such value, the error lists the known values; if only the column
/// does not exist, the error states the columns of the field. If the value belongs to a sensor that runs on
/// no robot, ChosenValue::text says so.
Result<ChosenValue> find_value(const engine::World& world, const std::string& name);
/// Returns one number per body of Frame::mobile, the list of the bodies that are in the world and not static.
/// The number is the chosen value of the body, or NaN if the body does not have this value or its sensor does
/// not run.
std::vector<double> values_of(const engine::World& world, const ChosenValue& value,
                              const engine::Frame& frame);

/// Returns the poses and beams of all rangers (range sensors) of all body types, for FrameScene::rangers. The
/// list is ordered by type and then by device; the scans that add_scans() appends contain indices into this
/// list.
std::vector<engine::FrameRanger> frame_rangers(const engine::World& world);
/// Appends the readings of all running rangers of the bodies of Frame::mobile to Frame::scans and
/// Frame::ranges. At tick 0 (before the first time step) no sensor has run, and it appends nothing.
void add_scans(const engine::World& world, engine::Frame& frame);
/// Appends the drawings of devices to Frame::sights (detections), Frame::blobs (regions of one colour that
/// sensors see) or Frame::grips (grippers), as `layer` selects. Each kind of device that belongs to the layer
/// has a function DeviceKind::draw, which add_layer() calls for each such device. Skips sensors that do not
/// run. At tick 0 no sensor has run, and it skips all sensors.
void add_layer(const engine::World& world, engine::FrameLayer layer, engine::Frame& frame);
/// Appends to Frame::links a line from each body that carries others to each body that it carries directly,
/// m, world frame.
void add_links(const engine::World& world, engine::Frame& frame);
/// Fills Frame::charges: for each body of Frame::mobile the charge of its first power pack (energy store), as
/// a fraction of the capacity (1 for an infinite pack); NaN for bodies without a power pack.
void add_charges(const engine::World& world, engine::Frame& frame);
/// Appends the names of the bodies of Frame::mobile to Frame::names, in the order of these bodies.
void add_names(const engine::World& world, engine::Frame& frame);

}  // namespace troupe
