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
/// (grey, opacity), (red, green, blue) or (red, green, blue, opacity). The channels of a PNM whose header has
/// a largest value other than 255 are scaled to 0 to 255.
using PixelRule = std::function<bool(std::span<const std::uint8_t> channels)>;
/// The default rule, which is that of Stage, an older robot simulator whose world files Troupe reads. A pixel
/// is solid if its first channel is at most 127. There must be at least one channel.
bool is_dark(std::span<const std::uint8_t> channels);

/// Reads a PNG, JPEG, BMP or binary PNM (P5, P6) image. `is_solid` decides which pixels are solid. If the
/// file is missing, is not such an image, is damaged, or exceeds a limit (a file size of 2^31 - 1 bytes,
/// k_most_pixels or k_most_corners), returns nothing and adds an error to `diagnostics`. `where` is the place
/// (file and line) of the error: that of the image's name in the world file.
std::optional<Bitmap> read_bitmap(const std::filesystem::path& file, Where where, Diagnostics& diagnostics,
                                  const PixelRule& is_solid = is_dark);
/// Like read_bitmap(), but reads the image from `bytes`, the content of a file. `name` is the name of the
/// image in messages. The limit on pixels is `most_pixels`.
std::optional<Bitmap> decode_bitmap(std::string_view bytes, std::string_view name, Where where,
                                    Diagnostics& diagnostics, double most_pixels = k_most_pixels,
                                    const PixelRule& is_solid = is_dark);

/// Returns the outlines of the areas of solid pixels, and of the holes in these areas, as closed rings. The
/// last point of a ring does not repeat the first. Outer outlines are clockwise, those of holes
/// counter-clockwise. Units are pixels, x is 0 at the left edge of the image, +y is up, and y is 0 at the top
/// of the image and -height at the bottom. Collinear edges are merged into one edge, but not among the first
/// three points of a ring: this is as in Stage (docs/stage-worlds.md). The result is empty if no pixel is
/// solid.
std::vector<Ring> bitmap_contours(const Bitmap& bitmap);

/// Converts the outlines of an image of width x height pixels in place, from pixels (as bitmap_contours()
/// returns them) to m. The result is scaled and shifted so that the whole image, margins included, fills
/// `size` (m) in x and y and is centred on the origin.
void fit_image(int width, int height, const Eigen::Vector3d& size, std::vector<Ring>& contours);

/// Adds four walls to the solids (extruded outlines) of a floor plan, a body that consists of walls. The
/// walls are just inside the edges of a box of size `size` (m), which is centred on the origin in x and y and
/// stands on z = 0. The walls are as tall as the box. Their thickness is the smallest of 0.01 m, size.x / 2
/// and size.y / 2.
void add_boundary(const Eigen::Vector3d& size, std::vector<Solid>& solids);

/// Scales and shifts several solids (extruded outlines) together. Afterwards, their common bounding box in x
/// and y, enlarged to contain `frame` (in the units of the solids), fills `size` (m) and is centred on the
/// origin. Heights are multiplied by size.z / (z_max - z_min), where z_min and z_max are the lowest and
/// highest points of all solids, and are not shifted. An axis along which the extent is 0 is not scaled. Does
/// nothing if the solids have no points and `frame` is empty.
void normalise(std::vector<Solid>& solids, const Eigen::Vector3d& size, const Box& frame = {});

}  // namespace troupe::worldio
