#pragma once

#include "engine/kinds/components.hpp"
#include "engine/kinds/drive_kind.hpp"
#include "engine/kinds/localization.hpp"

#include <cstdint>

namespace troupe::models {

/// Limits of the velocities and accelerations of a drive. In the robot frame, x points forward and y to the
/// left. The function describe() gives the units and meanings of the members.
struct MotionParams {
  double velocity_min_x = -1;
  double velocity_max_x = 1;
  double velocity_min_y = -1;
  double velocity_max_y = 1;
  double turn_min = -radians(90);
  double turn_max = radians(90);
  double acceleration_min_x = -1;
  double acceleration_max_x = 1;
  double acceleration_min_y = -1;
  double acceleration_max_y = 1;
  double turn_acceleration_min = -radians(90);
  double turn_acceleration_max = radians(90);

  static constexpr void describe(engine::Description<MotionParams>& d) {
    using namespace engine::facts;
    using enum engine::Unit;
    d.member<&MotionParams::velocity_min_x>(
        "velocity_min_x", meters_per_second, mirrors("velocity_max_x"),
        "lower limit of the forward speed; if negative, the robot can drive backwards");
    d.member<&MotionParams::velocity_max_x>("velocity_max_x", meters_per_second, mirrors("velocity_min_x"),
                                            "upper limit of the forward speed");
    d.member<&MotionParams::velocity_min_y>(
        "velocity_min_y", meters_per_second, mirrors("velocity_max_y"),
        "lower limit of the speed to the left, which is 0 for `diff` and `car` unless the limits exclude 0; "
        "if negative, an `omni` robot can drive to the right");
    d.member<&MotionParams::velocity_max_y>(
        "velocity_max_y", meters_per_second, mirrors("velocity_min_y"),
        "upper limit of the speed to the left, which is 0 for `diff` and `car` unless the limits exclude 0");
    d.member<&MotionParams::turn_min>("turn_min", radians_per_second, mirrors("turn_max"),
                                      "lower limit of the turn rate, which is positive counter-clockwise");
    d.member<&MotionParams::turn_max>("turn_max", radians_per_second, mirrors("turn_min"),
                                      "upper limit of the turn rate, which is positive counter-clockwise");
    d.member<&MotionParams::acceleration_min_x>("acceleration_min_x", meters_per_second_squared,
                                                mirrors("acceleration_max_x"),
                                                "lower limit of a commanded forward acceleration");
    d.member<&MotionParams::acceleration_max_x>("acceleration_max_x", meters_per_second_squared,
                                                mirrors("acceleration_min_x"),
                                                "upper limit of a commanded forward acceleration");
    d.member<&MotionParams::acceleration_min_y>(
        "acceleration_min_y", meters_per_second_squared, mirrors("acceleration_max_y"),
        "lower limit of a commanded acceleration to the left, used only by `omni`");
    d.member<&MotionParams::acceleration_max_y>(
        "acceleration_max_y", meters_per_second_squared, mirrors("acceleration_min_y"),
        "upper limit of a commanded acceleration to the left, used only by `omni`");
    d.member<&MotionParams::turn_acceleration_min>("turn_acceleration_min", radians_per_second_squared,
                                                   mirrors("turn_acceleration_max"),
                                                   "lower limit of a commanded angular acceleration");
    d.member<&MotionParams::turn_acceleration_max>("turn_acceleration_max", radians_per_second_squared,
                                                   mirrors("turn_acceleration_min"),
                                                   "upper limit of a commanded angular acceleration");
  }

  /// Returns an error if a lower limit exceeds its upper limit. The error names the first such pair, and both
  /// values.
  Result<> check() const;
};

/// Greatest speeds on the way to a goal (ControlMode::position). The limits of the drive apply as well. The
/// defaults are Stage's.
struct GoalParams {
  static constexpr double k_none = 1e9;  ///< no limit besides those of the drive

  double speed_max = 0.4;
  double turn_max = 1;

  static constexpr void describe(engine::Description<GoalParams>& d) {
    using namespace engine::facts;
    using enum engine::Unit;
    d.member<&GoalParams::speed_max>(
        "goal_speed_max", meters_per_second, above(0), at_most(k_none), in_json(k_none),
        "greatest speed on the way to a goal, for `omni` of the forward speed and of the speed to the left; "
        "the limits of the drive apply as well; in `.world` files it is Stage's 0.4 m/s");
    d.member<&GoalParams::turn_max>("goal_turn_max", radians_per_second, above(0), at_most(k_none),
                                    in_json(k_none),
                                    "greatest turn rate on the way to a goal; the limits of the drive apply "
                                    "as well; in `.world` files it "
                                    "is Stage's 1 rad/s");
  }
};

/// Velocity of a robot until its drive runs for the first time. A drive runs once per period: it then
/// computes a new velocity from the command. The function describe() gives the units of the members.
struct StartParams {
  double x = 0;
  double y = 0;
  double turn = 0;

  static constexpr void describe(engine::Description<StartParams>& d) {
    using enum engine::Unit;
    d.member<&StartParams::x>(
        "start_x", meters_per_second,
        "forward speed until the drive runs for the first time; the limits do not apply to it");
    d.member<&StartParams::y>(
        "start_y", meters_per_second,
        "speed to the left until the drive runs for the first time; the limits do not apply to it");
    d.member<&StartParams::turn>(
        "start_turn", radians_per_second,
        "turn rate until the drive runs for the first time; the limits do not apply to it");
  }
};

/// Parameters that all drives have.
struct DriveParams {
  MotionParams motion;
  GoalParams goal;
  StartParams start;
  std::int64_t pushes = 4;
  bool turns_when_blocked = false;
  engine::LocalizationParams localization;

  static constexpr void describe(engine::Description<DriveParams>& d) {
    using namespace engine::facts;
    d.part<&DriveParams::motion>();
    d.part<&DriveParams::goal>();
    d.part<&DriveParams::start>();
    d.member<&DriveParams::pushes>("pushes", within(0, engine::k_most_pushed), fixed,
                                   "greatest number of pushable bodies that the robot pushes at once; if "
                                   "there are more in its way, they block it");
    d.member<&DriveParams::turns_when_blocked>("turns_when_blocked", fixed,
                                               "true: a robot whose motion is blocked makes its turn on the "
                                               "spot, if nothing is in the way of the turn");
    d.part<&DriveParams::localization>();
  }
};

/// Parameters of the drive `car` (front wheels steer).
struct CarParams {
  double wheelbase = 1;
  DriveParams drive;

  static constexpr void describe(engine::Description<CarParams>& d) {
    using namespace engine::facts;
    using enum engine::Unit;
    d.member<&CarParams::wheelbase>("wheelbase", meters, above(0), "distance between the axles");
    d.part<&CarParams::drive>();
  }
};

/// Return the definitions of the drives `diff` (differential), `omni` (omnidirectional) and `car` (front
/// wheels steer). A drive computes the velocity v (forward, left; m/s) and the turn rate (rad/s,
/// counter-clockwise) of the robot from a command, and clamps them to its limits (MotionParams). If the
/// command is NaN, so is the result. A tick is a time step.
///
/// A command has the members x, y and turn. Their meaning depends on the mode of the command
/// (engine::ControlMode). docs/driving.md has the details.
///
/// velocity      The command is the velocity of the next tick, as in Stage. Accelerations have no limit in
///               this mode.
///               diff  v = (x, 0), turn rate = turn
///               omni  v = (x, y), turn rate = turn
///               car   v = (x cos(turn), 0), turn rate = x sin(turn) / wheelbase; turn is the steering angle
/// acceleration  The command is an acceleration. The drive clamps it to the limits of accelerations,
///               multiplies it by the time since the drive ran last, and adds it to the last velocity. For a
///               car, x is the acceleration of the front wheels, and turn is the steering angle.
/// position      The command is a goal: a pose in the frame in which the robot estimates its own pose. Speeds
///               are proportional to the remaining distance, and turn rates to the remaining angle, with a
///               gain of 1/s. They are at most 0.4 m/s (omni: forward and to the left each) and 1 rad/s. The
///               robot has arrived if it is within 0.02 m of the goal in x and in y. If the drive runs less
///               than once per second, the gain is lower, so that the robot does not overshoot the goal.
///               diff  turns towards the goal, drives while the goal is within pi/16 rad of straight ahead,
///                     and turns to the goal's heading after arrival
///               omni  drives to the goal, straight once neither speed is clamped, and turns to the goal's
///                     heading on the way
///               car   drives to the goal in a curve; the gain from the direction of the goal to the turn
///                     rate is 2/s. If the goal is behind the car, the car first turns on the spot about its
///                     rear axle. After arrival it turns on the spot to the goal's heading
///@{
engine::DriveKind diff_drive();
engine::DriveKind omni_drive();
engine::DriveKind car_drive();
///@}

}  // namespace troupe::models
