#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/kinds.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace troupe::models {

/// Least number of beams that a ranger must have to be used as a scanner. With fewer beams, left, ahead and
/// right could not be distinguished.
inline constexpr std::size_t k_least_samples = 9;

/// Summary of one scan, for obstacle avoidance. Scanner::ahead() returns it. The class Scanner defines what
/// "window", "left" and "right" mean.
struct ScanAhead {
  bool obstruction = false;  ///< a reading within the window ahead is below the limit `min_front`
  bool stop = false;         ///< a reading within the window ahead is below the limit `stop_distance`
  /// The smallest reading to the left, m; infinite if there are no beams to the left.
  float left = std::numeric_limits<float>::infinity();
  /// The smallest reading to the right or straight ahead, m; infinite if there are no such beams.
  float right = std::numeric_limits<float>::infinity();
};

/// Obstacle detection with a ranger. It uses the bearings of the beams. The order of the beams, and the
/// transducers (fans of beams) to which they belong, make no difference.
///
/// window  The beams ahead. Let n beams cover an angle F from the rightmost to the leftmost beam, so that
///         neighbouring beams are F / (n - 1) apart on average. The window leaves out n / `share` beams
///         (rounded down) at either end: it has the bearings b with -W < b <= W, where
///         W = F / 2 - (n / share) F / (n - 1). A beam exactly straight ahead is always in the window. In a
///         single fan that is symmetric about straight ahead, the window has the beams of the middle third
///         (share 3) or of the middle half (share 4), as in Stage's `wander`.
/// sides   The beams to the left and to the right of straight ahead. The beam nearest to straight ahead is
///         called the middle beam. It counts as right, as in Stage. If two beams are nearest, at the same
///         angle to either side, the left of them is the middle beam. If several parallel beams are nearest,
///         all of them are middle beams, and those that start left of their common centre count as left.
class Scanner {
 public:
  Scanner() = default;
  /// share: 3 or 4, the `share` in the definition of the window. If the device is not a ranger, or has only
  /// one beam, the scanner has no beams.
  Scanner(const engine::DeviceInfo& ranger, std::size_t share);

  /// Whether the scanner has at least k_least_samples beams, of which one or more are in the window, and one
  /// or more within 30 degrees of straight ahead.
  bool is_usable() const { return beams_.size() >= k_least_samples && sees_ahead_; }
  std::size_t size() const { return beams_.size(); }  ///< number of beams

  /// Summarises one scan. ranges: the readings of the ranger. min_front, stop_distance: the limits of
  /// ScanAhead::obstruction and ScanAhead::stop. All arguments are in m.
  ScanAhead ahead(std::span<const float> ranges, double min_front, double stop_distance) const;
  /// The reading of the middle beam, m; if there are several middle beams, the smallest of their readings;
  /// infinite if the scanner has no beams. ranges: the readings of the ranger, m.
  float straight_ahead(std::span<const float> ranges) const;

 private:
  struct Beam {
    std::uint32_t reading;
    bool is_ahead;   // the beam is in the window
    bool is_left;    // the beam counts as left; otherwise as right
    bool is_middle;  // the beam is a middle beam (see `sides` above)
  };
  std::vector<Beam> beams_;
  bool sees_ahead_ = false;
};

/// Adds the parameter `min_front` (m) to the description of a controller that turns away from obstacles
/// ahead. A description lists the parameters that a world file can set. `Params` must have a member of this
/// name.
template <class Params>
constexpr void describe_min_front(engine::Description<Params>& d) {
  using namespace engine::facts;
  d.template member<&Params::min_front>("min_front", engine::Unit::meters, at_least(0),
                                        "the robot turns away when a range measured ahead is below this");
}

}  // namespace troupe::models
