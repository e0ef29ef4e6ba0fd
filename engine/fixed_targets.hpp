#pragma once

#include "engine/world_spec.hpp"
#include "partition/box_grid.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace troupe::engine {

/// Parts of bodies that never move and that fiducial finders find, by where they stand.
class FixedTargets {
 public:
  struct Target {
    BodyId body;
    std::uint32_t part = 0;
    Pose pose_world_part;
  };

  FixedTargets() = default;
  FixedTargets(const WorldSpec& spec, const std::function<bool(BodyId)>& is_fixed);

  /// visit(target) for those whose origin lies in the box, each once or more, and perhaps some that do not.
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
