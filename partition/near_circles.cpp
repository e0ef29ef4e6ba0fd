#include "partition/near_circles.hpp"

#include <algorithm>

namespace troupe::partition {

void NearCircles::begin(const Vec2& centre, double reach) {
  centre_ = centre;
  reach_ = reach;
  size_ = 0;
}

void NearCircles::add_pieces(const FixedOutlines& outlines, double within, std::uint32_t mark) {
  outlines.for_each_run(Box::around(centre_, within),
                        [&](std::span<const BodyCircle> run) { add(run, mark); });
}

void NearCircles::forget_met(std::size_t rows) {
  if (met_.size() < rows) met_.resize(rows);
  if (++search_ != 0) return;
  std::ranges::fill(met_, 0);  // the numbers of searches begin again
  search_ = 1;
}

/// Adds those circles of `run` that reach into the disc. The loop has no branch, because a branch would be
/// unpredictable: the loop writes every circle and advances only past those that reach into the disc.
void NearCircles::add(std::span<const BodyCircle> run, std::uint32_t mark) {
  const auto margin = static_cast<float>(1e-6 + 3e-6 * reach_);
  const auto reach = static_cast<float>(reach_) + margin;
  circles_.change_capacity(size_ + run.size());
  for (const BodyCircle& circle : run) {
    const auto x = static_cast<float>(circle.x - centre_.x());
    const auto y = static_cast<float>(circle.y - centre_.y());
    const float radius = circle.radius * (1 + 1.5e-5f) + margin;
    circles_.set(size_, {x, y, radius, circle.row | mark});
    size_ += x * x + y * y <= (radius + reach) * (radius + reach);
  }
}

}  // namespace troupe::partition
