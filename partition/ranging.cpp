#include "partition/ranging.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe::partition {
namespace {

constexpr float k_end_on = 1.0f / 1024;

/// Edges seen end-on, or passing through the origin: sides decided as everywhere, the rest in double.
/// a and b are relative to the beam's origin.
float end_on_inverse(float ax, float ay, float bx, float by, float dx, float dy, float ca, float cb) {
  if (!((ca >= 0 && cb <= 0) || (ca <= 0 && cb >= 0))) return 0;
  const double a_x = ax, a_y = ay, b_x = bx, b_y = by, d_x = dx, d_y = dy;
  const double along_a = a_x * d_x + a_y * d_y;
  const double along_b = b_x * d_x + b_y * d_y;
  if (along_a < 0 && along_b < 0) return 0;  // behind
  const double double_area = a_x * b_y - a_y * b_x;
  const double side_a = a_x * d_y - a_y * d_x;
  const double side_b = b_x * d_y - b_y * d_x;
  double range;
  if (side_a != side_b) {
    range = double_area / (side_a - side_b);
    // One end behind the origin: the edge passes beside it, and the sign tells on which side of the beam's start.
    if ((along_a < 0 || along_b < 0) && range < 0) return 0;
  } else {
    range = std::min(along_a, along_b);  // the beam runs along the edge
  }
  const double nearest = std::max(0.0, std::min(along_a, along_b));
  const double farthest = std::max(along_a, along_b);
  range = std::clamp(range, nearest, farthest);
  return range > 0 ? static_cast<float>(1.0 / range) : std::numeric_limits<float>::infinity();
}

/// Branch-free over the beams, so that the compiler can take several at once; beams to which the edge is end-on
/// are left out and counted.
template <bool CommonOrigin>
bool project_edge(const RayEdge& e, const Fan& fan, float* __restrict inverse) {
  const std::size_t beams = fan.dx.size();
  const float* __restrict dx = fan.dx.data();
  const float* __restrict dy = fan.dy.data();
  const float* __restrict ox = fan.ox.data();
  const float* __restrict oy = fan.oy.data();
  int end_on = 0;
  if constexpr (CommonOrigin) {
    const float p = e.ax * e.by;
    const float q = e.ay * e.bx;
    const float area = p - q;
    if (std::abs(area) <= k_end_on * (std::abs(p) + std::abs(q))) return true;
    const float per_area = 1.0f / area;
    for (std::size_t i = 0; i < beams; ++i) {
      const float ca = e.ax * dy[i] - e.ay * dx[i];
      const float cb = e.bx * dy[i] - e.by * dx[i];
      float candidate = (ca - cb) * per_area;
      candidate = std::min(ca, cb) <= 0 ? candidate : 0.0f;
      candidate = std::max(ca, cb) >= 0 ? candidate : 0.0f;
      inverse[i] = candidate > inverse[i] ? candidate : inverse[i];
    }
    return false;
  } else {
    for (std::size_t i = 0; i < beams; ++i) {
      const float ax = e.ax - ox[i];
      const float ay = e.ay - oy[i];
      const float bx = e.bx - ox[i];
      const float by = e.by - oy[i];
      const float p = ax * by;
      const float q = ay * bx;
      const float area = p - q;
      const float ca = ax * dy[i] - ay * dx[i];
      const float cb = bx * dy[i] - by * dx[i];
      const bool thin = std::abs(area) <= k_end_on * (std::abs(p) + std::abs(q));
      float candidate = (ca - cb) * (1.0f / area);
      candidate = std::min(ca, cb) <= 0 ? candidate : 0.0f;
      candidate = std::max(ca, cb) >= 0 ? candidate : 0.0f;
      candidate = thin ? 0.0f : candidate;
      inverse[i] = candidate > inverse[i] ? candidate : inverse[i];
      end_on |= thin ? 1 : 0;
    }
    return end_on != 0;
  }
}

}  // namespace

bool may_meet(const Fan& fan, float x, float y, float radius, std::span<const float> inverse) {
  const std::size_t beams = fan.dx.size();
  const float* __restrict dx = fan.dx.data();
  const float* __restrict dy = fan.dy.data();
  const float* __restrict ox = fan.ox.data();
  const float* __restrict oy = fan.oy.data();
  const float* __restrict met = inverse.data();
  // Float errors grow with the distance; ten times their bound, and a little for the origin's neighbourhood.
  const float r = radius * (1 + 1e-5f) + (std::abs(x) + std::abs(y)) * 2e-6f + 1e-6f;
  int any = 0;
  for (std::size_t i = 0; i < beams; ++i) {
    const float ex = x - ox[i];
    const float ey = y - oy[i];
    const float aside = std::abs(ex * dy[i] - ey * dx[i]);
    const float along = ex * dx[i] + ey * dy[i];
    int meets = aside <= r ? 1 : 0;
    meets = along >= -r ? meets : 0;
    meets = (along - r) * met[i] <= 1.0f ? meets : 0;
    any |= meets;
  }
  return any != 0;
}

float inverse_range(const RayEdge& e, float dx, float dy, float ox, float oy) {
  const float ax = e.ax - ox;
  const float ay = e.ay - oy;
  const float bx = e.bx - ox;
  const float by = e.by - oy;
  const float p = ax * by;
  const float q = ay * bx;
  const float area = p - q;
  const float ca = ax * dy - ay * dx;
  const float cb = bx * dy - by * dx;
  if (std::abs(area) <= k_end_on * (std::abs(p) + std::abs(q))) return end_on_inverse(ax, ay, bx, by, dx, dy, ca, cb);
  if (!((ca >= 0 && cb <= 0) || (ca <= 0 && cb >= 0))) return 0;
  const float value = (ca - cb) * (1.0f / area);
  return value > 0 ? value : 0;
}

void project(std::span<const RayEdge> edges, const Fan& fan, std::span<float> inverse) {
  for (const RayEdge& e : edges) {
    const bool end_on = fan.common_origin ? project_edge<true>(e, fan, inverse.data())
                                          : project_edge<false>(e, fan, inverse.data());
    if (!end_on) continue;
    for (std::size_t i = 0; i < inverse.size(); ++i)
      inverse[i] = std::max(inverse[i], inverse_range(e, fan.dx[i], fan.dy[i], fan.ox[i], fan.oy[i]));
  }
}

void project(std::span<const RayEdge> edges, const Fan& fan, std::span<float> inverse, std::span<float> returns) {
  for (const RayEdge& e : edges) {
    for (std::size_t i = 0; i < inverse.size(); ++i) {
      const float value = inverse_range(e, fan.dx[i], fan.dy[i], fan.ox[i], fan.oy[i]);
      if (value > inverse[i]) {
        inverse[i] = value;
        returns[i] = e.ranger_return;
      } else if (value == inverse[i] && value > 0) {
        returns[i] = std::max(returns[i], e.ranger_return);
      }
    }
  }
}

}  // namespace troupe::partition
