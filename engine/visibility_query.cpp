#include "engine/visibility_query.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe::engine {
namespace {

using partition::BodyCircle;

// The mark of a circle says what it encloses. It is the row of a body, or the index of a static outline piece
// plus one of these flags, which are larger than any row.
constexpr std::uint32_t k_seen = 1u << 31;    // index into StaticScene::outlines()
constexpr std::uint32_t k_hidden = 1u << 30;  // index into StaticScene::hidden_outlines()
constexpr std::size_t k_room = 1024;          // initial capacity of the arrays, in circles
// With more circles than this, engine::first_met() is faster: it only tests circles near each ray.
constexpr std::size_t k_crowd = 512;
constexpr float k_far = std::numeric_limits<float>::infinity();

}  // namespace

/// Adds those circles of `run` that are, at least in part, within reach_ of the origin. `mark` is the flag of
/// their marks (k_seen, k_hidden), or 0 for bodies. Circles are stored relative to the origin, and are
/// widened by more than the rounding error.
void VisibilityQuery::add_near(std::span<const BodyCircle> run, std::uint32_t mark) {
  const auto margin = static_cast<float>(1e-6 + 3e-6 * reach_);
  const auto reach = static_cast<float>(reach_) + margin;
  circles_.make_room(size_ + run.size());
  for (const BodyCircle& circle : run) {
    const auto x = static_cast<float>(circle.x - origin_.x());
    const auto y = static_cast<float>(circle.y - origin_.y());
    const float radius = circle.radius * (1 + 1.5e-5f) + margin;
    circles_.set(size_, {x, y, radius, circle.row | mark});
    size_ += x * x + y * y <= (radius + reach) * (radius + reach);
  }
}

void VisibilityQuery::stand(const World& world, const Vec2& origin, double reach, Row own,
                            std::optional<double> z) {
  world_ = &world;
  origin_ = origin;
  reach_ = reach;
  own_ = own;
  z_ = z;
  fixed_reach_ = -1;
  size_ = 0;
  circles_.make_room(std::min(world.rows(), k_room));
  // Wide bodies are stored in several cells of the index.
  const float wide = world.index().has_wide() ? static_cast<float>(0.5 * world.geometry().cell_m) : k_far;
  const auto is_left_out = [&](std::size_t i, std::size_t kept) {
    if (own.valid() && world.same_tree(Row(circles_.row[i]), own)) return true;
    const std::span<const std::uint32_t> rows(circles_.row.data(), kept);
    return circles_.radius[i] > wide && std::ranges::find(rows, circles_.row[i]) != rows.end();
  };
  world.index().for_each_run(Box::around(origin, reach), [&](std::span<const BodyCircle> run) {
    std::size_t kept = size_;
    add_near(run, 0);
    for (std::size_t i = kept; i < size_; ++i)
      if (!is_left_out(i, kept))
        circles_.set(kept++, {circles_.x[i], circles_.y[i], circles_.radius[i], circles_.row[i]});
    size_ = kept;
  });
  bodies_ = size_;
}

void VisibilityQuery::find_fixed(double reach) {
  fixed_reach_ = reach;
  size_ = bodies_;
  const auto find = [&](const partition::FixedOutlines& outlines, std::uint32_t mark) {
    const Box centres = Box::around(origin_, reach + outlines.largest_radius());
    const partition::GridGeometry& grid = outlines.geometry();
    outlines.for_each_run(grid.cell(centres.min), grid.cell(centres.max),
                          [&](std::span<const BodyCircle> run) { add_near(run, mark); });
  };
  find(world_->scene().outlines(), k_seen);
  find(world_->scene().hidden_outlines(), k_hidden);
}

void VisibilityQuery::first_met(std::span<const SightLine> rays, std::span<RayHit> found) {
  double longest = 0;
  for (const SightLine& ray : rays) longest = std::max(longest, ray.length);
  if (longest > fixed_reach_) find_fixed(longest);
  for (std::size_t i = 0; i < rays.size(); ++i) found[i] = first_met(rays[i]);
}

RayHit VisibilityQuery::first_met(const SightLine& ray) {
  if (size_ > k_crowd)
    return engine::first_met(
        *world_, {.origin = origin_, .direction = ray.direction, .length = ray.length, .own = own_, .z = z_});
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
  if (near_.size() < size_) {
    near_.resize(2 * size_);
    hits_.resize(near_.size());
  }
  const auto dx = static_cast<float>(ray.direction.x());
  const auto dy = static_cast<float>(ray.direction.y());
  const float* xs = circles_.x.data();
  const float* ys = circles_.y.data();
  const float* radii = circles_.radius.data();
  float* near = near_.data();
  for (std::size_t i = 0; i < size_; ++i) {
    const float aside = std::abs(xs[i] * dy - ys[i] * dx);
    const float along = xs[i] * dx + ys[i] * dy;
    near[i] = std::max(aside, -along) <= radii[i] ? along - radii[i] : k_far;
  }
  const auto length = static_cast<float>(ray.length) * (1 + 0x1p-20f);
  std::size_t count = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    hits_[count] = {near[i], circles_.row[i]};
    count += near[i] <= length;
  }
  return count;
}

void VisibilityQuery::meet(std::uint32_t mark, const SightLine& ray, RayHit& nearest) const {
  const partition::StaticScene& scene = world_->scene();
  const auto meet = [&](const OutlineChain& chain) {
    if (!z_ || chain.z.contains(*z_)) meet_chain(chain, origin_, ray.direction, ray.length, nearest);
  };
  if ((mark & k_seen) != 0)
    meet(fixed_chain(scene, scene.outlines(), mark - k_seen));
  else if ((mark & k_hidden) != 0)
    meet(fixed_chain(scene, scene.hidden_outlines(), mark - k_hidden));
  else
    for_each_chain_of(*world_, Row(mark), meet);
}

}  // namespace troupe::engine
