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

/// The pose estimation of the robots of one type. Controllers and go-to commands use the estimate.
///
/// gps   The true pose, in the frame of the origin if one is given, else in the world frame.
/// odom  Wheel odometry since tick 0, with an error: each tick's true motion (none if it was blocked; a
///       teleport is not a motion) times 1 + error, along the estimated heading. In the frame of the origin,
///       which is the robot's own first pose unless it is given.
struct Localization {
  /// The source of the estimate.
  enum class Kind : std::uint8_t {
    gps,   ///< the true pose
    odom,  ///< wheel odometry
  };
  /// Relative errors of odometry.
  struct Error {
    double x = 0;     ///< of forward motion
    double y = 0;     ///< of motion to the left
    double turn = 0;  ///< of the turn
  };

  Kind kind = Kind::gps;       ///< source of the estimate
  std::optional<Pose> origin;  ///< world frame
  std::optional<Error> error;  ///< not given: random for each robot
  /// True: a tick's motion is added along the heading after its turn, as in Stage. False: along the heading
  /// before it, as the robot moves; only then is the estimate without error the true pose.
  bool along_new_heading = false;

  /// The error of one robot's odometry: as given, or uniform within +-1.5 % of the motions and +-2.5 % of the
  /// turn, a function of the seed and the id.
  Error error_of(std::uint64_t seed, BodyId body) const;
};

constexpr std::array<std::string_view, 2> names_of(Localization::Kind) { return {"gps", "odom"}; }

/// The parameters of localization, which are part of the parameters of drives. All are fixed while a world
/// runs, because a change would change the layout of the state.
struct LocalizationParams {
  /// The heading along which a tick's motion is added; in files "old" and "new".
  enum class Heading : std::uint8_t {
    old,      ///< the heading before its turn
    changed,  ///< the heading after it
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
        "localization", fixed, "how the robot estimates its pose: its true pose, or wheel odometry");
    d.member<&LocalizationParams::localization_origin>(
        "localization_origin", meters, fixed,
        "[x, y] in the world of the origin of the estimate's frame; [] is, with `gps`, the world frame, "
        "with `odom`, the pose of the robot at the start");
    d.member<&LocalizationParams::localization_origin_heading>(
        "localization_origin_heading", radians, fixed,
        "heading of that frame, if `localization_origin` is given");
    d.member<&LocalizationParams::odom_error>(
        "odom_error", fixed,
        "relative errors of `odom`, [forward, left, turn]; [] draws them for each robot, at random within "
        "+-[0.015, 0.015, 0.025]");
    d.member<&LocalizationParams::odom_heading>("odom_heading", fixed,
                                                "heading along which `odom` adds a tick's motion: before its "
                                                "turn, as the robot moves, or after it, as "
                                                "in Stage");
  }

  /// The localization that the parameters describe, or why they are inconsistent.
  Result<Localization> read() const;
};

/// The component `odometry`: the estimated pose of a robot with odometry.
struct Odometry {
  double x = 0;        ///< m, frame of the origin
  double y = 0;        ///< m, frame of the origin
  double heading = 0;  ///< rad

  /// Adds the motion of one tick: m forward and left, rad. The formula is in docs/driving.md.
  void advance(const Localization& how, const Localization::Error& error, double x, double y, double turn);
};

/// Converts a pose from the world frame to the frame of the origin. The height does not change.
Pose relative_to(const Pose& origin, const Pose& pose);

/// The estimated poses of robots of one type.
struct Estimates {
  const Localization* how = nullptr;     ///< null: there are no estimates
  std::span<const Pose> poses;           ///< true poses, one per row
  std::span<const Odometry> odometries;  ///< one per slot, if the type has odometry

  /// The estimated pose of one robot, m and rad; all 0 without estimates.
  Pose of(Row row, std::size_t slot) const;
};

}  // namespace troupe::engine
