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
/// and the thresholds that decide which cells (pixels) are occupied or free.
///
/// source  the documentation of map_server, https://wiki.ros.org/map_server, and of Nav2's map server
struct RosMap {
  enum class Mode { trinary, scale, raw };

  std::filesystem::path image;    ///< path of the image; relative paths are made relative to the YAML file
  Where where_image;              ///< line of the key `image`
  double resolution_m = 0;        ///< edge length of a cell
  Pose pose_map_corner;           ///< `origin`: pose of the lower left corner of the image, map frame
  double occupied_thresh = 0.65;  ///< cells with a greater probability of occupancy are solid
  double free_thresh = 0.196;     ///< cells with a smaller probability of occupancy are free
  bool negate = false;            ///< whether light cells are occupied, instead of dark cells
  Mode mode = Mode::trinary;
};

/// Whether a file is a ROS map, by its extension: .yaml or .yml.
bool is_ros_map(const std::filesystem::path& file);

/// Reads the YAML file of a ROS map. If it has errors, returns nothing and adds them at their lines, or one
/// error at `where` if the file cannot be read. Unknown keys cause warnings.
std::optional<RosMap> read_ros_map(const std::filesystem::path& file, Where where, Diagnostics& diagnostics);
/// Like read_ros_map(), but reads the content of the YAML file from `text`. `file` is its name in messages
/// and the base of the path of the image.
std::optional<RosMap> parse_ros_map(const std::filesystem::path& file, std::string_view text,
                                    Diagnostics& diagnostics);

/// Returns the rule that decides which pixels of a map are solid. Every cell is solid, unknown or free;
/// unknown cells are solid if `unknown_is_solid`. Let l be the lightness of a pixel, the mean of its colours
/// from 0 to 1. The probability that its cell is occupied is p = 1 - l, or p = l if `negate` is set. The mode
/// of the map decides:
///
/// trinary  p above occupied_thresh is solid, p below free_thresh is free, values between them are unknown
/// scale    Pixels that are not opaque are unknown. Other pixels are solid if p is above occupied_thresh,
///          else free.
/// raw      The value of the pixel, 0 to 255, is the probability in percent, and `negate` has no effect.
///          Values above 100 are unknown. Other values are solid if above occupied_thresh, else free.
PixelRule solid_cells(const RosMap& map, bool unknown_is_solid);

}  // namespace troupe::worldio
