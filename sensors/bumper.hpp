#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a bumper's percepts, in order.
enum BumperField : std::size_t {
  k_bumper_hit,   ///< u8 per strip: 1 if a body touches it
  k_bumper_body,  ///< u32 per strip: BodyId of that body, 0 (the ground) if none touches it
};

/// Contact strips. Each is a line segment across the heading of its pose. It detects any body of another
/// robot or of the scene whose outline comes within the thickness, whatever the heights.
/// ties    of several bodies the nearest is reported, then the lower id
/// source  Stage's bumper model, whose strips are as thick as its cells, 0.02 m: a strip without thickness
///         would not cross a wall that it touches in parallel
engine::DeviceKind bumper_kind();

}  // namespace troupe::sensors
