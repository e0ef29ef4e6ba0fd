#pragma once

#include "engine/kinds/act.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe {

class Simulation;

/// A change that a user or a program makes to a running world through Simulation::act(), such as moving or
/// removing a robot (engine/kinds/act.hpp).
using engine::Act;

/// Thrown for an act that is impossible, for example because it names a body that does not exist or a pose
/// that is not free. The text states the reason; the simulation is unchanged.
class ActRefused : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// The held robots of a simulation. A held robot is steered by a user or a program instead of its controller
/// (the code that normally commands it). An act of the kind `hold` holds a robot, and an act of the kind
/// `release` releases it. In between, apply() gives the robot the same speed command before every tick (time
/// step), which overrides the commands of its controller.
class Holds {
 public:
  /// Holds a robot. If the robot is already held, replaces its speeds. body: the number of the robot,
  /// BodyId::value. The robot must exist and have a drive; this is not checked. speed: forward, left and
  /// turn, body frame, m/s and rad/s; for a car drive, turn is the steering angle, rad.
  void set(std::uint32_t body, const std::array<double, 3>& speed) { speeds_[body] = speed; }
  /// Releases a robot. Returns false if the robot was not held.
  bool release(std::uint32_t body) { return speeds_.erase(body) > 0; }
  void clear() { speeds_.clear(); }               ///< releases all robots
  bool empty() const { return speeds_.empty(); }  ///< whether no robot is held
  /// Commands the speeds of all held robots with Model::set_speed(), in the order of the robots' ids.
  /// Releases robots that are no longer in the world. Call this function once before every tick.
  void apply(Simulation& simulation);

  /// Returns the held robots and their speeds as bytes, for a checkpoint.
  std::vector<std::byte> memory() const;
  /// Restores the held robots and speeds from the bytes that memory() returned. bodies: number of bodies in
  /// the world. If the bytes are invalid (a wrong length, a number of a body that does not exist, a speed
  /// that is not finite), returns false and releases all robots.
  bool remember(std::span<const std::byte> memory, std::size_t bodies);

 private:
  std::map<std::uint32_t, std::array<double, 3>> speeds_;  // by BodyId
};

/// Applies one act to a simulation. If the act is impossible, throws ActRefused and changes nothing. holds:
/// the held robots of this simulation; an act of the kind `hold` or `release` changes them.
void carry_out(Simulation& simulation, const Act& act, Holds& holds);

}  // namespace troupe
