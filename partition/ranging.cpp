#include "partition/ranging.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe::partition {
namespace {

constexpr float k_grazing = 1.0f / 256;
constexpr float k_tiny = 1.0f / (1 << 20);

float magnitude(const RayEdge& e) {
  return std::abs(e.ax) + std::abs(e.ay) + std::abs(e.bx) + std::abs(e.by);
}

/// Whether noise could decide on which side of its line the origin lies, or that the edge lies behind.
bool is_tiny(float area, float m) { return std::abs(area) <= k_tiny * (m * m); }

float grazing_limit(const RayEdge& e) { return k_grazing * (std::abs(e.ex) + std::abs(e.ey)); }

/// The careful way: sides as everywhere, the rest in double. m is the magnitude of edge and origin.
float careful_inverse(const RayEdge& e, double dx, double dy, double ox, double oy, float ca, float cb,
                      float m) {
  constexpr float k_noise = 1.0f / (1 << 21);       // of a side, over m
  constexpr double k_area_noise = 1.0 / (1 << 22);  // of the area, over what the origin's offset adds to it
  const bool falls = ca >= 0 && cb <= 0;
  const bool rises = ca <= 0 && cb >= 0;
  const bool runs_along = std::max(std::abs(ca), std::abs(cb)) <= k_noise * m;
  if (!falls && !rises && !runs_along) return 0;

  const double px = ox * e.ey;
  const double py = oy * e.ex;
  const double area = e.area - (px - py);
  const bool starts_on_line = std::abs(area) <= k_area_noise * (std::abs(px) + std::abs(py));
  const double along_a = (e.ax - ox) * dx + (e.ay - oy) * dy;
  const double along_b = (e.bx - ox) * dx + (e.by - oy) * dy;

  bool ahead;
  if (!runs_along) {
    ahead = starts_on_line || (area > 0 ? falls : rises);
  } else if ((along_a > 0) == (along_b > 0)) {
    // Sides are noise. An edge wholly ahead is met where noise says that the beam crosses it, because one of
    // its neighbours then relies on that; an edge wholly behind never is.
    ahead = along_a > 0 && (falls || rises);
  } else {
    // It passes the origin on the side that the area tells, so it crosses the beam on the way from its end
    // ahead to there where noise puts that end on the other side.
    const bool passes_right = (area > 0) == (along_b > 0);
    const float c_ahead = along_b > 0 ? cb : ca;
    ahead = starts_on_line || (passes_right ? c_ahead <= 0 : c_ahead >= 0);
  }
  if (!ahead) return 0;

  const double nearest = std::max(0.0, std::min(along_a, along_b));
  const double farthest = std::max(nearest, std::max(along_a, along_b));
  const double across = dx * e.ey - dy * e.ex;
  const double range = across == 0 ? nearest : std::clamp(std::abs(area / across), nearest, farthest);
  constexpr double k_least = 1e-30;  // its inverse is still a float
  return range > k_least ? static_cast<float>(1.0 / range) : std::numeric_limits<float>::infinity();
}

/// The two loops are branch-free, and their conditions are signs of minima and sums of comparisons, because
/// that is what gcc 12 turns into vector instructions. They leave out the beams that want care and return
/// true where there are any.

bool project_common(const RayEdge& e, const Fan& fan, float* __restrict inverse) {
  if (is_tiny(e.area, magnitude(e))) return true;
  const std::size_t beams = fan.dx.size();
  const float* __restrict dx = fan.dx.data();
  const float* __restrict dy = fan.dy.data();
  // Turned so that the area is positive, the edge is met from c_a >= 0 to c_b <= 0 and lies behind otherwise.
  const float turn = std::copysign(1.0f, e.area);  // no branch: it would be a coin's toss
  const float ax = turn * e.ax, ay = turn * e.ay, bx = turn * e.bx, by = turn * e.by;
  const float ex = turn * e.ex, ey = turn * e.ey;
  const float per_area = 1.0f / (turn * e.area);
  const float grazing = grazing_limit(e);
  int careful = 0;
  for (std::size_t i = 0; i < beams; ++i) {
    const float ca = ax * dy[i] - ay * dx[i];
    const float minus_cb = by * dx[i] - bx * dy[i];
    const float across = dx[i] * ey - dy[i] * ex;
    const float sides = std::min(ca, minus_cb);
    const float sharp = std::min(sides, across - grazing);  // >= 0: met, and not at a grazing angle
    const float candidate = sharp >= 0 ? across * per_area : 0.0f;
    careful += (sides >= 0 ? 1 : 0) - (sharp >= 0 ? 1 : 0);
    inverse[i] = candidate > inverse[i] ? candidate : inverse[i];
  }
  return careful != 0;
}

bool project_apart(const RayEdge& e, const Fan& fan, float* __restrict inverse) {
  const std::size_t beams = fan.dx.size();
  const float* __restrict dx = fan.dx.data();
  const float* __restrict dy = fan.dy.data();
  const float* __restrict ox = fan.ox.data();
  const float* __restrict oy = fan.oy.data();
  const float m = magnitude(e);
  const float grazing = grazing_limit(e);
  int careful = 0;
  for (std::size_t i = 0; i < beams; ++i) {
    const float ca = (e.ax - ox[i]) * dy[i] - (e.ay - oy[i]) * dx[i];
    const float cb = (e.bx - ox[i]) * dy[i] - (e.by - oy[i]) * dx[i];
    const float across = dx[i] * e.ey - dy[i] * e.ex;
    const float area = e.area - (ox[i] * e.ey - oy[i] * e.ex);
    const float reach = m + (std::abs(ox[i]) + std::abs(oy[i]));
    const float sides = std::min(std::max(ca, cb), -std::min(ca, cb));  // >= 0: different ones
    const float sharp = std::min(sides, std::abs(across) - grazing);
    const float tiny = k_tiny * (reach * reach) - std::abs(area);
    float candidate = across * (1.0f / area);
    candidate = sharp >= 0 ? candidate : 0.0f;
    candidate = tiny >= 0 ? 0.0f : candidate;
    careful += (sides >= 0 ? 1 : 0) - (sharp >= 0 ? 1 : 0) + (tiny >= 0 ? 1 : 0);
    inverse[i] = candidate > inverse[i] ? candidate : inverse[i];
    inverse[i] = candidate > inverse[i] ? candidate : inverse[i];
  }
  return careful != 0;
}

}  // namespace

bool may_meet(const Fan& fan, float x, float y, float radius, std::span<const float> inverse) {
  const std::size_t beams = fan.dx.size();
  const float* __restrict dx = fan.dx.data();
  const float* __restrict dy = fan.dy.data();
  const float* __restrict ox = fan.ox.data();
  const float* __restrict oy = fan.oy.data();
  const float* __restrict met = inverse.data();
  // Float errors of sides grow with the distance; ten times their bound, and a little for the origin's
  // neighbourhood.
  const float r = radius * (1 + 1e-5f) + (std::abs(x) + std::abs(y)) * 2e-6f + 1e-6f;
  constexpr float k_met = 1 + static_cast<float>(k_range_slack);
  int any = 0;
  for (std::size_t i = 0; i < beams; ++i) {
    const float ex = x - ox[i];
    const float ey = y - oy[i];
    const float aside = std::abs(ex * dy[i] - ey * dx[i]);
    const float along = ex * dx[i] + ey * dy[i];
    int meets = aside <= r ? 1 : 0;
    meets = along >= -r ? meets : 0;
    meets = (along - r) * met[i] <= k_met ? meets : 0;
    any |= meets;
  }
  return any != 0;
}

float inverse_range(const RayEdge& e, float dx, float dy, float ox, float oy) {
  const float ca = (e.ax - ox) * dy - (e.ay - oy) * dx;
  const float cb = (e.bx - ox) * dy - (e.by - oy) * dx;
  const float across = dx * e.ey - dy * e.ex;
  const float area = e.area - (ox * e.ey - oy * e.ex);
  const float m = magnitude(e) + (std::abs(ox) + std::abs(oy));
  if (is_tiny(area, m)) return careful_inverse(e, dx, dy, ox, oy, ca, cb, m);
  if (!(std::min(ca, cb) <= 0 && std::max(ca, cb) >= 0)) return 0;
  if (std::abs(across) < grazing_limit(e)) return careful_inverse(e, dx, dy, ox, oy, ca, cb, m);
  const float value = across * (1.0f / area);
  return value > 0 ? value : 0;
}

void project(std::span<const RayEdge> edges, const Fan& fan, std::span<float> inverse) {
  for (const RayEdge& e : edges) {
    if (!(fan.common_origin ? project_common(e, fan, inverse.data()) : project_apart(e, fan, inverse.data())))
      continue;
    for (std::size_t i = 0; i < inverse.size(); ++i)
      inverse[i] = std::max(inverse[i], inverse_range(e, fan.dx[i], fan.dy[i], fan.ox[i], fan.oy[i]));
  }
}

void project(std::span<const RayEdge> edges, const Fan& fan, std::span<float> inverse,
             std::span<float> returns) {
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
