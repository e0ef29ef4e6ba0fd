#include "sensors/ranger_grid.hpp"

#include "engine/sensing/sensing_view.hpp"
#include "sensors/ranger_noise.hpp"

#include <utility>

namespace troupe::sensors {

void cast_grid(const engine::DeviceBatch& batch, const RangerBeams& ranger) {
  const engine::SensingView& view = batch.view;
  const partition::RayGrid& grid = *view.ray_grid();
  thread_local NoisyHeadings noisy_headings;
  for (std::size_t r = 0; r < batch.rows.size(); ++r) {
    const Row row = batch.rows[r];
    Random random = random_of_headings(batch, r);
    const std::span<float> ranges = batch.state.cell<float>(view.slot(row), 0);
    const engine::Mount mount = batch.mount(r);
    const Transform& transform = mount.transform;
    const Vec2 reference = transform * ranger.reference;
    for (const BeamGroup& group : ranger.groups) {
      const double z = mount.z + group.z;
      const auto [dx, dy] = group.angular_noise.empty() ? std::pair(group.dx.data(), group.dy.data())
                                                        : noisy_headings.draw(group, random);
      for (std::size_t i = 0; i < group.count; ++i) {
        const Vec2 origin = reference + transform.rotation * Vec2(group.ox[i], group.oy[i]);
        const Vec2 direction = transform.rotation * Vec2(dx[i], dy[i]);
        const partition::GridHit hit = grid.cast({origin, direction, z, group.range_max[i], row.value});
        const std::size_t beam = group.first + i;
        ranges[beam] = hit.range;
        if (ranger.intensity) batch.state.cell<float>(view.slot(row), 1)[beam] = hit.ranger_return;
      }
    }
  }
}

}  // namespace troupe::sensors
