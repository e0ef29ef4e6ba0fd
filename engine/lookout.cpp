#include "engine/lookout.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace troupe::engine {
namespace {

using partition::BodyCircle;

// Marks of circles of pieces; rows lie below both.
constexpr std::uint32_t k_seen = 1u << 31;    // in StaticScene::outlines()
constexpr std::uint32_t k_hidden = 1u << 30;  // in StaticScene::hidden_outlines()
constexpr std::size_t k_room = 1024;          // circles: a crowd of that size grows the arrays at once
// Where there are many circles, some of them are looked at first, the nearest: what they hide need not be.
constexpr std::size_t k_many = 48;
constexpr double k_at_hand = 20;

constexpr std::array<float, partition::k_most_beams> k_no_offsets{};

/// Whether a circle comes within a reach of a point, and some that just do not.
class Nearby {
 public:
  Nearby(const Vec2& point, double reach)
      : x_(static_cast<float>(point.x())), y_(static_cast<float>(point.y())) {
    const double rounding = 0x1p-23 * (std::abs(point.x()) + std::abs(point.y()));
    reach_ = static_cast<float>((reach + rounding) * (1 + 0x1p-20) + partition::k_cull_slack);
  }
  bool operator()(const BodyCircle& circle) const {
    const float dx = circle.x - x_;
    const float dy = circle.y - y_;
    const float touching = circle.radius + reach_;
    return dx * dx + dy * dy <= touching * touching;
  }

 private:
  float x_, y_, reach_;
};

}  // namespace

void Lookout::stand(const World& world, const Vec2& origin, double reach, Row own, std::optional<double> z) {
  world_ = &world;
  origin_ = origin;
  z_ = z;
  fixed_reach_ = -1;
  circles_.make_room(std::min(world.rows(), k_room) + partition::k_circle_padding);
  std::size_t count = 0;
  const Nearby is_near(origin, reach);
  // Wide bodies lie in several cells of the index.
  const float wide = world.index().has_wide() ? static_cast<float>(0.5 * world.geometry().cell_m)
                                              : std::numeric_limits<float>::infinity();
  const auto is_known = [&](std::uint32_t row) {
    const std::span<const std::uint32_t> rows(circles_.row.data(), count);
    return std::ranges::find(rows, row) != rows.end();
  };
  world.index().for_each_run(Box::around(origin, reach), [&](std::span<const BodyCircle> run) {
    circles_.make_room(count + run.size());
    for (const BodyCircle& circle : run) {
      if (!is_near(circle) || (circle.radius > wide && is_known(circle.row))) continue;
      if (!own.valid() || !world.same_tree(Row(circle.row), own)) circles_.set(count++, circle);
    }
  });
  bodies_ = size_ = count;
}

void Lookout::find_fixed(double reach) {
  fixed_reach_ = reach;
  std::size_t count = bodies_;
  const Nearby is_near(origin_, reach);
  const auto find = [&](const partition::FixedOutlines& outlines, std::uint32_t mark) {
    const Box centres = Box::around(origin_, reach + outlines.largest_radius());
    const partition::GridGeometry& grid = outlines.geometry();
    outlines.for_each_run(grid.cell(centres.min), grid.cell(centres.max),
                          [&](std::span<const BodyCircle> run) {
                            circles_.make_room(count + run.size());
                            for (const BodyCircle& circle : run) {
                              circles_.set(count, {circle.x, circle.y, circle.radius, circle.row | mark});
                              count += is_near(circle);
                            }
                          });
  };
  find(world_->scene().outlines(), k_seen);
  find(world_->scene().hidden_outlines(), k_hidden);
  circles_.make_room(count + partition::k_circle_padding);
  while (count % partition::k_circle_padding != 0)
    circles_.set(count++, {0, 0, -std::numeric_limits<float>::infinity(), 0});
  size_ = count;
}

void Lookout::first_met(std::span<const SightLine> rays, std::span<Sighting> found) {
  double longest = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    found[i] = {.range = rays[i].length};
    longest = std::max(longest, rays[i].length);
  }
  if (longest > fixed_reach_) find_fixed(longest);
  for (std::size_t first = 0; first < rays.size(); first += partition::k_most_beams) {
    const std::size_t count = std::min(rays.size() - first, partition::k_most_beams);
    fan_out(rays.subspan(first, count), found.subspan(first, count), longest);
  }
}

/// Up to as many rays as a fan has beams.
void Lookout::fan_out(std::span<const SightLine> rays, std::span<Sighting> found, double longest) {
  rays_ = rays;
  found_ = found;
  const std::size_t padded = partition::padded_beams(rays.size());
  for (std::size_t i = 0; i < padded; ++i) {
    const SightLine& ray = rays[std::min(i, rays.size() - 1)];
    dx_[i] = static_cast<float>(ray.direction.x());
    dy_[i] = static_cast<float>(ray.direction.y());
  }
  const auto most = static_cast<double>(size_);
  const double near = size_ > k_many ? longest * sqrt(k_at_hand / most) : longest;
  look(-std::numeric_limits<float>::infinity(), static_cast<float>(near));
  if (near < longest) look(static_cast<float>(near), static_cast<float>(longest));
}

/// At circles whose nearest point lies from low to high away, as far as rays still go.
void Lookout::look(float low, float high) {
  float farthest = 0;
  for (std::size_t i = 0; i < partition::padded_beams(rays_.size()); ++i) {
    limits_[i] = static_cast<float>(found_[std::min(i, found_.size() - 1)].range) * (1 + 0x1p-20f);
    farthest = std::max(farthest, limits_[i]);
  }
  high = std::min(high, farthest);
  if (low > high) return;
  const partition::Fan fan{.dx = dx_.data(),
                           .dy = dy_.data(),
                           .ox = k_no_offsets.data(),
                           .oy = k_no_offsets.data(),
                           .count = rays_.size(),
                           .common_origin = true};
  const std::size_t met =
      partition::may_meet(circles_, 0, size_, origin_, fan, limits_.data(), low, high, met_);
  const partition::StaticScene& scene = world_->scene();
  for (std::size_t i = 0; i < met; ++i) {
    const std::uint32_t row = met_.row[i];
    const auto meet = [&](const OutlineChain& chain) { this->meet(chain, met_.beams[i]); };
    if ((row & k_seen) != 0)
      meet(fixed_chain(scene, scene.outlines(), row - k_seen));
    else if ((row & k_hidden) != 0)
      meet(fixed_chain(scene, scene.hidden_outlines(), row - k_hidden));
    else
      for_each_chain_of(*world_, Row(row), meet);
  }
}

void Lookout::meet(const OutlineChain& chain, partition::BeamSet rays) {
  if (z_ && !chain.z.contains(*z_)) return;
  for (; rays != 0; rays &= rays - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(rays));
    meet_chain(chain, origin_, rays_[i].direction, rays_[i].length, found_[i]);
  }
}

}  // namespace troupe::engine
