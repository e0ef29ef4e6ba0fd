#pragma once

#include "base/diagnostics.hpp"
#include "base/geometry.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// An image of solid and free pixels. Solid pixels belong to walls. Row 0 is the top row.
struct Bitmap {
  int width = 0;            ///< width, pixels
  int height = 0;           ///< height, pixels
  std::vector<bool> solid;  ///< whether each pixel is solid, row by row from the top

  /// Whether the pixel in column x and row y is solid; false outside the image.
  bool at(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height && solid[static_cast<std::size_t>(y) * width + x];
  }
};

/// Greatest number of pixels of an image that is read. A file of a few kilobytes can declare any number of
/// pixels, and memory use grows with this number.
inline constexpr double k_most_pixels = 100e6;
/// Greatest number of corners that all outlines of an image may have together. Memory use also grows with
/// this number.
inline constexpr std::size_t k_most_corners = 4000000;

/// A function that decides whether a pixel is solid. The channels of the pixel, each 0 to 255, are (grey),
/// (grey, opacity), (red, green, blue) or (red, green, blue, opacity). The header of a PNM image states the
/// value of white; the channels are scaled so that white is 255.
using PixelRule = std::function<bool(std::span<const std::uint8_t> channels)>;
/// The default rule, which is also that of Stage (an older robot simulator whose world files Troupe reads). A
/// pixel is solid if its first channel is at most 127. There must be at least one channel.
bool is_dark(std::span<const std::uint8_t> channels);

/// Reads a PNG, JPEG, BMP or PNM (PBM, PGM or PPM, in ASCII or binary) image. `is_solid` decides which pixels
/// are solid. Returns nothing, and adds an error to `diagnostics`, if the file
/// - is missing, is damaged, or has another format,
/// - has more than 2^31 - 1 bytes,
/// - has more than k_most_pixels pixels, or outlines with more than k_most_corners corners together.
///
/// `where` is the place (file and line) at which the error is reported: usually that of the image's name in
/// the world file.
std::optional<Bitmap> read_bitmap(const std::filesystem::path& file, Where where, Diagnostics& diagnostics,
                                  const PixelRule& is_solid = is_dark);
/// Like read_bitmap(), but reads the image from `bytes`, the content of a file. `name` is the name of the
/// image in messages. `most_pixels` is the greatest allowed number of pixels.
std::optional<Bitmap> decode_bitmap(std::string_view bytes, std::string_view name, Where where,
                                    Diagnostics& diagnostics, double most_pixels = k_most_pixels,
                                    const PixelRule& is_solid = is_dark);

/// Returns the outlines of the areas of solid pixels, and of the holes in these areas. The result is empty if
/// no pixel is solid.
///
/// ring   Each outline is a closed ring: an edge joins the last point to the first.
/// units  Pixels. The top left corner of the image is (0, 0), the bottom left corner is (0, -height): +x is
///        to the right, +y is up.
/// order  The points of outer outlines are in clockwise order, those of holes in counter-clockwise order.
/// edges  Successive collinear edges are merged into one edge. As in Stage, the first and the last edge of a
///        ring are never merged with others.
std::vector<Ring> bitmap_contours(const Bitmap& bitmap);

/// Converts the outlines of an image in place, from pixels (as bitmap_contours() returns them) to m. `width`
/// and `height` are the size of the image in pixels. The whole image, with the free pixels at its edges, is
/// scaled to the x and y of `size` (m) and centred on the origin.
void fit_image(int width, int height, const Eigen::Vector3d& size, std::vector<Ring>& contours);

/// Adds four walls to the solids (extruded outlines) of a floor plan, a body that consists of walls. The
/// walls stand just inside the edges of a box of size `size` (m). The box is centred on the origin in x and y
/// and stands on z = 0. The walls are as high as the box. Their thickness is the smallest of 0.01 m, half of
/// size.x and half of size.y.
void add_boundary(const Eigen::Vector3d& size, std::vector<Solid>& solids);

/// Scales several solids (extruded outlines) together to the size `size` (m). An axis along which the solids
/// have no extent is not scaled.
///
/// x, y  The bounding box of all solids is scaled to size.x by size.y and centred on the origin. If `frame`
///       is not empty, the bounding box is first enlarged to contain `frame`, which is in the units of the
///       solids.
/// z     Heights are multiplied by size.z / (z_max - z_min), where z_min and z_max are the lowest and the
///       highest point of all solids. The solids are not shifted: z = 0 stays at z = 0.
///
/// Does nothing if the solids have no points and `frame` is empty.
void normalise(std::vector<Solid>& solids, const Eigen::Vector3d& size, const Box& frame = {});

}  // namespace troupe::worldio
