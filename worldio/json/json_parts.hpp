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

/// Shapes of types and parts: conversion between documents and specs.
namespace troupe::worldio {

/// Reads a list of points [[x, y], ...], m. Empty, with an error, if a value is wrong or if there are fewer
/// than `least` or more than `most` points.
std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least,
                              std::size_t most = std::numeric_limits<std::size_t>::max());
/// Returns the list [[x, y], ...] of these points, m.
JsonNode points_node(std::span<const Vec2> points);

/// Reads a box [[x_min, y_min], [x_max, y_max]], m. Empty, with an error, if the value is not such a box.
std::optional<Box> read_box(const JsonCursor& at);

/// Checks that a ring, which must not be empty, can be the outline of a block. It returns an error if points
/// are repeated, if edges cross or touch, or if the ring has no area.
Result<> check_outline(const Ring& ring);

/// Returns the solids that an image gives a part, in the frame of the body.
std::vector<Solid> image_solids(const FloorImage& image, engine::PartSpec& part);

/// The images of a world and the folder that their paths are relative to.
struct ImageFolder {
  FloorImages& images;
  std::filesystem::path folder;
};
/// An image and how it is scaled.
struct ExpandedImage {
  const FloorImage* image = nullptr;
  engine::ImageSpec spec;
  Eigen::Vector3d size{0, 0, 0};  ///< m; for a ROS map, x and y follow from the map
};
/// Reads the image of the object at path `at`. Empty, with an error, if the image cannot be read or has
/// nothing solid. Also empty if the size of the image is missing, for which the reader of documents has
/// already reported an error.
std::optional<ExpandedImage> expand_image(const ImageDocument& document, const Placed& object,
                                          const DocumentPath& at, ImageFolder& images);
/// The inverse of expand_image(): returns the document of an image that is scaled to `size`, m. The path of
/// the image becomes relative to `folder`.
ImageDocument contract_image(const engine::ImageSpec& image, const Eigen::Vector3d& size,
                             const std::filesystem::path& folder);

/// Sets the shape of a part, whose pose must be set; the solids are in the frame of the body. Returns whether
/// the document gives a shape: a size, blocks or an image.
bool expand_shape(const PartDocument& document, const DocumentPath& at, ImageFolder& images,
                  engine::PartSpec& part);
/// The inverse of expand_shape(): sets the shape in `document`. `folder`: the folder that the paths of images
/// are relative to; null: an image is written as its outlines. Returns the size, m, that expand_shape() would
/// give the part.
Eigen::Vector3d contract_shape(const engine::PartSpec& part, const std::filesystem::path* folder,
                               PartDocument& document);
/// Sets `extent` of the document if the size of the part differs from `size_expanded`, the result of
/// contract_shape().
void contract_extent(const engine::PartSpec& part, const Eigen::Vector3d& size_expanded,
                     PartDocument& document);

/// Returns the solids, in the frame of the body, of a box of `size`, m, (if given) and of `blocks`. Both are
/// in the frame of the part, whose pose is `pose_body_part`.
std::vector<Solid> expand_solids(const std::optional<Eigen::Vector3d>& size,
                                 std::span<const BlockDocument> blocks, const Pose& pose_body_part);
/// Sets the size of a part to the extent of its solids, if it has any.
void measure_part(engine::PartSpec& part);

}  // namespace troupe::worldio
