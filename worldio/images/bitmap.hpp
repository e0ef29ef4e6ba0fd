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

/// Which pixels of an image are solid. Row 0 is the top.
struct Bitmap {
  int width = 0;
  int height = 0;
  std::vector<bool> solid;  // row-major

  bool at(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height && solid[static_cast<std::size_t>(y) * width + x];
  }
};

/// Limits of an image: pixels, and corners of its outlines. Memory grows with both, and a file of a few
/// kilobytes can ask for any number of either.
inline constexpr double k_most_pixels = 100e6;
inline constexpr std::size_t k_most_corners = 4000000;

/// Decides whether a pixel is solid, from its channels: grey, red green blue, or either followed by opacity.
using PixelRule = std::function<bool(std::span<const std::uint8_t> channels)>;
/// Stage's rule: a pixel is solid if its first channel is at most 127.
bool is_dark(std::span<const std::uint8_t> channels);

/// Reads PNG, JPEG, BMP or PNM. Empty, with an error at `where`, if the file is missing, not such an image,
/// damaged or too large.
std::optional<Bitmap> read_bitmap(const std::filesystem::path& file, Where where, Diagnostics& diagnostics,
                                  const PixelRule& is_solid = is_dark);
/// As read_bitmap(), for the content of a file; messages call it `name`.
std::optional<Bitmap> decode_bitmap(std::string_view bytes, std::string_view name, Where where,
                                    Diagnostics& diagnostics, double most_pixels = k_most_pixels,
                                    const PixelRule& is_solid = is_dark);

/// Returns the outlines of the solid pixels, holes included, as closed rings in pixels, +y up: y is 0 at the
/// top of the image and -height at the bottom. Collinear runs are merged, but as in Stage not among the first
/// three points of a ring (docs/stage-worlds.md).
std::vector<Ring> bitmap_contours(const Bitmap& bitmap);

/// Maps the outlines of an image of width x height pixels so that the whole image, margins included, fills
/// `size`, m, in x and y, centred.
void fit_image(int width, int height, const Eigen::Vector3d& size, std::vector<Ring>& contours);

/// Adds four walls just inside the box of a floor plan of this size, m, which is centred in x and y. They are
/// 0.01 m thick, less in a smaller box, and as tall as the box.
void add_boundary(const Eigen::Vector3d& size, std::vector<Solid>& solids);

/// Scales the contours of several solids together so that their common bounding box fills `size` and is
/// centred; z is multiplied by size.z / (z_max - z_min) and not shifted. The bounding box includes `frame`.
void normalise(std::vector<Solid>& solids, const Eigen::Vector3d& size, const Box& frame = {});

}  // namespace troupe::worldio
