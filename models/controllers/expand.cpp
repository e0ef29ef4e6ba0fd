#include "models/controllers/expand.hpp"

#include "base/math.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/observing/lint_view.hpp"
#include "models/controllers/beams.hpp"
#include "models/controllers/device_choice.hpp"
#include "models/controllers/scan_ahead.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

namespace troupe::models {
namespace {

// A vector sum shorter than this fraction of the sum of the readings, and an angle of the vector sum below
// this number (rad), are only rounding errors.
constexpr double k_even = 1e-6;
constexpr double k_turn_away = 0.5;  // rad: replaces the angle of the vector sum if a wall is straight ahead

struct Expand {
  struct Params {
    double speed = 0.3;
    double gain = 1;
    double clearance = 0.5;
    std::vector<double> clearances;
    double cone = 0.5;
    bool invert = false;
    bool hold_on_axis = false;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      using enum engine::Unit;
      d.member<&Params::speed>("speed", meters_per_second, "speed while the way is clear");
      d.member<&Params::gain>(
          "gain", per_second,
          "turn rate per radian of the angle from the heading to the vector sum of the ranges, each range "
          "being a vector along its beam");
      d.member<&Params::clearance>("clearance", meters, at_least(0),
                                   "free distance that the robot needs to drive: the reading of a beam at "
                                   "angle a from straight ahead must exceed clearance * cos(a)");
      d.member<&Params::clearances>(
          "clearances", meters, at_least(0),
          "list that replaces `clearance`: for each transducer, in order, the distance that the readings of "
          "its beams must exceed for the robot to drive; 0 or a missing entry: no limit");
      d.member<&Params::cone>("cone", radians, at_least(0),
                              "the robot drives only while the vector sum of the ranges points less than "
                              "this angle away from straight ahead");
      d.member<&Params::invert>("invert",
                                "true: robots turn away from the vector sum of the ranges, so that they "
                                "gather instead of dispersing");
      d.member<&Params::hold_on_axis>("hold_on_axis",
                                      "true: the robot repeats its last command while the vector sum lies "
                                      "exactly along its x or y axis, as in Stage's examples");
    }
  };
  /// A beam of the ranger, and the range that its reading must exceed for the robot to drive.
  struct Feeler {
    std::size_t reading;
    SinCos direction;
    double clearance;  // m; -1: no limit, because every range exceeds -1
  };

  /// A beam whose reading can never exceed the clearance.
  struct Short {
    float range_max;   // m
    double clearance;  // m
  };

  Params params;
  std::vector<Feeler> feelers;
  std::optional<Short> too_short;  // the first such beam; the robot then never drives

  /// Whether there are readings for which the vector sum of these beams, with `invert` its opposite, points
  /// into the cone ahead. If there are none, the robot would turn forever.
  bool can_point_ahead(std::span<const Beam> beams) const {
    double left = std::numeric_limits<double>::infinity();
    double right = -left;
    for (const Beam& beam : beams) {
      const double bearing = params.invert ? wrap_angle(beam.bearing + k_pi) : beam.bearing;
      if (std::abs(bearing) < params.cone) return true;
      double& side = bearing > 0 ? left : right;
      side = bearing > 0 ? std::min(side, bearing) : std::max(side, bearing);
    }
    return left - right < k_pi;
  }

  Result<std::vector<std::size_t>> choose(std::span<const engine::DeviceInfo> sensors,
                                          std::vector<bool>& claimed) {
    DeviceChoice choice(sensors, claimed);
    // Only the first ranger is read, as in Stage's examples, whose robots also have a second ranger (a
    // laser).
    const auto is_ranger = [](const engine::DeviceInfo& device) { return !device.prepared.bearings.empty(); };
    if (!choice.take(is_ranger))
      return Error{std::string("needs a ranger that no other controller of the robot reads") +
                   (std::ranges::any_of(sensors, is_ranger) ? "" : "; the robot has no ranger")};
    const engine::DeviceInfo& ranger = sensors[choice.chosen().front()];
    const std::vector<Beam> beams = beams_of(ranger);
    if (!can_point_ahead(beams))
      return Error{
          fmt::format("needs a ranger with a beam {0}, or beams to the left and to the right: the vector "
                      "sum of the beams of \"{1}\" never points {0}",
                      params.invert ? "behind" : "ahead", ranger.name)};
    if (const std::size_t count = ranger.prepared.transducers.size(); params.clearances.size() > count)
      return Error{fmt::format(
          "has {} clearances for the {} transducers of \"{}\": give at most one for each transducer",
          params.clearances.size(), count, ranger.name)};
    for (const Beam& beam : beams) {
      const double demand = params.clearances.empty() ? params.clearance * beam.direction.cos
                            : beam.transducer < params.clearances.size() ? params.clearances[beam.transducer]
                                                                         : 0.0;
      feelers.push_back({beam.reading, beam.direction, demand > 0 ? demand : -1.0});
      if (beam.range_max <= feelers.back().clearance && !too_short) too_short = Short{beam.range_max, demand};
    }
    return choice.chosen();
  }

  void operator()(const engine::DecideBatch& batch) const {
    // First all vector sums are computed, then all angles. An arc tangent has a long latency but few
    // operations, so the arc tangents of several robots overlap if nothing else is computed between them.
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
        double sum = 0;
        bool all_clear = true;
        for (const Feeler& feeler : feelers) {
          const double r = ranges[feeler.reading];
          sum_x += r * feeler.direction.cos;
          sum_y += r * feeler.direction.sin;
          sum += r;
          all_clear &= r > feeler.clearance;
        }
        // All sides are equally free: the sum is only rounding error, so the robot drives straight ahead.
        const bool is_even =
            !params.hold_on_axis && sum_x * sum_x + sum_y * sum_y <= k_even * k_even * sum * sum;
        x[i] = is_even ? 1 : params.invert ? -sum_x : sum_x;
        y[i] = is_even ? 0 : params.invert ? -sum_y : sum_y;
        clear[i] = all_clear;
      }
      for (std::size_t i = 0; i < count; ++i) {
        if (params.hold_on_axis && (x[i] == 0 || y[i] == 0)) continue;
        double theta = atan2(y[i], x[i]);
        // Without this exception, a robot that faces a wall at a right angle would never turn.
        if (!params.hold_on_axis && !params.invert && !clear[i] && std::abs(theta) < k_even)
          theta = k_turn_away;
        batch.command(first + i) = {clear[i] && std::abs(theta) < params.cone ? params.speed : 0.0, 0.0,
                                    params.gain * theta};
      }
    }
  }

  void lint(const engine::LintView& view) const {
    if (too_short && !distances_are_set(view))
      view.warn(engine::LintTopic::decision,
                fmt::format(
                    "{} never drives: it drives only while the reading of each beam exceeds the clearance of "
                    "the beam, but a beam with a clearance of {:.9g} m reads at most {:.9g} m",
                    engine::device_text("the controller", view.controller_spec().kind, view.type_spec().name),
                    too_short->clearance, too_short->range_max));
  }
};

}  // namespace

engine::ControllerKind expand_controller() {
  return engine::make_controller_kind<Expand>(
      "expand", "disperse: turn towards the vector sum of the ranges, and drive while the way is clear");
}

engine::Registry::Preset expand_pioneer_preset() {
  constexpr double d = 0.75;
  return {.name = "expand_pioneer",
          .kind = "expand",
          .text = "expand for 16 sonars, as in Stage's cave benchmark",
          .params = {{"speed", 0.2},
                     {"clearances", std::vector<double>{0, d / 4, d / 2, d, d, d / 2, d / 4}},
                     {"hold_on_axis", true}}};
}

engine::Registry::Preset expand_swarm_preset() {
  constexpr double d = 0.5;
  return {.name = "expand_swarm",
          .kind = "expand",
          .text = "expand for a ring of 12 infrared rangers, as in Stage's hospital benchmark",
          .params = {{"clearances",
                      std::vector<double>{d, d / 1.5, d / 3, d / 5, 0, 0, 0, 0, 0, d / 5, d / 3, d / 1.5}},
                     {"hold_on_axis", true}}};
}

}  // namespace troupe::models
