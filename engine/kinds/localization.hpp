#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"
#include "base/result.hpp"
#include "engine/fields/description.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// How the robots of one type estimate their poses. Controllers read the estimated pose. Goal poses in
/// commands (ControlMode::position) are in the frame of the estimate.
///
/// With `gps`, the estimate is the true pose. Its frame is `origin` or, if `origin` is not set, the world
/// frame.
///
/// With `odom`, the estimate comes from wheel odometry. It equals the true pose at the start of the run (tick
/// 0) or at the birth of the robot. In each tick (time step), the motion of the robot is multiplied by 1 +
/// error and added to the estimate, along the estimated heading. The estimate does not change in these cases:
/// - The motion is blocked, or would end out of bounds, so that the robot stays where it is.
/// - Another body carries the robot.
/// - A program sets the robot's pose.
///
/// The frame of the odometry is `origin` or, if `origin` is not set, the robot's pose at the start or at its
/// birth. The heading is wrapped into [-pi, pi].
///
/// For both kinds, the z of the estimate is the true height in the world frame.
struct Localization {
  /// The source of the estimate.
  enum class Kind : std::uint8_t {
    gps,   ///< the true pose
    odom,  ///< wheel odometry
  };
  /// Relative errors of odometry: an estimated motion is the true motion times 1 + error.
  struct Error {
    double x = 0;     ///< relative error of forward motion
    double y = 0;     ///< relative error of motion to the left
    double turn = 0;  ///< relative error of the turn
  };

  Kind kind = Kind::gps;  ///< source of the estimate
  /// Frame of the estimate, given as a pose in the world frame. The z of this pose is ignored. If not set:
  /// with `gps`, the world frame; with `odom`, the robot's pose at the start of the run (tick 0) or at its
  /// birth.
  std::optional<Pose> origin;
  /// Odometry error of all robots of the type; not set: each robot has a random error of its own.
  std::optional<Error> error;
  /// The heading along which odometry adds the motion of a tick (time step). False: the estimated heading
  /// before the turn of that tick, as the robot really moves. True: the estimated heading after the turn, as
  /// in the simulator Stage. The estimate is then not exact even if all errors are 0.
  bool along_new_heading = false;

  /// The error of one robot's odometry: `error` if it is set, otherwise a random error. The random error
  /// depends only on the seed of the world and the id of the body. It is uniform from -0.015 to 0.015 for x
  /// and y, and from -0.025 to 0.025 for the turn.
  Error error_of(std::uint64_t seed, BodyId body) const;
};

constexpr std::array<std::string_view, 2> names_of(Localization::Kind) { return {"gps", "odom"}; }

/// The parameters of localization, which are part of the parameters of drives. `describe` gives the meaning
/// of each parameter. No parameter can change while a world runs, neither by an intervention (a change that
/// the world file lists) nor by World::set().
struct LocalizationParams {
  /// The heading along which odometry adds the motion of a tick (time step). In files, the names are "old"
  /// and "new".
  enum class Heading : std::uint8_t {
    old,      ///< the heading before the turn of the tick
    changed,  ///< the heading after the turn of the tick
  };
  friend constexpr std::array<std::string_view, 2> names_of(Heading) { return {"old", "new"}; }

  Localization::Kind localization = Localization::Kind::gps;
  std::vector<double> localization_origin;
  double localization_origin_heading = 0;
  std::vector<double> odom_error;
  Heading odom_heading = Heading::old;

  static constexpr void describe(Description<LocalizationParams>& d) {
    using namespace facts;
    using enum Unit;
    d.member<&LocalizationParams::localization>(
        "localization", fixed,
        "source of the robot's estimated pose: `gps` is its true pose, `odom` is wheel odometry");
    d.member<&LocalizationParams::localization_origin>(
        "localization_origin", meters, within(-1e9, 1e9), fixed,
        "origin of the frame of the estimated pose: [x, y] in the world frame; if it is [], `gps` uses the "
        "world frame, and `odom` uses a frame at the robot's first pose");
    d.member<&LocalizationParams::localization_origin_heading>(
        "localization_origin_heading", radians, fixed,
        "heading of the frame of the estimated pose, in the world frame; used only if `localization_origin` "
        "is given");
    d.member<&LocalizationParams::odom_error>("odom_error", within(-1000, 1000), fixed,
                                              used_if("localization", "odom"),
                                              "relative errors of `odom`, [forward, left, turn]; with [] "
                                              "each robot has random errors, from -0.015 to "
                                              "0.015 (forward and left) and from -0.025 to 0.025 (turn)");
    d.member<&LocalizationParams::odom_heading>("odom_heading", fixed,
                                                "heading along which `odom` adds the motion of a tick: `old` "
                                                "is the heading before the turn of that tick, as the robot "
                                                "really moves; `new` is the heading after the turn, as in "
                                                "Stage");
  }

  /// Returns the localization that the parameters describe. Returns an error if `localization_origin` has a
  /// length other than 0 and 2, or if `odom_error` has a length other than 0 and 3.
  Result<Localization> read() const;
};

/// A row of the component (state table) `odometry`: the estimated pose of a robot with odometry.
struct Odometry {
  double x = 0;        ///< estimated x, m, in the frame of the estimate
  double y = 0;        ///< estimated y, m, in the frame of the estimate
  double heading = 0;  ///< estimated heading, rad, in the frame of the estimate, from -pi to pi

  /// Adds the motion of one tick (time step) to the estimate. The arguments x (forward, m), y (to the left,
  /// m) and turn (counter-clockwise, rad) are the true motion in the body frame. The function multiplies them
  /// by 1 + `error`. how.along_new_heading selects the heading along which the motion is added; the other
  /// members of `how` are not used. The formula is in docs/driving.md.
  void advance(const Localization& how, const Localization::Error& error, double x, double y, double turn);
};

/// Converts a pose from the world frame to the frame whose pose in the world frame is `origin`. The z of the
/// result is that of `pose`: the z of `origin` is ignored. The heading is wrapped into [-pi, pi].
Pose relative_to(const Pose& origin, const Pose& pose);

/// The estimated poses of the robots of one type. The row of a robot is its index in the state tables of the
/// world; its slot is its index in the state tables of its type.
struct Estimates {
  const Localization* how = nullptr;     ///< how the poses are estimated; null: there are no estimates
  std::span<const Pose> poses;           ///< true poses, one per row
  std::span<const Odometry> odometries;  ///< odometry estimates, one per slot; empty without odometry

  /// The estimated pose of a robot, m and rad, in the frame that Localization defines; all values are 0 if
  /// `how` is null. `row` is the index of the robot in the state tables of the world, and `slot` is its index
  /// in the state tables of its type.
  Pose of(Row row, std::size_t slot) const;
};

}  // namespace troupe::engine
