#include "models/expand.hpp"

#include "base/math.hpp"
#include "engine/controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace troupe::models {
namespace {

using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Unit;

const FieldTable& expand_fields() {
  static const FieldTable table{{
      {.name = "speed", .unit = Unit::meters_per_second, .fallback = 0.3, .text = "while the way is clear"},
      {.name = "gain",
       .unit = Unit::per_second,
       .fallback = 1.0,
       .text = "turn rate for each radian between heading and vector sum"},
      {.name = "clearance",
       .unit = Unit::meters,
       .fallback = 0.5,
       .min = 0,
       .text = "what must be free ahead; a beam at angle a from the front must exceed clearance * cos(a)"},
      {.name = "clearances",
       .type = FieldType::numbers,
       .unit = Unit::meters,
       .fallback = std::vector<double>{},
       .min = 0,
       .text = "instead of `clearance`: what each transducer must exceed, in their order; 0 or left out: "
               "anything"},
      {.name = "cone",
       .unit = Unit::radians,
       .fallback = 0.5,
       .min = 0,
       .text = "drives only while the vector sum lies less than this off the front"},
      {.name = "invert",
       .type = FieldType::boolean,
       .fallback = false,
       .text = "turn away from the vector sum: robots cluster instead of dispersing"},
  }};
  return table;
}

struct Expand {
  struct Beam {
    std::size_t reading;
    double cos, sin;
    double clearance;  // m; -1: anything goes, as every range is more
  };

  double speed, gain, clearance;
  std::vector<double> clearances;
  double cone;
  bool invert;
  std::vector<Beam> beams;

  static Expand make(const Record& p) {
    return {p[0].number(), p[1].number(), p[2].number(), p[3].numbers(), p[4].number(), p[5].boolean(), {}};
  }

  std::vector<std::size_t> choose(std::span<const engine::DeviceInfo> sensors, std::vector<bool>& claimed,
                                  std::string& fault) {
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      const auto& layout = sensors[s].prepared;
      if (claimed[s] || layout.transducers.empty()) continue;
      claimed[s] = true;
      if (clearances.size() > layout.transducers.size()) {
        fault = fmt::format("has {} clearances for the {} transducers of \"{}\"", clearances.size(),
                            layout.transducers.size(), sensors[s].name);
      }
      for (std::size_t t = 0; t < layout.transducers.size(); ++t) {
        const SinCos a = sincos(layout.transducer_headings[t]);
        const double demand = clearances.empty()      ? std::max(0.0, clearance * a.cos)
                              : t < clearances.size() ? clearances[t]
                                                      : 0.0;
        beams.push_back({layout.transducers[t], a.cos, a.sin, demand > 0 ? demand : -1.0});
      }
      // Stage's examples take a second ranger when there is one (a laser) and leave it unread.
      return {s};
    }
    fault = "needs a ranger that no other controller of the robot reads";
    return {};
  }

  void operator()(const engine::DecideBatch& batch) const {
    // First all the sums, then all the angles: an arc tangent takes long to come and little to do, so that
    // those of several robots overlap when nothing stands between them.
    constexpr std::size_t k_some = 64;
    std::array<double, k_some> x;
    std::array<double, k_some> y;
    std::array<bool, k_some> clear;
    for (std::size_t first = 0; first < batch.size(); first += k_some) {
      const std::size_t count = std::min(k_some, batch.size() - first);
      for (std::size_t i = 0; i < count; ++i) {
        const std::span<const float> ranges = batch.ranges(0, first + i);
        double sum_x = 0;
        double sum_y = 0;
        bool all_clear = true;
        for (const Beam& beam : beams) {
          const double r = ranges[beam.reading];
          sum_x += r * beam.cos;
          sum_y += r * beam.sin;
          all_clear &= r > beam.clearance;
        }
        x[i] = sum_x;
        y[i] = sum_y;
        clear[i] = all_clear;
      }
      for (std::size_t i = 0; i < count; ++i) {
        if (x[i] == 0 || y[i] == 0) continue;  // no direction to choose: the last command stays
        const double theta = invert ? atan2(-y[i], -x[i]) : atan2(y[i], x[i]);
        batch.command(first + i) = {clear[i] && std::abs(theta) < cone ? speed : 0.0, 0.0, gain * theta};
      }
    }
  }
};

}  // namespace

engine::ControllerKind expand_controller() {
  return engine::make_controller_kind<Expand>("expand", "disperse along the vector sum of the ranges",
                                              expand_fields());
}

engine::Registry::Preset expand_pioneer_preset() {
  constexpr double d = 0.75;
  return {
      .name = "expand_pioneer",
      .kind = "expand",
      .text = "expand for 16 sonars, as in Stage's cave benchmark",
      .params = {{"speed", 0.2}, {"clearances", std::vector<double>{0, d / 4, d / 2, d, d, d / 2, d / 4}}}};
}

engine::Registry::Preset expand_swarm_preset() {
  constexpr double d = 0.5;
  return {.name = "expand_swarm",
          .kind = "expand",
          .text = "expand for a ring of 12 infrared rangers, as in Stage's hospital benchmark",
          .params = {{"clearances",
                      std::vector<double>{d, d / 1.5, d / 3, d / 5, 0, 0, 0, 0, 0, d / 5, d / 3, d / 1.5}}}};
}

}  // namespace troupe::models
