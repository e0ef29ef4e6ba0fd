#include "engine/sensing/visibility_query.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe::engine {
namespace {

constexpr std::size_t k_room = 1024;  // initial capacity of the arrays, in circles
// With more circles than this, engine::first_met() is faster: it only tests circles near each ray.
constexpr std::size_t k_crowd = 512;
constexpr float k_far = std::numeric_limits<float>::infinity();

}  // namespace

void VisibilityQuery::stand(const SensingView& view, const Vec2& origin, double reach, Row own,
                            std::optional<double> z) {
  view_ = &view;
  origin_ = origin;
  reach_ = reach;
  own_ = own;
  z_ = z;
  fixed_reach_ = -1;
  near_.make_room(std::min(view.rows(), k_room));
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
  double longest = 0;
  for (const SightLine& ray : rays) longest = std::max(longest, ray.length);
  if (longest > fixed_reach_) find_fixed(longest);
  for (std::size_t i = 0; i < rays.size(); ++i) found[i] = first_met(rays[i]);
}

RayHit VisibilityQuery::first_met(const SightLine& ray) {
  if (near_.size() > k_crowd)
    return engine::first_met(*view_, {.origin = origin_,
                                      .direction = ray.direction,
                                      .length = ray.length,
                                      .own = own_,
                                      .z = z_,
                                      .target = ray.target});
  RayHit nearest{.range_m = ray.length};
  const std::size_t count = find_hits(ray);  // may reallocate hits_
  const std::span<Hit> hits(hits_.data(), count);
  std::ranges::sort(hits, {}, &Hit::near);
  for (const Hit& hit : hits) {
    if (hit.near > nearest.range_m) break;
    meet(hit.mark, ray, nearest);
  }
  return nearest;
}

/// Writes the circles that the ray meets within its length to the front of hits_, and returns their number.
/// The compiler vectorizes the loop.
std::size_t VisibilityQuery::find_hits(const SightLine& ray) {
  const std::size_t size = near_.size();
  if (distances_.size() < size) {
    distances_.resize(2 * size);
    hits_.resize(distances_.size());
  }
  const auto dx = static_cast<float>(ray.direction.x());
  const auto dy = static_cast<float>(ray.direction.y());
  const partition::CircleArrays& circles = near_.circles();
  const float* xs = circles.x.data();
  const float* ys = circles.y.data();
  const float* radii = circles.radius.data();
  float* near = distances_.data();
  for (std::size_t i = 0; i < size; ++i) {
    const float aside = std::abs(xs[i] * dy - ys[i] * dx);
    const float along = xs[i] * dx + ys[i] * dy;
    near[i] = std::max(aside, -along) <= radii[i] ? along - radii[i] : k_far;
  }
  const auto length = static_cast<float>(ray.length) * (1 + 0x1p-20f);
  std::size_t count = 0;
  for (std::size_t i = 0; i < size; ++i) {
    hits_[count] = {near[i], circles.row[i]};
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
