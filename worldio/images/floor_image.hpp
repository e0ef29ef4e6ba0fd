#pragma once

#include "base/diagnostics.hpp"
#include "base/geometry.hpp"
#include "base/pose.hpp"
#include "engine/spec/world_spec.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// The outlines of an image of walls. If the image belongs to a ROS map (a floor plan in the format of ROS's
/// map_server), its size in m and its pose in the frame of the map are also stored.
struct FloorImage {
  int width = 0;   ///< width, pixels
  int height = 0;  ///< height, pixels
  /// Outlines in pixels, +y up: x is from 0 to width, y from -height to 0.
  std::vector<Ring> contours;

  /// The size and place of a ROS map (worldio/images/ros_map.hpp).
  struct Place {
    Eigen::Vector2d size_m;  ///< size of the whole image in x and y
    Pose pose_map_center;    ///< pose of the image's centre in the frame of the map
    /// The map was read with `unknown_is_solid`, but none of its cells is unknown.
    bool lacks_unknown = false;
  };
  std::optional<Place> place;  ///< set if the image is a ROS map

  /// Returns the walls of the image as one solid from z = 0 to z = size.z. The solid is scaled so that the
  /// whole image, margins included, fills `size` (m) and is centred on the origin in x and y.
  Solid solid(const Eigen::Vector3d& size) const;
};

/// Returns the solids (extruded outlines) of a floor plan, a body that consists of walls, in its own frame.
/// The solids stand on z = 0. They are scaled so that a region of the image fills `size` (m) and is centred
/// on the origin in x and y. This region is the bounding box of the solid pixels, or the whole image if
/// spec.keeps_margins is set. With spec.boundary, four walls just inside the edges of `size` are added. The
/// solids of a ROS map are not fitted to `size`: the map determines their pose and their size in x and y, and
/// their frame is that of the map. The function then sets size.x and size.y to the size of the map; size.z is
/// the height of the walls.
std::vector<Solid> floor_plan_body(const FloorImage& image, const engine::ImageSpec& spec,
                                   Eigen::Vector3d& size);
/// Like floor_plan_body(), but for a body or part that is not a floor plan. All solids, including those of
/// the boundary, are scaled to `size` a second time, which may change the last bits of their coordinates.
/// Stage, an older robot simulator whose files Troupe reads, does the same. The solids of a ROS map are not
/// scaled a second time.
std::vector<Solid> image_body(const FloorImage& image, const engine::ImageSpec& spec, Eigen::Vector3d& size);

/// Reads the images of one world. It reads each file only once for each value of `unknown_is_solid`.
class FloorImages {
 public:
  explicit FloorImages(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// Reads an image, or a ROS map if the name of `file` ends in `.yaml` or `.yml`. `unknown_is_solid` says
  /// whether the unknown cells of a map are solid; for other images it has no effect. Returns null if the
  /// file, or the image that a map names, cannot be read or has errors. A failure adds an error at `where`,
  /// the place (file and line) of the file's name in the world file, or at a line of the YAML file. A
  /// repeated call with the same `file` and `unknown_is_solid` adds no further error. An image without solid
  /// pixels is not an error: its `contours` are empty. The result is valid until this object is destroyed.
  const FloorImage* read(const std::filesystem::path& file, bool unknown_is_solid, Where where);

 private:
  Diagnostics& diagnostics_;
  std::map<std::pair<std::string, bool>, std::optional<FloorImage>> images_;
};

}  // namespace troupe::worldio
