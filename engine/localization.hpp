#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"
#include "base/result.hpp"
#include "engine/description.hpp"

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
/// gps   The estimate is the true pose. It is given in the frame `origin` if that is set, else in the world
///       frame.
/// odom  Wheel odometry with an error. In each tick, the robot's true motion times 1 + error is added to the
///       estimate, along the estimated heading. Neither a blocked motion nor a pose that a program sets
///       changes the estimate. The estimate is given in the frame `origin` if that is set, else in the frame
///       of the robot's first pose.
struct Localization {
  /// The source of the estimate.
  enum class Kind : std::uint8_t {
    gps,   ///< the true pose
    odom,  ///< wheel odometry
  };
  /// Relative errors of odometry: the estimated motion is the true one times 1 + error.
  struct Error {
    double x = 0;     ///< relative error of forward motion
    double y = 0;     ///< error of motion to the left
    double turn = 0;  ///< relative error of the turn
  };

  Kind kind = Kind::gps;  ///< source of the estimate
  /// Frame of the estimate, given as a pose in the world frame; not set: see `gps` and `odom` above.
  std::optional<Pose> origin;
  /// Error of all robots of the type; not set: each robot has a random error of its own.
  std::optional<Error> error;
  /// True: odometry adds the motion of a tick along the estimated heading after the turn of that tick, as in
  /// Stage. False: it adds the motion along the heading before the turn, as the robot really moves. Only with
  /// false does odometry with error 0 give the true pose.
  bool along_new_heading = false;

  /// The error of one robot's odometry: `error` if that is set. Otherwise it is random, a function of the
  /// seed and the id of the body: uniform from -0.015 to 0.015 for x and y, and from -0.025 to 0.025 for the
  /// turn.
  Error error_of(std::uint64_t seed, BodyId body) const;
};

constexpr std::array<std::string_view, 2> names_of(Localization::Kind) { return {"gps", "odom"}; }

/// The parameters of localization, which are part of the parameters of drives. Interventions cannot change
/// them while a world runs, because the layout of the state depends on the source of the estimate.
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
        "origin of the frame of the estimated pose: [x, y] in the world frame; without it ([]) that frame is "
        "the world frame with `gps`, and the robot's first pose with `odom`");
    d.member<&LocalizationParams::localization_origin_heading>(
        "localization_origin_heading", radians, fixed,
        "heading of the frame of the estimated pose, in the world frame; used only if `localization_origin` "
        "is "
        "given");
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

  /// Returns the localization that the parameters describe. The error says why they are inconsistent.
  Result<Localization> read() const;
};

/// The component `odometry`: the estimated pose of a robot with odometry.
struct Odometry {
  double x = 0;        ///< estimated x, m, in the frame of the estimate
  double y = 0;        ///< estimated y, m, in the frame of the estimate
  double heading = 0;  ///< estimated heading, rad

  /// Adds the true motion of one tick, changed by `error`, to the estimate: x forward and y to the left, m,
  /// and turn, rad. The motion is added along the heading that how.along_new_heading chooses. The formula is
  /// in docs/driving.md.
  void advance(const Localization& how, const Localization::Error& error, double x, double y, double turn);
};

/// Converts a pose from the world frame to the frame whose pose in the world frame is `origin`. The height
/// does not change.
Pose relative_to(const Pose& origin, const Pose& pose);

/// The estimated poses of robots of one type.
struct Estimates {
  const Localization* how = nullptr;     ///< how the poses are estimated; null: there are no estimates
  std::span<const Pose> poses;           ///< true poses, one per row
  std::span<const Odometry> odometries;  ///< odometry estimates, one per slot; empty without odometry

  /// The estimated pose of a robot, m and rad, by its row (index in the state tables) and slot (index in the
  /// tables of its type); all values are 0 if `how` is null.
  Pose of(Row row, std::size_t slot) const;
};

}  // namespace troupe::engine
