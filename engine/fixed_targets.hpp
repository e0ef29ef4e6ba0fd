#pragma once

#include "engine/world_spec.hpp"
#include "partition/box_grid.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace troupe::engine {

/// A spatial index of the fiducial targets of static bodies.
class FixedTargets {
 public:
  /// A marked part.
  struct Target {
    BodyId body;             ///< body of the part
    std::uint32_t part = 0;  ///< index in the body's type
    Pose pose_world_part;    ///< with every joint at rest
  };

  FixedTargets() = default;
  /// Collects the marked parts (Returns::fiducial) of all bodies for which is_fixed returns true.
  FixedTargets(const WorldSpec& spec, const std::function<bool(BodyId)>& is_fixed);

  /// Calls visit(target) for all targets whose origin lies in the box. May visit a target more than once, and
  /// others near the box too.
  template <class Visit>
  void for_each_near(const Box& box, Visit&& visit) const {
    places_.any_near(box, [&](std::uint32_t i) {
      visit(targets_[i]);
      return false;
    });
  }

 private:
  std::vector<Target> targets_;
  partition::BoxGrid places_;
};

}  // namespace troupe::engine
