#pragma once

#include "base/geometry.hpp"
#include "engine/kinds.hpp"
#include "engine/world_spec.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/json/json_reader.hpp"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// What JSON worlds say of the bodies of types and their parts: where they are, what they look like, and how
/// they show themselves. What is read by read_x() is written by write_x() beside it.
namespace troupe::worldio {

inline constexpr double k_max_size_m = 100000;

/// The key `pose` of an object; `fallback` where it is absent.
Pose read_pose(JsonObject& object, const Pose& fallback = {});
/// Nothing where the pose is `fallback`.
void write_pose(const Pose& pose, JsonNode::Object& object, const Pose& fallback = {});

/// The same with x, y and heading whatever they are: where a body stands is what people look for, and set.
void write_place(const Pose& pose, JsonNode::Object& object);

/// The keys `obstacle`, `ranger_return`, `fiducial_return`, `fiducial_key`, `gripper_return`, `blob_return`,
/// `pushable`.
engine::Returns read_returns(JsonObject& object);
void write_returns(const engine::Returns& returns, JsonNode::Object& object);

/// A key that is true or false.
bool read_boolean(JsonObject& object, std::string_view name, bool fallback);

/// Pairs of metres: [[x, y], ...]. Empty, and reported, where they are wrong or number fewer or more than
/// asked.
std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least,
                              std::size_t most = std::numeric_limits<std::size_t>::max());
JsonNode points_node(std::span<const Vec2> points);

/// A box under a key: [[x_min, y_min], [x_max, y_max]], m. Nothing where it is not there, or is wrong, which
/// is reported.
std::optional<Box> read_box(JsonObject& object, std::string_view key);

/// Whether a ring can be the outline of a block; else what is wrong: repeated points, crossing edges, no
/// area. The ring has points.
Result<> check_outline(const Ring& ring);

/// The image that an object names, and how it is to be stretched.
struct JsonImage {
  const FloorImage* image = nullptr;
  engine::ImageSpec spec;
  Eigen::Vector3d size{0, 0, 0};  ///< of a map of ROS its own
};
/// The keys `bitmap`, `size_m`, `margins` and `boundary`, or of a map of ROS `height_m`, `unknown` and
/// `boundary`. Every key is looked at, so that all that is wrong is reported; empty when anything is.
std::optional<JsonImage> read_image(JsonObject& object, FloorImages& images,
                                    const std::filesystem::path& folder);
/// `folder`: that the path of the image is to be relative to.
void write_image(const engine::ImageSpec& image, const Eigen::Vector3d& size,
                 const std::filesystem::path& folder, JsonNode::Object& object);

/// What the image of a part makes of it, in the body's frame; the part's size is that of a map of ROS then.
std::vector<Solid> image_solids(const FloorImage& image, engine::PartSpec& part);

/// Where the images of a world are.
struct ImageFolder {
  FloorImages& images;
  std::filesystem::path folder;
};
/// The keys `size_m`, `blocks` (with `fit` and `origin`) or `bitmap`, and `floor_plan`, for a part whose pose
/// is known; its solids are in the body's frame. True where one of the first three is there.
bool read_shape(JsonObject& object, ImageFolder& images, engine::PartSpec& part);
/// `folder` as for write_image(); null: an image is written as its outlines. Returns the size that the part
/// has once it is read.
Eigen::Vector3d write_shape(const engine::PartSpec& part, const std::filesystem::path* folder,
                            JsonNode::Object& object);

/// The key `extent_m`: the size as it is declared, where it is not that of what is solid. True where it is
/// given.
bool read_extent(JsonObject& object, engine::PartSpec& part);
void write_extent(const engine::PartSpec& part, const Eigen::Vector3d& size_read, JsonNode::Object& object);

/// `size_m` and `blocks` of what stands at this pose; solids in the body's frame.
std::vector<Solid> read_solids(JsonObject& object, const Pose& pose_body_part);
/// The extent of a part's solids is its size.
void measure_part(engine::PartSpec& part);

}  // namespace troupe::worldio
