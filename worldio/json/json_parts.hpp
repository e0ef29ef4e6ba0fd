#pragma once

#include "base/geometry.hpp"
#include "base/result.hpp"
#include "engine/world_spec.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/world_document.hpp"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

/// The bodies of types and their parts: between what a document says of them and what is made of it.
namespace troupe::worldio {

/// Pairs of metres: [[x, y], ...]. Empty, and reported, where they are wrong or number fewer or more than
/// asked.
std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least,
                              std::size_t most = std::numeric_limits<std::size_t>::max());
JsonNode points_node(std::span<const Vec2> points);

/// A box: [[x_min, y_min], [x_max, y_max]], m. Nothing where it is wrong, which is reported.
std::optional<Box> read_box(const JsonCursor& at);

/// Whether a ring can be the outline of a block; else what is wrong: repeated points, crossing edges, no
/// area. The ring has points.
Result<> check_outline(const Ring& ring);

/// What the image of a part makes of it, in the body's frame; the part's size is that of a map of ROS then.
std::vector<Solid> image_solids(const FloorImage& image, engine::PartSpec& part);

/// Where the images of a world are.
struct ImageFolder {
  FloorImages& images;
  std::filesystem::path folder;
};
/// The image that an object names, and how it is to be stretched.
struct ExpandedImage {
  const FloorImage* image = nullptr;
  engine::ImageSpec spec;
  Eigen::Vector3d size{0, 0, 0};  ///< of a map of ROS its own
};
/// Empty, and reported, where the image cannot be read or has nothing solid, and where its size is missing.
/// object: what has the image, at this path
std::optional<ExpandedImage> expand_image(const ImageDocument& document, const Placed& object,
                                          const DocumentPath& at, ImageFolder& images);
/// `folder`: that the path of the image is to be relative to.
ImageDocument contract_image(const engine::ImageSpec& image, const Eigen::Vector3d& size,
                             const std::filesystem::path& folder);

/// The shape of a part whose pose is known; its solids are in the body's frame. True where it has one: a
/// size, blocks or an image.
bool expand_shape(const PartDocument& document, const DocumentPath& at, ImageFolder& images,
                  engine::PartSpec& part);
/// `folder` as for contract_image(); null: an image is written as its outlines. Returns the size that the
/// part has once it is expanded.
Eigen::Vector3d contract_shape(const engine::PartSpec& part, const std::filesystem::path* folder,
                               PartDocument& document);
/// The extent, where the size is not that of what is solid.
void contract_extent(const engine::PartSpec& part, const Eigen::Vector3d& size_expanded,
                     PartDocument& document);

/// A box of this size, and blocks, of what stands at this pose; solids in the body's frame.
std::vector<Solid> expand_solids(const std::optional<Eigen::Vector3d>& size,
                                 std::span<const BlockDocument> blocks, const Pose& pose_body_part);
/// The extent of a part's solids is its size.
void measure_part(engine::PartSpec& part);

}  // namespace troupe::worldio
