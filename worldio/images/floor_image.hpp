#pragma once

#include "base/diagnostics.hpp"
#include "base/geometry.hpp"
#include "base/pose.hpp"
#include "engine/spec/world_spec.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// The outlines of an image of walls. The image may belong to a ROS map: a floor plan in the format of ROS's
/// map_server, with cells (pixels) that are occupied, free or unknown. For a ROS map, the size in m and the
/// pose in the frame of the map are also stored.
struct FloorImage {
  int width = 0;   ///< width, pixels
  int height = 0;  ///< height, pixels
  /// Outlines in pixels, +y up: x is from 0 to width, y from -height to 0.
  std::vector<Ring> contours;

  /// The size and pose of a ROS map (worldio/images/ros_map.hpp).
  struct Place {
    Eigen::Vector2d size_m;  ///< size of the whole image in x and y
    Pose pose_map_center;    ///< pose of the image's centre in the frame of the map
    /// True: the map was read with the option that unknown cells are solid, but the map has no unknown cell.
    /// The option then has no effect.
    bool lacks_unknown = false;
  };
  std::optional<Place> place;  ///< set if the image is a ROS map

  /// Returns the text of the warning about an image or a map without solid pixels, that is, without
  /// `contours`.
  std::string unsolid_text(const engine::ImageSpec& spec) const;

  /// Returns the text of a warning about the free pixels at the edges of the image `file`, which are cut off
  /// if its margins are not kept: how many rows and columns, and by what factor the walls grow. Empty without
  /// such pixels, without solid pixels, and for a ROS map. keep: the property or key that keeps the margins
  std::string margins_text(const std::string& file, std::string_view keep) const;

  /// Returns the walls of the image as one solid (an extruded outline) from z = 0 to z = size.z. The whole
  /// image, with the free pixels at its edges, is scaled to the x and y of `size` (m) and centred on the
  /// origin.
  Solid solid(const Eigen::Vector3d& size) const;
};

/// Returns the solids (extruded outlines) of a floor plan, a body that consists of walls, in the frame of the
/// body. The walls stand on z = 0 and have the height size.z (m).
/// - For an image that is not a ROS map, a region of the image is scaled to the x and y of `size` and centred
///   on the origin. The region is the whole image if spec.keeps_margins is set, else the bounding box of the
///   solid pixels.
/// - For a ROS map, the frame of the body is the frame of the map. The map determines pose and size of the
///   walls in x and y. The function sets size.x and size.y to the size of the map.
///
/// An image without solid pixels has no walls. If spec.boundary is set, the result contains four more walls,
/// just inside the edges of the scaled region or of the map.
std::vector<Solid> floor_plan_body(const FloorImage& image, const engine::ImageSpec& spec,
                                   Eigen::Vector3d& size);
/// Like floor_plan_body(), but for a body or part that is not a floor plan. For an image that is not a ROS
/// map, the solids of floor_plan_body() are scaled to `size` once more, as in Stage (an older robot simulator
/// whose files Troupe reads). This may change the last bits of their coordinates.
std::vector<Solid> image_body(const FloorImage& image, const engine::ImageSpec& spec, Eigen::Vector3d& size);

/// Reads the images of one world. Each file is read only once, or twice if read() is called with both values
/// of `unknown_is_solid`.
class FloorImages {
 public:
  explicit FloorImages(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// Reads an image, or a ROS map if the name of `file` ends in `.yaml` or `.yml`. `unknown_is_solid` says
  /// whether the unknown cells of a map are solid; for other images it has no effect. An image without solid
  /// pixels has no `contours`; this is not an error. The result is valid until this object is destroyed.
  ///
  /// Returns null if the file, or the image that a map names, cannot be read or has errors. The first call
  /// with these arguments also adds an error to the diagnostics. An error in the content of a map has its
  /// place in the YAML file. Any other error is reported at `where`, the place (file and line) of the file's
  /// name in the world file.
  const FloorImage* read(const std::filesystem::path& file, bool unknown_is_solid, Where where);

 private:
  Diagnostics& diagnostics_;
  std::map<std::pair<std::string, bool>, std::optional<FloorImage>> images_;
};

}  // namespace troupe::worldio
