#pragma once

namespace troupe::engine {

/// What is known of the surroundings of a body: it saves time in the resolution of conflicts
/// (engine/conflicts/conflicts.hpp) and changes no outcome. Default-constructed: nothing is known. It must be
/// replaced by FreeCircle() when other code than the resolution sets the pose of the body, or when the shape
/// of the body changes.
struct FreeCircle {
  float x = 0;  ///< x of the centre of a circle that no edge of a static obstacle (a wall or another body
                ///< that never moves) enters, whatever the height of the edge; world frame, m
  float y = 0;  ///< y of its centre
  float radius = 0;  ///< its radius; 0: no circle is known, and the body may overlap the static scene
  /// False: the body overlaps no body that had the value false as well.
  bool may_overlap = true;
};

}  // namespace troupe::engine
