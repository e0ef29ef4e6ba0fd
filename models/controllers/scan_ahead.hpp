#pragma once

#include "engine/description.hpp"
#include "engine/kinds.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace troupe::models {

/// A scanner has at least this many beams, so that its readings tell what is left, ahead and right.
inline constexpr std::size_t k_least_samples = 9;

/// What a robot that turns away from obstacles looks for in the readings of a scanner.
struct ScanAhead {
  bool obstruction = false;  ///< a reading below `min_front` within the window ahead
  bool stop = false;         ///< a reading below `stop_distance` within the window ahead
  /// The nearest reading to the left, m; infinite where no beam looks there.
  float left = std::numeric_limits<float>::infinity();
  float right = std::numeric_limits<float>::infinity();  ///< to the right and straight ahead
};

/// How a controller looks ahead by a ranger: by the bearing of each beam, in whatever transducers and
/// whatever order the ranger has them.
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
  /// share: 3 or 4, see above. Of a device that is no ranger: none of its beams is ahead.
  Scanner(const engine::DeviceInfo& ranger, std::size_t share);

  /// Whether it has the beams that a controller needs: k_least_samples, of which some are in the window and
  /// one is within 30 degrees of straight ahead.
  bool is_usable() const { return beams_.size() >= k_least_samples && sees_ahead_; }
  std::size_t size() const { return beams_.size(); }  ///< beams

  /// ranges: the readings of the ranger, m. Distances in m.
  ScanAhead look(std::span<const float> ranges, double min_front, double stop_distance) const;
  /// The reading of the beam that is nearest to straight ahead, m; of several the least.
  float straight_ahead(std::span<const float> ranges) const;

 private:
  struct Beam {
    std::uint32_t reading;
    bool is_ahead;   // in the window
    bool is_left;    // else it counts as right
    bool is_middle;  // nearest to straight ahead
  };
  std::vector<Beam> beams_;
  bool sees_ahead_ = false;
};

/// The parameter `min_front` of controllers that turn away from what a scanner sees ahead, m.
template <class Params>
constexpr void describe_min_front(engine::Description<Params>& d) {
  using namespace engine::facts;
  d.template member<&Params::min_front>("min_front", engine::Unit::meters, at_least(0),
                                        "turns away when a reading ahead is below this");
}

}  // namespace troupe::models
