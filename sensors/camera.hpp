#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a camera's percepts, in order. Pixels are stored row by row from the upper left corner.
enum CameraField : std::size_t {
  k_camera_color,  ///< u8 [red green blue opacity] per pixel
  k_camera_depth,  ///< f32 per pixel, m along the axis of view: range_far if nothing is seen
};

/// A camera: renders colour and depth of its field of view without a graphics library.
/// sees    Bodies of other robots and of the scene as extruded blocks, with their tops and undersides, and
///         the floor at z = 0; unlit, each in its own colour. Surfaces nearer than range_near are not drawn,
///         those farther than range_far are drawn as sky.
/// pixels  of a pinhole camera: each shows the colour along one ray through its middle
/// ties    of two surfaces at one depth the lower (body, solid) is drawn
/// edges   a plate below the camera is not seen if its whole outline is outside the field of view
/// cost    an edge is tested for the columns that it spans; with a tilted camera for every pixel
/// source  Stage's camera model, which needs a window; its pitch is called `tilt` here
engine::DeviceKind camera_kind();

}  // namespace troupe::sensors
