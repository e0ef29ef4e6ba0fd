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

/// How the robots of one type estimate their poses. Controllers and position commands (ControlMode::position)
/// use the estimate.
///
/// With `gps`, the estimate is the true pose, in the frame `origin` if `origin` is set, otherwise in the
/// world frame.
///
/// With `odom`, the estimate comes from wheel odometry with an error. In each tick, the motion of the robot
/// times 1 + error is added to the estimate, along the estimated heading. The estimate does not change if the
/// motion is blocked or would end out of bounds, if the robot is carried, or if a program sets its pose. The
/// frame of the estimate is `origin` if `origin` is set, otherwise the robot's pose at tick 0 or at its
/// birth. The heading is wrapped into [-pi, pi].
///
/// In both cases, the z of the estimate is the true height, world frame.
struct Localization {
  /// The source of the estimate.
  enum class Kind : std::uint8_t {
    gps,   ///< the true pose
    odom,  ///< wheel odometry
  };
  /// Relative errors of odometry: the estimated motion is the true one times 1 + error.
  struct Error {
    double x = 0;     ///< relative error of forward motion
    double y = 0;     ///< relative error of motion to the left
    double turn = 0;  ///< relative error of the turn
  };

  Kind kind = Kind::gps;  ///< source of the estimate
  /// Frame of the estimate, given as a pose in the world frame; the z of this pose is ignored. Not set: the
  /// frame is the world frame with `gps`, and the robot's pose at tick 0 or at its birth with `odom`.
  std::optional<Pose> origin;
  /// Error of all robots of the type; not set: each robot has a random error of its own.
  std::optional<Error> error;
  /// True: odometry adds the motion of a tick along the estimated heading after the turn of that tick, as in
  /// Stage. False: odometry adds the motion along the estimated heading before the turn, as the robot really
  /// moves. With error 0, the estimate follows the true motion only if this member is false.
  bool along_new_heading = false;

  /// The error of one robot's odometry: `error` if that member is set. Otherwise a random error, which is a
  /// function of the seed of the world and the id of the body: uniform from -0.015 to 0.015 for x and y, and
  /// from -0.025 to 0.025 for the turn.
  Error error_of(std::uint64_t seed, BodyId body) const;
};

constexpr std::array<std::string_view, 2> names_of(Localization::Kind) { return {"gps", "odom"}; }

/// The parameters of localization, which are part of the parameters of drives. Neither interventions of the
/// world file nor World::set() can change them while a world runs, because the layout of the state depends on
/// the source of the estimate.
struct LocalizationParams {
  /// The heading along which a tick's motion is added; in files "old" and "new".
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
        "localization_origin", meters, fixed,
        "origin of the frame of the estimated pose: [x, y] in the world frame; if it is [], `gps` uses the "
        "world frame, and `odom` uses a frame at the robot's first pose");
    d.member<&LocalizationParams::localization_origin_heading>(
        "localization_origin_heading", radians, fixed,
        "heading of the frame of the estimated pose, in the world frame; used only if `localization_origin` "
        "is given");
    d.member<&LocalizationParams::odom_error>("odom_error", fixed,
                                              "relative errors of `odom`, [forward, left, turn]; with [] "
                                              "each robot has random errors, from -0.015 to "
                                              "0.015 (forward and left) and from -0.025 to 0.025 (turn)");
    d.member<&LocalizationParams::odom_heading>("odom_heading", fixed,
                                                "heading along which `odom` adds the motion of a tick: `old` "
                                                "is the heading before the turn of that tick, as the robot "
                                                "really moves; `new` is the heading after the turn, as in "
                                                "Stage");
  }

  /// Returns the localization that the parameters describe. It is an error if `localization_origin` has a
  /// length other than 0 and 2, or `odom_error` a length other than 0 and 3.
  Result<Localization> read() const;
};

/// A row of the component (state table) `odometry`: the estimated pose of a robot with odometry.
struct Odometry {
  double x = 0;        ///< estimated x, m, in the frame of the estimate
  double y = 0;        ///< estimated y, m, in the frame of the estimate
  double heading = 0;  ///< estimated heading, rad, in the frame of the estimate, from -pi to pi

  /// Adds the true motion of one tick, multiplied by 1 + `error`, to the estimate. The motion is in the body
  /// frame: x forward and y to the left, m, and turn, rad. It is added along the heading that
  /// how.along_new_heading chooses; the other members of `how` are not used. The formula is in
  /// docs/driving.md.
  void advance(const Localization& how, const Localization::Error& error, double x, double y, double turn);
};

/// Converts a pose from the world frame to the frame whose pose in the world frame is `origin`. The z of the
/// result is that of `pose`: the z of `origin` is ignored. The heading is wrapped into [-pi, pi].
Pose relative_to(const Pose& origin, const Pose& pose);

/// The estimated poses of robots of one type.
struct Estimates {
  const Localization* how = nullptr;     ///< how the poses are estimated; null: there are no estimates
  std::span<const Pose> poses;           ///< true poses, one per row
  std::span<const Odometry> odometries;  ///< odometry estimates, one per slot; empty without odometry

  /// The estimated pose of a robot, m and rad, in the frame that Localization defines; all values are 0 if
  /// `how` is null. `row` is the index of the robot in the state tables of the world, and `slot` its index
  /// in the tables of its type.
  Pose of(Row row, std::size_t slot) const;
};

}  // namespace troupe::engine
