#include "engine/sensing/sensing_view.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace troupe::engine {

void SensingView::throw_elsewhere(BodyId body) const {
  throw std::logic_error(
      fmt::format("internal error: the row of \"{}\" was read, but another rank has it; unless a plug-in "
                  "caused this, it is "
                  "no error of your input: please report it",
                  spec().name(body)));
}

Pose SensingView::pose(BodyId body) const {
  const Row r = row(body);
  if (!r.valid()) return spec().bodies[body.index()].pose_world_body;
  if (presence(r) == Presence::unborn) return k_nowhere;
  return poses()[r.index()];
}

}  // namespace troupe::engine
