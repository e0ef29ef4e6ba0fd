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

/// The most that is read of an image: pixels, and corners of its outlines. They are what memory grows with,
/// and a file of some kilobytes can ask for any number of either.
inline constexpr double k_most_pixels = 100e6;
inline constexpr std::size_t k_most_corners = 4000000;

/// Whether a pixel is solid, from its channels: grey, grey and opacity, red green blue, or these and opacity.
using PixelRule = std::function<bool(std::span<const std::uint8_t> channels)>;
/// Stage's: the first channel is 127 or darker.
bool is_dark(std::span<const std::uint8_t> channels);

/// Reads PNG, JPEG, BMP or PNM. Empty, with an error at `where`, when the file is missing, no image or too
/// large.
std::optional<Bitmap> read_bitmap(const std::filesystem::path& file, Where where, Diagnostics& diagnostics,
                                  const PixelRule& is_solid = is_dark);
/// The same for the content of a file, which messages call `name`.
std::optional<Bitmap> decode_bitmap(std::string_view bytes, std::string_view name, Where where,
                                    Diagnostics& diagnostics, double most_pixels = k_most_pixels,
                                    const PixelRule& is_solid = is_dark);

/// The outlines of the solid pixels as closed rings, holes included, collinear runs merged; pixel units, +y
/// up (image row 0 has the largest y). Source: stage worlds' floor plans; docs/stage-worlds.md.
std::vector<Ring> bitmap_contours(const Bitmap& bitmap);

/// Maps the outlines of an image of this size in pixels so that the whole of it, margins included, fills
/// `size` in x and y, centred.
void fit_image(int width, int height, const Eigen::Vector3d& size, std::vector<Ring>& contours);

/// Adds four walls that stand just inside the box of a floor plan, 0.01 m thick (less in a smaller box) and
/// as tall as it.
void add_boundary(const Eigen::Vector3d& size, std::vector<Solid>& solids);

/// Scales the contours of several solids together so that their common bounding box fills `size` and is
/// centred; z is multiplied by size.z / (z_max - z_min) and not shifted. `frame` counts as part of the box.
void normalise(std::vector<Solid>& solids, const Eigen::Vector3d& size, const Box& frame = {});

}  // namespace troupe::worldio
