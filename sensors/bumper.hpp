#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a bumper's readings, in order. Each field is an array with one entry per strip (see
/// bumper_kind()); its comment begins with the type of the entries.
enum BumperField : std::size_t {
  k_bumper_hit,   ///< u8 per strip: 1 if a body or wall touches the strip, else 0
  k_bumper_body,  ///< u32 per strip: number (BodyId) of the body that touches the strip; 0: none
};

/// Returns the implementation of the sensor `bumper`, which has one or more contact strips. Each strip is a
/// horizontal line segment, centred on the position of its pose (parameter `bumpers`) and perpendicular to
/// the heading of this pose. A strip detects any wall or body whose outline comes within `thickness` (m) of
/// the segment; the heights of the strip and of the body make no difference. A strip ignores its own robot
/// and all bodies that move with this robot (one carries the other, or a third body carries both).
/// ties    If several bodies touch a strip, the nearest is reported; at equal distances, the one with the
///         lower id.
/// source  Stage's bumper model, whose strips are as thick as its cells, 0.02 m. A strip without thickness
///         would not detect a wall that it touches in parallel.
engine::DeviceKind bumper_kind();

}  // namespace troupe::sensors
