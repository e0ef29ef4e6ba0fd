#include "render/raster.hpp"

#include "base/assert.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace troupe::render {
namespace {

constexpr int k_tile = 32;  // pixels; a tile's samples take 32 KiB
constexpr std::size_t k_tile_pixels = std::size_t{k_tile} * k_tile;
constexpr int k_sub = 256;  // of a pixel
constexpr std::size_t k_samples = 4;
// Of a pixel, from its upper left corner: no two in one row or column, as Direct3D and Vulkan define them.
constexpr std::array<int, k_samples> k_sample_x = {96, 224, 32, 160};
constexpr std::array<int, k_samples> k_sample_y = {32, 96, 160, 224};
constexpr double k_deepest = 1 << 24;
/// Larger pictures are drawn once: keeping them would double the memory of a poster.
constexpr std::size_t k_most_kept_pixels = 4096 * 2304;

std::uint32_t packed(Rgba color) { return std::bit_cast<std::uint32_t>(color); }

// Two of a colour's four channels at a time, each in 16 bits.
constexpr std::uint32_t k_even = 0x00ff00ff;

/// An opaque colour that is drawn over others with an opacity.
struct Blend {
  std::uint32_t even, odd;  ///< channels times opacity, and one half
  std::uint32_t rest;       ///< 255 less opacity

  explicit Blend(Rgba color) : rest(255U - color[3]) {
    const std::uint32_t opacity = color[3];
    const std::uint32_t opaque = packed({color[0], color[1], color[2], 255});
    even = (opaque & k_even) * opacity + 0x00800080;
    odd = ((opaque >> 8) & k_even) * opacity + 0x00800080;
  }
  /// Each channel of color * opacity + below * (1 - opacity), rounded.
  std::uint32_t over(std::uint32_t below) const {
    const std::uint32_t a = (below & k_even) * rest + even;
    const std::uint32_t b = ((below >> 8) & k_even) * rest + odd;
    // (v + v / 256) / 256 is v / 255 for all sums that there can be.
    return ((a + ((a >> 8) & k_even)) >> 8 & k_even) | ((b + ((b >> 8) & k_even)) & ~k_even);
  }
};

/// The sides of a triangle: positive inside, and 0 on the sides that belong to it.
struct Side {
  std::int64_t a, b, c;  ///< of a * x + b * y + c
};

std::array<Side, 3> sides_of(const std::array<std::int32_t, 3>& x, const std::array<std::int32_t, 3>& y) {
  std::array<Side, 3> sides{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    Side& side = sides[i];
    side.a = std::int64_t{y[i]} - y[k];
    side.b = std::int64_t{x[k]} - x[i];
    side.c = -(side.a * x[i] + side.b * y[i]);
    // A sample on a side is that of the triangle on its right, or below it.
    if (!(side.a > 0 || (side.a == 0 && side.b > 0))) --side.c;
  }
  return sides;
}

/// In 1/256 pixel, rounded. The sum is positive for all that are within the guard, so that cutting it off
/// rounds down.
std::int32_t placed(double pixels) {
  constexpr double k_shift = 1 << 29;
  return static_cast<std::int32_t>(pixels * k_sub + k_shift + 0.5) - static_cast<std::int32_t>(k_shift);
}

/// A depth in the units of the buffer.
std::int32_t buffer_depth(float depth) {
  return static_cast<std::int32_t>(std::clamp(depth, 0.0F, static_cast<float>(k_deepest)));
}

/// The least pixel whose sample lies at or beyond a coordinate in 1/256 pixel.
int first_pixel(std::int32_t coordinate, int sample) {
  return static_cast<int>((std::int64_t{coordinate} - sample + k_sub - 1) >> 8);
}

}  // namespace

/// The samples of a tile, in a plane for each of the four.
struct Raster::Tile {
  int left = 0;  // pixels
  int top = 0;
  std::array<std::array<std::uint32_t, k_tile_pixels>, k_samples> color;
  std::array<std::array<std::int32_t, k_tile_pixels>, k_samples> depth;

  void clear_depth() {
    for (auto& plane : depth) plane.fill(static_cast<std::int32_t>(k_deepest));
  }

  /// Pixels [begin, end) of a row of the tile.
  void fill(std::size_t sample, int row, int begin, int end, const Shape& shape) {
    const std::size_t offset = static_cast<std::size_t>(row) * k_tile + static_cast<std::size_t>(begin);
    const auto n = static_cast<std::size_t>(end - begin);
    std::uint32_t* const to = color[sample].data() + offset;
    const std::uint32_t opaque = packed(shape.color);
    const Blend blend(shape.color);
    const bool is_opaque = shape.color[3] == 255;
    if (shape.rule == DepthRule::none) {
      if (is_opaque)
        std::fill_n(to, n, opaque);
      else
        for (std::size_t i = 0; i < n; ++i) to[i] = blend.over(to[i]);
      return;
    }
    std::int32_t* const nearest = depth[sample].data() + offset;
    const double x = left + begin + k_sample_x[sample] / double{k_sub};
    const double y = top + row + k_sample_y[sample] / double{k_sub};
    const auto first = static_cast<float>((shape.z + shape.z_x * x + shape.z_y * y) * k_deepest);
    const auto step = static_cast<float>(shape.z_x * k_deepest);
    const bool writes = shape.rule == DepthRule::test_and_write;
    if (is_opaque && writes) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::int32_t here = buffer_depth(first + step * static_cast<float>(static_cast<int>(i)));
        const bool is_seen = here <= nearest[i];
        to[i] = is_seen ? opaque : to[i];
        nearest[i] = is_seen ? here : nearest[i];
      }
      return;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::int32_t here = buffer_depth(first + step * static_cast<float>(static_cast<int>(i)));
      const bool is_seen = here <= nearest[i];
      to[i] = is_seen ? blend.over(to[i]) : to[i];
      nearest[i] = is_seen && writes ? here : nearest[i];
    }
  }

  void add_rectangle(const Shape& shape) {
    for (std::size_t s = 0; s < k_samples; ++s) {
      const int begin = std::max(first_pixel(shape.x[0], k_sample_x[s]) - left, 0);
      const int end = std::min(first_pixel(shape.x[1], k_sample_x[s]) - left, k_tile);
      const int first = std::max(first_pixel(shape.y[0], k_sample_y[s]) - top, 0);
      const int last = std::min(first_pixel(shape.y[1], k_sample_y[s]) - top, k_tile);
      for (int row = first; row < last && begin < end; ++row) fill(s, row, begin, end, shape);
    }
  }

  void add_triangle(const Shape& shape) {
    const std::array<Side, 3> sides = sides_of(shape.x, shape.y);
    const auto [low, high] = std::ranges::minmax(shape.y);
    for (std::size_t s = 0; s < k_samples; ++s) {
      const int first = std::max(first_pixel(low, k_sample_y[s]) - top, 0);
      const int last = std::min(first_pixel(high + 1, k_sample_y[s]) - top, k_tile);
      for (int row = first; row < last; ++row) {
        std::int64_t begin = 0;
        std::int64_t end = k_tile;
        for (const Side& side : sides) {
          const std::int64_t at_left = side.a * (std::int64_t{left} * k_sub + k_sample_x[s]) +
                                       side.b * (std::int64_t{top + row} * k_sub + k_sample_y[s]) + side.c;
          const std::int64_t step = side.a * k_sub;
          if (step > 0 && at_left < 0)
            begin = std::max(begin, (step - 1 - at_left) / step);
          else if (step < 0 && at_left >= 0)
            end = std::min(end, at_left / -step + 1);
          else if (step <= 0 && at_left < 0)
            end = 0;
        }
        if (begin < end) fill(s, row, static_cast<int>(begin), static_cast<int>(end), shape);
      }
    }
  }
};

std::span<const std::uint32_t> Raster::Shapes::of_tile(std::size_t tile) const {
  return std::span(of_tiles).subspan(starts[tile], starts[tile + 1] - starts[tile]);
}

void Raster::begin(int width, int height, Rgba ground) {
  TROUPE_ASSERT(width >= 1 && height >= 1);
  epoch_ = 0;
  now_.width = width;
  now_.height = height;
  now_.ground = ground;
  now_.all.clear();
}

void Raster::add_triangle(const std::array<PixelPoint, 3>& corners, Rgba color, DepthRule rule) {
  Shape shape{.x{},
              .y{},
              .z = 0,
              .z_x = 0,
              .z_y = 0,
              .color = color,
              .epoch = epoch_,
              .rule = rule,
              .is_rectangle = false};
  for (std::size_t i = 0; i < 3; ++i) {
    shape.x[i] = placed(corners[i].x);
    shape.y[i] = placed(corners[i].y);
  }
  const std::int64_t area =
      (std::int64_t{shape.x[1]} - shape.x[0]) * (std::int64_t{shape.y[2]} - shape.y[0]) -
      (std::int64_t{shape.y[1]} - shape.y[0]) * (std::int64_t{shape.x[2]} - shape.x[0]);
  if (area == 0 || color[3] == 0) return;
  const auto [left, right] = std::ranges::minmax(shape.x);
  const auto [top, bottom] = std::ranges::minmax(shape.y);
  if (right < 0 || bottom < 0 || left > now_.width * k_sub || top > now_.height * k_sub) return;
  if (area < 0) {
    std::swap(shape.x[1], shape.x[2]);
    std::swap(shape.y[1], shape.y[2]);
  }
  // The plane through the corners as they were given: after rounding a sliver's slope would be far off.
  const auto& [p, q, r] = corners;
  const double twice = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  constexpr double k_least_area = 1e-9;  // square pixels; less has no slope that can be seen
  if (rule != DepthRule::none && std::abs(twice) > k_least_area) {
    shape.z_x = ((q.z - p.z) * (r.y - p.y) - (q.y - p.y) * (r.z - p.z)) / twice;
    shape.z_y = ((q.x - p.x) * (r.z - p.z) - (q.z - p.z) * (r.x - p.x)) / twice;
  }
  shape.z = p.z - shape.z_x * p.x - shape.z_y * p.y;
  now_.all.push_back(shape);
}

void Raster::add_square(const PixelPoint& middle, double size, Rgba color, DepthRule rule) {
  const double half = size / 2;
  const Shape shape{.x = {placed(middle.x - half), placed(middle.x + half), 0},
                    .y = {placed(middle.y - half), placed(middle.y + half), 0},
                    .z = middle.z,
                    .z_x = 0,
                    .z_y = 0,
                    .color = color,
                    .epoch = epoch_,
                    .rule = rule,
                    .is_rectangle = true};
  if (color[3] == 0 || shape.x[1] < 0 || shape.y[1] < 0 || shape.x[0] > now_.width * k_sub ||
      shape.y[0] > now_.height * k_sub)
    return;
  now_.all.push_back(shape);
}

void Raster::sort_into_tiles() {
  constexpr int k_tile_sub = k_tile * k_sub;
  const int columns = (now_.width + k_tile - 1) / k_tile;
  const int rows = (now_.height + k_tile - 1) / k_tile;
  std::vector<std::uint32_t>& starts = now_.starts;
  starts.assign(static_cast<std::size_t>(columns) * rows + 1, 0);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> met;  // tile and shape, in the order of drawing
  for (std::size_t i = 0; i < now_.all.size(); ++i) {
    const Shape& shape = now_.all[i];
    const std::size_t corners = shape.is_rectangle ? 2 : 3;
    const auto [left, right] = std::ranges::minmax(std::span(shape.x).first(corners));
    const auto [top, bottom] = std::ranges::minmax(std::span(shape.y).first(corners));
    const int first_column = std::max(left / k_tile_sub, 0);
    const int last_column = std::min(right / k_tile_sub, columns - 1);
    const int first_row = std::max(top / k_tile_sub, 0);
    const int last_row = std::min(bottom / k_tile_sub, rows - 1);
    // Of a shape that is larger than a tile many of those in its box may lie beside it.
    const bool looks_closer = !shape.is_rectangle && last_column > first_column && last_row > first_row;
    const std::array<Side, 3> sides = looks_closer ? sides_of(shape.x, shape.y) : std::array<Side, 3>{};
    for (int row = first_row; row <= last_row; ++row) {
      for (int column = first_column; column <= last_column; ++column) {
        const auto lies_beside = [&](const Side& side) {  // for the corner that is farthest inside
          const std::int64_t x = std::int64_t{column + (side.a > 0 ? 1 : 0)} * k_tile_sub;
          const std::int64_t y = std::int64_t{row + (side.b > 0 ? 1 : 0)} * k_tile_sub;
          return side.a * x + side.b * y + side.c < 0;
        };
        if (looks_closer && std::ranges::any_of(sides, lies_beside)) continue;
        const auto tile = static_cast<std::uint32_t>(row * columns + column);
        met.emplace_back(tile, static_cast<std::uint32_t>(i));
        ++starts[tile + 1];
      }
    }
  }
  for (std::size_t tile = 1; tile < starts.size(); ++tile) starts[tile] += starts[tile - 1];
  now_.of_tiles.resize(met.size());
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
  for (const auto& [tile, shape] : met) now_.of_tiles[next[tile]++] = shape;
}

bool Raster::is_as_before(std::size_t tile) const {
  return std::ranges::equal(now_.of_tile(tile), before_.of_tile(tile),
                            [&](std::uint32_t a, std::uint32_t b) { return now_.all[a] == before_.all[b]; });
}

void Raster::draw_tile(std::size_t tile, Tile& pixels, std::vector<std::uint8_t>& rgba) const {
  const auto columns = static_cast<std::size_t>((now_.width + k_tile - 1) / k_tile);
  pixels.left = static_cast<int>(tile % columns) * k_tile;
  pixels.top = static_cast<int>(tile / columns) * k_tile;
  const auto wide = static_cast<std::size_t>(std::min(k_tile, now_.width - pixels.left));
  const auto high = static_cast<std::size_t>(std::min(k_tile, now_.height - pixels.top));
  const auto row_of = [&](std::size_t row) {
    const std::size_t first =
        (static_cast<std::size_t>(pixels.top) + row) * static_cast<std::size_t>(now_.width) +
        static_cast<std::size_t>(pixels.left);
    return rgba.data() + 4 * first;
  };
  const auto store = [](std::uint8_t* to, std::uint32_t color) {
    const auto channels = std::bit_cast<Rgba>(color);
    std::ranges::copy(channels, to);
  };
  const std::span<const std::uint32_t> shapes = now_.of_tile(tile);
  if (shapes.empty()) {
    for (std::size_t row = 0; row < high; ++row)
      for (std::size_t i = 0; i < wide; ++i) store(row_of(row) + 4 * i, packed(now_.ground));
    return;
  }

  for (auto& plane : pixels.color) plane.fill(packed(now_.ground));
  std::uint32_t epoch = std::numeric_limits<std::uint32_t>::max();
  for (const std::uint32_t index : shapes) {
    const Shape& shape = now_.all[index];
    if (shape.epoch != std::exchange(epoch, shape.epoch)) pixels.clear_depth();
    if (shape.is_rectangle)
      pixels.add_rectangle(shape);
    else
      pixels.add_triangle(shape);
  }

  const auto& [a, b, c, d] = pixels.color;
  const bool is_opaque = now_.ground[3] == 255;
  for (std::size_t row = 0; row < high; ++row) {
    std::uint8_t* const to = row_of(row);
    for (std::size_t i = 0; i < wide; ++i) {
      const std::size_t p = row * k_tile + i;
      const std::uint32_t even =
          (a[p] & k_even) + (b[p] & k_even) + (c[p] & k_even) + (d[p] & k_even) + 0x00020002;
      const std::uint32_t odd = ((a[p] >> 8) & k_even) + ((b[p] >> 8) & k_even) + ((c[p] >> 8) & k_even) +
                                ((d[p] >> 8) & k_even) + 0x00020002;
      store(to + 4 * i, (even >> 2 & k_even) | ((odd >> 2 & k_even) << 8));
    }
    for (std::size_t i = 0; !is_opaque && i < wide;
         ++i) {  // what was drawn on nothing is multiplied by its opacity
      std::uint8_t* const pixel = to + 4 * i;
      const unsigned opacity = pixel[3];
      for (std::size_t k = 0; opacity > 0 && k < 3; ++k)
        pixel[k] = static_cast<std::uint8_t>(std::min(255U, (255U * pixel[k] + opacity / 2) / opacity));
    }
  }
}

std::vector<std::uint8_t> Raster::finish() {
  sort_into_tiles();
  const bool is_like_before = !rgba_before_.empty() && now_.width == before_.width &&
                              now_.height == before_.height && now_.ground == before_.ground;
  const std::size_t pixels = static_cast<std::size_t>(now_.width) * static_cast<std::size_t>(now_.height);
  std::vector<std::uint8_t> rgba;
  if (is_like_before)
    rgba = std::move(rgba_before_);
  else
    rgba.resize(4 * pixels);
  const auto tile_pixels = std::make_unique<Tile>();
  for (std::size_t tile = 0; tile + 1 < now_.starts.size(); ++tile)
    if (!is_like_before || !is_as_before(tile)) draw_tile(tile, *tile_pixels, rgba);
  rgba_before_.clear();
  if (pixels <= k_most_kept_pixels) rgba_before_ = rgba;
  std::swap(now_, before_);
  return rgba;
}

}  // namespace troupe::render
