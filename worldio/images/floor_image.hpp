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

/// The outlines of an image, and what a map says of it beside.
struct FloorImage {
  int width = 0;
  int height = 0;
  std::vector<Ring> contours;  ///< in pixels, +y up: the image lies in x from 0 to width, y from -height to 0

  /// Of a map of ROS (worldio/images/ros_map.hpp).
  struct Place {
    Eigen::Vector2d size_m;
    Pose pose_map_center;  ///< of the image's middle
  };
  std::optional<Place> place;

  /// One solid from the floor up: the whole image, margins included, fills the size, centred.
  Solid solid(const Eigen::Vector3d& size) const;
};

/// The body of a floor plan, in its own frame: what of the image is solid fills `size` and is centred; z is
/// from the floor up. A map of ROS has its own size in x and y, which is put into `size`, and its own place.
std::vector<Solid> floor_plan_body(const FloorImage& image, const engine::ImageSpec& spec,
                                   Eigen::Vector3d& size);
/// The same of a model, as Stage has it: what is there in the end, boundary included, is fitted once more,
/// which may change last bits.
std::vector<Solid> image_body(const FloorImage& image, const engine::ImageSpec& spec, Eigen::Vector3d& size);

/// Images of one world, each read once.
class FloorImages {
 public:
  explicit FloorImages(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// `file` is an image or the YAML of a map; of a map's unknown cells, `unknown_is_solid` says
  /// what they are. Null, with an error at `where` (or in the YAML), where it cannot be read, and again each
  /// time. It may be without a solid pixel.
  const FloorImage* read(const std::filesystem::path& file, bool unknown_is_solid, Where where);

 private:
  Diagnostics& diagnostics_;
  std::map<std::pair<std::string, bool>, std::optional<FloorImage>> images_;
};

}  // namespace troupe::worldio
