#pragma once

#include "base/diagnostics.hpp"
#include "base/geometry.hpp"
#include "base/pose.hpp"
#include "engine/world_spec.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// The outlines of an image of walls. If the image belongs to a ROS map, also its size in m and its place in
/// the frame of the map.
struct FloorImage {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
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

  /// Returns the walls of the image as one solid that stands on z = 0. It is scaled so that the whole image,
  /// margins included, fills `size` (m) and is centred on the origin in x and y.
  Solid solid(const Eigen::Vector3d& size) const;
};

/// Returns the solids of a floor plan in its own frame, standing on z = 0. They are scaled so that the
/// bounding box of the solid pixels, or the whole image if spec.keeps_margins is set, fills `size` (m) and is
/// centred on the origin in x and y. With spec.boundary, four walls just inside the edges are added. A ROS
/// map keeps its own place, and its own size in x and y, which is written to `size`.
std::vector<Solid> floor_plan_body(const FloorImage& image, const engine::ImageSpec& spec,
                                   Eigen::Vector3d& size);
/// Like floor_plan_body(), but for a model that is not a floor plan. As in Stage, the solids, boundary
/// included, are then scaled to `size` once more, which may change the last bits of their coordinates. A ROS
/// map is not scaled.
std::vector<Solid> image_body(const FloorImage& image, const engine::ImageSpec& spec, Eigen::Vector3d& size);

/// Reads the images of one world. It reads each file only once.
class FloorImages {
 public:
  explicit FloorImages(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// Reads an image, or a ROS map if `file` is a YAML file. `unknown_is_solid` says whether the unknown cells
  /// of a map are solid. Returns null if the file cannot be read. The first call that fails for a file adds
  /// an error at `where`, the place of the file's name in the world file, or at a line of the YAML file. An
  /// image without solid pixels is not an error. The result is valid as long as this object.
  const FloorImage* read(const std::filesystem::path& file, bool unknown_is_solid, Where where);

 private:
  Diagnostics& diagnostics_;
  std::map<std::pair<std::string, bool>, std::optional<FloorImage>> images_;
};

}  // namespace troupe::worldio
