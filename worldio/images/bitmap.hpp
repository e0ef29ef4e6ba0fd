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

/// Which pixels of an image are solid, that is, belong to a wall. Row 0 is the top row.
struct Bitmap {
  int width = 0;            ///< pixels
  int height = 0;           ///< pixels
  std::vector<bool> solid;  ///< row-major

  /// Whether pixel (x, y) is solid; false outside the image.
  bool at(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height && solid[static_cast<std::size_t>(y) * width + x];
  }
};

/// Greatest number of pixels of an image that is read. A file of a few kilobytes can claim any number of
/// pixels, and memory use grows with it.
inline constexpr double k_most_pixels = 100e6;
/// Greatest number of corners of the outlines of an image that is read, for the same reason.
inline constexpr std::size_t k_most_corners = 4000000;

/// Decides whether a pixel is solid. Its channels, 0 to 255, are (grey), (red, green, blue), or one of these
/// followed by the opacity.
using PixelRule = std::function<bool(std::span<const std::uint8_t> channels)>;
/// Stage's rule: a pixel is solid if its first channel is at most 127.
bool is_dark(std::span<const std::uint8_t> channels);

/// Reads a PNG, JPEG, BMP or PNM image. If the file is missing, not such an image, damaged or too large,
/// returns nothing and adds an error at `where`.
std::optional<Bitmap> read_bitmap(const std::filesystem::path& file, Where where, Diagnostics& diagnostics,
                                  const PixelRule& is_solid = is_dark);
/// Like read_bitmap(), but reads the content of a file from memory. `name` is the name of the image in
/// messages.
std::optional<Bitmap> decode_bitmap(std::string_view bytes, std::string_view name, Where where,
                                    Diagnostics& diagnostics, double most_pixels = k_most_pixels,
                                    const PixelRule& is_solid = is_dark);

/// Returns the outlines of the solid pixels and of their holes as closed rings. Units are pixels, +y is up,
/// and y is 0 at the top of the image and -height at the bottom. Collinear edges are merged into one, but as
/// in Stage not among the first three points of a ring (docs/stage-worlds.md).
std::vector<Ring> bitmap_contours(const Bitmap& bitmap);

/// Converts outlines (bitmap_contours) of an image of width x height pixels from pixels to m: the whole
/// image, margins included, fills `size` (m) in x and y and is centred on the origin.
void fit_image(int width, int height, const Eigen::Vector3d& size, std::vector<Ring>& contours);

/// Adds four walls to a floor plan, just inside its box of size `size` (m), which is centred in x and y. The
/// walls are 0.01 m thick, or thinner in a smaller box, and as tall as the box.
void add_boundary(const Eigen::Vector3d& size, std::vector<Solid>& solids);

/// Scales several solids together so that their common bounding box, enlarged to contain `frame`, fills
/// `size` (m) and is centred in x and y. Heights are multiplied by size.z / (z_max - z_min) and not shifted.
void normalise(std::vector<Solid>& solids, const Eigen::Vector3d& size, const Box& frame = {});

}  // namespace troupe::worldio
