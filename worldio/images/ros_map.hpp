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
  /// How pixel values decide which cells are solid, unknown or free: see solid_cells().
  enum class Mode { trinary, scale, raw };

  std::filesystem::path image;    ///< path of the image, joined with the folder of the YAML file
  Where where_image;              ///< place (file and line) of the value of `image` in the YAML file
  double resolution_m = 0;        ///< edge length of a cell, m
  Where where_resolution;         ///< place (file and line) of the value of `resolution` in the YAML file
  Pose pose_map_corner;           ///< `origin` of the file: pose of the image's lower left corner, map frame
  double occupied_thresh = 0.65;  ///< cells with a greater probability of occupancy are solid
  double free_thresh = 0.196;     ///< mode trinary: cells with a smaller probability of occupancy are free
  bool negate = false;            ///< whether light cells are occupied, instead of dark cells
  Mode mode = Mode::trinary;      ///< meaning of the pixel values
};

/// Whether a file is a ROS map, judged only by the extension of its name: .yaml or .yml, in lower case.
bool is_ros_map(const std::filesystem::path& file);

/// Reads the YAML file of a ROS map, but not its image. If the file has errors, returns nothing and adds the
/// errors at their lines; an error about a missing key, or about the whole file, has no line. If the file
/// cannot be read, returns nothing and adds an error at `where`, the place of the file's name in the world
/// file. Each unknown key adds a warning. If the file also has an error, each unknown key adds an error
/// instead, because it may be a misspelt known key. A file of more than 64 KiB is an error.
std::optional<RosMap> read_ros_map(const std::filesystem::path& file, Where where, Diagnostics& diagnostics);
/// Like read_ros_map(), but reads `text`, the content of the YAML file. `file` is the path of this file in
/// messages. A relative path of the image is relative to its folder.
std::optional<RosMap> parse_ros_map(const std::filesystem::path& file, std::string_view text,
                                    Diagnostics& diagnostics);

/// Returns the rule that decides which pixels of a map are solid. A cell (pixel) is occupied, unknown or
/// free. Occupied cells are solid; unknown cells are solid if `unknown_is_solid` is true. Let l be the
/// lightness of a pixel: the mean of its colour channels, from 0 to 1. The probability that the cell is
/// occupied is p = 1 - l, or p = l if `negate` is set. The mode of the map decides:
///
/// trinary  A cell is occupied if p is above occupied_thresh, free if p is below free_thresh, else unknown.
/// scale    Pixels that are not opaque are unknown. Other cells are occupied if p is above occupied_thresh,
///          else free.
/// raw      The mean of the colour channels of the pixel, 0 to 255, is the probability in percent, and
///          `negate` has no effect. Values above 100 are unknown. Other cells are occupied if the probability
///          is above occupied_thresh, else free.
PixelRule solid_cells(const RosMap& map, bool unknown_is_solid);

}  // namespace troupe::worldio
