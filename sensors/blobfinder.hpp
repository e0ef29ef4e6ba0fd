#pragma once

#include "engine/kinds/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a blob finder's readings, in order. Each comment begins with the type of the field; `u32` is
/// an unsigned 32-bit integer. Fields per blob are arrays with `most_blobs` entries. Words in backquotes are
/// parameters of the sensor. Blobs are listed from right to left, and entries after the last blob are 0.
/// Columns and rows count from 0 at the upper left corner of the image.
enum BlobField : std::size_t {
  k_blob_count,   ///< u32: number of blobs with a colour in `colors` (empty: any); may exceed `most_blobs`
  k_blob_left,    ///< i32 per blob: leftmost column
  k_blob_right,   ///< i32 per blob: rightmost column, inclusive
  k_blob_top,     ///< i32 per blob: top row
  k_blob_bottom,  ///< i32 per blob: bottom row; `image_height` if the blob reaches below the image
  k_blob_range,   ///< f32 per blob, m: mean range of the rays of its columns
  k_blob_color,   ///< u8 [red green blue opacity] per blob, each from 0 to 255
};

/// Returns the implementation of the sensor `blobfinder`, which reports the blobs that a camera with few
/// columns would see. A blob is a run of neighbouring columns that show the same colour.
/// sees    The sensor casts one ray per column, of length `range`. The rays are at equal angles from -fov/2
///         to +fov/2 about the axis of view, which is the heading of the sensor plus `pan`; fov/2 is to the
///         left, in column 0. A single column looks along the axis of view. A ray ends at the first wall or
///         body; the heights of the sensor and of the body make no difference. A ray ignores the sensor's own
///         robot and all bodies that move with it (one carries the other, or a third body carries both).
/// rows    The rows of a blob are computed as if all bodies were 0.6 m tall and seen from the middle of their
///         height.
/// source  Stage's blobfinder model. That model skips a column after each blob; this sensor skips none. As in
///         Stage, colours are the same if their red, green and blue (from 0 to 1) each differ by less than
///         1e-5; opacity does not count. With the parameter use_blob_return, a body whose blob_return is
///         false is not reported, but it hides the bodies behind it.
engine::DeviceKind blobfinder_kind();

}  // namespace troupe::sensors
