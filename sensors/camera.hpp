#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a camera's readings, in order. Each field is an array with one entry per pixel; its comment
/// begins with the type of the entries. Pixels are stored row by row from the upper left corner; each row
/// goes from left to right.
enum CameraField : std::size_t {
  k_camera_color,  ///< u8 [red green blue opacity] per pixel, each from 0 to 255
  /// F32 per pixel, m along the axis of view; range_far (the farthest visible depth) if the pixel shows sky
  k_camera_depth,
};

/// Returns the implementation of the sensor `camera`, which renders colour and depth of its field of view
/// without a graphics library. Words such as range_near are parameters of the camera.
/// sees    A picture shows walls and bodies as extruded blocks (solids) with tops and undersides, and the
///         floor at z = 0. It does not show the camera's own robot, nor bodies that move with this robot (one
///         carries the other, or a third body carries both). There is no light or shadow: each body has its
///         own colour. Surfaces nearer than range_near are not drawn; beyond range_far the picture shows sky.
/// pixels  The camera is a pinhole camera: each pixel shows the colour along one ray through its middle.
/// ties    Of two surfaces at the same depth, the surface of the body with the lower id is drawn; within one
///         body, the surface of the block that comes first in the body type. A body at the depth of the floor
///         hides the floor.
/// cost    A level camera tests an edge of a block only in the columns of pixels that the edge spans. A
///         tilted camera tests the edge in every pixel.
/// source  Stage's camera model, which needs a window; its `pitch` is called `tilt` here.
engine::DeviceKind camera_kind();

}  // namespace troupe::sensors
