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

/// The held robots of a simulation: robots that a user or a program steers instead of their controllers (the
/// code that normally commands them). Between the act that holds a robot and the act that releases it, the
/// robot gets the same speed command before every tick (time step). This command overrides the controller of
/// the robot.
class Holds {
 public:
  /// Holds a robot from the next tick on; replaces the speeds of a robot that is already held. body: number
  /// of the robot's BodyId; the robot must exist and have a drive, which is not checked. speed: forward and
  /// left in m/s, turn in rad/s (for a car drive: the steering angle, rad), in the body frame.
  void set(std::uint32_t body, const std::array<double, 3>& speed) { speeds_[body] = speed; }
  /// Releases a robot. Returns false if it was not held.
  bool release(std::uint32_t body) { return speeds_.erase(body) > 0; }
  void clear() { speeds_.clear(); }               ///< releases all robots
  bool empty() const { return speeds_.empty(); }  ///< whether no robot is held
  /// Commands the speeds of all held robots, in the order of their ids, as Model::set_speed() does. Call it
  /// once before every tick. Robots that are no longer in the world are released.
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

/// Applies one act to a simulation. holds: the held robots of this simulation; an act that holds or releases
/// a robot changes them. Throws ActRefused, and changes nothing, if the act is impossible.
void carry_out(Simulation& simulation, const Act& act, Holds& holds);

}  // namespace troupe
