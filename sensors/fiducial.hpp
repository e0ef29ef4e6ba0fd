#pragma once

#include "engine/kinds/device_kind.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of the readings of a fiducial finder, in order. Each comment begins with the type of the field.
/// A target is a model (a body or a part of a body) that the finder finds: see fiducial_kind(). A field "per
/// target" is an array of `most_targets` (a parameter) entries. The entries list the nearest targets, sorted
/// by range. Targets at the same range are sorted by body id, and targets of one body by the number of the
/// part. Entries after the last target are 0. Angles are from -pi to pi, rounded to f32.
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

/// Returns the implementation of the sensor `fiducial`, a finder that reports the poses and marker numbers of
/// models in sight. A model is a body or a part of a body. A model has a marker number, its parameter
/// fiducial_return, and a key, its parameter fiducial_key. Words in backquotes are parameters of the finder.
/// finds   The finder finds a model if all these conditions hold. The marker number of the model is not 0.
///         The key of the model equals the finder's `key`. The horizontal distance to the origin of the model
///         is less than `range_max`. If `apply_range_min` is true, this distance is at least `range_min`. The
///         bearing of the origin, relative to the heading of the finder, is from -fov/2 to fov/2. The model
///         belongs neither to the finder's own body nor to a body that moves together with it (one of the two
///         carries the other, or a third body carries both). The model is in sight.
/// sight   A model is in sight if a horizontal ray from the finder towards the model's origin hits the model
///         before anything else. Walls, other bodies and other parts of the model's body stop the ray, even
///         if range sensors do not detect them.
/// z       If `ignore_zloc` is true, models that are wholly above or below the ray are also found. Such a
///         model is in sight if the ray hits no surface that is nearer than the model's origin.
/// edges   A model whose origin is at a distance of exactly `range_max` is not found. A model whose origin is
///         at a bearing of exactly fov/2 is found. If the origin is at the position of the finder, the
///         bearing is 0.
/// source  Stage's fiducial model. In Stage, with ignore_zloc, a body behind a target may hide the target;
///         here it does not.
engine::DeviceKind fiducial_kind();

}  // namespace troupe::sensors
