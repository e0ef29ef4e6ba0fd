#pragma once

#include "base/diagnostics.hpp"
#include "base/pose.hpp"
#include "worldio/images/bitmap.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// A floor plan in the format of ROS's map_server: a YAML file with the path of an image, its scale and pose,
/// and the thresholds that make its cells occupied or free.
/// source  the documentation of map_server and of Nav2's, https://wiki.ros.org/map_server
struct RosMap {
  enum class Mode { trinary, scale, raw };

  std::filesystem::path image;
  Where where_image;
  double resolution_m = 0;  ///< edge of a cell
  Pose pose_map_corner;     ///< of the lower left corner of the image: its `origin`
  double occupied_thresh = 0.65;
  double free_thresh = 0.196;
  bool negate = false;
  Mode mode = Mode::trinary;
};

/// Whether a file is a ROS map, by its extension: .yaml or .yml.
bool is_ros_map(const std::filesystem::path& file);

/// Reads a ROS map. Empty, with errors at their lines, or at `where` if the file cannot be read. Unknown keys
/// are warnings.
std::optional<RosMap> read_ros_map(const std::filesystem::path& file, Where where, Diagnostics& diagnostics);
/// As read_ros_map(), for the content of the file.
std::optional<RosMap> parse_ros_map(const std::filesystem::path& file, std::string_view text,
                                    Diagnostics& diagnostics);

/// Returns the rule for the solid pixels of a map. With lightness l, the mean of the colours from 0 to 1, a
/// cell is occupied with probability p = 1 - l, or l if `negate` is set.
/// trinary  solid: p above occupied_thresh; unknown: from free_thresh to there; free: the rest
/// scale    solid: p above occupied_thresh; unknown: pixels that are not opaque; free: the rest
/// raw      the pixel's value, 0 to 255, is the probability in percent: solid where it is above
///          occupied_thresh; unknown above 100; free: the rest. `negate` does not count
PixelRule solid_cells(const RosMap& map, bool unknown_is_solid);

}  // namespace troupe::worldio
