#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a fiducial finder's percepts, in order. The entries of arrays are the nearest targets,
/// sorted by range, then body, then part; entries after the last target are 0.
enum FiducialField : std::size_t {
  k_fiducial_count,    ///< u32: number of targets in sight, which may exceed the number of entries
  k_fiducial_id,       ///< i32 per target: its fiducial_return; 0 if it is too far away to read
  k_fiducial_body,     ///< u32 per target: its BodyId
  k_fiducial_range,    ///< f32 per target, m: distance to its origin, on the ground
  k_fiducial_bearing,  ///< f32 per target, rad: bearing of its origin, sensor frame
  k_fiducial_heading,  ///< f32 per target, rad: its heading, sensor frame
  k_fiducial_size,     ///< f32 [x y z] per target, m: its declared size
  k_fiducial_pose,     ///< f64 [x y z heading] per target, m and rad: its pose, world frame
};

/// A fiducial finder: finds the marked models (fiducial_return other than 0) in sight, and their poses.
/// finds   Models of other robots and of the scene that have its key and whose origin is nearer than
///         range_max and within fov, if the first surface along the ray towards the origin, at the finder's
///         height, is that of the model itself. Every body stops the ray, even if rangers do not see it.
/// z       with ignore_zloc it also finds a model that the ray passes above or below, unless another body is
///         in front of it
/// edges   a model at exactly range_max is not found, one at exactly fov/2 is
/// source  Stage's fiducial model, in which a body behind a target may hide it with ignore_zloc; not so here
engine::DeviceKind fiducial_kind();

}  // namespace troupe::sensors
