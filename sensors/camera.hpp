#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// Fields of a camera's percepts, in their order: pixels row by row from the upper left corner.
enum CameraField : std::size_t {
  k_camera_color,  ///< u8 [red green blue opacity] each
  k_camera_depth,  ///< f32 each, m along the axis of view: range_far where nothing is seen
};

/// A camera: colour and depth of what stands in its field of view, without a graphics library.
/// sees    bodies of other robots and of the scene as the extruded blocks they are, with their tops and
///         undersides, and the floor at z = 0; unlit, each in its own colour. What is nearer than range_near
///         is cut away, what is farther than range_far is sky.
/// pixels  of a pinhole camera: each the colour of one ray through its middle
/// ties    of two surfaces at one depth the lower (body, solid)
/// edges   a plate that the camera is above is not seen where all of its outline is out of the field of view
/// cost    an edge is looked at for the columns that it spans; of a tilted camera for every pixel
/// source  Stage's camera model, which needs a window; its pitch is `tilt` here
engine::DeviceKind camera_kind();

}  // namespace troupe::sensors
