#include "worldio/images/floor_image.hpp"

#include "base/limits.hpp"
#include "base/split.hpp"
#include "worldio/images/bitmap.hpp"
#include "worldio/images/ros_map.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

/// Whether a map fits into the world. Reports an error at the map's resolution if it is too wide or too high.
/// Larger maps would need memory for every part of the world that they cover.
bool fits_world(const Bitmap& bitmap, const RosMap& map, Diagnostics& diagnostics) {
  constexpr double k_most_m = 2 * k_world_reach_m;
  const auto fits = [&](int pixels, std::string_view direction) {
    const double size_m = pixels * map.resolution_m;
    if (size_m <= k_most_m) return true;
    diagnostics.error(map.where_resolution,
                      fmt::format("the map is larger than the world, which is {:g} km wide and high: {} "
                                  "pixels of {:g} m make the map {:g} km {}",
                                  k_most_m / 1000, pixels, map.resolution_m, size_m / 1000, direction));
    return false;
  };
  const bool fits_x = fits(bitmap.width, "wide");
  const bool fits_y = fits(bitmap.height, "high");
  return fits_x && fits_y;
}

std::optional<FloorImage> read_map(const std::filesystem::path& file, bool unknown_is_solid, Where where,
                                   Diagnostics& diagnostics) {
  const std::optional<RosMap> map = read_ros_map(file, where, diagnostics);
  if (!map) return {};
  PixelRule is_solid = solid_cells(*map, unknown_is_solid);
  bool has_unknown = false;
  if (unknown_is_solid)
    is_solid = [&has_unknown, with_unknown = is_solid,
                occupied = solid_cells(*map, false)](std::span<const std::uint8_t> channels) {
      const bool solid = with_unknown(channels);
      if (solid && !has_unknown) has_unknown = !occupied(channels);
      return solid;
    };
  const auto bitmap = read_bitmap(map->image, map->where_image, diagnostics, is_solid);
  if (!bitmap || !fits_world(*bitmap, *map, diagnostics)) return {};
  FloorImage image{bitmap->width, bitmap->height, bitmap_contours(*bitmap), {}};
  const Eigen::Vector2d size = map->resolution_m * Eigen::Vector2d(bitmap->width, bitmap->height);
  image.place = {size, compose(map->pose_map_corner, {size.x() / 2, size.y() / 2, 0, 0}),
                 unknown_is_solid && !has_unknown};
  return image;
}

}  // namespace

std::string FloorImage::unsolid_text(const engine::ImageSpec& spec) const {
  const std::string walls = spec.boundary ? "only its \"boundary\" has walls" : "it has no walls";
  return place ? fmt::format(
                     "the ROS map {} has no occupied cell, so {}; if it should have, check its image, "
                     "\"negate\" and \"occupied_thresh\"",
                     spec.file, walls)
               : fmt::format(
                     "the image {} has no solid pixel, so {}; pixels whose first channel is at most 127 "
                     "are solid",
                     spec.file, walls);
}

std::string FloorImage::margins_text(const std::string& file, std::string_view keep) const {
  if (place || contours.empty()) return {};
  Box box;
  for (const Ring& ring : contours) box.extend(bounds(ring));
  const double columns = width - box.size().x();
  const double rows = height - box.size().y();
  std::vector<std::string> cut, grown;
  const auto add = [&](double pixels, double all, std::string_view what, std::string_view axis) {
    if (pixels <= 0) return;
    cut.push_back(fmt::format("{:g} of its {:g} {}", pixels, all, what));
    grown.push_back(fmt::format("{:.4g} in {}", all / (all - pixels), axis));
  };
  add(columns, width, "columns", "x");
  add(rows, height, "rows", "y");
  if (cut.empty()) return {};
  return fmt::format(
      "the white margins of the image {} are cut off, as in Stage: {}; the walls grow by a factor of "
      "{}; {} keeps the margins",
      file, joined(cut, " and "), joined(grown, " and "), keep);
}

Solid FloorImage::solid(const Eigen::Vector3d& size) const {
  Solid solid{contours, {0, size.z()}};
  fit_image(width, height, size, solid.contours);
  return solid;
}

std::vector<Solid> floor_plan_body(const FloorImage& image, const engine::ImageSpec& spec,
                                   Eigen::Vector3d& size) {
  std::vector<Solid> solids;
  if (image.place) size.head<2>() = image.place->size_m;
  if (image.contours.empty()) {  // no solid pixel: only the boundary
  } else if (image.place || spec.keeps_margins) {
    solids.push_back(image.solid(size));
  } else {
    solids.push_back({image.contours, {0, 1}});
    normalise(solids, size);
  }
  if (spec.boundary) add_boundary(size, solids);
  if (image.place)
    for (Solid& solid : solids) solid = placed(std::move(solid), image.place->pose_map_center);
  return solids;
}

std::vector<Solid> image_body(const FloorImage& image, const engine::ImageSpec& spec, Eigen::Vector3d& size) {
  std::vector<Solid> solids = floor_plan_body(image, spec, size);
  if (image.place) return solids;
  Box frame;  // bounding box of the whole image if its margins are kept, else empty
  if (spec.keeps_margins) {
    frame.max = size.head<2>() / 2;
    frame.min = -frame.max;
  }
  normalise(solids, size, frame);
  return solids;
}

const FloorImage* FloorImages::read(const std::filesystem::path& file, bool unknown_is_solid, Where where) {
  const auto [entry, is_new] = images_.try_emplace({file.string(), unknown_is_solid});
  if (is_new && is_ros_map(file)) {
    entry->second = read_map(file, unknown_is_solid, where, diagnostics_);
  } else if (is_new) {
    if (const auto bitmap = read_bitmap(file, where, diagnostics_))
      entry->second = FloorImage{bitmap->width, bitmap->height, bitmap_contours(*bitmap), {}};
  }
  return entry->second ? &*entry->second : nullptr;
}

}  // namespace troupe::worldio
