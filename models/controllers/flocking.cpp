#include "models/controllers/flocking.hpp"

#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "models/controllers/beams.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/fiducial_readings.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace troupe::models {
namespace {

using engine::DeviceInfo;

constexpr double k_gain = 0.3;        // 1/s: turn rate per radian of the angle to free space
constexpr double k_flock_gain = 0.3;  // 1/s: turn rate per radian of the angle to the nearest robot's heading
constexpr double k_speed = 0.4;       // m/s
constexpr double k_cone = 0.5;        // rad: robots drive only if the angle to free space is below this
constexpr double k_front = 1.0;       // m that must be free within k_front_angle of straight ahead
constexpr double k_side = 0.5;        // m that must be free between k_front_angle and k_side_angle
constexpr double k_tolerance = 1e-3;  // rad and m: files give angles in degrees with few digits
constexpr double k_front_angle = radians(30);
constexpr double k_side_angle = radians(50);
// rad/s: if a robot that does not drive would turn more slowly than this, it gets a random turn rate.
constexpr double k_least_turn = 0.1;

struct Flocking {
  static constexpr std::size_t k_ring = 8;  // least number of transducers of a ring of sonars
  /// A beam of the ranger, and the range that its reading must exceed for the robot to drive.
  struct Sonar {
    std::size_t reading;
    SinCos direction;
    double clearance;  // m; -1: no limit, because every range exceeds -1
  };
  std::vector<Sonar> sonars;
  FiducialReadings finder;

  /// The beams of a ranger that point forwards or sideways. A beam at a right angle to the heading counts
  /// only if it does not start behind the robot's origin. So the front eight of Stage's ring of 16 sonars
  /// remain.
  static std::vector<Sonar> front_of(const DeviceInfo& device) {
    std::vector<Sonar> front;
    for (const Beam& beam : beams_of(device)) {
      const double off = std::abs(beam.bearing);
      const bool is_beside = std::abs(off - k_pi / 2) <= k_tolerance;
      if (is_beside ? beam.origin.x() < -k_tolerance : off > k_pi / 2) continue;
      const double clearance = off <= k_front_angle + k_tolerance  ? k_front
                               : off <= k_side_angle + k_tolerance ? k_side
                                                                   : -1;
      front.push_back({beam.reading, beam.direction, clearance});
    }
    return front;
  }
  static bool is_usable(const DeviceInfo& device) {
    const std::vector<Sonar> front = front_of(device);
    const auto any = [&](auto&& fits) { return std::ranges::any_of(front, fits); };
    return any([](const Sonar& s) { return s.clearance == k_front; }) &&
           any([](const Sonar& s) { return s.direction.sin > k_tolerance; }) &&
           any([](const Sonar& s) { return s.direction.sin < -k_tolerance; });
  }

  Result<std::vector<std::size_t>> choose(std::span<const DeviceInfo> devices, std::vector<bool>& claimed) {
    DeviceChoice choice(devices, claimed);
    const auto is_ring = [](const DeviceInfo& d) {
      return d.prepared.transducers.size() >= k_ring && is_usable(d);
    };
    if (!choice.take(is_ring) && !choice.take(is_usable))
      return Error{
          "needs a ranger with beams to the left, to the right and within 30 degrees of straight ahead"};
    if (!choice.take_kind("fiducial"))
      return choice.missing("fiducial", "needs a fiducial finder (a device of kind \"fiducial\")");
    finder = FiducialReadings(devices[choice.chosen()[1]]);
    sonars = front_of(devices[choice.chosen()[0]]);
    return choice.chosen();
  }

  void operator()(const engine::Percept& percept, Random& random, engine::Actions& actions) const {
    const std::span<const float> ranges = percept.ranges(0);
    double x = 0;
    double y = 0;
    bool is_free = true;
    for (const Sonar& sonar : sonars) {
      const double range = ranges[sonar.reading];
      x += range * sonar.direction.cos;
      y += range * sonar.direction.sin;
      is_free = is_free && range > sonar.clearance;
    }
    const double theta = x == 0 && y == 0 ? 0 : atan2(y, x);
    double turn = k_gain * theta;
    if (is_free && std::abs(theta) < k_cone) {
      const engine::Readings& seen = percept.devices[1];
      if (finder.count(seen) > 0) turn += k_flock_gain * finder.heading(seen, 0);
      actions.command = {k_speed, 0, turn};
      return;
    }
    if (std::abs(turn) < k_least_turn) turn = random.uniform();
    actions.command = {0, 0, turn};
  }
};

}  // namespace

engine::ControllerKind pioneer_flocking_controller() {
  return engine::make_controller_kind<Flocking>(
      "pioneer_flocking",
      "flock: drive where the sonars see free space, and turn to the heading of the nearest robot that the "
      "fiducial finder finds");
}

}  // namespace troupe::models
