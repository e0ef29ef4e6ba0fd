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
  /// How pixel values decide which cells are occupied, unknown or free: see solid_cells().
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

/// Reads the YAML file of a ROS map, but not its image. Returns nothing, and adds errors to `diagnostics`, if
/// the file cannot be read, has more than 64 KiB or has errors. `where` is the place (file and line) of the
/// file's name in the world file; the error that the file cannot be read is reported there. Every other error
/// is reported at its line in the YAML file; an error about a missing key or about the whole file has no
/// line.
///
/// In a file without errors, an unknown key is a warning. In a file with errors, an unknown key is an error,
/// because it may be the misspelt name of a missing key.
std::optional<RosMap> read_ros_map(const std::filesystem::path& file, Where where, Diagnostics& diagnostics);
/// Like read_ros_map(), but reads `text`, the content of the YAML file. `file` is the path of the YAML file,
/// which messages state. A relative path of the image is relative to the folder of `file`.
std::optional<RosMap> parse_ros_map(const std::filesystem::path& file, std::string_view text,
                                    Diagnostics& diagnostics);

/// Returns the rule that decides which pixels of a map are solid. Each cell (pixel) of a map is occupied,
/// unknown or free. Occupied cells are solid. Unknown cells are solid if `unknown_is_solid` is true.
///
/// Let v be the mean of the colour channels of the pixel, from 0 to 255. Let p be the probability that the
/// cell is occupied. In the modes trinary and scale, p = 1 - v / 255, or p = v / 255 if `negate` is set. In
/// the mode raw, p = v / 100, and `negate` has no effect. The mode of the map decides:
///
/// trinary  The cell is occupied if p is above occupied_thresh, free if p is below free_thresh, else unknown.
/// scale    The cell is unknown if the pixel is not opaque. Else it is occupied if p is above
///          occupied_thresh. Else it is free.
/// raw      The cell is unknown if v is above 100. Else it is occupied if p is above occupied_thresh. Else it
///          is free.
PixelRule solid_cells(const RosMap& map, bool unknown_is_solid);

}  // namespace troupe::worldio
