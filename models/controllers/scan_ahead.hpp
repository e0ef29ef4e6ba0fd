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

/// Summary of the readings of a scanner, for obstacle avoidance. Scanner::ahead() returns it.
struct ScanAhead {
  bool obstruction = false;  ///< a reading within the window ahead is below the limit `min_front`
  bool stop = false;         ///< a reading within the window ahead is below the limit `stop_distance`
  /// The smallest reading to the left, m; infinite if there are no beams to the left.
  float left = std::numeric_limits<float>::infinity();
  /// The smallest reading to the right or straight ahead, m; infinite if there are no such beams.
  float right = std::numeric_limits<float>::infinity();
};

/// Obstacle detection with a ranger. It uses only the bearings of the beams. Their order, and the transducers
/// to which they belong, make no difference.
///
/// window  The beams ahead. Let n beams cover an angle F from the first to the last, so that neighbouring
///         beams are F / (n - 1) apart on average. The window leaves out n / `share` beams at either end: it
///         has the bearings b with -W < b <= W, where W = F / 2 - (n / share) F / (n - 1). In a single fan
///         that is symmetric about straight ahead, these are the beams of the middle third (share 3) or of
///         the middle half (share 4), as in Stage's `wander`.
/// sides   The beams to the left and to the right of straight ahead. The beam nearest to straight ahead
///         counts as right, as in Stage. If two beams are nearest, at the same angle to either side, the left
///         one counts as right too. If several parallel beams point straight ahead, those that start to the
///         left of their middle count as left.
class Scanner {
 public:
  Scanner() = default;
  /// share: 3 or 4, the `share` of the window above. With a device that is not a ranger, the scanner has no
  /// beams.
  Scanner(const engine::DeviceInfo& ranger, std::size_t share);

  /// Whether the scanner has at least k_least_samples beams, at least one of them in the window, and one
  /// within 30 degrees of straight ahead.
  bool is_usable() const { return beams_.size() >= k_least_samples && sees_ahead_; }
  std::size_t size() const { return beams_.size(); }  ///< number of beams

  /// Summarises one scan. ranges: the readings of the ranger; all arguments in m.
  ScanAhead ahead(std::span<const float> ranges, double min_front, double stop_distance) const;
  /// The reading of the beam nearest to straight ahead, m; of several equally near beams, the smallest.
  float straight_ahead(std::span<const float> ranges) const;

 private:
  struct Beam {
    std::uint32_t reading;
    bool is_ahead;   // the beam is in the window
    bool is_left;    // the beam counts as left; otherwise as right
    bool is_middle;  // the beam is the nearest to straight ahead, or one of several equally near beams
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
