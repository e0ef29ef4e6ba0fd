#include "troupe/swarm.hpp"

#include "base/diagnostics.hpp"
#include "engine/measures.hpp"
#include "engine/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <utility>

namespace troupe {
namespace {

void check_size(std::string_view what, std::size_t given, std::size_t robots) {
  if (given != robots)
    throw std::invalid_argument(
        fmt::format("found {} {} for a swarm of {} robots: give one per robot", given, what, robots));
}

bool is_ranger(const engine::BodyType::Device& device) { return !device.prepared.bearings.empty(); }

}  // namespace

Swarm Simulation::swarm(std::string_view of) {
  engine::World& world = this->world();
  std::vector<Row> robots = engine::robots_of(world, of);
  if (robots.empty() && !of.empty()) {
    const std::vector<std::string> known = engine::names_of_robots(world);
    throw std::out_of_range(unknown_name("type or population of robots", of,
                                         std::vector<std::string_view>(known.begin(), known.end())));
  }
  return Swarm(world, std::move(robots));
}

/// The requested ranger of one type of robots, and the table that stores its readings.
struct Swarm::Ranger {
  const engine::BodyType::Device* device = nullptr;
  const engine::StateTable* readings = nullptr;
};

Swarm::Swarm(engine::World& world, std::vector<Row> rows) : world_(&world), rows_(std::move(rows)) {
  ids_.reserve(size());
  for (const Row row : rows_) ids_.push_back(world.body(row));
}

std::vector<std::string> Swarm::names() const {
  std::vector<std::string> names;
  names.reserve(size());
  for (const BodyId id : ids_) names.push_back(world_->spec().name(id));
  return names;
}

std::vector<std::string> Swarm::types() const {
  std::vector<std::string> types;
  for (const engine::BodyType& type : world_->types())
    if (std::ranges::any_of(rows_, [&](Row row) { return &world_->type(row) == &type; }))
      types.push_back(type.name);
  return types;
}

/// Calls one(row, i) for each robot i and its row in the state tables. room: number of elements of the
/// caller's span. Throws std::invalid_argument if this is not size().
template <class Read>
void Swarm::read(std::size_t room, Read&& one) const {
  world_->require_whole();
  check_size("elements", room, size());
  for (std::size_t i = 0; i < size(); ++i) one(rows_[i], i);
}

/// Calls one(row, i) for each robot that `where` selects and that is in the world. given: number of elements
/// of the caller's span. Throws std::invalid_argument if this is not size().
template <class Write>
void Swarm::write(std::size_t given, std::span<const std::uint8_t> where, Write&& one) const {
  Model::refuse_in_for_each(*world_, "a command for a swarm");
  world_->require_whole();
  check_size("elements", given, size());
  if (!where.empty()) check_size("elements of `where`", where.size(), size());
  for (std::size_t i = 0; i < size(); ++i)
    if ((where.empty() || where[i] != 0) && world_->is_there(rows_[i])) one(rows_[i], i);
}

void Swarm::alive(std::span<std::uint8_t> out) const {
  read(out.size(), [&](Row row, std::size_t i) { out[i] = world_->is_there(row); });
}

void Swarm::stalled(std::span<std::uint8_t> out) const {
  read(out.size(), [&](Row row, std::size_t i) { out[i] = world_->stalled(row); });
}

void Swarm::poses(std::span<Pose> out) const {
  read(out.size(), [&](Row, std::size_t i) { out[i] = world_->pose(ids_[i]); });
}

void Swarm::estimates(std::span<Pose> out) const {
  read(out.size(), [&](Row row, std::size_t i) { out[i] = world_->estimate(row); });
}

void Swarm::speeds(std::span<Model::Speed> out) const {
  const std::span<const engine::Velocity> velocities = world_->velocities();
  read(out.size(), [&](Row row, std::size_t i) {
    const engine::Velocity& v = velocities[row.index()];
    out[i] = {v.x, v.y, v.turn};
  });
}

Swarm::Ranger Swarm::ranger_of(Row row, std::string_view sensor) const {
  std::vector<std::string_view> known;
  for (const engine::BodyType::Device& device : world_->type(row).devices) {
    if (!is_ranger(device)) continue;
    if (sensor.empty() || device.name == sensor) return {&device, &world_->percepts(device)};
    known.push_back(device.name);
  }
  const std::string name = world_->spec().name(world_->body(row));
  if (known.empty()) throw std::out_of_range(fmt::format("\"{}\" has no ranger", name));
  throw std::out_of_range(
      fmt::format("\"{}\" has no ranger \"{}\"; it has: {}", name, sensor, comma_list(known)));
}

/// Calls visit(ranger, row, i) for each robot i, with its ranger named `sensor`. Throws std::out_of_range if
/// a robot has none.
template <class Visit>
void Swarm::for_rangers(std::string_view sensor, Visit&& visit) const {
  const engine::BodyType* type = nullptr;
  Ranger ranger;
  for (std::size_t i = 0; i < size(); ++i) {
    if (const engine::BodyType& own = world_->type(rows_[i]); type != &own) {
      ranger = ranger_of(rows_[i], sensor);
      type = &own;
    }
    visit(ranger, rows_[i], i);
  }
}

std::size_t Swarm::beams(std::string_view sensor) const {
  if (rows_.empty()) return 0;
  const std::size_t beams = ranger_of(rows_.front(), sensor).device->prepared.bearings.size();
  for_rangers(sensor, [&](const Ranger& ranger, Row, std::size_t i) {
    if (const std::size_t own = ranger.device->prepared.bearings.size(); own != beams)
      throw std::invalid_argument(
          fmt::format("robots with different rangers: the ranger of \"{1}\" has {0} beams, that of \"{3}\" "
                      "has {2}; use a swarm of one type",
                      beams, world_->spec().name(ids_.front()), own, world_->spec().name(ids_[i])));
  });
  return beams;
}

void Swarm::ranges(std::span<float> out, std::string_view sensor) const {
  world_->require_whole();
  const std::size_t count = beams(sensor);
  if (out.size() != count * size())
    throw std::invalid_argument(fmt::format(
        "found a span of {} elements for {} robots with {} beams each: give robots x beams elements",
        out.size(), size(), count));
  for_rangers(sensor, [&](const Ranger& ranger, Row row, std::size_t i) {
    if (!world_->senses(row, *ranger.device))
      throw std::logic_error(
          fmt::format("sensor \"{}\" of \"{}\" does not run: call subscribe() before the first step",
                      ranger.device->name, world_->spec().name(ids_[i])));
    const std::span<const float> readings = ranger.readings->cell<float>(world_->slot(row), 0);
    std::ranges::copy(readings, out.subspan(i * count).begin());
  });
}

std::vector<double> Swarm::bearings(std::string_view sensor) const {
  return rows_.empty() ? std::vector<double>() : ranger_of(rows_.front(), sensor).device->prepared.bearings;
}

double Swarm::range_bound(std::string_view sensor) const {
  return rows_.empty() ? 0 : ranger_of(rows_.front(), sensor).device->prepared.reach_m;
}

void Swarm::subscribe() {
  Model::refuse_in_for_each(*world_, "subscribe()");
  if (world_->tick() > 0) throw std::logic_error("subscribe() must be called before the first step");
  for (const BodyId id : ids_) world_->subscribe(id);
}

void Swarm::for_each(const std::function<void(std::size_t i, Model& robot)>& visit) {
  constexpr std::size_t k_batch = 32;  // calls per task, enough to be worth waking a thread
  world_->require_whole();
  if (robots_.empty()) {
    robots_.reserve(size());
    for (const BodyId id : ids_) robots_.push_back(Model::of(*world_, id));
  }
  world_->parallel().for_each((size() + k_batch - 1) / k_batch, [&](std::size_t batch) {
    std::exception_ptr error;
    for (std::size_t i = batch * k_batch; i < std::min(size(), (batch + 1) * k_batch); ++i) {
      if (!world_->is_there(rows_[i])) continue;
      try {
        const Model::Visit turn(robots_[i]);
        visit(i, robots_[i]);
      } catch (...) {
        if (!error) error = std::current_exception();
      }
    }
    if (error) std::rethrow_exception(error);
  });
}

void Swarm::set_speeds(std::span<const Model::Speed> speeds, std::span<const std::uint8_t> where) {
  write(speeds.size(), where, [&](Row row, std::size_t i) {
    const Model::Speed& speed = speeds[i];
    world_->set_command(row, {speed.forward, speed.left, speed.turn, engine::ControlMode::velocity});
  });
}

void Swarm::accelerate(std::span<const Model::Speed> accelerations, std::span<const std::uint8_t> where) {
  write(accelerations.size(), where, [&](Row row, std::size_t i) {
    const Model::Speed& rate = accelerations[i];
    world_->set_command(row, {rate.forward, rate.left, rate.turn, engine::ControlMode::acceleration});
  });
}

void Swarm::go_to(std::span<const Pose> goals, std::span<const std::uint8_t> where) {
  write(goals.size(), where, [&](Row row, std::size_t i) {
    const Pose& goal = goals[i];
    world_->set_command(row, {goal.x, goal.y, goal.heading, engine::ControlMode::position});
  });
}

void Swarm::set_poses(std::span<const Pose> poses, std::span<const std::uint8_t> where) {
  std::vector<engine::World::Placed> placed;
  placed.reserve(size());
  write(poses.size(), where, [&](Row row, std::size_t i) { placed.push_back({row, poses[i]}); });
  world_->set_poses(placed);
}

}  // namespace troupe
