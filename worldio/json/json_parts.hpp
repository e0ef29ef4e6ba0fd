#pragma once

#include "base/geometry.hpp"
#include "base/result.hpp"
#include "engine/spec/world_spec.hpp"
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

/// Converts the shapes of parts between JSON documents and specs. A type describes bodies of the same
/// construction. Its parts are rigid pieces, each with a pose in the frame of the body; part 0 is the body
/// itself. A document is a struct with the content of a JSON object (worldio/json/world_document.hpp). A spec
/// (engine::PartSpec) is the description that the engine uses. A block is an upright prism. A floor plan is a
/// body that consists of walls.
namespace troupe::worldio {

/// Reads a list of points [[x, y], ...], m. If the value is not a list of pairs of numbers from -k_max_size_m
/// to k_max_size_m, or has fewer than `least` or more than `most` points, reports an error and returns an
/// empty list.
std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least,
                              std::size_t most = std::numeric_limits<std::size_t>::max());
/// Returns the list [[x, y], ...] of these points, m.
JsonNode points_node(std::span<const Vec2> points);

/// Reads a box [[x_min, y_min], [x_max, y_max]], m. If the value is not such a box, or a minimum exceeds its
/// maximum, reports an error and returns nothing.
std::optional<Box> read_box(const JsonCursor& at);

/// Checks that a ring, which must not be empty, can be the outline of a block. Returns an error if a point
/// equals the next one (the first follows the last), if the ring turns back on itself, if two of its edges
/// cross or touch other than at their common point, or if it has no area.
Result<> check_outline(const Ring& ring);

/// Returns the solids (extruded outlines) that an image gives a part, in the frame of the body. The members
/// `image`, `size` and `pose_body_part` of `part` must be set; `solids` of `part` is not changed. If the
/// image is a ROS map (a floor plan in the format of ROS's map_server), sets x and y of the size of `part` to
/// those of the map.
std::vector<Solid> image_solids(const FloorImage& image, engine::PartSpec& part);

/// The images of a world, and the folder to which paths of images in the world file are relative.
struct ImageFolder {
  FloorImages& images;           ///< reads the images, and keeps them
  std::filesystem::path folder;  ///< usually the folder of the world file
};
/// An image that was read, and the size to which it is scaled.
struct ExpandedImage {
  const FloorImage* image = nullptr;  ///< valid as long as ImageFolder::images
  engine::ImageSpec spec;             ///< path of the image, joined with the folder, and its options
  Eigen::Vector3d size{0, 0, 0};      ///< size in x, y and z, m; for a ROS map, x and y follow from the map
};
/// Reads the image of a part or floor plan. `object` is this part or floor plan, and `at` is its path; both
/// are used for errors. Returns nothing if the document has no image. If the image cannot be read or has no
/// solid pixel, reports an error and returns nothing. If the size of the image is missing, returns nothing
/// without an error, because the reader of documents has already reported the missing size.
std::optional<ExpandedImage> expand_image(const ImageDocument& document, const Placed& object,
                                          const DocumentPath& at, ImageFolder& images);
/// The inverse of expand_image(): returns the document of an image that is scaled to `size`, m. The path of
/// the image becomes relative to `folder`. For a ROS map, the document gets the height of `size`, but not its
/// x and y, which follow from the map.
ImageDocument contract_image(const engine::ImageSpec& image, const Eigen::Vector3d& size,
                             const std::filesystem::path& folder);

/// Sets the shape of a part: its solids (in the frame of the body), size and image, and whether it is a floor
/// plan. The pose of the part must be set before. `at` is the path of the part, for errors. Returns whether
/// the document gives a shape: a size, a disc with radius and height, a list of blocks, `fit` (blocks that
/// are scaled to a size), or an image. An image, and `fit`, count even if an error was reported for them.
bool expand_shape(const PartDocument& document, const DocumentPath& at, ImageFolder& images,
                  engine::PartSpec& part);
/// The inverse of expand_shape(): sets the shape in `document`. Paths of images become relative to `folder`;
/// if `folder` is null, the outlines of an image are stored as blocks, or as a box if they form one. Returns
/// the size, m, that expand_shape() would give the part.
Eigen::Vector3d contract_shape(const engine::PartSpec& part, const std::filesystem::path* folder,
                               PartDocument& document);
/// Sets PartDocument::extent, the size that fiducial finders (sensors that detect marked bodies) report, to
/// the size of the part. Does so only if this size differs in any bit from `size_expanded`, the result of
/// contract_shape().
void contract_extent(const engine::PartSpec& part, const Eigen::Vector3d& size_expanded,
                     PartDocument& document);

/// Returns the solids of a part in the frame of the body: those of `blocks` and, if `size` is given, a box of
/// this size, m. The box, and the blocks whose `frame` is `part`, are given in the frame of the part;
/// `pose_body_part` is the pose of the part in the frame of the body.
std::vector<Solid> expand_solids(const std::optional<Eigen::Vector3d>& size,
                                 std::span<const BlockDocument> blocks, const Pose& pose_body_part);
/// Sets the size of a part, m, to the extent of its solids along x, y and z of the body. Along z, the extent
/// always includes z = 0: solids from 1 m to 2 m above z = 0 give a height of 2 m. A part whose solids have
/// no points keeps its size.
void measure_part(engine::PartSpec& part);

}  // namespace troupe::worldio
