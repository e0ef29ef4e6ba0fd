#include "engine/sensing_view.hpp"

#include <limits>

namespace troupe::engine {

Pose SensingView::pose(BodyId body) const {
  const Row r = row(body);
  if (!r.valid()) return spec().bodies[body.index()].pose_world_body;
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  if (presence(r) == Presence::unborn) return {k_nan, k_nan, k_nan, k_nan};
  return poses()[r.index()];
}

}  // namespace troupe::engine
