#pragma once

#include "engine/act.hpp"

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

/// A change that a user or a program makes to a running world: Simulation::act().
using engine::Act;

/// An impossible act. The text states why; the simulation is unchanged.
class ActRefused : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Robots whose speeds are commanded from outside before every tick.
class Holds {
 public:
  /// Holds a robot from the next tick on. The body must exist and have a drive.
  void set(std::uint32_t body, const std::array<double, 3>& speed) { speeds_[body] = speed; }
  /// Releases a robot. False if it was not held.
  bool release(std::uint32_t body) { return speeds_.erase(body) > 0; }
  void clear() { speeds_.clear(); }               ///< releases all robots
  bool empty() const { return speeds_.empty(); }  ///< whether no robot is held
  /// Commands all held robots, in the order of their ids. Holds of robots that left the world end.
  void apply(Simulation& simulation);

  /// The holds as bytes, for a checkpoint.
  std::vector<std::byte> memory() const;
  /// Restores memory(); bodies: number of bodies of the world. False, with no holds left, for invalid bytes.
  bool remember(std::span<const std::byte> memory, std::size_t bodies);

 private:
  std::map<std::uint32_t, std::array<double, 3>> speeds_;  // by BodyId
};

/// Applies one act. Throws ActRefused. `holds` are those of the simulation.
void carry_out(Simulation& simulation, const Act& act, Holds& holds);

}  // namespace troupe
