#include "engine/world.hpp"

#include <limits>
#include <stdexcept>
#include <utility>

namespace troupe::engine {

/// The data of the test mode hide_beyond_reach(): copies of the data of the hidden rows, and a spatial index
/// without these rows.
struct World::Blinkers {
  explicit Blinkers(const World& world)
      : transforms(world.transforms_),
        outlines(world.outlines_),
        radii(world.row_radii_),
        shapes(world.row_shapes_),
        tables(world.tables_),
        index(world.geometry_) {}

  // Copies of the world's members. Only the elements of hidden rows are used.
  std::vector<Transform> transforms;
  std::vector<Vec2> outlines;
  std::vector<double> radii;
  std::vector<const partition::ObstacleShape*> shapes;
  std::vector<StateTable> tables;
  partition::BodyIndex index;
  partition::Parallel serial{1};
  std::vector<Row> hidden;
};

void World::BlinkersDeleter::operator()(Blinkers* blinkers) const { delete blinkers; }

void World::hide_beyond_reach(bool on) {
  if (on && (parallel_.threads() != 1 || ray_grid_))
    throw std::invalid_argument("hide_beyond_reach() needs a world with one thread and the exact ray engine");
  blinkers_.reset(on ? new Blinkers(*this) : nullptr);
}

void World::hide_from(Row row, double reach) {
  Blinkers& b = *blinkers_;
  constexpr double k_slack_m = 1e-6;  // for the rounding of a distance and a radius
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  static const partition::ObstacleShape k_no_shape;
  const Vec2 origin = transform(row).position;
  b.hidden.clear();
  for (std::size_t r = 0; r < rows(); ++r) {
    const Row other(r);
    if (same_tree(other, row) || !is_there(other)) continue;
    if ((transform(other).position - origin).norm() - row_radii_[r] > reach + k_slack_m)
      b.hidden.push_back(other);
  }
  for (const Row other : b.hidden) {
    const std::size_t r = other.index();
    b.transforms[r] =
        std::exchange(transforms_[r], Transform({k_nan, k_nan}, Rotation(SinCos{k_nan, k_nan})));
    b.radii[r] = std::exchange(row_radii_[r], partition::k_not_there);
    b.shapes[r] = std::exchange(row_shapes_[r], &k_no_shape);
    for (std::size_t v = outline_begins_[r]; v < outline_begins_[r] + type(other).outline_vertices.size();
         ++v)
      b.outlines[v] = std::exchange(outlines_[v], Vec2(k_nan, k_nan));
    for_tables_of(other, [&](std::size_t t, std::size_t at) {
      b.tables[t].copy_row(at, tables_[t]);
      tables_[t].fill_row(at, std::byte{0xff});  // a floating-point field is then NaN
    });
  }
  std::swap(index_, b.index);
  index_.rebuild(transforms_, row_radii_, b.serial);
}

void World::show_hidden() {
  Blinkers& b = *blinkers_;
  std::swap(index_, b.index);
  for (const Row other : b.hidden) {
    const std::size_t r = other.index();
    transforms_[r] = b.transforms[r];
    row_radii_[r] = b.radii[r];
    row_shapes_[r] = b.shapes[r];
    for (std::size_t v = outline_begins_[r]; v < outline_begins_[r] + type(other).outline_vertices.size();
         ++v)
      outlines_[v] = b.outlines[v];
    for_tables_of(other, [&](std::size_t t, std::size_t at) { tables_[t].copy_row(at, b.tables[t]); });
  }
}

}  // namespace troupe::engine
