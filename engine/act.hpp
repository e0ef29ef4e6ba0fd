#pragma once

#include "base/pose.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {

/// What a person or a program does to a running world between two ticks (docs/live.md). Plain data: names,
/// and numbers in SI units.
struct Act {
  /// What is done.
  enum class Kind : std::uint8_t {
    move,   ///< a body is put at `pose`, where that place is free
    speed,  ///< a robot is commanded `speed`, once
    hold,   ///< a robot is commanded `speed` before every tick, whatever its controller says, until `release`
    release,  ///< ends a hold
    command,  ///< fields of the command of `device` are set to `values`
    add,      ///< the next body of the reserve of population `whom` is born at `pose`
    remove,   ///< a life ends
    disable,  ///< all of a body stops: devices, controllers, drive
    enable,   ///< what `disable` stopped goes on
  };
  Kind kind = Kind::move;  ///< in the order of k_acts
  std::string whom;        ///< name of a body; of `add` of a population
  Pose pose;               ///< of `move` and `add`: world frame, m and rad
  std::array<double, 3>
      speed{};         ///< of `speed` and `hold`: forward and left m/s, turn rad/s, as Model::set_speed
  std::string device;  ///< of `command`: its name
  /// Of `command`: fields of its struct, and a number a column.
  std::vector<std::pair<std::string, std::vector<double>>> values;

  friend bool operator==(const Act&, const Act&) = default;
};
/// As files and messages write them, in the order of Act::Kind.
inline constexpr std::array<std::string_view, 9> k_acts{"move", "speed",  "hold",    "release", "command",
                                                        "add",  "remove", "disable", "enable"};

}  // namespace troupe::engine
