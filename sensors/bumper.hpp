#pragma once

#include "engine/kinds/device_kind.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of the readings of a bumper, in order. Each field is an array with one entry per contact strip
/// (see bumper_kind()). Each comment begins with the type of the entries.
enum BumperField : std::size_t {
  k_bumper_hit,   ///< u8 per strip: 1 if a body or wall touches the strip, else 0
  k_bumper_body,  ///< u32 per strip: number (BodyId) of the body that touches the strip; 0: none
  /// u32 per strip: number of the body that crashed into the strip since the last reading, plus 1; 0: none.
  /// Only with BumperParams::crashes.
  k_bumper_crash,
};

/// Returns the implementation of the sensor `bumper`, which has one or more contact strips. A strip is a
/// horizontal line segment. The parameter `bumpers` gives a length and a pose for each strip: the position is
/// the middle of the segment, and the heading is perpendicular to the segment. A strip detects a wall or body
/// if, seen from above, the distance between the segment and an outline of the wall or body is at most
/// `thickness` (a parameter, m). The heights of the strip and of the body make no difference. A strip ignores
/// its own robot and all bodies that move together with this robot (one of the two carries the other, or a
/// third body carries both).
/// ties    If several bodies touch a strip, the nearest is reported. If two are at the same distance, the one
///         with the lower id is reported.
/// source  Stage's bumper model. The strips of that model are as thick as a cell of its grid, 0.02 m.
engine::DeviceKind bumper_kind();

}  // namespace troupe::sensors
