#pragma once

#include "base/result.hpp"
#include "engine/observing/frame.hpp"
#include "engine/world/world.hpp"
#include "troupe/picture_source.hpp"

#include <string>
#include <vector>

namespace troupe {

// These functions read the data of a world that a viewer needs to draw it. engine::Frame has the data of one
// tick (time step); Frame::mobile lists the bodies that are in the world and not static. engine::FrameScene
// has the data that are constant during a run. A ranger is a range sensor. A sensor runs only if the world
// file, a controller of the robot or Simulation::subscribe() makes it run.

/// Finds a value of the state by name. The state consists of tables, called components. A component has named
/// fields, and a field has one or more columns. The name is COMPONENT.FIELD.COLUMN, or COMPONENT.FIELD for
/// the column 0. COMPONENT is one of:
/// - the name of a component: `velocity`, `ranger/ir` (readings of the ranger `ir`), `wander/0` (memory of a
///   controller);
/// - the part of such a name before the slash, which is the kind of device or controller: `ranger`, `wander`;
/// - for a device, the part of the name after the slash, which is the name of the device: `ir`.
///
/// So `ranger/ir.ranges.3`, `ranger.ranges.3` and `ir.ranges.3` are names of the same value. If there is no
/// such value, the error lists the known values. If only the column does not exist, the error states the
/// columns of the field. If only types without bodies have the value, or if it belongs to a sensor that runs
/// on no robot, ChosenValue::text says so.
Result<ChosenValue> find_value(const engine::World& world, const std::string& name);
/// Returns one number per body of Frame::mobile: the chosen value of the body. The number is NaN if the body
/// does not have the value, or if the value is a reading of a sensor that does not run.
std::vector<double> values_of(const engine::World& world, const ChosenValue& value,
                              const engine::Frame& frame);

/// Returns the poses and beams of all rangers of all body types, for FrameScene::rangers. The list is ordered
/// by type and then by device. The scans that add_scans() appends refer to a ranger by its index in this
/// list.
std::vector<engine::FrameRanger> frame_rangers(const engine::World& world);
/// Appends the readings of all running rangers of the bodies of Frame::mobile to Frame::scans and
/// Frame::ranges. Appends nothing at tick 0, because no ranger has measured anything before the first step.
void add_scans(const engine::World& world, engine::Frame& frame);
/// Appends the drawings of the devices that belong to `layer`:
/// - `sights`: lines from fiducial finders to the bodies that they detect, to Frame::sights
/// - `blobs`: the regions of one colour that blob finders see, to Frame::blobs
/// - `grips`: light beams of grippers, and lines to the bodies that they hold, to Frame::grips
///
/// Sensors that do not run draw nothing. At tick 0 no sensor draws anything, because none has measured
/// anything before the first step.
void add_layer(const engine::World& world, engine::FrameLayer layer, engine::Frame& frame);
/// Appends one line (m, world frame) to Frame::links for each body that another body carries. The line goes
/// from the origin of the carrier, such as the robot whose gripper holds the body, to the origin of the body.
void add_links(const engine::World& world, engine::Frame& frame);
/// Fills Frame::charges: for each body of Frame::mobile, the charge of its first power pack (energy store),
/// as a fraction of the capacity. The charge is 1 for an infinite pack, and NaN for a body without a power
/// pack.
void add_charges(const engine::World& world, engine::Frame& frame);
/// Appends the names of the bodies of Frame::mobile to Frame::names, in the order of these bodies.
void add_names(const engine::World& world, engine::Frame& frame);

}  // namespace troupe
