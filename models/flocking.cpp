#include "models/flocking.hpp"

#include "base/math.hpp"
#include "engine/controller.hpp"
#include "models/device_choice.hpp"
#include "models/fiducial_readings.hpp"

#include <cmath>

namespace troupe::models {
namespace {

using engine::DeviceInfo;

constexpr double k_gain = 0.3;        // 1/s: to where there is room
constexpr double k_flock_gain = 0.3;  // 1/s: to the heading of another
constexpr double k_speed = 0.4;       // m/s
constexpr double k_cone = 0.5;        // rad
constexpr double k_front = 1.0;       // m
constexpr double k_side = 0.5;        // m
constexpr double k_least_turn = 0.1;  // rad/s, of one that stands

struct Flocking {
  static constexpr std::size_t k_front_ring = 8;
  std::array<std::size_t, k_front_ring> readings{};
  std::array<SinCos, k_front_ring> directions{};
  FiducialReadings finder;

  static Flocking make(const engine::Record&) { return {}; }

  std::vector<std::size_t> choose(std::span<const DeviceInfo> devices, std::vector<bool>& claimed,
                                  std::string& fault) {
    DeviceChoice choice(devices, claimed);
    const bool has_ring =
        choice.take([](const DeviceInfo& d) { return d.prepared.transducers.size() >= k_front_ring; });
    if (!has_ring)
      fault = "needs a ranger of 8 or more transducers";
    else if (!choice.take_kind("fiducial"))
      fault = "needs a fiducial finder";
    if (!fault.empty()) return {};
    finder = FiducialReadings(devices[choice.chosen()[1]].prepared);
    const auto& layout = devices[choice.chosen()[0]].prepared;
    for (std::size_t i = 0; i < k_front_ring; ++i) {
      readings[i] = layout.transducers[i];
      directions[i] = sincos(layout.transducer_headings[i]);
    }
    return choice.chosen();
  }

  void operator()(const engine::Percept& percept, Random& random, engine::Actions& actions) const {
    const std::span<const float> ranges = percept.ranges(0);
    std::array<double, k_front_ring> r;
    double x = 0;
    double y = 0;
    for (std::size_t i = 0; i < k_front_ring; ++i) {
      r[i] = ranges[readings[i]];
      x += r[i] * directions[i].cos;
      y += r[i] * directions[i].sin;
    }
    const double theta = x == 0 && y == 0 ? 0 : atan2(y, x);
    double turn = k_gain * theta;
    const bool is_free = r[2] > k_front && r[3] > k_front && r[4] > k_front && r[5] > k_front &&
                         r[1] > k_side && r[6] > k_side && std::abs(theta) < k_cone;
    if (is_free) {
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
      "pioneer_flocking", "flock: drive where sonars see room, turning as the nearest marked robot does", {});
}

}  // namespace troupe::models
