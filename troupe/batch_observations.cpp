#include "engine/world/world.hpp"
#include "troupe/batch_impl.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

// The arrays of a BatchEnv: what its robots observe.

namespace troupe {
namespace {

/// Position of a body in the frame of a robot, m.
struct Seen {
  double x = 0;
  double y = 0;
};

Seen seen_from(const Transform& own, double dx, double dy) {
  const Rotation& r = own.rotation;
  return {dx * r.cos + dy * r.sin, dy * r.cos - dx * r.sin};
}

}  // namespace

/// Writes the row of one robot in an array, part by part.
class BatchEnv::Impl::RowReader {
 public:
  /// `i`: index of the robot in its team; `row`: address of the first byte of the row.
  RowReader(const Impl& env, const Copy& copy, const TeamCopy& team, std::size_t i, std::byte* row)
      : env_(env),
        copy_(copy),
        world_(copy.simulation.world()),
        team_(team),
        i_(i),
        own_(world_.view().row(team.ids[i])),
        here_(world_.view().transform(own_)),
        out_(reinterpret_cast<float*>(row)) {}

  void read(const ArrayData& array) {
    for (const Part& part : array.parts) read(part, array.element);
  }

 private:
  /// Writes the columns of a part; `element` is the element type of the array.
  void read(const Part& part, engine::Element element) {
    const double scale = part.spec->scale;
    switch (part.spec->of) {
      case Of::reading: return add_reading(part, element);
      case Of::pose: return add_pose(world_.view().poses()[own_.index()], here_.rotation, scale);
      case Of::estimate: {
        const Pose pose = world_.view().estimate(own_);
        return add_pose(pose, Rotation(pose.heading), scale);
      }
      case Of::speed: {
        const engine::Velocity& v = world_.view().velocities()[own_.index()];
        add(v.x * scale);
        add(v.y * scale);
        add(v.turn * scale);
        return;
      }
      case Of::stalled: return add(world_.view().stalled(own_) ? 1 : 0);
      case Of::time_left:
        return add(static_cast<double>(copy_.last_tick - std::min(copy_.last_tick, world_.tick())) /
                   static_cast<double>(env_.episode_ticks));
      case Of::nearest: return add_nearest(part);
      case Of::target: return add_target(part);
    }
  }

  void add(double value) { *out_++ = static_cast<float>(value); }
  void add_zeros(std::size_t count) { out_ = std::fill_n(out_, count, 0.0f); }
  void add_pose(const Pose& pose, const Rotation& rotation, double scale) {
    add(pose.x * scale);
    add(pose.y * scale);
    add(rotation.cos);
    add(rotation.sin);
  }

  void add_reading(const Part& part, engine::Element element) {
    const DeviceField& reading = team_.readings[part.of_kind * team_.ids.size() + i_];
    const std::byte* from = world_.tables()[reading.device->table]
                                .cell<std::byte>(world_.view().slot(own_), reading.field)
                                .data();
    const std::size_t size = engine::element_size(part.element);
    const bool is_raw = element != engine::Element::f32;
    if (is_raw || (part.element == engine::Element::f32 && part.spec->scale == 1)) {
      std::memcpy(out_, from, part.columns * size);
      out_ += part.columns;  // a raw array has no other part
      return;
    }
    for (std::size_t k = 0; k < part.columns; ++k)
      add(engine::number_at(part.element, from + k * size) * part.spec->scale);
  }

  struct Near {
    double distance2;
    Row row;
  };

  /// Sets `nearest` to the nearest robots of the part's group, from near to far. Of two robots at the same
  /// distance, the one with the lower id comes first.
  void find_nearest(const Part& part, std::vector<Near>& nearest) const {
    nearest.clear();
    const BatchPart& wanted = *part.spec;
    const double range2 = wanted.range_m * wanted.range_m;
    for (const BodyId id : team_.groups[part.of_kind]) {  // in order of ids
      const Row other = world_.view().row(id);
      if (other == own_ || !world_.view().is_there(other)) continue;
      const Vec2 way = world_.view().transform(other).position - here_.position;
      const double distance2 = way.x() * way.x() + way.y() * way.y();
      if (distance2 > range2 || (nearest.size() == wanted.count && distance2 >= nearest.back().distance2))
        continue;
      if (nearest.size() == wanted.count) nearest.pop_back();
      auto at = nearest.end();
      while (at != nearest.begin() && distance2 < std::prev(at)->distance2) --at;
      nearest.insert(at, {distance2, other});
    }
  }

  void add_nearest(const Part& part) {
    thread_local std::vector<Near> nearest;
    find_nearest(part, nearest);
    for (const Near& near : nearest) {
      const Transform& there = world_.view().transform(near.row);
      const Seen seen =
          seen_from(here_, there.position.x() - here_.position.x(), there.position.y() - here_.position.y());
      const Rotation& a = here_.rotation;
      const Rotation& b = there.rotation;
      add(seen.x * part.spec->scale);
      add(seen.y * part.spec->scale);
      add(a.cos * b.cos + a.sin * b.sin);
      add(a.cos * b.sin - a.sin * b.cos);
      add(1);
    }
    add_zeros(part.columns - BatchPart::k_neighbour * nearest.size());
  }

  void add_target(const Part& part) {
    const std::vector<BodyId>& targets = team_.targets[part.of_kind];
    const BodyId body = targets[targets.size() == 1 ? 0 : i_];
    const Row row = world_.view().row(body);
    if (row.valid() && !world_.view().is_there(row)) return add_zeros(part.columns);
    const Pose pose = world_.view().pose(body);
    const double dx = pose.x - here_.position.x();
    const double dy = pose.y - here_.position.y();
    const Seen seen = seen_from(here_, dx, dy);
    add(seen.x * part.spec->scale);
    add(seen.y * part.spec->scale);
    add(std::sqrt(dx * dx + dy * dy) * part.spec->scale);
  }

  const Impl& env_;
  const Copy& copy_;
  const engine::World& world_;
  const TeamCopy& team_;
  std::size_t i_;
  Row own_;
  const Transform& here_;
  float* out_;  // the next column
};

/// Fills the arrays of copy c.
void BatchEnv::Impl::observe(std::size_t c) {
  const Copy& copy = *copies[c];
  const engine::World& world = copy.simulation.world();
  for (std::size_t t = 0; t < teams.size(); ++t) {
    TeamData& team = teams[t];
    for (std::size_t i = 0; i < team.robots; ++i) {
      const std::size_t at = c * team.robots + i;
      team.alive[at] = world.view().is_there(world.view().row(copy.teams[t].ids[i]));
      for (ArrayData& array : team.arrays) {
        std::byte* out = array.bytes.data() + at * array.row_bytes();
        if (team.alive[at] != 0)
          RowReader(*this, copy, copy.teams[t], i, out).read(array);
        else
          std::fill_n(out, array.row_bytes(), std::byte{0});
      }
    }
  }
}

/// The present number in a column of an array or of the measures, for robot i of a team in copy c.
double BatchEnv::Impl::value(const TeamData& team, const Column& column, std::size_t c, std::size_t i) const {
  if (column.of_measure) return measures[c * measure_columns.size() + column.column];
  const ArrayData& array = team.arrays[column.array];
  const std::byte* row = array.bytes.data() + (c * team.robots + i) * array.row_bytes();
  return engine::number_at(array.element, row + column.column * engine::element_size(array.element));
}

}  // namespace troupe
