#include "models/controllers/scan_ahead.hpp"

#include "engine/observing/lint_view.hpp"
#include "models/controllers/beams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace troupe::models {
namespace {

constexpr double k_ahead = radians(30);  // a usable scanner has a beam within this angle of straight ahead

}  // namespace

Scanner::Scanner(const engine::DeviceInfo& ranger, std::size_t share) {
  const std::vector<models::Beam> beams = beams_of(ranger);
  if (beams.size() < 2) return;
  const auto [right, left] = std::ranges::minmax(beams, {}, &models::Beam::bearing);
  const double fov = left.bearing - right.bearing;
  const double step = fov / static_cast<double>(beams.size() - 1);
  const std::size_t margin = beams.size() / share;
  const double window = fov / 2 - static_cast<double>(margin) * step;
  // Files give angles in degrees with few digits. With the tolerance, a beam that should be exactly at an
  // edge of the window is treated as if it were.
  const double tolerance = 1e-3 * step + 1e-9;

  const auto off = [](const models::Beam& beam) { return std::abs(beam.bearing); };
  const double least = off(*std::ranges::min_element(beams, {}, off));
  const auto is_near = [&](const models::Beam& beam) { return off(beam) <= least + tolerance; };
  const bool left_is_near = std::ranges::any_of(
      beams, [&](const models::Beam& beam) { return is_near(beam) && beam.bearing >= -tolerance; });
  double y_min = std::numeric_limits<double>::infinity();
  double y_max = -y_min;
  for (const models::Beam& beam : beams) {
    const bool is_middle = is_near(beam) && (!left_is_near || beam.bearing >= -tolerance);
    const bool is_ahead = (is_middle && least <= tolerance) ||
                          (beam.bearing > tolerance - window && beam.bearing <= window + tolerance);
    beams_.push_back(
        {static_cast<std::uint32_t>(beam.reading), is_ahead, !is_middle && beam.bearing > 0, is_middle});
    if (is_ahead) reach_ahead_ = std::min(reach_ahead_, beam.range_max);
    sees_ahead_ = sees_ahead_ || (is_ahead && least <= k_ahead + tolerance);
    if (!is_middle) continue;
    y_min = std::min(y_min, beam.origin.y());
    y_max = std::max(y_max, beam.origin.y());
  }
  constexpr double k_same_m = 1e-6;
  for (std::size_t i = 0; i < beams.size(); ++i)
    if (beams_[i].is_middle) beams_[i].is_left = beams[i].origin.y() > (y_min + y_max) / 2 + k_same_m;
}

ScanAhead Scanner::ahead(std::span<const float> ranges, double min_front, double stop_distance) const {
  ScanAhead seen;
  for (const Beam& beam : beams_) {
    const float range = ranges[beam.reading];
    if (beam.is_ahead) {
      seen.obstruction = seen.obstruction || range < min_front;
      seen.stop = seen.stop || range < stop_distance;
    }
    float& side = beam.is_left ? seen.left : seen.right;
    side = std::min(side, range);
  }
  return seen;
}

float Scanner::straight_ahead(std::span<const float> ranges) const {
  float least = std::numeric_limits<float>::infinity();
  for (const Beam& beam : beams_)
    if (beam.is_middle) least = std::min(least, ranges[beam.reading]);
  return least;
}

bool distances_are_set(const engine::LintView& view) {
  return view.is_set({"min_front", "stop", "clearance", "clearances"}) ||
         std::ranges::any_of(view.controller().devices, [&](std::size_t d) {
           return view.world.is_set(view.type_spec().devices[d].params, {"transducers"});
         });
}

bool warns_of_turning(const engine::LintView& view, const Scanner& scanner, double distance,
                      std::string_view parameter) {
  if (distance <= scanner.reach_ahead() || distances_are_set(view)) return false;
  view.warn(
      engine::LintTopic::decision,
      fmt::format("{} always sees an obstacle ahead: it turns away while a reading ahead is below its \"{}\" "
                  "of {:.9g} m, but its ranger reads at most {:.9g} m there",
                  engine::device_text("the controller", view.controller_spec().kind, view.type_spec().name),
                  parameter, distance, scanner.reach_ahead()));
  return true;
}

}  // namespace troupe::models
