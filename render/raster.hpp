#pragma once

#include "render/color.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::render {

/// How a shape meets the depth buffer.
enum class DepthRule : std::uint8_t {
  test_and_write,
  test,  ///< is covered, and covers nothing
  none,  ///< covers what was drawn before it
};

/// A point of the picture.
struct PixelPoint {
  double x = 0;  ///< pixels right of the picture's left edge
  double y = 0;  ///< pixels below its upper edge
  double z = 0;  ///< depth, from 0 (near) to 1
};

/// Draws triangles of one colour each, with four samples a pixel, in the calling thread.
///
/// Positions are rounded to 1/256 pixel and all coverage is decided in integers, so that two triangles that
/// share an edge leave no gap and cover no sample twice. The picture is made in tiles that fit into the
/// first-level cache; a tile whose shapes are those of the picture before is not drawn again.
///
/// cost    12 ns a small triangle, and 4 ms for the tiles of 1280 x 720 pixels where all have changed
/// checks  the same bytes for the same calls, whatever was drawn before; on any processor
class Raster {
 public:
  /// Points farther than this from the picture's upper left corner, pixels, must have been clipped off.
  static constexpr double k_guard = 1 << 20;

  /// Begins a picture: sides of at least 1 pixel. A ground that is not opaque must be (0, 0, 0, 0).
  void begin(int width, int height, Rgba ground);
  /// From here on shapes cover everything that was drawn before.
  void clear_depth() { ++epoch_; }
  void add_triangle(const std::array<PixelPoint, 3>& corners, Rgba color, DepthRule rule);
  /// A square with this point in its middle and a side of `size` pixels.
  void add_square(const PixelPoint& middle, double size, Rgba color, DepthRule rule);
  /// 8-bit RGBA, row 0 on top; opacity is not multiplied into the colours. Ends the picture.
  std::vector<std::uint8_t> finish();

 private:
  /// A triangle or an upright rectangle, clipped to nothing.
  struct Shape {
    std::array<std::int32_t, 3> x;  ///< 1/256 pixel; of a rectangle the first two: left and right
    std::array<std::int32_t, 3> y;
    double z, z_x, z_y;  ///< depth at the picture's upper left corner, and its change from pixel to pixel
    Rgba color;
    std::uint32_t epoch;
    DepthRule rule;
    bool is_rectangle;

    bool operator==(const Shape&) const = default;
  };
  struct Tile;
  /// All shapes of a picture, and which of them each tile shows, in the order of drawing.
  struct Shapes {
    int width = 0;
    int height = 0;
    Rgba ground{};
    std::vector<Shape> all;
    std::vector<std::uint32_t> starts;    ///< of each tile's list in `of_tiles`, and the end of the last
    std::vector<std::uint32_t> of_tiles;  ///< indices into `all`

    std::span<const std::uint32_t> of_tile(std::size_t tile) const;
  };

  void sort_into_tiles();
  bool is_as_before(std::size_t tile) const;
  void draw_tile(std::size_t tile, Tile& tile_pixels, std::vector<std::uint8_t>& rgba) const;

  std::uint32_t epoch_ = 0;
  Shapes now_;
  Shapes before_;
  std::vector<std::uint8_t> rgba_before_;  ///< the picture of `before_`; empty: it was too large to keep
};

}  // namespace troupe::render
