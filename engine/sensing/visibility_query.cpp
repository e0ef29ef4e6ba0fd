#include "engine/sensing/visibility_query.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe::engine {
namespace {

constexpr std::size_t k_room = 1024;  // initial capacity of the arrays, in circles
// With more circles than this, engine::first_met() is faster: it only tests circles near each ray.
constexpr std::size_t k_crowd = 512;
constexpr std::size_t k_sorted_crowd = 8192;  // the same, if the circles are sorted into sectors
// With fewer rays or circles, sorting takes longer than it saves.
constexpr std::size_t k_least_rays = 16;
constexpr std::size_t k_least_circles = 32;
constexpr float k_far = std::numeric_limits<float>::infinity();

double longest_of(std::span<const SightLine> rays) {
  double longest = 0;
  for (const SightLine& ray : rays) longest = std::max(longest, ray.length);
  return longest;
}

/// A number from 0 to 4 that increases with the bearing of a vector: 1 is a quarter of a turn. Its derivative
/// with respect to the bearing (rad) is at most 1.
float quarters(float x, float y) {
  if (y >= 0) return x >= 0 ? y / (x + y) : 1 + x / (x - y);
  return x < 0 ? 2 + y / (x + y) : 3 + x / (x - y);
}

}  // namespace

void VisibilityQuery::stand(const SensingView& view, const Vec2& origin, double reach, Row own,
                            std::optional<double> z) {
  view_ = &view;
  origin_ = origin;
  reach_ = reach;
  own_ = own;
  z_ = z;
  fixed_reach_ = -1;
  near_.change_capacity(std::min(view.rows(), k_room));
  near_.begin(origin, reach);
  near_.add_bodies(view.index(),
                   [&](std::uint32_t row) { return own.valid() && view.same_tree(Row(row), own); });
  bodies_ = near_.size();
}

void VisibilityQuery::find_fixed(double reach) {
  fixed_reach_ = reach;
  near_.keep(bodies_);
  near_.add_pieces(view_->scene().outlines(), reach, k_seen);
  near_.add_pieces(view_->scene().hidden_outlines(), reach, k_hidden);
}

void VisibilityQuery::first_met(std::span<const SightLine> rays, std::span<RayHit> found) {
  if (const double longest = longest_of(rays); longest > fixed_reach_) find_fixed(longest);
  const std::size_t size = near_.size();
  const bool is_sorted = rays.size() >= k_least_rays && size >= k_least_circles && size <= k_sorted_crowd;
  if (is_sorted) sort_into_sectors();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const SightLine& ray = rays[i];
    if (is_sorted) {
      const float at = quarters(static_cast<float>(ray.direction.x()), static_cast<float>(ray.direction.y()));
      const std::size_t sector = static_cast<std::size_t>(at * k_sectors_per_quarter) % k_sectors;
      found[i] = first_met(ray, sorted_, begins_[sector], begins_[sector + 1]);
    } else {
      found[i] = size > k_crowd ? search_along(ray) : first_met(ray, near_.circles(), 0, size);
    }
  }
}

/// Copies the circles to sorted_: each circle to all sectors that it reaches into, and perhaps to some more.
void VisibilityQuery::sort_into_sectors() {
  const partition::CircleArrays& circles = near_.circles();
  const std::size_t size = near_.size();
  if (reaches_.size() < size) reaches_.resize(2 * size);
  begins_.fill(0);
  for (std::size_t i = 0; i < size; ++i) {
    Reach reach{0, k_sectors};
    const float square = circles.x[i] * circles.x[i] + circles.y[i] * circles.y[i];
    const float radius = circles.radius[i];
    if (square > radius * radius) {
      // asin(a) is at most pi / 2 * a. The sum covers rounding.
      const float half = 1.6f * radius / std::sqrt(square) + 1e-3f;
      const float middle = quarters(circles.x[i], circles.y[i]) + 4;  // + 4, so that no sector is negative
      const auto first = static_cast<std::size_t>((middle - half) * k_sectors_per_quarter);
      const auto last = static_cast<std::size_t>((middle + half) * k_sectors_per_quarter);
      reach = {static_cast<std::uint8_t>(first % k_sectors),
               static_cast<std::uint8_t>(std::min(last - first + 1, k_sectors))};
    }
    reaches_[i] = reach;
    for (std::size_t k = 0; k < reach.count; ++k) ++begins_[(reach.first + k) % k_sectors + 1];
  }
  for (std::size_t k = 0; k < k_sectors; ++k) begins_[k + 1] += begins_[k];
  sorted_.change_capacity(begins_.back());
  std::array<std::uint32_t, k_sectors> next;
  std::copy_n(begins_.begin(), k_sectors, next.begin());
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t k = 0; k < reaches_[i].count; ++k)
      sorted_.set(next[(reaches_[i].first + k) % k_sectors]++,
                  {circles.x[i], circles.y[i], circles.radius[i], circles.row[i]});
}

void VisibilityQuery::first_met(const SensingView& view, const Vec2& origin, Row own, std::optional<double> z,
                                std::span<const SightLine> rays, std::span<RayHit> found) {
  if (rays.empty()) return;
  const double longest = longest_of(rays);
  // stand() visits a number of cells that grows with the square of the length. A search along a ray visits a
  // number that grows with the length, and takes as long as stand() for a length of about eight cells.
  constexpr double k_cells_per_ray = 8;
  const partition::GridGeometry& cells = view.geometry();
  const double ground = static_cast<double>(view.index().tiles()) * cells.tile_m() * cells.tile_m();
  const double bodies = static_cast<double>(view.index().order().size());
  const bool is_crowded = 3 * longest * longest * bodies > static_cast<double>(k_sorted_crowd) * ground;
  if (longest <= k_cells_per_ray * static_cast<double>(rays.size()) * cells.cell_m && !is_crowded) {
    stand(view, origin, longest, own, z);
    return first_met(rays, found);
  }
  view_ = &view;
  origin_ = origin;
  own_ = own;
  z_ = z;
  for (std::size_t i = 0; i < rays.size(); ++i) found[i] = search_along(rays[i]);
}

/// The first surface along a ray, found without the circles.
RayHit VisibilityQuery::search_along(const SightLine& ray) const {
  return engine::first_met(*view_, {.origin = origin_,
                                    .direction = ray.direction,
                                    .length = ray.length,
                                    .own = own_,
                                    .z = z_,
                                    .target = ray.target});
}

/// The first surface along a ray, found among the circles [first, end).
RayHit VisibilityQuery::first_met(const SightLine& ray, const partition::CircleArrays& circles,
                                  std::size_t first, std::size_t end) {
  RayHit nearest{.range_m = ray.length};
  const std::size_t count = find_hits(ray, circles, first, end);  // may reallocate hits_
  const std::span<Hit> hits(hits_.data(), count);
  std::ranges::sort(hits, {}, &Hit::near);
  for (const Hit& hit : hits) {
    if (hit.near > nearest.range_m) break;
    meet(hit.mark, ray, nearest);
  }
  return nearest;
}

/// Writes those of the circles [first, end) that the ray meets within its length to the front of hits_, and
/// returns their number. The compiler vectorizes the first loop.
std::size_t VisibilityQuery::find_hits(const SightLine& ray, const partition::CircleArrays& circles,
                                       std::size_t first, std::size_t end) {
  const std::size_t size = end - first;
  if (distances_.size() < size) {
    distances_.resize(2 * size);
    hits_.resize(distances_.size());
  }
  const auto dx = static_cast<float>(ray.direction.x());
  const auto dy = static_cast<float>(ray.direction.y());
  const float* xs = circles.x.data() + first;
  const float* ys = circles.y.data() + first;
  const float* radii = circles.radius.data() + first;
  const std::uint32_t* marks = circles.row.data() + first;
  float* near = distances_.data();
  for (std::size_t i = 0; i < size; ++i) {
    const float aside = std::abs(xs[i] * dy - ys[i] * dx);
    const float along = xs[i] * dx + ys[i] * dy;
    near[i] = std::max(aside, -along) <= radii[i] ? along - radii[i] : k_far;
  }
  const auto length = static_cast<float>(ray.length) * (1 + 0x1p-20f);
  std::size_t count = 0;
  for (std::size_t i = 0; i < size; ++i) {
    hits_[count] = {near[i], marks[i]};
    count += near[i] <= length;
  }
  return count;
}

void VisibilityQuery::meet(std::uint32_t mark, const SightLine& ray, RayHit& nearest) const {
  const bool is_body = (mark & (k_seen | k_hidden)) == 0;
  if (is_body && ray.target.valid() && view_->same_tree(Row(mark), ray.target)) return;
  visit_chains(mark, [&](const OutlineChain& chain) {
    if (!z_ || chain.z.contains(*z_)) meet_chain(chain, origin_, ray.direction, ray.length, nearest);
  });
}

}  // namespace troupe::engine
