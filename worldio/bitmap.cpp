#include "worldio/bitmap.hpp"

#include "worldio/stage_files.hpp"

#define STBI_NO_STDIO
#include <stb/stb_image.h>

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string_view>

namespace troupe::worldio {
namespace {

constexpr int k_darkest_free = 128;  // of 255: what is darker is solid

/// True when a chunk of a PNG is cut off or does not fit its checksum. stb_image does not look, and a map
/// with a flipped bit would be another map.
bool png_is_damaged(std::string_view bytes) {
  constexpr std::string_view k_signature = "\x89PNG\r\n\x1a\n";
  if (!bytes.starts_with(k_signature)) return false;
  const auto number = [&](std::size_t at) {
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) n = n << 8 | static_cast<unsigned char>(bytes[at + i]);
    return n;
  };
  constexpr std::size_t k_frame = 12;  // a chunk's length, kind and checksum
  for (std::size_t at = k_signature.size(); bytes.size() - at >= k_frame;) {
    const std::size_t length = number(at);
    if (length > bytes.size() - at - k_frame) return true;
    const auto* kind_and_data = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    if (crc32(0, kind_and_data, static_cast<uInt>(length + 4)) != number(at + 8 + length)) return true;
    if (bytes.substr(at + 4, 4) == "IEND") return false;
    at += k_frame + length;
  }
  return true;
}

/// The directed unit edges around the solid pixels that are left when those between two solid pixels cancel,
/// as the set of directions in which they leave each corner of the pixel lattice (image axes, +y down).
class BoundaryEdges {
 public:
  // In the order of the corners they lead to, x before y: the first one set is the one Stage takes.
  enum Direction : std::uint8_t { left = 1, up = 2, down = 4, right = 8 };

  explicit BoundaryEdges(const Bitmap& bitmap)
      : rows_(static_cast<std::size_t>(bitmap.height) + 1),
        leaving_((static_cast<std::size_t>(bitmap.width) + 1) * rows_, 0) {
    for (int y = 0; y < bitmap.height; ++y)
      for (int x = 0; x < bitmap.width; ++x) {
        if (!bitmap.solid[static_cast<std::size_t>(y) * bitmap.width + x]) continue;
        if (!bitmap.at(x, y - 1)) at(x, y) |= right;
        if (!bitmap.at(x + 1, y)) at(x + 1, y) |= down;
        if (!bitmap.at(x, y + 1)) at(x + 1, y + 1) |= left;
        if (!bitmap.at(x - 1, y)) at(x, y + 1) |= up;
      }
  }

  std::size_t corners() const { return leaving_.size(); }
  /// Corners are numbered by x, then y.
  int x_of(std::size_t corner) const { return static_cast<int>(corner / rows_); }
  int y_of(std::size_t corner) const { return static_cast<int>(corner % rows_); }
  bool any_leaves(std::size_t corner) const { return leaving_[corner] != 0; }

  /// Takes one edge out and returns the corner it leads to.
  std::size_t follow(std::size_t corner) {
    std::uint8_t& set = leaving_[corner];
    const auto first = static_cast<std::uint8_t>(set & (~set + 1));
    set = static_cast<std::uint8_t>(set & ~first);
    switch (first) {
      case left: return corner - rows_;
      case up: return corner - 1;
      case down: return corner + 1;
      default: return corner + rows_;
    }
  }

 private:
  std::uint8_t& at(int x, int y) { return leaving_[static_cast<std::size_t>(x) * rows_ + y]; }

  std::size_t rows_;
  std::vector<std::uint8_t> leaving_;
};

}  // namespace

std::optional<Bitmap> read_bitmap(const std::filesystem::path& file, Where where, Diagnostics& diagnostics) {
  const std::optional<std::string> bytes = read_file(file);
  if (!bytes) {
    diagnostics.error(where, fmt::format("cannot read the image {}", file.string()));
    return {};
  }
  if (bytes->size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    diagnostics.error(where, fmt::format("the image {} is larger than 2 GB", file.string()));
    return {};
  }
  if (png_is_damaged(*bytes)) {
    diagnostics.error(where,
                      fmt::format("the image {} is damaged: a checksum in it does not fit", file.string()));
    return {};
  }
  Bitmap bitmap;
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes->data()), static_cast<int>(bytes->size()),
                            &bitmap.width, &bitmap.height, &channels, 0),
      stbi_image_free);
  if (!pixels) {
    diagnostics.error(where, fmt::format("{} is no PNG, JPEG, BMP or PNM image that can be read ({})",
                                         file.string(), stbi_failure_reason()));
    return {};
  }
  const std::size_t count = static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height);
  bitmap.solid.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    bitmap.solid[i] = pixels.get()[i * static_cast<std::size_t>(channels)] < k_darkest_free;
  return bitmap;
}

std::vector<Ring> bitmap_contours(const Bitmap& bitmap) {
  BoundaryEdges edges(bitmap);
  std::vector<Ring> rings;
  for (std::size_t start = 0; start < edges.corners(); ++start)
    while (edges.any_leaves(start)) {
      Ring ring;
      std::size_t corner = start;
      do {
        const Vec2 point(edges.x_of(corner), -edges.y_of(corner));
        // Straight runs become one edge, but as in Stage never among the first three points.
        const std::size_t n = ring.size();
        if (n > 2 && cross(ring[n - 1] - ring[n - 2], point - ring[n - 1]) == 0)
          ring.back() = point;
        else
          ring.push_back(point);
        corner = edges.follow(corner);
      } while (corner != start);
      rings.push_back(std::move(ring));
    }
  return rings;
}

void add_boundary(const Eigen::Vector3d& size, std::vector<Solid>& solids) {
  constexpr double k_thickness = 0.01;  // m, as in Stage
  const double x = size.x() / 2;
  const double y = size.y() / 2;
  const double t = std::min({k_thickness, x, y});
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    solids.push_back({{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}}, {0, size.z()}});
  };
  wall(-x, -y, -x + t, y);
  wall(x - t, -y, x, y);
  wall(-x, -y, x, -y + t);
  wall(-x, y - t, x, y);
}

void normalise(std::vector<Solid>& solids, const Eigen::Vector3d& size) {
  Box box;
  ZInterval z{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Solid& solid : solids) {
    for (const Ring& ring : solid.contours)
      for (const Vec2& point : ring) box.extend(point);
    z.min = std::min(z.min, solid.z.min);
    z.max = std::max(z.max, solid.z.max);
  }
  if (box.empty()) return;
  const auto scale = [](double wanted, double extent) { return extent > 0 ? wanted / extent : 1.0; };
  const Vec2 center = box.center();
  const Vec2 factor(scale(size.x(), box.size().x()), scale(size.y(), box.size().y()));
  const double factor_z = scale(size.z(), z.max - z.min);
  for (Solid& solid : solids) {
    for (Ring& ring : solid.contours)
      for (Vec2& point : ring) point = (point - center).cwiseProduct(factor);
    solid.z = {solid.z.min * factor_z, solid.z.max * factor_z};
  }
}

}  // namespace troupe::worldio
