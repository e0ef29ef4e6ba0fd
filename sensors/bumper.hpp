#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// Fields of a bumper's percepts, in their order.
enum BumperField : std::size_t {
  k_bumper_hit,   ///< u8 each: 1 where something touches that bumper
  k_bumper_body,  ///< u32 each: BodyId of what does, 0 (the ground) where nothing does
};

/// Contact strips: each is a straight line across its pose's heading, and feels any body of another robot or
/// of the scene whose outline comes as near as its thickness, whatever the heights.
/// ties    of several the nearest, then the lower body
/// source  Stage's bumper model, whose strips are as thick as its cells, 0.02 m: a strip without thickness
///         would cross no wall that it meets flat
engine::DeviceKind bumper_kind();

}  // namespace troupe::sensors
