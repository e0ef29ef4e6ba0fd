#include "partition/ranging.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe::partition {
namespace {

float magnitude(const RayEdge& e) {
  return std::abs(e.ax) + std::abs(e.ay) + std::abs(e.bx) + std::abs(e.by);
}

/// Whether `area` is so small that rounding errors could change its sign. The sign tells on which side of the
/// edge's line the origin of the beam is, and so whether the edge is ahead of the origin. area: twice the
/// signed area of the triangle of origin and edge, m^2. m: sum of the magnitudes of all coordinates, metres.
bool is_tiny(float area, float m) { return std::abs(area) <= k_tiny * (m * m); }

float grazing_limit(const RayEdge& e) { return k_grazing * (std::abs(e.ex) + std::abs(e.ey)); }

/// The inverse range at which a beam hits an edge, for edges that are hit at a grazing angle (k_grazing) or
/// look tiny (k_tiny); 0 if the beam misses the edge. ca, cb: the cross products (a - o) x d and (b - o) x d,
/// whose signs tell on which side of the beam the ends a and b of the edge are. They are computed in float as
/// for all edges; everything else is computed in double. m: the sum of the magnitudes of the coordinates of
/// edge and origin, metres.
float careful_inverse(const RayEdge& e, double dx, double dy, double ox, double oy, float ca, float cb,
                      float m) {
  constexpr float k_noise = 1.0f / (1 << 21);       // rounding error of a side, relative to m
  constexpr double k_area_noise = 1.0 / (1 << 22);  // error of area, relative to the terms with the origin
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
    // The edge runs along the beam, and the sides are rounding errors. An edge wholly ahead of the origin is
    // hit if these sides say that the beam crosses it: the edges that share its vertices use the same sides,
    // so that no beam passes between them. An edge wholly behind the origin is never hit.
    ahead = along_a > 0 && (falls || rises);
  } else {
    // One end of the edge is ahead of the origin and the other end is behind. The sign of the area tells on
    // which side the edge passes the origin. The edge crosses the beam if the end that is ahead is on the
    // opposite side of the beam. The side of this end is taken as computed, although it may be only a
    // rounding error.
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

}  // namespace

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

}  // namespace troupe::partition
