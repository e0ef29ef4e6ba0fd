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

/// Reads [[x, y], ...], m. Empty, with an error, if a value is wrong or there are not `least` to `most`
/// points.
std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least,
                              std::size_t most = std::numeric_limits<std::size_t>::max());
JsonNode points_node(std::span<const Vec2> points);

/// Reads [[x_min, y_min], [x_max, y_max]], m. Empty, with an error, if it is wrong.
std::optional<Box> read_box(const JsonCursor& at);

/// Checks that a ring, which is not empty, can be the outline of a block. Errors: repeated points, crossing
/// edges, no area.
Result<> check_outline(const Ring& ring);

/// The solids that the image of a part gives it, in the body's frame.
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
/// nothing solid; also empty if its size is missing, which the reader of documents has reported.
std::optional<ExpandedImage> expand_image(const ImageDocument& document, const Placed& object,
                                          const DocumentPath& at, ImageFolder& images);
/// The inverse: the document of an image of this size. The path becomes relative to `folder`.
ImageDocument contract_image(const engine::ImageSpec& image, const Eigen::Vector3d& size,
                             const std::filesystem::path& folder);

/// Sets the shape of a part whose pose is set; its solids are in the body's frame. Returns whether the
/// document gives one: a size, blocks or an image.
bool expand_shape(const PartDocument& document, const DocumentPath& at, ImageFolder& images,
                  engine::PartSpec& part);
/// The inverse. `folder` as for contract_image(); null: an image is written as its outlines. Returns the size
/// that expand_shape() gives the part.
Eigen::Vector3d contract_shape(const engine::PartSpec& part, const std::filesystem::path* folder,
                               PartDocument& document);
/// Sets `extent` of the document if the part's size is not `size_expanded`.
void contract_extent(const engine::PartSpec& part, const Eigen::Vector3d& size_expanded,
                     PartDocument& document);

/// The solids, in the body's frame, of a box of this size, if given, and of blocks, both at `pose_body_part`.
std::vector<Solid> expand_solids(const std::optional<Eigen::Vector3d>& size,
                                 std::span<const BlockDocument> blocks, const Pose& pose_body_part);
/// Sets the size of a part to the extent of its solids, if it has any.
void measure_part(engine::PartSpec& part);

}  // namespace troupe::worldio
