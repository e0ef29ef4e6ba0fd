#include "troupe/swarm.hpp"

#include "engine/kinds/finite.hpp"
#include "engine/observing/measures.hpp"
#include "engine/world/world.hpp"
#include "troupe/model_place.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <utility>
#include <vector>

namespace troupe {
namespace {

void check_size(std::string_view what, std::size_t given, std::size_t robots) {
  if (given != robots)
    throw std::invalid_argument(
        fmt::format("found {} {} for a swarm of {} robots: give one per robot", given, what, robots));
}

}  // namespace

Swarm Simulation::swarm(std::string_view of) {
  engine::World& world = this->world();
  std::vector<BodyId> robots = engine::robots_of(world, of);
  if (robots.empty() && !of.empty() && !engine::is_name_of_no_robots(world, of))
    throw std::out_of_range(engine::unknown_robots(world, of));
  return Swarm(world, std::move(robots));
}

/// The requested ranger of one type of robots, and the table that stores its readings.
struct Swarm::Ranger {
  const engine::BodyType::Device* device = nullptr;
  const engine::StateTable* readings = nullptr;
};

Swarm::Swarm(engine::World& world, std::vector<BodyId> ids) : world_(&world), ids_(std::move(ids)) {}

Swarm Swarm::of(engine::World& world, std::vector<BodyId> ids) {
  const std::size_t bodies = world.spec().bodies.size();
  for (const BodyId id : ids) {
    if (id.index() >= bodies)
      throw std::out_of_range(fmt::format(
          "no robot with id {}: the world has {} bodies, whose ids begin at 0", id.value, bodies));
    if (world.view().location(id) == engine::RowLocation::none)
      throw std::out_of_range(
          fmt::format("\"{}\" (id {}) is not a robot: it is static", world.spec().name(id), id.value));
  }
  return {world, std::move(ids)};
}

/// The present row of robot i in the state tables.
Row Swarm::row(std::size_t i) const { return world_->view().row(ids_[i]); }

std::vector<std::string> Swarm::names() const {
  std::vector<std::string> names;
  names.reserve(size());
  for (const BodyId id : ids_) names.push_back(world_->spec().name(id));
  return names;
}

std::uint64_t Swarm::tick() const { return world_->tick(); }
double Swarm::time_s() const { return world_->view().time_s(); }

std::vector<std::string> Swarm::types() const {
  const std::span<const engine::BodyType> all = world_->view().types();
  std::vector<std::uint8_t> has(all.size(), 0);
  for (const BodyId id : ids_) has[world_->spec().bodies[id.index()].type.index()] = 1;
  std::vector<std::string> types;
  for (std::size_t t = 0; t < all.size(); ++t)
    if (has[t] != 0) types.push_back(all[t].name);
  return types;
}

/// Calls one(row, i) for each robot i and its row in the state tables. room: number of elements of the
/// caller's span. Throws std::invalid_argument if `room` is not size().
template <class Read>
void Swarm::read(std::size_t room, Read&& one) const {
  world_->require_whole();
  check_size("elements", room, size());
  for (std::size_t i = 0; i < size(); ++i) one(row(i), i);
}

/// Calls one(row, i) for each robot that `where` selects and that is in the world. given: number of elements
/// of the caller's span. Throws std::invalid_argument if `given`, or the size of `where` if `where` is not
/// empty, is not size().
template <class Write>
void Swarm::write(std::size_t given, std::span<const std::uint8_t> where, Write&& one) const {
  Model::require_may_change(*world_, "a command for a swarm");
  world_->require_whole();
  check_size("elements", given, size());
  if (!where.empty()) check_size("elements of `where`", where.size(), size());
  for (std::size_t i = 0; i < size(); ++i)
    if ((where.empty() || where[i] != 0) && world_->view().is_there(row(i))) one(row(i), i);
}

void Swarm::alive(std::span<std::uint8_t> out) const {
  read(out.size(), [&](Row row, std::size_t i) { out[i] = world_->view().is_there(row); });
}

void Swarm::stalled(std::span<std::uint8_t> out) const {
  read(out.size(), [&](Row row, std::size_t i) { out[i] = world_->view().stalled(row); });
}

void Swarm::blocked_by(std::span<BodyId> out) const {
  if (!world_->state().contact_table) engine::throw_no_contacts();
  read(out.size(), [&](Row row, std::size_t i) { out[i] = world_->view().contact(row).blocker(); });
}

void Swarm::poses(std::span<Pose> out) const {
  read(out.size(), [&](Row, std::size_t i) { out[i] = world_->view().pose(ids_[i]); });
}

void Swarm::estimates(std::span<Pose> out) const {
  read(out.size(), [&](Row row, std::size_t i) { out[i] = world_->view().estimate(row); });
}

void Swarm::speeds(std::span<Model::Speed> out) const {
  const std::span<const engine::Velocity> velocities = world_->view().velocities();
  read(out.size(), [&](Row row, std::size_t i) {
    const engine::Velocity& v = velocities[row.index()];
    out[i] = {v.x, v.y, v.turn};
  });
}

/// The robot with this row, for the search of its devices.
Model::Place Swarm::place(Row row) const {
  const BodyId body = world_->view().body(row);
  return {world_, body, 0, world_->spec().name(body)};
}

Swarm::Ranger Swarm::ranger_of(Row row, std::string_view sensor) const {
  const engine::BodyType::Device& device = place(row).ranger(sensor);
  return {&device, &world_->tables()[device.table]};
}

/// Calls visit(ranger, row, i) for each robot i, with its ranger named `sensor`. Throws std::out_of_range if
/// a robot has none.
template <class Visit>
void Swarm::for_rangers(std::string_view sensor, Visit&& visit) const {
  const engine::BodyType* type = nullptr;
  Ranger ranger;
  for (std::size_t i = 0; i < size(); ++i) {
    const Row row = this->row(i);
    if (const engine::BodyType& own = world_->view().type(row); type != &own) {
      ranger = ranger_of(row, sensor);
      type = &own;
    }
    visit(ranger, row, i);
  }
}

std::size_t Swarm::beams(std::string_view sensor) const {
  if (ids_.empty()) return 0;
  const std::size_t beams = ranger_of(row(0), sensor).device->prepared.bearings.size();
  for_rangers(sensor, [&](const Ranger& ranger, Row, std::size_t i) {
    if (const std::size_t own = ranger.device->prepared.bearings.size(); own != beams)
      throw std::invalid_argument(
          fmt::format("the robots have different rangers: the ranger of \"{1}\" has {0} beams, that of "
                      "\"{3}\" has {2}; use a swarm of one type",
                      beams, world_->spec().name(ids_.front()), own, world_->spec().name(ids_[i])));
  });
  return beams;
}

void Swarm::ranges(std::span<float> out, std::string_view sensor) const {
  world_->require_whole();
  const std::size_t count = beams(sensor);
  if (out.size() != count * size())
    throw std::invalid_argument(fmt::format(
        "found a span of {} elements, but {} robots with {} beams each need {}, one per robot and beam",
        out.size(), size(), count, size() * count));
  for_rangers(sensor, [&](const Ranger& ranger, Row row, std::size_t i) {
    if (!world_->view().senses(row, *ranger.device))
      refuse_stopped(*ranger.device, world_->spec().name(ids_[i]));
    const std::span<const float> readings = ranger.readings->cell<float>(world_->view().slot(row), 0);
    std::ranges::copy(readings, out.subspan(i * count).begin());
  });
}

std::vector<double> Swarm::bearings(std::string_view sensor) const {
  return ids_.empty() ? std::vector<double>() : ranger_of(row(0), sensor).device->prepared.bearings;
}

double Swarm::range_bound(std::string_view sensor) const {
  return ids_.empty() ? 0 : ranger_of(row(0), sensor).device->prepared.reach_m;
}

/// A field of the readings or commands of a device of one type of robots, and the device; or a field of the
/// memory of a controller.
struct Swarm::Cells {
  const engine::BodyType::Device* device = nullptr;  ///< null: the field belongs to a memory
  const engine::StateField* field = nullptr;
  std::size_t index = 0;                         ///< index of the field in `readings`
  const engine::StateTable* readings = nullptr;  ///< null: the field belongs to a command
};

Swarm::Cells Swarm::readings_of(Row row, std::string_view field, std::string_view wanted) const {
  const Model::Place::Reading found = place(row).reading(field, wanted);
  return {found.state.device, &found.field(), found.index, found.state.table};
}

Swarm::Cells Swarm::commands_of(Row row, std::string_view field, std::string_view wanted) const {
  const engine::BodyType::Device& device = place(row).commanded(wanted);
  return {.device = &device,
          .field = &command_field(device.prepared.commands, field,
                                  fmt::format("device \"{}\" of \"{}\"", device.name,
                                              world_->spec().name(world_->view().body(row))))};
}

/// Calls visit(cells, row, i) for each robot i. bytes: size of the caller's span. Throws
/// std::invalid_argument, before the first call, if this size is not that of the fields of all robots, or if
/// the types or numbers of columns of the fields differ between robots.
template <class Visit>
void Swarm::for_cells(FindCells find, std::size_t bytes, std::string_view field, std::string_view device,
                      Visit&& visit) const {
  world_->require_whole();
  struct Run {  // robots of one type
    Cells cells;
    std::size_t end = 0;
  };
  std::vector<Run> runs;
  const engine::BodyType* type = nullptr;
  for (std::size_t i = 0; i < size(); ++i) {
    const Row row = this->row(i);
    if (const engine::BodyType& own = world_->view().type(row); type != &own) {
      const Cells its = (this->*find)(row, field, device);
      const engine::StateField& first = runs.empty() ? *its.field : *runs.front().cells.field;
      if (first.element != its.field->element || first.columns != its.field->columns)
        throw std::invalid_argument(fmt::format(
            "the robots have different devices: \"{}\" of \"{}\" has {} columns of type {}, that "
            "of \"{}\" has {} of type {}; use a swarm of one type",
            field, world_->spec().name(ids_.front()), first.columns, engine::element_name(first.element),
            world_->spec().name(ids_[i]), its.field->columns, engine::element_name(its.field->element)));
      if (bytes != size() * its.field->bytes())
        throw std::invalid_argument(fmt::format(
            "found {} bytes for \"{}\" of {} robots with {} columns each: give {}, one element of "
            "type {} per robot and column",
            bytes, field, size(), its.field->columns, size() * its.field->bytes(),
            engine::element_name(its.field->element)));
      runs.push_back({.cells = its});
      type = &own;
    }
    runs.back().end = i + 1;
  }
  std::size_t i = 0;
  for (const Run& run : runs)
    for (; i < run.end; ++i) visit(run.cells, row(i), i);
}

const engine::StateField& Swarm::reading_field(std::string_view field, std::string_view device) const {
  if (ids_.empty()) throw std::logic_error("a swarm without robots has no readings");
  return *readings_of(row(0), field, device).field;
}

void Swarm::readings(std::span<std::byte> out, std::string_view field, std::string_view device) const {
  for_cells(&Swarm::readings_of, out.size(), field, device, [&](const Cells& cells, Row row, std::size_t i) {
    if (cells.device != nullptr && cells.device->kind->is_sensor() &&
        !world_->view().senses(row, *cells.device))
      refuse_stopped(*cells.device, world_->spec().name(ids_[i]));
    std::memcpy(out.data() + i * cells.field->bytes(),
                cells.readings->cell<std::byte>(world_->view().slot(row), cells.index).data(),
                cells.field->bytes());
  });
}

std::span<const engine::StateField> Swarm::command_fields(std::string_view device) const {
  if (ids_.empty()) throw std::logic_error("a swarm without robots has no commands");
  return place(row(0)).commanded(device).prepared.commands;
}

std::vector<std::string_view> Swarm::devices_with_command(std::string_view field) const {
  if (ids_.empty()) throw std::logic_error("a swarm without robots has no devices");
  std::vector<std::string_view> names;
  for (const engine::BodyType::Device& device : world_->view().type(row(0)).devices)
    if (engine::field_named(device.prepared.commands, field) != nullptr) names.push_back(device.name);
  return names;
}

void Swarm::commands(std::span<std::byte> out, std::string_view field, std::string_view device) const {
  for_cells(&Swarm::commands_of, out.size(), field, device, [&](const Cells& cells, Row row, std::size_t i) {
    std::memcpy(out.data() + i * cells.field->bytes(),
                world_->view().commands(*cells.device).row(world_->view().slot(row)) + cells.field->offset,
                cells.field->bytes());
  });
}

void Swarm::set_commands(std::span<const std::byte> values, std::string_view field, std::string_view device,
                         std::span<const std::uint8_t> where) {
  world_->require_between_steps("set_commands()");
  Model::require_may_change(*world_, "a command for a swarm");
  if (!where.empty()) check_size("elements of `where`", where.size(), size());
  const auto for_selected = [&](auto&& visit) {
    for_cells(&Swarm::commands_of, values.size(), field, device,
              [&](const Cells& cells, Row row, std::size_t i) {
                if ((where.empty() || where[i] != 0) && world_->view().is_there(row))
                  visit(cells, row, values.subspan(i * cells.field->bytes(), cells.field->bytes()), ids_[i]);
              });
  };
  for_selected([&](const Cells& cells, Row, std::span<const std::byte> own, BodyId id) {
    for (const std::byte value : own)
      if (cells.field->is_bool && std::to_integer<unsigned>(value) > 1)
        throw std::invalid_argument(
            fmt::format("found {} for the command \"{}\" of \"{}\", which is a bool: give 0 or 1",
                        std::to_integer<unsigned>(value), field, world_->spec().name(id)));
  });
  for_selected([&](const Cells& cells, Row row, std::span<const std::byte> own, BodyId) {
    std::memcpy(world_->device_command(row, *cells.device) + cells.field->offset, own.data(), own.size());
  });
}

void Swarm::subscribe() {
  Model::require_may_change(*world_, "subscribe()");
  check_subscribable(*world_);
  for (const BodyId id : ids_) world_->subscribe(id);
}

void Swarm::for_each(const std::function<void(std::size_t i, Model& robot)>& visit) {
  constexpr std::size_t k_batch = 32;  // calls per task, enough to be worth waking a thread
  if (!visit)
    throw std::invalid_argument("for_each(): found a null function: give a function to call for each robot");
  world_->require_whole();
  Model::require_may_change(*world_, "for_each()");
  if (robots_.empty()) {
    robots_.reserve(size());
    for (const BodyId id : ids_) robots_.push_back(Model::of(*world_, id));
  }
  world_->gather();  // fetches the rows of other ranks before the calls below, which run in parallel
  world_->parallel().for_batches(size(), k_batch, [&](std::size_t first, std::size_t end) {
    std::exception_ptr error;
    for (std::size_t i = first; i < end; ++i) {
      if (!world_->view().is_there(row(i))) continue;
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

/// Commands command_of(values[i]) to each robot i that write() selects. Throws std::invalid_argument, before
/// the first command, if a number of a command is not finite. call: name of the calling function
template <class Value, class CommandOf>
void Swarm::command(std::string_view call, std::span<const Value> values, std::span<const std::uint8_t> where,
                    CommandOf&& command_of) const {
  world_->require_between_steps(call);
  write(values.size(), where, [&](Row, std::size_t i) {
    const engine::Command command = command_of(values[i]);
    if (!engine::is_finite(command))
      Model::require_finite(world_->spec().name(ids_[i]), command.x, command.y, command.turn);
  });
  write(values.size(), where,
        [&](Row row, std::size_t i) { world_->set_command(row, command_of(values[i])); });
}

void Swarm::set_speeds(std::span<const Model::Speed> speeds, std::span<const std::uint8_t> where) {
  command("set_speeds()", speeds, where, [](const Model::Speed& speed) {
    return engine::Command{speed.forward, speed.left, speed.turn, engine::ControlMode::velocity};
  });
}

void Swarm::accelerate(std::span<const Model::Speed> accelerations, std::span<const std::uint8_t> where) {
  command("accelerate()", accelerations, where, [](const Model::Speed& rate) {
    return engine::Command{rate.forward, rate.left, rate.turn, engine::ControlMode::acceleration};
  });
}

void Swarm::go_to(std::span<const Pose> goals, std::span<const std::uint8_t> where) {
  command("go_to()", goals, where, [](const Pose& goal) {
    return engine::Command{goal.x, goal.y, goal.heading, engine::ControlMode::position};
  });
}

void Swarm::set_poses(std::span<const Pose> poses, std::span<const std::uint8_t> where) {
  std::vector<engine::World::Placed> placed;
  placed.reserve(size());
  write(poses.size(), where, [&](Row row, std::size_t i) { placed.push_back({row, poses[i]}); });
  world_->set_poses(placed);
}

}  // namespace troupe
