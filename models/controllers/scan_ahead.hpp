#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::models {

/// Least number of beams of a ranger (range sensor) that is used as a scanner. With fewer beams, left, ahead
/// and right could not be distinguished.
inline constexpr std::size_t k_least_samples = 9;

/// Summary of one scan (one set of readings of a ranger), for obstacle avoidance. Scanner::ahead() returns
/// it. The class Scanner defines "window" (the beams that look ahead), "left" and "right".
struct ScanAhead {
  bool obstruction = false;  ///< a reading in the window is below the limit `min_front`
  bool stop = false;         ///< a reading in the window is below the limit `stop_distance`
  /// Smallest reading of the beams that count as left, m; infinite if there is no such beam.
  float left = std::numeric_limits<float>::infinity();
  /// Smallest reading of the beams that count as right, m; infinite if there is no such beam.
  float right = std::numeric_limits<float>::infinity();
};

/// Detects obstacles in the readings of a ranger (range sensor). It uses the bearings of the beams. The order
/// of the beams, and the transducers (fans of beams) to which they belong, make no difference.
///
/// window  The beams that look ahead. The argument `share` of the constructor is 3 or 4. At either end of the
///         scan, 1 / `share` of all beams are not in the window. So if the beams are spread evenly and
///         symmetrically about straight ahead, the window is the middle third (`share` 3) or the middle half
///         (`share` 4) of the scan, as in Stage's `wander`.
///         The exact rule: Let n be the number of beams, F the angle between the outermost beams, and
///         m = n / `share`, rounded down. A beam with the bearing b is in the window if -W < b <= W, where
///         W = F / 2 - m F / (n - 1). A beam exactly straight ahead is always in the window.
/// middle  The middle beam is the beam nearest to straight ahead. If two beams are nearest, one on either
///         side, it is the left one. If several parallel beams are nearest, all of them are middle beams.
/// sides   Each beam counts as left or right: by the sign of its bearing, except for middle beams. A single
///         middle beam counts as right, as in Stage. If several parallel beams are middle beams, those count
///         as left that start left of the middle between the leftmost and the rightmost starting point.
class Scanner {
 public:
  Scanner() = default;
  /// Makes a scanner for the readings of `ranger`. share: 3 or 4 (see `window` above). If the device is not a
  /// ranger, or has only one beam, the scanner has no beams.
  Scanner(const engine::DeviceInfo& ranger, std::size_t share);

  /// Whether the scanner is good enough for obstacle avoidance: it has at least k_least_samples beams, at
  /// least one beam in the window, and at least one beam within 30 degrees of straight ahead.
  bool is_usable() const { return beams_.size() >= k_least_samples && sees_ahead_; }
  std::size_t size() const { return beams_.size(); }  ///< number of beams
  /// Smallest of the greatest readings of the beams in the window, m; infinite if there is no such beam. If
  /// the argument `min_front` of ahead() exceeds this, ahead() always reports an obstruction.
  float reach_ahead() const { return reach_ahead_; }

  /// Summarises one scan.
  ///
  /// ranges: the readings of the ranger, m
  /// min_front: a reading in the window below this, m, sets ScanAhead::obstruction
  /// stop_distance: a reading in the window below this, m, sets ScanAhead::stop
  ScanAhead ahead(std::span<const float> ranges, double min_front, double stop_distance) const;
  /// Returns the reading of the middle beam, m. If there are several middle beams, returns the smallest of
  /// their readings; if there is none, infinity. ranges: the readings of the ranger, m.
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
  float reach_ahead_ = std::numeric_limits<float>::infinity();
};

/// Adds the parameter `min_front` (m) to `d`, the list of the parameters that a world file can give a
/// controller. It is for controllers that turn away from obstacles ahead. `Params` must have a member
/// `min_front`.
template <class Params>
constexpr void describe_min_front(engine::Description<Params>& d) {
  using namespace engine::facts;
  d.template member<&Params::min_front>("min_front", engine::Unit::meters, at_least(0),
                                        "the robot turns away when a range measured ahead is below this");
}

/// Whether an intervention changes the distances at which the controller of the view reacts to obstacles, or
/// the ranges that it reads.
bool distances_are_set(const engine::LintView& view);
/// Warns of a controller whose robots turn away all the time, because its ranger reads at most a distance at
/// which they already turn away, unless distances_are_set(). Returns whether it warned.
///
/// distance: the controller turns away while a reading ahead is below this, m
/// parameter: name of the parameter that gives `distance`
bool warns_of_turning(const engine::LintView& view, const Scanner& scanner, double distance,
                      std::string_view parameter = "min_front");

}  // namespace troupe::models
