#pragma once

#include "engine/kinds/device_kind.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of the readings of a camera, in order. Each field is an array with one entry per pixel. Each
/// comment begins with the type of the entries. Pixels are stored row by row from the upper left corner, and
/// from left to right in each row.
enum CameraField : std::size_t {
  k_camera_color,  ///< u8 [red green blue opacity] per pixel, each from 0 to 255
  k_camera_depth,  ///< f32 per pixel: depth, m along the axis of view; range_far (a parameter) for sky
};

/// Returns the implementation of the sensor `camera`, which renders images of its field of view: colour and
/// depth. It needs no graphics library. range_near, range_far and tilt are parameters of the camera.
/// shows   An image shows walls and bodies as extruded polygons (solids) with tops and undersides, and the
///         floor at z = 0. There is no light or shadow: a surface has the same colour from all sides.
/// inside  A camera inside a solid sees the sides of the solid from inside. It sees through the top and the
///         underside.
/// omits   The image does not show the camera's own robot, nor bodies that move together with this robot (one
///         of the two carries the other, or a third body carries both). Surfaces at a depth of less than
///         range_near are not drawn. A pixel that shows no surface up to the depth range_far shows sky.
/// pixels  The camera is a pinhole camera: a pixel shows what a ray through its middle hits first.
/// ties    If surfaces of two bodies are at the same depth, the body with the lower id is drawn. If they
///         belong to one body, the solid that comes first in the body type is drawn. If a body and the floor
///         are at the same depth, the body is drawn.
/// cost    A camera with a tilt of 0 is faster: it intersects outlines with rays once per column of pixels. A
///         camera with any other tilt does this once per pixel.
/// source  Stage's camera model, whose parameter `pitch` is called `tilt` here. Stage's model works only in a
///         program with a window; this sensor needs none.
engine::DeviceKind camera_kind();

}  // namespace troupe::sensors
