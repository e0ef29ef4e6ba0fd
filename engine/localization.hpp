#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"
#include "base/result.hpp"
#include "engine/fields.hpp"

#include <cstdint>
#include <optional>
#include <span>
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
  const Localization* how = nullptr;     ///< null: nobody knows
  std::span<const Pose> poses;           ///< a row each
  std::span<const Odometry> odometries;  ///< a slot each, where they have odometry

  /// That of one robot, m and rad; all 0 where nobody knows.
  Pose of(Row row, std::size_t slot) const;
};

/// The parameters that say it, for the tables of drives.
std::vector<Field> localization_fields();
/// What they say. params: their values, one each, in their order.
Localization read_localization(std::span<const Value> params);
/// Whether they fit together; else what is wrong with them. params: the same.
Result<> check_localization(std::span<const Value> params);

}  // namespace troupe::engine
