#include "models/drives/wheels.hpp"

#include "engine/kinds/finite.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <fmt/format.h>

#include <array>

namespace troupe::models {
namespace {

using engine::Command;
using engine::ControlMode;
using engine::DeviceBatch;
using engine::DeviceKind;
using engine::DriveKind;
using engine::Record;
using engine::Velocity;

// Limit of the distance of the part from its rest position. The bounding circle of its body must contain all
// positions of the part. Without a limit, the circle would be unbounded. The kind does not declare this limit
// as DeviceKind::Prepared::joint_reach_m: the cells of the spatial index would become too wide for the far
// smaller circles that bodies usually have.
constexpr double k_most_reach_m = 100;

enum class Law : std::uint8_t { diff, omni, car };
constexpr std::array<std::string_view, 3> names_of(Law) { return {"diff", "omni", "car"}; }

const DriveKind& kind_of(Law law) {
  static const std::array<DriveKind, 3> kinds{diff_drive(), omni_drive(), car_drive()};
  return kinds[static_cast<std::size_t>(law)];
}

struct Wheels {
  /// The parameters of a drive without three groups. The parameters of localization are not needed, because
  /// the estimated pose is the true pose; `pushes` and
  /// `turns_when_blocked` are not, because the engine moves joints in another way; the start velocities are
  /// not, because the drive runs before the first motion of the part.
  struct Params {
    Law drive = Law::diff;
    double wheelbase = CarParams().wheelbase;
    MotionParams motion;
    GoalParams goal;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::drive>("drive", "kind of drive that moves the part");
      d.member<&Params::wheelbase>("wheelbase", meters, above(0), used_if("drive", "car"),
                                   "distance between the axles of a car drive; no effect on other drives");
      d.part<&Params::motion>();
      d.part<&Params::goal>();
    }
  };
  using State = WheelsState;
  static constexpr std::array joints{std::string_view("joint")};
  static constexpr bool drives = true;

  const DriveKind* kind = nullptr;
  std::any data;
  Result<> bounds;  // holds an error if the parameters contradict each other; bind_part() returns it
  Pose rest;        // rest pose of the part, body frame

  static DeviceKind::Prepared prepare(const Params& params, const Pose& pose_body_part) {
    const DriveKind& kind = kind_of(params.drive);
    const DriveParams own{.motion = params.motion, .goal = params.goal};
    const Record record = params.drive == Law::car ? engine::to_record(CarParams{params.wheelbase, own})
                                                   : engine::to_record(own);
    return {.data = Wheels{&kind, kind.prepare(record), params.motion.check(), pose_body_part},
            .commands = engine::command_fields(),
            .command_bytes = sizeof(Command)};
  }
  Result<> bind_part(const engine::TypeSpec&, std::uint32_t) const {
    if (bounds) return {};
    return Error{fmt::format("has contradictory drive parameters: {}", bounds.error().text)};
  }

  static void halt(WheelsState& state) { state.forward = state.left = state.turn = 0; }
  void act(const DeviceBatch& batch) const;
  void joints_moved(const DeviceBatch& batch) const;

  Velocity drive(const Command& command, const Pose& at, double elapsed_s, Velocity v) const {
    engine::DriveBatch batch{
        .commands = {&command, 1}, .velocities = {&v, 1}, .estimates = {}, .elapsed_s = elapsed_s};
    if (command.mode != ControlMode::velocity) batch.estimates = {&at, 1};
    kind->drive(data, batch);
    return v;
  }
};

/// The pose of the joint after dt seconds, in the frame of its rest pose. q: the present pose of the joint in
/// this frame. v: the velocity of the joint, in its own frame. Like a body, the joint moves in a straight
/// line, in the direction given by its heading at the start of the tick.
Pose moved(const Pose& q, const Velocity& v, double dt) {
  const Vec2 way = Rotation(q.heading) * Vec2(v.x * dt, v.y * dt);
  return {q.x + way.x(), q.y + way.y(), q.z, q.heading + v.turn * dt};
}

void Wheels::act(const DeviceBatch& batch) const {
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    auto& state = batch.state.as<WheelsState>(batch.slot(i));
    const Pose& q = batch.joint(i, 0);
    const Pose at = compose(batch.mount(i), compose(rest, q));
    const auto& command = batch.commands->as<Command>(batch.slot(i));
    const Velocity v = drive(command, at, batch.period_s, {state.forward, state.left, state.turn});
    if (!is_finite(command) || !is_finite(v))
      throw engine::StepError(fmt::format(
          "tick {}: a drive on a part of \"{}\" was commanded a velocity that is not a finite number",
          batch.view.tick(), batch.view.spec().name(batch.body(i))));
    state = {at.x + 0.0, at.y + 0.0, at.z + 0.0, at.heading + 0.0, v.x + 0.0, v.y + 0.0, v.turn + 0.0, 0};
    if (v.x == 0 && v.y == 0 && v.turn == 0) continue;
    const Pose to = moved(q, v, batch.period_s);
    state.stalled = !(to.position().norm() <= k_most_reach_m);
    if (state.stalled == 0) batch.move_joint(i, 0, to);
  }
}

void Wheels::joints_moved(const DeviceBatch& batch) const {
  for (std::size_t i = 0; i < batch.rows.size(); ++i)
    if (batch.asked_joint(i, 0))
      batch.state.as<WheelsState>(batch.slot(i)).stalled = !batch.moved_joint(i, 0);
}

}  // namespace

DeviceKind wheels_kind() {
  return engine::make_device_kind<Wheels>("wheels", "gives a part of a body a drive of its own");
}

WheelsDrive drive_of_wheels(const engine::Record& params) {
  const auto own = engine::from_record<Wheels::Params>(params);
  return {kind_of(own.drive).name, own.motion};
}

}  // namespace troupe::models
