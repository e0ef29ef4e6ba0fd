#include "engine/rows/starting.hpp"

#include "engine/kinds/finite.hpp"
#include "engine/kinds/localization.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/state/kind_calls.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <vector>

namespace troupe::engine {
namespace {

void start_drive(WorldState& state, Row row, const BodyType::Drive& drive) {
  if (drive.kind->start) {
    const Velocity v = call_kind(state.view, {&row, 1}, drive, [&] { return drive.kind->start(drive.data); });
    if (!is_finite(v))
      throw StepError(
          fmt::format("tick {}: drive \"{}\" of \"{}\" starts with the velocity x {}, y {} (m/s), turn "
                      "{} (rad/s) (DriveKind::start): the numbers must be finite",
                      state.now.tick, drive.kind->name, state.spec.name(state.bodies[row.index()]), v.x, v.y,
                      v.turn),
          state.bodies[row.index()]);
    state.as<Velocity>(WorldState::k_velocity)[row.index()] = v;
  }
  if (!drive.odometry_table) return;
  const Pose& pose = state.poses()[row.index()];
  const Pose estimate = relative_to(drive.localization.origin.value_or(pose), pose);
  state.as<Odometry>(*drive.odometry_table)[state.slots[row.index()]] = {estimate.x, estimate.y,
                                                                         estimate.heading};
}

}  // namespace

Pose canonical(const Pose& pose) {
  return {pose.x + 0.0, pose.y + 0.0, pose.z + 0.0, wrap_angle(pose.heading) + 0.0};
}

void start(WorldState& state, Row row, const Pose& pose) {
  const BodyType& type = state.type(row);
  const std::size_t slot = state.slots[row.index()];
  for (const BodyType::Device& device : type.devices)
    if (device.kind->start)
      call_kind(state.view, {&row, 1}, device,
                [&] { device.kind->start(device.prepared.data, state.tables[device.table], slot); });
  for (const std::size_t d : type.joint_devices) {
    const BodyType::Device& device = type.devices[d];
    const std::vector<Pose>& joints = device.prepared.joints;
    for (std::size_t n = 0; n < joints.size(); ++n)
      state.tables[type.joints[static_cast<std::size_t>(device.moves) + n].table].as<Pose>(slot) = joints[n];
  }
  for (const BodyType::Controller& controller : type.controllers)
    if (controller.table)
      call_kind(state.view, {&row, 1}, controller,
                [&] { controller.kind->start(state.tables[*controller.table].row(slot)); });
  state.poses()[row.index()] = canonical(pose);
  if (type.drive) start_drive(state, row, *type.drive);
}

}  // namespace troupe::engine
