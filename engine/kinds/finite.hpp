#pragma once

#include "base/pose.hpp"
#include "engine/kinds/commands.hpp"

#include <cmath>

namespace troupe::engine {

/// Whether all numbers of a pose, a command or a velocity are finite.
///@{
inline bool is_finite(const Pose& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.heading);
}
inline bool is_finite(const Command& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.turn);
}
inline bool is_finite(const Velocity& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.turn);
}
///@}

}  // namespace troupe::engine
