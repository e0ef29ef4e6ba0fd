#pragma once

#include "engine/conflicts/conflicts.hpp"
#include "engine/kinds/collision.hpp"
#include "partition/static_scene.hpp"

#include <cstdint>

namespace troupe::engine {

/// What a Collision refers to: a motion with a sample in Crowd::blocks.
struct Collision::Sides {
  const Conflicts::Crowd& crowd;        ///< bodies and motions of the tick
  const partition::StaticScene& scene;  ///< the bodies that never move
  std::uint32_t mover;                  ///< row of the mover
  std::uint32_t blocker;  ///< row of the body that blocked it; the value of an invalid Row if it is static
  bool feels_as_mover;    ///< whether the device is on the mover, or on the body in its way
};

}  // namespace troupe::engine
