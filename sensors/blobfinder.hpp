#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// The fields of a blob finder's percepts, in order. Blobs are listed from right to left; entries after the
/// last blob are 0. Columns and rows count from the upper left corner of the image.
enum BlobField : std::size_t {
  k_blob_count,   ///< u32: number of blobs in sight, which may exceed the number of entries
  k_blob_left,    ///< i32 per blob: first column
  k_blob_right,   ///< i32 per blob: last column, inclusive
  k_blob_top,     ///< i32 per blob: top row
  k_blob_bottom,  ///< i32 per blob: bottom row
  k_blob_range,   ///< f32 per blob, m: mean distance over its columns
  k_blob_color,   ///< u8 [red green blue opacity] per blob
};

/// A blob finder: reports the stretches of one colour that a camera with few columns would see.
/// sees    One ray per column, of length `range`, at equal angles from -fov/2 to +fov/2 about heading and pan
///         (a single column: straight ahead). It ends at the first body of another robot or of the scene,
///         whatever the heights. Neighbouring columns of one colour form a blob.
/// rows    are computed as if all bodies were 0.6 m tall and seen from the middle of their height
/// source  Stage's blobfinder model, which skips a column after each blob and compares colours to 1e-5. Here
///         no column is skipped, and a model without blob_return is not a blob, but hides others
engine::DeviceKind blobfinder_kind();

}  // namespace troupe::sensors
