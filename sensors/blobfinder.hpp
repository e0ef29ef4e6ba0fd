#pragma once

#include "base/color.hpp"
#include "engine/kinds/device_kind.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of the readings of a blob finder, in order. blobfinder_kind() explains blobs. Each comment
/// begins with the type of the field; u32 is an unsigned 32-bit integer. A field "per blob" is an array of
/// `most_blobs` entries, one for each blob, from the rightmost blob to the leftmost. Entries after the last
/// blob are 0. Columns and rows of the image are counted in pixels, from 0 at the upper left corner. Words in
/// backquotes are parameters of the sensor.
enum BlobField : std::size_t {
  k_blob_count,   ///< u32: number of reported blobs; may exceed `most_blobs`, the number of entries
  k_blob_left,    ///< i32 per blob: leftmost column
  k_blob_right,   ///< i32 per blob: rightmost column, inclusive
  k_blob_top,     ///< i32 per blob: top row
  k_blob_bottom,  ///< i32 per blob: bottom row; `image_height` if the blob reaches below the image
  k_blob_range,   ///< f32 per blob, m: mean length of the rays of its columns, up to the body
  k_blob_color,   ///< u8 [red green blue opacity] per blob, each from 0 to 255
};

/// Returns the implementation of the sensor `blobfinder`, which reports blobs in the image of a camera. A
/// blob is a run of neighbouring image columns that show the same colour. Words in backquotes are parameters
/// of the sensor.
/// rays    The sensor casts one horizontal ray of length `range` per column. The axis of view is the heading
///         of the sensor plus `pan`. Column 0 looks fov/2 to the left of the axis of view, and the last
///         column fov/2 to the right. The angle between neighbouring columns is always the same. If the image
///         has only one column, it looks along the axis of view.
/// hits    A column shows the colour of the first wall or body that its ray hits. The heights of the sensor
///         and of the body make no difference. Rays pass through the robot that has the sensor, and through
///         all bodies that move together with this robot (one of the two carries the other, or a third body
///         carries both).
/// same    Two colours are the same if their red, green and blue values (from 0 to 1) each differ by less
///         than 1e-5. Opacity is ignored.
/// omits   If `colors` is not empty, only blobs with one of these colours are reported. If `use_blob_return`
///         is true, a body whose own parameter blob_return is false is not reported, but it hides the bodies
///         behind it.
/// rows    The top and the bottom row of a blob are computed as if every body were 0.6 m tall, the sensor
///         were at half this height, and a row covered a vertical angle of fov / `image_height`.
/// source  Stage's blobfinder model. Unlike that model, this sensor does not skip a column after each blob.
engine::DeviceKind blobfinder_kind();

/// Whether a blob finder takes two colours for the same.
bool is_same_color(const Color& a, const Color& b);

}  // namespace troupe::sensors
