#include "base/fp_environment.hpp"
#include "engine/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace troupe::engine {
namespace {

constexpr std::size_t k_batch = 64;      // rows a task: a crowded tile is split, small ones are joined
constexpr double k_world_limit = 100e3;  // m: where a world without floor plans ends

bool due(std::uint64_t tick, std::uint64_t period) { return tick % period == 0; }

}  // namespace

std::string_view phase_name(Phase phase) {
  switch (phase) {
    case Phase::sense: return "sense";
    case Phase::decide: return "decide";
    case Phase::move: return "move";
    case Phase::index: break;
  }
  return "index";
}

/// One tick. Each phase reads the state that the one before it left, and writes rows of its own only.
/// The drive comes before the decision: a command takes effect a tick after the readings it was made from.
void World::step() {
  restore_fp_environment();  // a library that the caller loaded since may have switched its thread to fast
                             // maths
  ++tick_;
  begin(Phase::sense);
  sense();
  begin(Phase::decide);
  drive();
  decide();
  begin(Phase::move);
  move();
  begin(Phase::index);
  index_bodies();
  if (on_phase_) on_phase_(std::nullopt);
}

void World::begin(Phase phase) {
  if (on_phase_) on_phase_(phase);
}

template <class Work>
void World::for_batches(Work&& work) {
  const std::span<const std::uint32_t> order = index_.order();
  const std::size_t batches = (order.size() + k_batch - 1) / k_batch;
  parallel_.for_each(batches, [&](std::size_t b) {
    std::array<Row, k_batch> rows;
    const std::size_t count = std::min(k_batch, order.size() - b * k_batch);
    for (std::size_t i = 0; i < count; ++i) rows[i] = Row(order[b * k_batch + i]);
    const std::span<Row> all(rows.data(), count);
    const auto type_of = [&](Row row) { return row_types_[row.index()]; };
    if (!std::ranges::all_of(all, [&](Row row) { return type_of(row) == type_of(all.front()); }))
      std::ranges::sort(
          all, [&](Row a, Row c) { return type_of(a) != type_of(c) ? type_of(a) < type_of(c) : a < c; });
    for (std::size_t i = 0; i < count;) {
      std::size_t end = i + 1;
      while (end < count && type_of(rows[end]) == type_of(rows[i])) ++end;
      work(std::span<const Row>(all.subspan(i, end - i)), types_[type_of(rows[i])]);
      i = end;
    }
  });
}

void World::sense() {
  std::atomic<std::uint64_t> beams = 0;
  for_batches([&](std::span<const Row> rows, const BodyType& type) {
    for (const BodyType::Sensor& sensor : type.sensors) {
      if (!due(tick_, sensor.period)) continue;
      const auto sense_rows = [&](std::span<const Row> some) {
        const std::uint64_t cast =
            sensor.kind->sense(*this, sensor.prepared.data, some, tables_[sensor.table]);
        beams.fetch_add(cast, std::memory_order_relaxed);
      };
      if (sensor.active) {
        sense_rows(rows);
        continue;
      }
      for (std::size_t i = 0; i < rows.size(); ++i)
        if (row_subscribed_[rows[i].index()]) sense_rows(rows.subspan(i, 1));
    }
  });
  beams_ += beams;
}

void World::drive() {
  std::atomic<std::uint32_t> faulty = Row().value;  // the lowest row whose velocity is no number
  for_batches([&](std::span<const Row> rows, const BodyType& type) {
    if (!type.drive || !due(tick_, type.drive->period)) return;
    std::array<Command, k_batch> commands;
    std::array<Velocity, k_batch> velocities;
    for (std::size_t i = 0; i < rows.size(); ++i) commands[i] = as<Command>(k_command)[rows[i].index()];
    type.drive->kind->drive(type.drive->data, {commands.data(), rows.size()},
                            {velocities.data(), rows.size()});
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Velocity& v = velocities[i];
      if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.turn)) {
        std::uint32_t lowest = faulty.load();
        while (rows[i].value < lowest && !faulty.compare_exchange_weak(lowest, rows[i].value)) {
        }
        continue;
      }
      // + 0.0 turns -0 into 0: equal velocities have equal bits.
      as<Velocity>(k_velocity)[rows[i].index()] = {v.x + 0.0, v.y + 0.0, v.turn + 0.0};
    }
  });
  if (const Row row(faulty.load()); row.valid()) {
    throw StepError(fmt::format("tick {}: robot \"{}\" was commanded a speed that is not a finite number",
                                tick_, spec_.name(body(row))));
  }
}

void World::decide() {
  for_batches([&](std::span<const Row> rows, const BodyType& type) {
    for (const BodyType::Controller& controller : type.controllers) {
      if (!due(tick_, controller.period)) continue;
      std::array<std::span<const float>, k_most_sensors_read> ranges;
      const std::size_t sensors = controller.sensors.size();
      for (const Row row : rows) {
        const std::size_t at = slot(row);
        for (std::size_t s = 0; s < sensors; ++s)
          ranges[s] = percepts(type.sensors[controller.sensors[s]]).cell<float>(at, 0);
        const Percept percept{tick_, time_s(), spec_.tick_s, body(row).value, {ranges.data(), sensors}};
        Random random(spec_.seed, controller.stream, body(row).value, static_cast<std::uint32_t>(tick_));
        Actions actions{as<Command>(k_command)[row.index()]};
        std::byte* memory = controller.table ? tables_[*controller.table].row(at) : nullptr;
        controller.kind->decide(controller.data, percept, memory, random, actions);
      }
    }
  });
}

void World::move() {
  const double dt = spec_.tick_s;
  for_batches([&](std::span<const Row> rows, const BodyType& type) {
    for (const Row row : rows) {
      const Pose& from = poses()[row.index()];
      const Velocity& v = velocities()[row.index()];
      Motion& motion = motions_[row.index()];
      motion = {from, from, v.turn * dt, type.drive && (v.x != 0 || v.y != 0 || v.turn != 0)};
      // Euler with the old heading, as in Stage.
      if (motion.moves) motion.to = compose(from, transform(row), {v.x * dt, v.y * dt, 0, motion.turn});
    }
  });
  const Box bounds = spec_.bounds.value_or(Box::around(Vec2::Zero(), k_world_limit));
  conflicts_.settle({motions_, row_shapes_, row_ids_, spec_.seed, tick_, bounds}, scene_, index_, parallel_,
                    outcomes_);
  conflict_rounds_ += conflicts_.rounds();
  for_batches([&](std::span<const Row> rows, const BodyType&) {
    for (const Row row : rows) {
      const Conflicts::Outcome outcome = outcomes_[row.index()];
      if (outcome == Conflicts::Outcome::moved) {
        const Pose& to = motions_[row.index()].to;
        as<Pose>(k_pose)[row.index()] = {to.x + 0.0, to.y + 0.0, to.z + 0.0, to.heading + 0.0};
      }
      stall()[row.index()] = outcome == Conflicts::Outcome::refused ? k_refused
                             : outcome == Conflicts::Outcome::held  ? k_held
                                                                    : k_free;
    }
  });
}

void World::index_bodies() {
  const std::size_t batches = (rows() + k_batch - 1) / k_batch;
  parallel_.for_each(batches, [&](std::size_t b) {
    for (std::size_t r = b * k_batch; r < std::min(rows(), (b + 1) * k_batch); ++r) {
      const Transform transform(poses()[r]);
      transforms_[r] = transform;
      positions_[r] = transform.position;
      Vec2* out = outlines_.data() + outline_begins_[r];
      for (const Vec2& v : type(Row(r)).outline_vertices) *out++ = transform * v;
    }
  });
  index_.rebuild(positions_, row_radii_, parallel_);
}

}  // namespace troupe::engine
