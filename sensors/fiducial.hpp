#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a fiducial finder's readings, in order. Each comment begins with the type of the field. A
/// target is a marked body, or a marked part of a body, that the finder finds, see fiducial_kind(). Fields
/// per target are arrays with `most_targets` (a parameter) entries, one for each of the nearest targets,
/// sorted by range, then body id, then number of the part. Entries after the last target are 0. Angles are in
/// [-pi, pi] before they are rounded to f32.
enum FiducialField : std::size_t {
  k_fiducial_count,    ///< u32: number of targets found; may exceed `most_targets`
  k_fiducial_id,       ///< i32 per target: its marker number; 0 if it is at least range_max_id (m) away
  k_fiducial_body,     ///< u32 per target: number (BodyId) of its body
  k_fiducial_range,    ///< f32 per target, m: horizontal distance to its origin
  k_fiducial_bearing,  ///< f32 per target, rad: bearing of its origin, sensor frame
  k_fiducial_heading,  ///< f32 per target, rad: its heading, sensor frame
  k_fiducial_size,     ///< f32 [x y z] per target, m: its size as the world declares it
  k_fiducial_pose,     ///< f64 [x y z heading] per target, m and rad: its pose, world frame
};

/// Returns the implementation of the sensor `fiducial`, a finder that reports marked models in sight and
/// their poses. A model is a body or a part of a body. It is marked if its marker number, the parameter
/// fiducial_return, is not 0.
/// finds   The finder finds models of other bodies, but not of bodies that move with its own body (one
///         carries the other, or a third body carries both). The model must have the finder's `key` as
///         fiducial_key, and its origin must be nearer than range_max and within fov. With apply_range_min,
///         the origin must also be at least range_min away. The model must be in sight: a ray from the finder
///         towards the model's origin, at the height of the finder, must meet the model first. Walls, all
///         other bodies, and the other parts of the model's body stop this ray, even if range sensors do not
///         see them.
/// z       With the parameter ignore_zloc, the finder also finds a model that the ray passes above or below,
///         if the ray meets no other surface that is nearer than the model's origin.
/// edges   A model whose origin is at exactly range_max is not found; a model whose origin is at a bearing of
///         exactly fov/2 is found. A model whose origin is at the position of the finder has the bearing 0.
/// source  Stage's fiducial model. There, with ignore_zloc, a body behind a target may hide the target; here
///         it does not.
engine::DeviceKind fiducial_kind();

}  // namespace troupe::sensors
