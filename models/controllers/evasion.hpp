#pragma once

#include "base/random.hpp"
#include "engine/kinds/commands.hpp"
#include "engine/kinds/percept.hpp"
#include "models/controllers/drive_period.hpp"
#include "models/controllers/scan_ahead.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

namespace troupe::models {

/// Obstacle avoidance for controllers, made for swarms in which many robots drive to the same goal. avoids()
/// turns away from obstacles that a ranger sees; escapes() frees a robot that is stuck. A decision is one
/// call of the controller. Speeds are in m/s and rad/s, distances in m.
///
/// Both functions keep variables in the memory of the controller, a struct `Memory` that the controller
/// defines. avoids() needs the member avoid_updates (std::int32_t). escapes() needs still_updates and
/// escape_updates (std::uint32_t), and x, y and heading (double). All must be 0 at the start.
struct Evasion {
  double avoid_speed = 0.05;  ///< forward speed while the robot turns away
  double avoid_turn = 0.5;    ///< absolute turn rate while the robot turns away, left or right
  double min_front = 0.7;     ///< the robot turns away when a reading ahead is below this
  double stop = 0.5;          ///< the robot turns on the spot when a reading ahead is below this
  double back_speed = 0.1;    ///< absolute speed while the robot backs out
  /// escapes() acts when the robot has not moved for more than this number of consecutive decisions, although
  /// it had a command to move. If the drive runs so rarely that a command moves the robot later, escapes()
  /// waits for decisions_to_move() decisions instead.
  std::uint32_t stuck = 5;
  std::uint64_t drive_period = 1;  ///< from drive_period(): ticks between two runs of the drive
  /// The argument `share` with which the Scanner for avoids() must be made. With 4, it looks at the middle
  /// half of the scan.
  static constexpr std::size_t window_share = 4;

  /// Makes the robot turn away from obstacles ahead. If a reading ahead is below `min_front` or `stop`, a
  /// turn begins: away from the nearer side, or to the left if both are equally near, for 5 to 9 decisions.
  ///
  /// scanner: made with the argument `share` = window_share
  /// ranges: readings of the ranger of the scanner, m
  /// command: before the call, the last command of the robot, whose turn rate is kept until the turn ends
  ///
  /// Returns true if the robot turns; `command` is then the new command. Returns false if the way is free;
  /// `command` is then unchanged.
  template <class Memory>
  bool avoids(Memory& memory, const Scanner& scanner, std::span<const float> ranges, Random& random,
              engine::Command& command) const {
    const auto [obstruction, is_near, left, right] = scanner.ahead(ranges, min_front, stop);
    if (!obstruction && !is_near && memory.avoid_updates == 0) return false;
    // A program may have commanded another control mode between two ticks.
    if (command.mode != engine::ControlMode::velocity) {
      command.mode = engine::ControlMode::velocity;
      memory.avoid_updates = 0;  // `turn` is no turn rate
    }
    command.x = is_near ? 0 : avoid_speed;
    command.y = 0;
    if (memory.avoid_updates < 1) {
      memory.avoid_updates = 5 + static_cast<std::int32_t>(random.below(5));
      command.turn = left < right ? -avoid_turn : avoid_turn;
    }
    --memory.avoid_updates;
    return true;
  }

  /// Frees a robot that is stuck, for example at an obstacle that its scanner does not see. The robot is
  /// stuck if it has not moved for a number of decisions (member `stuck`). It then backs out for 5 to 14
  /// decisions: it drives backwards if its last command was to drive forwards, and otherwise forwards, and
  /// turns at a random rate. Call the function once per decision.
  ///
  /// command: before the call, the last command of the robot. When the robot begins to back out, the function
  ///     replaces it
  ///
  /// Returns true while the robot backs out; the caller must then not change `command`.
  template <class Memory>
  bool escapes(Memory& memory, const engine::Percept& percept, Random& random,
               engine::Command& command) const {
    const Pose& here = percept.estimate;
    const bool is_to_move =
        command.mode == engine::ControlMode::velocity && (command.x != 0 || command.turn != 0);
    const bool is_still = here.x == memory.x && here.y == memory.y && here.heading == memory.heading;
    memory.still_updates = is_to_move && is_still ? memory.still_updates + 1 : 0;
    memory.x = here.x;
    memory.y = here.y;
    memory.heading = here.heading;
    if (memory.still_updates > std::max(stuck, decisions_to_move(drive_period, percept))) {
      memory.still_updates = 0;
      memory.escape_updates = 5 + random.below(10);
      command = {command.x > 0 ? -back_speed : back_speed, 0, random.uniform(-avoid_turn, avoid_turn)};
    }
    if (memory.escape_updates == 0) return false;
    --memory.escape_updates;
    return true;
  }
};

}  // namespace troupe::models
