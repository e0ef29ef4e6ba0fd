#include "sensors/heights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace troupe::sensors {
namespace {

/// Returns heights as text: "0.5 m", "0 to 1 m".
std::string heights_text(const ZInterval& z) {
  return z.min == z.max ? fmt::format("{:.4g} m", z.min) : fmt::format("{:.4g} to {:.4g} m", z.min, z.max);
}

/// Returns how many of the solids at the height z, world frame, are those of the body at the height `level`
/// whose sensor looks there.
std::size_t count_own(const engine::LintView& view, std::span<const ZInterval> own, double level, double z) {
  std::ptrdiff_t count = 0;
  for (const auto& [other, bodies] : view.world.levels[view.type])
    if (other == level || view.world.bodies[view.type] == 1)
      count += std::ranges::count_if(
          own, [&, up = other](const ZInterval& solid) { return solid.shifted(up).contains(z); });
  return static_cast<std::size_t>(count);
}

}  // namespace

void Heights::add(const ZInterval& z, std::size_t count) {
  begins_[z.min] += count;
  ends_[z.max] += count;
  extent_ = {std::min(extent_.min, z.min), std::max(extent_.max, z.max)};
}

void Heights::sum() {
  for (auto* list : {&begins_, &ends_}) {
    std::size_t sum = 0;
    for (auto& [z, count] : *list) count = sum += count;
  }
}

std::size_t Heights::at(double z) const {
  const auto begun = begins_.upper_bound(z);
  const auto ended = ends_.lower_bound(z);
  return (begun == begins_.begin() ? 0 : std::prev(begun)->second) -
         (ended == ends_.begin() ? 0 : std::prev(ended)->second);
}

std::string why_at_no_height(const engine::LintView& view, const DetectableSolids& solids,
                             std::span<const double> sensor_z) {
  Heights looks;
  for (const auto& [level, bodies] : view.world.levels[view.type])
    for (const double height : sensor_z) {
      const double z = height + level;
      if (solids.all.at(z) > count_own(view, solids.own, level, z)) return {};
      looks.add({z, z}, 1);
    }
  if (solids.all.empty() || solids.all.extent().contains(looks.extent().min))
    return fmt::format("{} is at the height of the sensor, {}", solids.none, heights_text(looks.extent()));
  return fmt::format("it is at a height of {}, but {} are at {}", heights_text(looks.extent()), solids.name,
                     heights_text(solids.all.extent()));
}

}  // namespace troupe::sensors
