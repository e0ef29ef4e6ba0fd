#pragma once

#include "base/random.hpp"
#include "engine/kinds/kinds.hpp"
#include "models/controllers/scan_ahead.hpp"

#include <cstdint>
#include <span>

namespace troupe::models {

/// Obstacle avoidance for controllers of swarms in which many robots drive to the same goal. Speeds are in
/// m/s and rad/s, distances in m. The template parameter `Memory` is the type of the controller's memory, the
/// variables that the controller keeps between calls. It must have the members avoid_updates (int32),
/// still_updates and escape_updates (uint32), x, y (m) and heading (rad), all 0 at the start.
struct Evasion {
  double avoid_speed = 0.05;  ///< forward speed while the robot turns away
  double avoid_turn = 0.5;    ///< absolute turn rate while the robot turns away, left or right
  double min_front = 0.7;     ///< the robot turns away when a reading ahead is below this
  double stop = 0.5;          ///< the robot turns on the spot when a reading ahead is below this
  double back_speed = 0.1;    ///< absolute speed while the robot backs out
  /// The robot backs out (escapes()) after more than this number of consecutive decisions (calls of the
  /// controller) in which it had a command to move but its estimated pose did not change. The number must be
  /// larger than the number of decisions after which a command takes effect: otherwise a robot would back out
  /// before its first command has moved it.
  std::uint32_t stuck = 5;
  /// Argument `share` of the constructor of Scanner for the scanner that is passed to avoids(). With 4, the
  /// scanner looks at the middle half of the scan.
  static constexpr std::size_t window_share = 4;

  /// Makes the robot turn away from obstacles ahead: a reading below `min_front` or `stop` starts a turn away
  /// from the nearer side, which takes 5 to 9 decisions. The controller `wander` differs in two points: it
  /// looks at the middle third of the scan, and its turns take 10 to 19 decisions. The view is wider here and
  /// the turns are shorter, because many robots meet near their common goals. ranges: readings of the
  /// scanner's ranger, m. command: on entry, the last command of the robot; its turn rate is kept until the
  /// turn ends. Returns true if it has set `command`. Returns false if the way is free; `command` is then
  /// unchanged.
  template <class Memory>
  bool avoids(Memory& memory, const Scanner& scanner, std::span<const float> ranges, Random& random,
              engine::Command& command) const {
    const auto [obstruction, is_near, left, right] = scanner.ahead(ranges, min_front, stop);
    if (!obstruction && !is_near && memory.avoid_updates == 0) return false;
    command.x = is_near ? 0 : avoid_speed;
    command.y = 0;
    if (memory.avoid_updates < 1) {
      memory.avoid_updates = 5 + static_cast<std::int32_t>(random.below(5));
      command.turn = left < right ? -avoid_turn : avoid_turn;
    }
    --memory.avoid_updates;
    return true;
  }

  /// Backs out for 5 to 14 decisions if the robot is stuck at an obstacle that its scanner does not see
  /// (Evasion::stuck). To back out means to drive backwards if the last command was to drive forwards, and
  /// else forwards, at a random turn rate. Call it once per decision. here: the estimated pose of the robot.
  /// command: the command of the last decision, which is replaced when the robot begins to back out. Returns
  /// true while the robot backs out: the caller must then leave the command as it is.
  template <class Memory>
  bool escapes(Memory& memory, const Pose& here, Random& random, engine::Command& command) const {
    const bool is_to_move = command.x != 0 || command.turn != 0;
    const bool is_still = here.x == memory.x && here.y == memory.y && here.heading == memory.heading;
    memory.still_updates = is_to_move && is_still ? memory.still_updates + 1 : 0;
    memory.x = here.x;
    memory.y = here.y;
    memory.heading = here.heading;
    if (memory.still_updates > stuck) {
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
