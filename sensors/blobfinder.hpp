#pragma once

#include "engine/kinds.hpp"

#include <cstddef>

namespace troupe::sensors {

/// Fields of a blob finder's percepts, in their order: blobs follow one another from right to left; entries
/// behind the last are 0. Columns and rows count from the image's upper left corner.
enum BlobField : std::size_t {
  k_blob_count,   ///< u32: blobs in sight, which may be more than there are entries
  k_blob_left,    ///< i32 each, column
  k_blob_right,   ///< i32 each, column, included
  k_blob_top,     ///< i32 each, row
  k_blob_bottom,  ///< i32 each, row
  k_blob_range,   ///< f32 each, m: the mean over its columns
  k_blob_color,   ///< u8 [red green blue opacity] each
};

/// A blob finder: which stretches of one colour a camera of few columns would see.
/// sees    a ray a column at equal angles from -fov/2 to +fov/2 about its heading and pan (one column:
///         straight ahead), as long as `range`, ends at the first body of another robot or of the scene,
///         whatever the heights. Neighbouring columns of one colour are one blob.
/// rows    as if all bodies were 0.6 m tall, seen from the middle of their height
/// source  Stage's blobfinder model, which skips a column after each blob, and whose colours may be compared
///         to 1e-5; here no column is lost, and what has no blob_return hides but is no blob
engine::DeviceKind blobfinder_kind();

}  // namespace troupe::sensors
