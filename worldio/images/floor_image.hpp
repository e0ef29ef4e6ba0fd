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

/// The outlines of an image and, if it is a ROS map, its place.
struct FloorImage {
  int width = 0;
  int height = 0;
  std::vector<Ring> contours;  ///< in pixels, +y up: the image lies in x from 0 to width, y from -height to 0

  /// The size and place of a ROS map (worldio/images/ros_map.hpp).
  struct Place {
    Eigen::Vector2d size_m;
    Pose pose_map_center;  ///< of the image's centre
  };
  std::optional<Place> place;

  /// Returns one solid that stands on z = 0: the whole image, margins included, fills `size`, m, centred.
  Solid solid(const Eigen::Vector3d& size) const;
};

/// Returns the body of a floor plan in its own frame, on z = 0: the solid pixels, or the whole image if its
/// margins are kept, fill `size`, m, and are centred. A ROS map keeps its own place and its own size in x and
/// y, which overwrites that of `size`.
std::vector<Solid> floor_plan_body(const FloorImage& image, const engine::ImageSpec& spec,
                                   Eigen::Vector3d& size);
/// As floor_plan_body(), for a model, as in Stage: the result, boundary included, is fitted to `size` once
/// more, which may change the last bits.
std::vector<Solid> image_body(const FloorImage& image, const engine::ImageSpec& spec, Eigen::Vector3d& size);

/// The images of one world. Each is read once.
class FloorImages {
 public:
  explicit FloorImages(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// Reads an image, or a ROS map if `file` is a YAML file; `unknown_is_solid` says whether its unknown cells
  /// are solid. Null if it cannot be read, with an error at `where` or in the YAML file at the first call.
  /// The image may have no solid pixel.
  const FloorImage* read(const std::filesystem::path& file, bool unknown_is_solid, Where where);

 private:
  Diagnostics& diagnostics_;
  std::map<std::pair<std::string, bool>, std::optional<FloorImage>> images_;
};

}  // namespace troupe::worldio
