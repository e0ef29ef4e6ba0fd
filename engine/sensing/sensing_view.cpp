#include "engine/sensing/sensing_view.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace troupe::engine {

void SensingView::throw_elsewhere(BodyId body) const {
  throw std::logic_error(
      fmt::format("internal error: the data of \"{}\" was read on a rank that does not have it. If a plug-in "
                  "read it, the plug-in has an error: it may read only bodies that its device can reach. "
                  "Otherwise your input is not the cause: please report this",
                  spec().name(body)));
}

Pose SensingView::pose(BodyId body) const {
  const Row r = row(body);
  if (!r.valid()) return spec().bodies[body.index()].pose_world_body;
  if (presence(r) == Presence::unborn) return k_nowhere;
  return poses()[r.index()];
}

}  // namespace troupe::engine
