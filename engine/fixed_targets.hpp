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
  /// One such part.
  struct Target {
    BodyId body;             ///< whose it is
    std::uint32_t part = 0;  ///< of the body's type
    Pose pose_world_part;    ///< with every joint at rest
  };

  FixedTargets() = default;
  /// Takes the marked parts (Returns::fiducial) of all bodies for which is_fixed says so.
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
