#include "models/drives/wheels.hpp"

#include "engine/world.hpp"
#include "models/drives/drives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace troupe::models {
namespace {

using engine::Command;
using engine::ControlMode;
using engine::DeviceBatch;
using engine::DeviceKind;
using engine::DriveKind;
using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Velocity;

// How far from its rest it may go: the circle about its body grows with that.
constexpr double k_most_reach_m = 100;

const std::array<DriveKind, 3>& drives() {
  static const std::array<DriveKind, 3> kinds{diff_drive(), omni_drive(), car_drive()};
  return kinds;
}

/// All that any drive takes, but for what it knows of where it is, and what it pushes: joints push nothing.
const FieldTable& table() {
  static const FieldTable fields = [] {
    FieldTable all{{{.name = "drive",
                     .type = FieldType::text,
                     .fallback = std::string("diff"),
                     .text = "how it drives",
                     .choices = {"diff", "omni", "car"}}}};
    const DriveKind& any = drives().back();
    for (std::size_t f = 0; f < *any.localization; ++f)  // these come last
      if (f != any.pushes) all.fields.push_back(any.params.fields[f]);
    return all;
  }();
  return fields;
}

struct Wheels {
  const DriveKind* kind = nullptr;
  std::any data;
  Result<> bounds;  // whether the parameters fit together
  Pose rest;        // of the part, body frame

  void drive(const Command& command, const Pose& at, double elapsed_s, Velocity& v) const {
    engine::DriveBatch batch{
        .commands = {&command, 1}, .velocities = {&v, 1}, .estimates = {}, .elapsed_s = elapsed_s};
    if (command.mode != ControlMode::velocity) batch.estimates = {&at, 1};
    kind->drive(data, batch);
  }
};

Wheels read(const Record& params, const Pose& rest) {
  const std::string& name = params[0].text();
  Wheels wheels{
      .kind = &*std::ranges::find(drives(), name, &DriveKind::name), .data = {}, .bounds = {}, .rest = rest};
  Record own = wheels.kind->params.defaults();
  for (std::size_t f = 0; f < own.size(); ++f)
    if (const int at = table().find(wheels.kind->params.fields[f].name); at >= 0)
      own[f] = params[static_cast<std::size_t>(at)];
  wheels.bounds = wheels.kind->check(own);
  wheels.data = wheels.kind->prepare(own);
  return wheels;
}

/// In the frame of the joint's rest, by the heading at the beginning, as bodies move.
Pose moved(const Pose& q, const Velocity& v, double dt) {
  const Vec2 way = Rotation(q.heading) * Vec2(v.x * dt, v.y * dt);
  return {q.x + way.x(), q.y + way.y(), q.z, q.heading + v.turn * dt};
}

void act(const DeviceBatch& batch) {
  const Wheels& wheels = *std::any_cast<Wheels>(&batch.data);
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    auto& state = batch.state.as<WheelsState>(batch.slot(i));
    const Pose& q = batch.joint(i, 0);
    const Pose at = compose(batch.mount(i), compose(wheels.rest, q));
    Velocity v{state.forward, state.left, state.turn};
    wheels.drive(batch.commands->as<Command>(batch.slot(i)), at, batch.period_s, v);
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.turn))
      throw engine::StepError(
          fmt::format("tick {}: a part of \"{}\" was commanded what is not a finite number",
                      batch.world.tick(), batch.world.spec().name(batch.body(i))));
    state = {at.x + 0.0, at.y + 0.0, at.z + 0.0, at.heading + 0.0, v.x + 0.0, v.y + 0.0, v.turn + 0.0, 0};
    if (v.x == 0 && v.y == 0 && v.turn == 0) continue;
    const Pose to = moved(q, v, batch.period_s);
    state.stalled = !(to.position().norm() <= k_most_reach_m);
    if (state.stalled == 0) batch.move_joint(i, 0, to);
  }
}

void settled(const DeviceBatch& batch) {
  for (std::size_t i = 0; i < batch.rows.size(); ++i)
    if (batch.asked_joint(i, 0))
      batch.state.as<WheelsState>(batch.slot(i)).stalled = !batch.moved_joint(i, 0);
}

}  // namespace

DeviceKind wheels_kind() {
  DeviceKind kind{.name = "wheels", .text = "a drive of a part of its own, which moves on its body"};
  kind.params = table();
  kind.joints = {"joint"};
  kind.drives = true;
  kind.prepare = [](const Record& params, const Pose& pose_body_part) {
    return DeviceKind::Prepared{.data = read(params, pose_body_part),
                                .percepts = engine::memory_fields<WheelsState>(),
                                .percept_bytes = sizeof(WheelsState),
                                .commands = engine::command_fields(),
                                .command_bytes = sizeof(Command)};
  };
  kind.mount = [](std::any& data, const engine::TypeSpec&, std::uint32_t) -> Result<> {
    const Result<>& bounds = std::any_cast<Wheels>(&data)->bounds;
    if (bounds) return {};
    return Error{fmt::format("has drive parameters that contradict one another: {}", bounds.error().text)};
  };
  kind.act = act;
  kind.settled = settled;
  return kind;
}

}  // namespace troupe::models
