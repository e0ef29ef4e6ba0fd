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

/// Converts the shapes of parts between JSON documents and specs.
///
/// type        a description of bodies of the same construction
/// part        a rigid piece of a body, with a pose in the frame of the body; part 0 is the body itself
/// document    a struct with the content of a JSON object (worldio/json/world_document.hpp)
/// spec        the description that the engine uses; that of a part is an engine::PartSpec
/// solid       a region of the plane, bounded by outlines and extruded along z
/// block       a solid that a document describes: an upright prism
/// floor plan  a body that consists of walls
/// ROS map     a floor plan in the format of ROS's map_server, whose size follows from its YAML file
namespace troupe::worldio {

/// Returns the description of a point [x, y], m, with the limits of its coordinates. They also hold for the
/// corners of blocks in `.world` files.
const engine::Field& point_field();
/// Reads a list of points [[x, y], ...], m. If the value is not such a list, if a coordinate is outside
/// -k_max_size_m to k_max_size_m, or if there are fewer than `least` or more than `most` points, reports an
/// error and returns an empty list.
std::vector<Vec2> read_points(const JsonCursor& at, std::size_t least,
                              std::size_t most = std::numeric_limits<std::size_t>::max());
/// Returns the list [[x, y], ...] of these points, m.
JsonNode points_node(std::span<const Vec2> points);

/// Reads a box [[x_min, y_min], [x_max, y_max]], m. If the value is not such a box, or a minimum exceeds its
/// maximum, reports an error and returns nothing.
std::optional<Box> read_box(const JsonCursor& at);

/// Whether all points of a ring, at least two, lie on one line, within rounding errors.
bool is_on_one_line(const Ring& ring);
/// Checks that a ring, which must not be empty, can be the outline of a block. Returns an error if
/// - two successive points are equal (the first point follows the last),
/// - all points lie on one line,
/// - an edge runs back over the edge before it,
/// - two edges that do not follow one another cross or touch.
Result<> check_outline(const Ring& ring);

/// Returns the solids that a part gets from its image, in the frame of the body. part.image, part.size and
/// part.pose_body_part must be set before the call. If the image is a ROS map, sets the x and y of part.size
/// to the size of the map. Does not change part.solids.
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
/// Reads the image of a part or floor plan. `object` is the part or floor plan, and `at` is its path, both
/// for errors. Returns nothing if the document has no image. Reports an error and returns nothing if the
/// image cannot be read. Warns if it has no solid pixel. Also returns nothing if the document lacks the size
/// of the image; the reader of documents has already reported that error.
std::optional<ExpandedImage> expand_image(const ImageDocument& document, const Placed& object,
                                          const DocumentPath& at, ImageFolder& images);
/// The inverse of expand_image(): returns the document of an image that is scaled to `size`, m. The path of
/// the image becomes relative to `folder`. The document of a ROS map contains the height size.z, but neither
/// size.x nor size.y.
ImageDocument contract_image(const engine::ImageSpec& image, const Eigen::Vector3d& size,
                             const std::filesystem::path& folder);

/// Sets the shape of a part: the members `solids` (in the frame of the body), `size`, `image`, `fitted` and
/// `floor_plan` of `part`. part.pose_body_part must be set before the call. `at` is the path of the part, for
/// errors. Returns whether the document states a shape. A shape is a size, a disc with radius and height, a
/// list of blocks, blocks that are scaled to a size (`fit`), or an image. An image or `fit` with errors is
/// also a shape: the caller then does not report that the shape is missing.
bool expand_shape(const PartDocument& document, const DocumentPath& at, ImageFolder& images,
                  engine::PartSpec& part);
/// The inverse of expand_shape(): sets the shape in `document`. The path of an image becomes relative to
/// `folder`. If `folder` is null, the document gets no image: the solids of the image are stored as blocks,
/// or as a size if they are a box of this size. Returns the size, m, that expand_shape() would give a part
/// with this document.
Eigen::Vector3d contract_shape(const engine::PartSpec& part, const std::filesystem::path* folder,
                               PartDocument& document);
/// Sets PartDocument::extent to the size of the part, unless this size is the same bit by bit as
/// `size_expanded`. The extent is the size that fiducial finders (sensors that detect marked bodies) report.
/// `size_expanded` is the size, m, that the part would get from the document without the extent, such as the
/// result of contract_shape().
void contract_extent(const engine::PartSpec& part, const Eigen::Vector3d& size_expanded,
                     PartDocument& document);

/// Returns the solids of a part in the frame of the body: a box of the size `size` (m), if it is given, and
/// the solids of `blocks`. The box stands on z = 0 of the part, centred on the origin of the part.
/// BlockDocument::frame says whether a block is given in the frame of the part or of the body.
/// `pose_body_part` is the pose of the part in the frame of the body.
std::vector<Solid> expand_solids(const std::optional<Eigen::Vector3d>& size,
                                 std::span<const BlockDocument> blocks, const Pose& pose_body_part);
/// Sets the size of a part, m, to the extent of its solids along the x, y and z axes of the body frame. Along
/// z, the extent always includes z = 0: solids from z = 1 m to z = 2 m give a height of 2 m. A part whose
/// solids have no points keeps its size.
void measure_part(engine::PartSpec& part);

}  // namespace troupe::worldio
