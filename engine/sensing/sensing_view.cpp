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

Estimates CommittedView::estimates(const BodyType& type) const {
  static const Localization k_true_pose;  // of bodies without a drive
  if (!type.drive) return {&k_true_pose, poses(), {}};
  Estimates estimates{&type.drive->localization, poses(), {}};
  if (!type.drive->odometry_table) return estimates;
  const StateTable& table = columns_.tables[*type.drive->odometry_table];
  estimates.odometries = {reinterpret_cast<const Odometry*>(table.row(0)), table.rows()};
  return estimates;
}

std::vector<BodyId> CommittedView::subscribed() const {
  std::vector<BodyId> bodies;
  for (std::size_t b = 0; b < columns_.rows.size(); ++b)
    if (const BodyId body(b);
        location(body) == RowLocation::here && columns_.subscribed[row(body).index()] != 0)
      bodies.push_back(body);
  return bodies;
}

Vec2 CommittedView::origin(Row row) const {
  const BodyId id = body(row);
  if (spec().starts(id)) return spec().bodies[id.index()].pose_world_body.position();
  const Life& life = columns_.lives[row.index()];
  return {life.x, life.y};
}

}  // namespace troupe::engine
