#include "sensors/ranger_grid.hpp"

namespace troupe::sensors {

void cast_grid(const engine::World& world, const RangerBeams& ranger, std::span<const Row> rows,
               std::int32_t joint, engine::StateTable& percepts) {
  const partition::RayGrid& grid = *world.ray_grid();
  for (const Row row : rows) {
    const std::span<float> ranges = percepts.cell<float>(world.slot(row), 0);
    const engine::Mount mount = world.mount(row, joint);
    const Transform& transform = mount.transform;
    const Vec2 reference = transform * ranger.reference;
    for (const BeamGroup& group : ranger.groups) {
      const double z = mount.z + group.z;
      for (std::size_t i = 0; i < group.count; ++i) {
        const Vec2 origin = reference + transform.rotation * Vec2(group.ox[i], group.oy[i]);
        const Vec2 direction = transform.rotation * Vec2(group.dx[i], group.dy[i]);
        const partition::GridHit hit = grid.cast({origin, direction, z, group.range_max[i], row.value});
        const std::size_t beam = group.first + i;
        ranges[beam] = hit.range;
        if (ranger.intensity) percepts.cell<float>(world.slot(row), 1)[beam] = hit.ranger_return;
      }
    }
  }
}

}  // namespace troupe::sensors
