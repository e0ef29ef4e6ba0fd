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

/// What a person or a program does to a running world: Simulation::act().
using engine::Act;

/// An act that cannot be done; the text says why. Nothing has changed.
class ActRefused : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Robots that are driven from outside: each has its speeds commanded before every tick.
class Holds {
 public:
  /// From the next tick on. The robot exists, and has a drive.
  void set(std::uint32_t body, const std::array<double, 3>& speed) { speeds_[body] = speed; }
  /// False where it was not held.
  bool release(std::uint32_t body) { return speeds_.erase(body) > 0; }
  void clear() { speeds_.clear(); }               ///< releases all
  bool empty() const { return speeds_.empty(); }  ///< no robot is held
  /// Commands all of them, by id; a hold of a robot that is gone ends.
  void apply(Simulation& simulation);

  /// For a checkpoint, and back; false for what is no such memory of this simulation.
  std::vector<std::byte> memory() const;
  bool remember(std::span<const std::byte> memory, std::size_t bodies);  ///< bodies: of the world

 private:
  std::map<std::uint32_t, std::array<double, 3>> speeds_;  // by BodyId
};

/// Does one act; throws ActRefused. `holds` is the simulation's.
void carry_out(Simulation& simulation, const Act& act, Holds& holds);

}  // namespace troupe
