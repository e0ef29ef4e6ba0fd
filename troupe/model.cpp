#include "base/diagnostics.hpp"
#include "engine/kinds/finite.hpp"
#include "engine/state/kind_calls.hpp"
#include "engine/world/world.hpp"
#include "models/drives/wheels.hpp"
#include "troupe/model_place.hpp"
#include "troupe/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

namespace troupe {
namespace {

/// Returns the first device on the part with this index, not on its subparts, whose kind defines the function
/// `declared`; null if there is none.
template <class Capability>
const engine::BodyType::Device* device_on(const engine::BodyType& type, std::size_t part,
                                          Capability engine::DeviceKind::*declared) {
  for (const engine::BodyType::Device& device : type.devices)
    if (device.part == part && device.kind->*declared) return &device;
  return nullptr;
}

/// Whether two structs have the same fields at the same places.
bool same_layout(std::span<const engine::StateField> a, std::span<const engine::StateField> b) {
  return engine::same_fields(a, b) &&
         std::ranges::equal(a, b, {}, &engine::StateField::offset, &engine::StateField::offset);
}

/// Returns the names and types of fields: `shows (uint8), red (float32)`.
std::string names_and_types(std::span<const engine::StateField> fields) {
  std::string text;
  for (const engine::StateField& field : fields)
    text +=
        fmt::format("{}{} ({}{})", text.empty() ? "" : ", ", field.name, engine::element_name(field.element),
                    field.columns == 1 ? "" : fmt::format(" x {}", field.columns));
  return text;
}

/// The function of Model that commands in this mode.
std::string_view setter_of(engine::ControlMode mode) {
  switch (mode) {
    case engine::ControlMode::velocity: break;
    case engine::ControlMode::acceleration: return "accelerate()";
    case engine::ControlMode::position: return "go_to()";
  }
  return "set_speed()";
}

/// The robot that Swarm::for_each() visits on this thread; null if this thread is not in for_each().
thread_local const Model* visited_robot = nullptr;

}  // namespace

void refuse_stopped(const engine::BodyType::Device& sensor, std::string_view owner) {
  throw std::logic_error(fmt::format(
      "sensor \"{}\" of \"{}\" does not run: call subscribe() before the first step", sensor.name, owner));
}

const engine::StateField& command_field(std::span<const engine::StateField> fields, std::string_view name,
                                        std::string_view whose) {
  if (const engine::StateField* const field = engine::field_named(fields, name)) return *field;
  throw std::out_of_range(
      fmt::format("{}: {}", whose, unknown_name("command field", name, name_list(fields))));
}

void check_subscribable(const engine::World& world) {
  if (world.tick() > 0)
    throw std::logic_error(fmt::format(
        "subscribe() must be called before the first step, but this simulation is at tick {}", world.tick()));
}

Row Model::Place::row() const {
  world->require_whole();
  const Row row = world->view().row(body);
  if (!row.valid())
    throw std::logic_error(
        fmt::format("\"{}\" is static: it has no drive, device or controller and cannot be gripped or "
                    "pushed, so it has no motion, command or reading",
                    name));
  return row;
}

BodyId Model::Place::of_body() const {
  if (part > 0)
    throw std::logic_error(fmt::format("\"{}\" is a part of \"{}\": use the model \"{}\" instead", name,
                                       world->spec().name(body), world->spec().name(body)));
  return body;
}

Row Model::Place::whole() const {
  const Row row = world->view().row(of_body());
  if (!row.valid())
    throw std::logic_error(fmt::format(
        "\"{}\" is static: only bodies that have a drive, a device or a controller, or that can be "
        "gripped or pushed, can be moved, removed or disabled",
        name));
  return row;
}

template <class Counted>
std::vector<std::string_view> Model::Place::names_of(Counted&& counted) const {
  std::vector<std::string_view> names;
  for (const engine::BodyType::Device& device : type().devices)
    if (owns(device) && counted(device)) names.push_back(device.name);
  return names;
}

void Model::Place::throw_unknown(std::string_view what, std::string_view wanted,
                                 std::span<const std::string_view> known) const {
  if (known.empty()) throw std::out_of_range(fmt::format("\"{}\" has no {}", name, what));
  throw std::out_of_range(fmt::format("\"{}\" has no {} \"{}\"; it has: {}{}", name, what, wanted,
                                      comma_list(known), did_you_mean(wanted, known)));
}

void Model::Place::check_running(const engine::BodyType::Device& sensor) const {
  if (!world->view().senses(row(), sensor)) refuse_stopped(sensor, name);
}

const engine::BodyType::Device& Model::Place::ranger(std::string_view wanted) const {
  const auto is_ranger = [](const engine::BodyType::Device& d) { return d.is_ranger(); };
  const auto* found = find([&](const engine::BodyType::Device& d) {
    return is_ranger(d) && (wanted.empty() || d.name == wanted);
  });
  if (!found) throw_unknown("ranger", wanted, names_of(is_ranger));
  return *found;
}

std::string Model::Place::State::text() const {
  return fmt::format("{} \"{}\"", device != nullptr ? "device" : "controller", name());
}

Model::Place::State Model::Place::state(std::string_view wanted) const {
  if (const auto* found = find([&](const engine::BodyType::Device& d) { return d.name == wanted; }))
    return {found, &world->tables()[found->table]};
  std::vector<std::string_view> known = names_of([](const engine::BodyType::Device&) { return true; });
  for (std::size_t c = 0; c < type().controllers.size(); ++c) {
    const std::optional<std::size_t>& memory = type().controllers[c].table;
    if (!memory || !owns_controller(c)) continue;
    const engine::StateTable& table = world->tables()[*memory];
    if (table.component() == wanted) return {nullptr, &table};
    known.push_back(table.component());
  }
  throw_unknown("device", wanted, known);
}

Model::Place::Reading Model::Place::reading(std::string_view field, std::string_view wanted) const {
  const auto find_in = [&](const State& state) -> std::optional<Reading> {
    const std::span<const engine::StateField> fields = state.table->fields();
    const engine::StateField* const found = engine::field_named(fields, field);
    if (found == nullptr) return {};
    return Reading{state, static_cast<std::size_t>(found - fields.data())};
  };
  if (!wanted.empty()) {
    const State state = this->state(wanted);
    if (const auto found = find_in(state)) return *found;
    throw std::out_of_range(fmt::format("{} of \"{}\": {}", state.text(), name,
                                        unknown_name("field", field, name_list(state.table->fields()))));
  }
  std::vector<std::string_view> known;
  for (const engine::BodyType::Device& device : type().devices) {
    if (!owns(device)) continue;
    const State state{&device, &world->tables()[device.table]};
    if (const auto found = find_in(state)) return *found;
    for (const engine::StateField& other : state.table->fields())
      if (std::ranges::find(known, other.name) == known.end()) known.push_back(other.name);
  }
  throw std::out_of_range(
      fmt::format("devices of \"{}\": {}", name, unknown_name("field", field, std::move(known))));
}

Model::Model(std::shared_ptr<const Place> place) : place_(std::move(place)) {}

Model::Visit::Visit(const Model& robot) : before_(visited_robot) { visited_robot = &robot; }
Model::Visit::~Visit() { visited_robot = before_; }

void Model::require_may_change(const engine::World& world, std::string_view what) {
  world.require_between_steps(what);
  if (visited_robot != nullptr && visited_robot->place_->world == &world)
    throw std::logic_error(
        fmt::format("{} is not allowed in for_each(), here for \"{}\": for_each() calls the function for "
                    "several robots at once, and each call may change only the commands of its own robot; "
                    "collect other changes and apply them after for_each()",
                    what, visited_robot->name()));
}

void Model::require_may_command(std::string_view call) const {
  place_->world->require_between_steps(call);
  if (visited_robot != nullptr && visited_robot->place_->body != place_->body)
    require_may_change(*place_->world, fmt::format("a command for \"{}\"", name()));
}

Model Model::of(engine::World& world, BodyId body) {
  return Model(std::make_shared<Place>(Place{&world, body, 0, world.spec().name(body)}));
}

const std::string& Model::name() const { return place_->name; }

BodyId Model::id() const { return place_->body; }

bool Model::operator==(const Model& other) const {
  return place_->world == other.place_->world && place_->body == other.place_->body &&
         place_->part == other.place_->part;
}

Random Model::random(std::string_view name) const {
  const engine::World& world = *place_->world;
  return {world.spec().seed, stream_id("program", name), place_->body.value,
          static_cast<std::uint32_t>(world.tick())};
}

Pose Model::pose() const {
  const engine::World& world = *place_->world;
  world.require_whole();
  const engine::WorldSpec& spec = world.spec();
  const auto& part = spec.type(place_->body).parts[place_->part];
  if (part.joint != engine::k_rigid)
    return compose(world.view().mount(place_->row(), part.joint), part.pose_body_part);
  return compose(world.view().pose(place_->body), part.pose_body_part);
}

Eigen::Vector3d Model::size() const {
  const engine::WorldSpec& spec = place_->world->spec();
  return spec.type(place_->body).parts[place_->part].size;
}

void Model::refuse_absent() const {
  if (!is_alive())
    throw std::logic_error(
        fmt::format("\"{}\" is not in the world: it is not yet born, or dead", place_->name));
}

void Model::require_finite(std::string_view robot, double x, double y, double turn) {
  if (!engine::is_finite(engine::Command{x, y, turn}))
    throw std::invalid_argument(
        fmt::format("\"{}\" was commanded {}, {}, {}: give finite numbers", robot, x, y, turn));
}

void Model::command(engine::ControlMode mode, double x, double y, double turn) {
  require_may_command(setter_of(mode));
  require_finite(place_->name, x, y, turn);
  const auto* wheels = place_->wheels();
  if (wheels == nullptr && !place_->type().drive)
    throw std::logic_error(fmt::format("\"{}\" has no drive", place_->name));
  refuse_absent();
  if (wheels != nullptr) {
    std::byte* const command = place_->world->device_command(place_->row(), *wheels);
    *reinterpret_cast<engine::Command*>(command) = {x, y, turn, mode};
    return;
  }
  place_->world->set_command(place_->row(), {x, y, turn, mode});
}

void Model::set_speed(double forward, double left, double turn) {
  command(engine::ControlMode::velocity, forward, left, turn);
}

void Model::accelerate(double forward, double left, double turn) {
  command(engine::ControlMode::acceleration, forward, left, turn);
}

void Model::go_to(double x, double y, double heading) {
  command(engine::ControlMode::position, x, y, heading);
}

Model::Speed Model::speed() const {
  if (const auto* wheels = place_->wheels()) {
    if (!place_->world->view().runs(place_->row(), *wheels))
      return {};  // because `wheels` that do not run keep the state of their last run
    const auto& state = place_->world->tables()[wheels->table].as<models::WheelsState>(place_->slot());
    return {state.forward, state.left, state.turn};
  }
  const engine::Velocity v = place_->world->view().velocities()[place_->row().index()];
  return {v.x, v.y, v.turn};
}

bool Model::is_alive() const {
  place_->world->require_whole();
  const Row row = place_->world->view().row(place_->body);
  return !row.valid() || place_->world->view().is_there(row);
}

bool Model::stalled() const {
  if (const auto* wheels = place_->wheels())
    return place_->world->view().runs(place_->row(), *wheels) &&
           place_->world->tables()[wheels->table].as<models::WheelsState>(place_->slot()).stalled != 0;
  return place_->world->view().stalled(place_->row());
}

engine::Contact Model::blocked_by() const {
  if (!place_->world->state().contact_table) engine::throw_no_contacts();
  return place_->world->view().contact(place_->row());
}

Pose Model::estimate() const {
  return place_->wheels() ? pose() : place_->world->view().estimate(place_->row());
}

void Model::set_estimate(const Pose& pose) {
  require_may_command("set_estimate()");
  place_->world->set_estimate(place_->row(), pose);
}

void Model::set_pose(const Pose& pose) {
  require_may_change(*place_->world, "set_pose()");
  const engine::World::Placed placed{place_->whole(), pose};
  place_->world->set_poses({&placed, 1});
}

bool Model::is_free(const Pose& pose) const { return place_->world->is_free(place_->whole(), pose); }

std::vector<std::string> Model::sensors() const {
  std::vector<std::string> names;
  for (const engine::BodyType::Device& device : place_->type().devices)
    if (device.kind->is_sensor() && place_->owns(device)) names.push_back(device.name);
  return names;
}

std::span<const float> Model::ranges(std::string_view sensor) const {
  const auto& found = place_->ranger(sensor);
  place_->check_running(found);
  return place_->world->tables()[found.table].cell<float>(place_->world->view().slot(place_->row()), 0);
}

std::span<const float> Model::intensities(std::string_view sensor) const {
  const auto& found = place_->ranger(sensor);
  place_->check_running(found);
  const engine::StateTable& table = place_->world->tables()[found.table];
  if (table.fields().size() < 2) return {};
  return table.cell<float>(place_->world->view().slot(place_->row()), 1);
}

Model::Reading Model::reading(std::string_view field, std::string_view wanted) const {
  const auto [state, index] = place_->reading(field, wanted);
  if (state.device != nullptr && state.device->kind->is_sensor()) place_->check_running(*state.device);
  const engine::StateField& found = state.table->fields()[index];
  return {state.name(), &found, {state.table->cell<std::byte>(place_->slot(), index).data(), found.bytes()}};
}

std::span<const std::byte> Model::cell(std::string_view field, std::string_view wanted,
                                       engine::Element element) const {
  const Reading found = reading(field, wanted);
  if (const engine::Element own = found.field->element; own != element)
    throw std::invalid_argument(fmt::format("field \"{}\" of {} of \"{}\" has the type {}, not {}", field,
                                            place_->state(found.device).text(), name(),
                                            engine::element_name(own), engine::element_name(element)));
  return found.bytes;
}

std::span<const engine::StateField> Model::fields(std::string_view device) const {
  return place_->state(device).table->fields();
}

std::byte* Model::asked(std::string_view wanted, std::size_t bytes,
                        std::span<const engine::StateField> fields) {
  require_may_command("command()");
  const auto takes = [](const engine::BodyType::Device& d) { return d.command_table.has_value(); };
  const auto takes_these = [&](const engine::BodyType::Device& d) {
    return takes(d) && d.prepared.command_bytes == bytes && same_layout(d.prepared.commands, fields);
  };
  const auto* device = place_->find([&](const engine::BodyType::Device& d) {
    return wanted.empty() ? takes_these(d) : takes(d) && d.name == wanted;
  });
  if (!device && wanted.empty())
    if (const auto known = place_->names_of(takes); !known.empty())
      throw std::out_of_range(
          fmt::format("\"{}\" has no device that takes this command struct; devices that take commands: {}",
                      name(), comma_list(known)));
  if (!device)
    place_->throw_unknown("device that takes this command struct", wanted, place_->names_of(takes));
  if (!takes_these(*device))
    throw std::invalid_argument(
        fmt::format("\"{}\" of \"{}\" takes commands of kind {}, with the fields {} in {} bytes; the given "
                    "struct has the fields {} in {} bytes",
                    device->name, name(), device->kind->name, names_and_types(device->prepared.commands),
                    device->prepared.command_bytes, names_and_types(fields), bytes));
  refuse_absent();
  return place_->world->device_command(place_->row(), *device);
}

const engine::BodyType::Device& Model::Place::commanded(std::string_view wanted) const {
  const auto takes = [](const engine::BodyType::Device& d) { return d.command_table.has_value(); };
  const auto* device = find([&](const engine::BodyType::Device& d) { return takes(d) && d.name == wanted; });
  if (!device) throw_unknown("device that takes commands", wanted, names_of(takes));
  return *device;
}

Model::Asked Model::asked(std::string_view wanted) {
  require_may_command("asked()");
  const engine::BodyType::Device& device = place_->commanded(wanted);
  refuse_absent();
  return {device.prepared.commands,
          {place_->world->device_command(place_->row(), device), device.prepared.command_bytes}};
}

std::span<const engine::StateField> Model::command_fields(std::string_view device) const {
  return place_->commanded(device).prepared.commands;
}

std::optional<Model::Energy> Model::energy() const {
  const engine::World& world = *place_->world;
  const engine::TypeSpec& spec = world.spec().type(place_->body);
  for (std::size_t part = place_->part;; part = spec.parts[part].parent) {
    if (const auto* pack = device_on(place_->type(), part, &engine::DeviceKind::energy))
      return engine::energy_of(world.view(), place_->row(), *pack);
    if (part == 0) return {};
  }
}

std::size_t Model::flag_count() const {
  const engine::World& world = *place_->world;
  const auto* holder = device_on(place_->type(), place_->part, &engine::DeviceKind::flags);
  if (!holder) return 0;
  const Row row = place_->row();
  return engine::call_hook(
             world.view(), row, *holder,
             [&] { return holder->kind->flags(world.tables()[holder->table], world.view().slot(row)); })
      .count;
}

}  // namespace troupe
