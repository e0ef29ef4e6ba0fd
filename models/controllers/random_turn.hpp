#pragma once

#include "base/math.hpp"
#include "base/random.hpp"
#include "models/controllers/decisions.hpp"

#include <algorithm>

namespace troupe::models {

/// Begins a turn on the spot by a random angle, from a quarter to half a turn: sets the turn rate
/// `memory.turn`, rad/s, and the number of decisions for which it lasts, `memory.turn_updates`.
///
/// period_s: time between two decisions, s
/// right: true for a turn to the right, false for a turn to the left
template <class Memory>
void begin_turn(Memory& memory, double period_s, Random& random, bool right) {
  constexpr double k_turn = 1.5;             // rad/s
  constexpr double k_least_turn = k_pi / 2;  // rad
  memory.turn = static_cast<float>(right ? -k_turn : k_turn);
  // At least one decision: with none, the robot would never turn away from an obstacle.
  memory.turn_updates = std::max(1u, whole_decisions(random.uniform(k_least_turn, k_pi) / k_turn, period_s));
}

}  // namespace troupe::models
