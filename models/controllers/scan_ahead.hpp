#pragma once

#include "engine/description.hpp"
#include "engine/kinds.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace troupe::models {

/// Least number of beams of a scanner: enough to distinguish left, ahead and right.
inline constexpr std::size_t k_least_samples = 9;

/// Summary of the readings of a scanner, for obstacle avoidance.
struct ScanAhead {
  bool obstruction = false;  ///< a reading below `min_front` within the window ahead
  bool stop = false;         ///< a reading below `stop_distance` within the window ahead
  /// The smallest reading to the left, m; infinite without beams to the left.
  float left = std::numeric_limits<float>::infinity();
  float right = std::numeric_limits<float>::infinity();  ///< to the right or straight ahead, m
};

/// Obstacle detection with a ranger. It uses only the bearings of the beams, whatever their order and
/// whichever transducers they belong to.
///
/// window  With n beams over an angle of F in all (both ends included, so F / (n - 1) from beam to beam on
///         average) and a margin of n / `share` beams at either end: bearings b, -W < b <= W, where
///         W = F / 2 - (n / share) F / (n - 1). Of one fan about straight ahead these are the beams of the
///         middle third (share 3) or half (share 4), as in Stage's `wander`.
/// sides   The beams to the left and to the right of straight ahead. The one nearest to straight ahead counts
///         as right, as in Stage; of two at the same angle to either side the left one does. Of several
///         parallel beams straight ahead those count as left that start to the left of their middle.
class Scanner {
 public:
  Scanner() = default;
  /// share: 3 or 4, see above. A device that is not a ranger gives a scanner without beams.
  Scanner(const engine::DeviceInfo& ranger, std::size_t share);

  /// Whether it has at least k_least_samples beams, some of them in the window and one within 30 degrees of
  /// straight ahead.
  bool is_usable() const { return beams_.size() >= k_least_samples && sees_ahead_; }
  std::size_t size() const { return beams_.size(); }  ///< number of beams

  /// ranges: the readings of the ranger. All values in m.
  ScanAhead ahead(std::span<const float> ranges, double min_front, double stop_distance) const;
  /// The reading of the beam nearest to straight ahead, m; of several equally near beams, the smallest.
  float straight_ahead(std::span<const float> ranges) const;

 private:
  struct Beam {
    std::uint32_t reading;
    bool is_ahead;   // it is in the window
    bool is_left;    // else it counts as right
    bool is_middle;  // nearest to straight ahead
  };
  std::vector<Beam> beams_;
  bool sees_ahead_ = false;
};

/// Describes the parameter `min_front`, m, of controllers that turn away from obstacles ahead.
template <class Params>
constexpr void describe_min_front(engine::Description<Params>& d) {
  using namespace engine::facts;
  d.template member<&Params::min_front>("min_front", engine::Unit::meters, at_least(0),
                                        "the robot turns away when a reading ahead is below this");
}

}  // namespace troupe::models
