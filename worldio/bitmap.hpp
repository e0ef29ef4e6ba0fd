#pragma once

#include "base/diagnostics.hpp"
#include "base/geometry.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Which pixels of an image are solid: first channel <= 127. Row 0 is the top.
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

/// Reads PNG, JPEG, BMP or PNM. Empty, with an error at `where`, when the file is missing, no image or too
/// large.
std::optional<Bitmap> read_bitmap(const std::filesystem::path& file, Where where, Diagnostics& diagnostics);
/// The same for the content of a file, which messages call `name`.
std::optional<Bitmap> decode_bitmap(std::string_view bytes, std::string_view name, Where where,
                                    Diagnostics& diagnostics, double most_pixels = k_most_pixels);

/// The outlines of the solid pixels as closed rings, holes included, collinear runs merged; pixel units, +y
/// up (image row 0 has the largest y). Source: stage worlds' floor plans; docs/stage-worlds.md.
std::vector<Ring> bitmap_contours(const Bitmap& bitmap);

/// Adds four walls that stand just inside the box of a floor plan, 0.01 m thick (less in a smaller box) and
/// as tall as it.
void add_boundary(const Eigen::Vector3d& size, std::vector<Solid>& solids);

/// Scales the contours of several solids together so that their common bounding box fills `size` and is
/// centred; z is multiplied by size.z / (z_max - z_min) and not shifted.
void normalise(std::vector<Solid>& solids, const Eigen::Vector3d& size);

}  // namespace troupe::worldio
