#pragma once

#include "base/diagnostics.hpp"
#include "base/pose.hpp"
#include "worldio/images/bitmap.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// A floor plan as ROS's map_server keeps it: a YAML file that names an image and says how large it is, where
/// it lies, and which of its cells are occupied.
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

/// By its ending: .yaml or .yml.
bool is_ros_map(const std::filesystem::path& file);

/// Empty, with errors at their lines, or at `where` when the file cannot be read. Keys that maps do not have
/// are warnings.
std::optional<RosMap> read_ros_map(const std::filesystem::path& file, Where where, Diagnostics& diagnostics);
/// The same for the content of the file.
std::optional<RosMap> parse_ros_map(const std::filesystem::path& file, std::string_view text,
                                    Diagnostics& diagnostics);

/// Which pixels of a map are solid. With lightness l, the mean of the colours from 0 to 1, a cell is occupied
/// with probability p = 1 - l, or l where `negate` is set.
/// trinary  solid: p above occupied_thresh; unknown: from free_thresh to there; free: the rest
/// scale    solid: p above occupied_thresh; unknown: what is not opaque; free: the rest
/// raw      the pixel's value, 0 to 255, is the probability in percent: solid where it is above
///          occupied_thresh; unknown above 100; free: the rest. `negate` does not count
PixelRule solid_cells(const RosMap& map, bool unknown_is_solid);

}  // namespace troupe::worldio
