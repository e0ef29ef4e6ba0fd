#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// Fields of a fiducial finder's percepts, in their order: entries of the arrays are the nearest targets, by
/// range, then body, then part; those behind the last target are 0.
enum FiducialField : std::size_t {
  k_fiducial_count,    ///< u32: targets in sight, which may be more than there are entries
  k_fiducial_id,       ///< i32 each: the target's fiducial_return; 0 where it is too far to be read
  k_fiducial_body,     ///< u32 each: BodyId of the target
  k_fiducial_range,    ///< f32 each, m: to the target's origin, on the ground
  k_fiducial_bearing,  ///< f32 each, rad: of the target's origin, sensor frame
  k_fiducial_heading,  ///< f32 each, rad: the target's, sensor frame
  k_fiducial_size,     ///< f32 [x y z] each, m: as declared
  k_fiducial_pose,     ///< f64 [x y z heading] each, m and rad: the target's, world frame
};

/// A fiducial finder: which marked models (fiducial_return other than 0) are in sight, and where.
/// finds   models of other robots and of the scene with its key whose origin is nearer than range_max and
///         within fov, when the first surface along the ray towards that origin, at the finder's height, is
///         the model's own. Every body stops the ray, also one that rangers see through.
/// z       with ignore_zloc a model that the ray passes above or below is found too, unless something stands
///         before it
/// edges   a model at exactly range_max is not found, one at exactly fov/2 is
/// source  Stage's fiducial model, which lets what stands behind a target hide it from ignore_zloc; here it
///         does not
engine::DeviceKind fiducial_kind();

}  // namespace troupe::sensors
