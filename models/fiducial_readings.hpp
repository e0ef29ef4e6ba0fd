#pragma once

#include "base/assert.hpp"
#include "engine/kinds.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace troupe::models {

/// What a fiducial finder reads, for controllers. Models and sensors do not know one another, so the fields
/// are found once by their names, which are those of recordings too; sensors/fiducial.hpp says what is in
/// them.
class FiducialReadings {
 public:
  FiducialReadings() = default;
  /// Of the device `finder` of a type, which must be a fiducial finder.
  explicit FiducialReadings(const engine::DeviceKind::Prepared& finder)
      : count_(field(finder, "count")),
        id_(field(finder, "id")),
        range_(field(finder, "range")),
        bearing_(field(finder, "bearing")),
        heading_(field(finder, "heading")) {}

  /// Targets that have an entry; the nearest comes first. There may be more in sight.
  std::size_t count(const engine::Readings& seen) const {
    return std::min<std::size_t>(seen.field<std::uint32_t>(count_)[0], seen.field<std::int32_t>(id_).size());
  }
  /// Its fiducial_return; 0 where it is too far to be read.
  std::int32_t id(const engine::Readings& seen, std::size_t target) const {
    return seen.field<std::int32_t>(id_)[target];
  }
  /// To its origin, m.
  float range(const engine::Readings& seen, std::size_t target) const {
    return seen.field<float>(range_)[target];
  }
  /// Of its origin, rad, sensor frame.
  float bearing(const engine::Readings& seen, std::size_t target) const {
    return seen.field<float>(bearing_)[target];
  }
  /// Its own, rad, sensor frame.
  float heading(const engine::Readings& seen, std::size_t target) const {
    return seen.field<float>(heading_)[target];
  }

 private:
  static std::size_t field(const engine::DeviceKind::Prepared& finder, std::string_view name) {
    const auto is_it = [name](const engine::StateField& field) { return field.name == name; };
    const auto found = std::ranges::find_if(finder.percepts, is_it);
    TROUPE_ASSERT(found != finder.percepts.end());
    return static_cast<std::size_t>(found - finder.percepts.begin());
  }

  std::size_t count_ = 0;
  std::size_t id_ = 0;
  std::size_t range_ = 0;
  std::size_t bearing_ = 0;
  std::size_t heading_ = 0;
};

}  // namespace troupe::models
