#pragma once

#include "engine/spec/world_spec.hpp"
#include "partition/box_grid.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace troupe::engine {

/// A spatial index of the marked parts of static bodies, which do not move during a run. A marked part is a
/// part that fiducial finders (sensors for markers) detect. The index finds a part by the position of its
/// origin.
class FixedTargets {
 public:
  /// A part that fiducial finders detect (Returns::fiducial is not 0).
  struct Target {
    BodyId body;             ///< body of the part
    std::uint32_t part = 0;  ///< index of the part in the body's type
    Pose pose_world_part;    ///< pose of the part's frame with every joint at rest, world frame
  };

  FixedTargets() = default;  ///< an index without targets
  /// Collects the marked parts of those bodies of `spec` (the description of a world) for which
  /// is_fixed(body) is true. The bodies have their poses at the beginning of a run. Does not keep references
  /// to its arguments.
  FixedTargets(const WorldSpec& spec, const std::function<bool(BodyId)>& is_fixed);

  /// Calls visit(const Target&) for all targets whose origin lies in the box or on its edge (world frame, m),
  /// and possibly for other targets. A target may be visited more than once. The order depends only on the
  /// targets and the box.
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
