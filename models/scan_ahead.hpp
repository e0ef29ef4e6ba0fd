#pragma once

#include "engine/fields.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

namespace troupe::models {

/// So many readings a scanner must have that a robot sees by them what is left, ahead and right of it.
inline constexpr std::size_t k_least_samples = 9;

/// What a robot that turns away from obstacles looks for in a scan.
struct ScanAhead {
  bool obstruction = false;  ///< a reading below `min_front` within the window
  bool stop = false;         ///< a reading below `stop_distance` within the window
  /// The nearest reading of the left half of the scan, m; infinite where there is none.
  float left = std::numeric_limits<float>::infinity();
  float right = std::numeric_limits<float>::infinity();  ///< of the right one with the middle
};

/// scan    readings from right to left, m
/// margin  how many at either end are beside the window ahead, and the one that follows them on the right
inline ScanAhead look_ahead(std::span<const float> scan, std::size_t margin, double min_front,
                            double stop_distance) {
  ScanAhead seen;
  const std::size_t n = scan.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (i > margin && i < n - margin) {
      seen.obstruction = seen.obstruction || scan[i] < min_front;
      seen.stop = seen.stop || scan[i] < stop_distance;
    }
    float& side = i > n / 2 ? seen.left : seen.right;
    side = std::min(side, scan[i]);
  }
  return seen;
}

/// The parameter of controllers that turn away from what look_ahead() sees, m.
inline engine::Field min_front_field(double fallback) {
  return {.name = "min_front",
          .unit = engine::Unit::meters,
          .fallback = fallback,
          .min = 0,
          .text = "a reading below it ahead is turned away from"};
}

}  // namespace troupe::models
