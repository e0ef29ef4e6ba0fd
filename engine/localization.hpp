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

/// How robots of one type know where they are: what controllers and go-to commands are given as the estimate.
///
/// gps   the true pose; where there is an origin, in its frame
/// odom  what their wheels counted since tick 0, with an error: each tick's true motion (nothing where it was
///       refused; a teleport is no motion) times 1 + error, laid along the estimated heading. In the frame of
///       the origin, which is the robot's own first pose unless it is given.
struct Localization {
  /// How they know it.
  enum class Kind : std::uint8_t {
    gps,   ///< truly
    odom,  ///< by what their wheels counted
  };
  /// Relative errors: of the way forward and to the left, and of the turn.
  struct Error {
    double x = 0;     ///< of the way forward
    double y = 0;     ///< of the way to the left
    double turn = 0;  ///< of the turn
  };

  Kind kind = Kind::gps;       ///< see above
  std::optional<Pose> origin;  ///< world frame
  std::optional<Error> error;  ///< not given: drawn for each robot
  /// Lays a tick's motion along the heading after its turn, as Stage does, not along the one before it, as
  /// the robot moves: only so is the estimate without error the truth.
  bool along_new_heading = false;

  /// The error of one robot's odometry: as given, or uniform within +-1.5 % of the ways and +-2.5 % of the
  /// turn, a property of the seed and the robot.
  Error error_of(std::uint64_t seed, BodyId body) const;
};

constexpr std::array<std::string_view, 2> names_of(Localization::Kind) { return {"gps", "odom"}; }

/// The parameters that say it: a part of those of drives. None of them changes while a world runs, since with
/// them would the state.
struct LocalizationParams {
  /// Along which a tick's way is laid: by the names "old" and "new".
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
        "localization", fixed, "source of the estimated pose: the true pose, or wheel odometry");
    d.member<&LocalizationParams::localization_origin>(
        "localization_origin", meters, fixed,
        "origin [x, y] of the frame of the estimated pose, world frame; [] is the world frame with `gps`, "
        "the start pose of the robot with `odom`");
    d.member<&LocalizationParams::localization_origin_heading>(
        "localization_origin_heading", radians, fixed,
        "heading of that frame, if `localization_origin` is given");
    d.member<&LocalizationParams::odom_error>(
        "odom_error", fixed,
        "relative errors of `odom`, [forward, left, turn]; [] draws them for each robot, uniform within "
        "plus and minus [0.015, 0.015, 0.025]");
    d.member<&LocalizationParams::odom_heading>(
        "odom_heading", fixed,
        "heading along which odometry adds the motion of a tick: that before its turn, as the robot moves, "
        "or that after it, as in Stage");
  }

  /// What they say, or why they do not fit together.
  Result<Localization> read() const;
};

/// The component `odometry`, a row a robot that has one: the pose it believes in.
struct Odometry {
  double x = 0;        ///< m, frame of the origin
  double y = 0;        ///< m, frame of the origin
  double heading = 0;  ///< rad

  /// A motion of one tick: m forward and left, rad; docs/driving.md has the formula.
  void advance(const Localization& how, const Localization::Error& error, double x, double y, double turn);
};

/// The pose, given in the world's frame, as the origin's frame has it. Heights are not touched.
Pose relative_to(const Pose& origin, const Pose& pose);

/// The estimated poses of robots of one type.
struct Estimates {
  const Localization* how = nullptr;     ///< null: there are no estimates
  std::span<const Pose> poses;           ///< a row each
  std::span<const Odometry> odometries;  ///< a slot each, where they have odometry

  /// That of one robot, m and rad; all 0 without estimates.
  Pose of(Row row, std::size_t slot) const;
};

}  // namespace troupe::engine
