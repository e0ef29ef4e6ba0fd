#pragma once

#include "base/ids.hpp"

#include <cstdint>

namespace troupe::engine {

/// The first surface that a ray hits.
struct RayHit {
  double range_m = 0;      ///< distance to the surface, m; the length of the ray if it hit nothing
  BodyId body;             ///< body of the surface; not valid(): the ray hit nothing
  std::uint32_t part = 0;  ///< index of the part in the body's type; no meaning if nothing was hit

  bool met() const { return body.valid(); }  ///< whether the ray hit a surface
};

}  // namespace troupe::engine
