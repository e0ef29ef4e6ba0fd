#include "troupe/simulation.hpp"

#include "base/diagnostics.hpp"
#include "base/fp_environment.hpp"
#include "base/hash.hpp"
#include "engine/replica.hpp"
#include "engine/sight.hpp"
#include "engine/stop_conditions.hpp"
#include "engine/ticks.hpp"
#include "engine/world.hpp"
#include "models/drives/wheels.hpp"
#include "partition/simd_target.hpp"
#include "partition/transport.hpp"
#include "troupe/acts.hpp"
#include "troupe/build_info.hpp"
#include "troupe/pictures.hpp"
#include "troupe/plugins.hpp"
#include "troupe/rank_processes.hpp"
#include "troupe/rank_team.hpp"
#include "troupe/recording.hpp"
#include "troupe/registry.hpp"
#include "troupe/script.hpp"
#include "troupe/world_builder.hpp"
#include "worldio/json/experiment_json.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/spec_check.hpp"
#include "worldio/load.hpp"
#include "worldio/results/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <stdexcept>

namespace troupe {
namespace {

constexpr double k_longest_run_s =
    1e12;  // 32,000 years: a longer time is a mistake; the ticks of 1e12 s fit in 64 bits
constexpr double k_longest_ray_m = 3e5;  // from corner to corner of the largest world

/// Returns the first part of a line of version_line(), "troupe 0.2.0".
std::string_view version_of(std::string_view line) { return line.substr(0, line.find(" (")); }

/// Throws InputError for a checkpoint of another version unless `across_versions`. Returns a warning if
/// another version, or another build of this version, wrote the checkpoint; else an empty text.
std::string check_version(const worldio::Checkpoint& checkpoint, bool across_versions) {
  const std::string made_by = checkpoint.header("version");
  const std::string here = version_line();
  if (made_by == here) return {};
  const bool is_other = version_of(made_by) != version_of(here);
  if (is_other && !across_versions)
    throw InputError(
        fmt::format("{}: error: {} wrote this checkpoint, but this program is {}: results may differ; give "
                    "--across-versions to resume it anyway",
                    checkpoint.file().string(), version_of(made_by), version_of(here)));
  return fmt::format("{}: warning: the checkpoint was written by {}; this program is {}{}",
                     checkpoint.file().string(), made_by, here,
                     is_other ? ""
                              : ": the run continues with the same bits, because results do not depend on "
                                "compiler or processor (docs/determinism.md)");
}

constexpr const char* k_spare = "spare";          // key in a header
constexpr const char* k_holds = "holds";          // key in the memories of a checkpoint
constexpr std::string_view k_plugin = "plugin ";  // prefix of keys in a header: plugin NAME

/// Loads the plug-ins that a checkpoint was written with. Throws InputError if a plug-in is missing or is
/// another build. With `across_plugins` another build is accepted, and the result contains a warning for it.
std::vector<std::string> load_plugins(const worldio::Checkpoint& checkpoint, Plugins& plugins,
                                      bool across_plugins) {
  std::vector<std::string> warnings;
  for (const auto& [key, contents] : checkpoint.header()) {
    if (!key.starts_with(k_plugin)) continue;
    const std::string name = key.substr(k_plugin.size());
    const Result<const Plugins::Library*> loaded = plugins.load(name);
    if (!loaded)
      throw InputError(fmt::format(
          "{}: error: the run needs plug-in \"{}\": {}; if it is a Python script, give --controller {}.py",
          checkpoint.file().string(), name, loaded.error().text, name));
    const Plugins::Library* library = *loaded;
    if (hex(library->contents) == contents) continue;
    const std::string text =
        fmt::format("{} is another build of plug-in \"{}\" than the one that the checkpoint was written with",
                    library->file.string(), name);
    if (!across_plugins)
      throw InputError(
          fmt::format("{}: error: {} (its hash is {}, the checkpoint has {}): results may differ; "
                      "give --across-plugins to resume it anyway",
                      checkpoint.file().string(), text, hex(library->contents), contents));
    warnings.push_back(fmt::format("{}: warning: {}", checkpoint.file().string(), text));
  }
  return warnings;
}

void append(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

/// Returns the first device on the part with this index, not on its subparts, whose kind defines the function
/// `declared`; null if there is none.
template <class Capability>
const engine::BodyType::Device* device_on(const engine::BodyType& type, std::size_t part,
                                          Capability engine::DeviceKind::*declared) {
  for (const engine::BodyType::Device& device : type.devices)
    if (device.part == part && device.kind->*declared) return &device;
  return nullptr;
}

std::uint64_t ticks_of(std::string_view call, double seconds, double tick_s) {
  if (!(seconds >= 0 && seconds <= k_longest_run_s))
    throw std::invalid_argument(
        fmt::format("{}({}): give a time from 0 to {:g} s", call, seconds, k_longest_run_s));
  return engine::ticks_until(seconds, tick_s);
}

/// Whether the names of the fields are those in `names`, which a struct lists with TROUPE_FIELDS, in the same
/// order.
bool are_listed(std::span<const engine::StateField> fields, std::string_view names) {
  for (const engine::StateField& field : fields) {
    const std::size_t comma = names.find(',');
    std::string_view name = names.substr(0, comma);
    while (name.starts_with(' ')) name.remove_prefix(1);
    if (name != field.name) return false;
    names.remove_prefix(comma == names.npos ? names.size() : comma + 1);
  }
  return names.empty();
}

/// The robot that Swarm::for_each() visits on this thread; null outside of it.
thread_local const Model* visited_robot = nullptr;

}  // namespace

struct Simulation::Impl {
  std::shared_ptr<engine::Registry> registry;  ///< shared with simulations from another()
  std::shared_ptr<Plugins> plugins;            ///< loads plug-ins for `registry`
  std::unique_ptr<engine::World> world;
  /// The ranks that compute `world` together with this thread; null if it is computed by one rank.
  std::unique_ptr<RankGroup> ranks;
  std::vector<std::string> warnings;
  std::filesystem::path file;       ///< world file
  double tile_size_m = 0;           ///< from SimulationOptions
  worldio::PlaceAgain place_again;  ///< places bodies for another seed; empty if no place depends on it
  /// Changes to the world, as pairs of key and value for effective_options(): those of the option `set` (if a
  /// run was resumed with them, the key contains the tick), and `spare`.
  std::vector<std::pair<std::string, std::string>> changes;
  /// Tick of the checkpoint that the run was resumed from.
  std::optional<std::uint64_t> resumed_at;
  /// The data that observers stored in the checkpoint that the run was resumed from.
  worldio::Memories memories;
  /// The callbacks of on_save(), by name.
  std::map<std::string, std::function<std::vector<std::byte>()>> on_save;
  /// Evaluates the stop conditions; null if the world has no `stop_when`.
  std::unique_ptr<engine::StopConditions> stop;
  /// The recording that record() started; null if none is running.
  std::unique_ptr<Recording> recording;
  std::deque<std::function<void(Simulation&)>> on_tick;
  bool in_callbacks = false;
  /// Renderer and options of the last call of snapshot() or picture().
  std::unique_ptr<Pictures> pictures;
  PictureOptions picture_options;

  Pictures& pictures_of(const Simulation& simulation, const PictureOptions& options) {
    if (!pictures || picture_options != options) {
      pictures.reset();
      pictures = std::make_unique<Pictures>(simulation, options);
      picture_options = options;
    }
    pictures->forget();
    return *pictures;
  }
  std::function<void(Simulation&)> before_tick;
  /// Robots held by act().
  Holds holds;

  void refuse_in_callbacks(std::string_view what) const {
    if (in_callbacks)
      throw std::logic_error(fmt::format("{} is not allowed in a callback of on_tick()", what));
  }

  /// Makes the world of a valid spec, and collects warnings about it and about plug-ins in `warnings`.
  void start(engine::WorldSpec spec, const SimulationOptions& options, Diagnostics& diagnostics) {
    tile_size_m = options.tile_size_m;
    spec.mortal = spec.mortal || options.mortal;
    if (options.spare > 0) {
      engine::add_spare(spec, options.spare);
      changes.emplace_back(k_spare, fmt::format("{}", options.spare));
    }
    spec.ranging = options.ranging.value_or(spec.ranging);
    make_world(std::move(spec), options, diagnostics);
    watch_for_the_end(diagnostics);
    warnings = diagnostics.warnings();
    append(warnings, plugins->warnings());
  }
  /// Makes `world`, and its replicas on the other ranks. options: SimulationOptions or ResumeOptions.
  template <class Options>
  void make_world(engine::WorldSpec spec, const Options& options, Diagnostics& diagnostics) {
    const RankOptions team{options.ranks, options.rank_seed, options.rank_clock};
    check_ranks(team);
    const engine::WorldOptions own{threads_per_rank(options.threads, team.ranks), options.tile_size_m};
    world = std::make_unique<engine::World>(std::move(spec), *registry, own, diagnostics);
    if (options.processes)
      ranks = options.processes->add(*world, *registry, *plugins, own, options.rank_seed);
    else if (team.ranks > 1)
      ranks = std::make_unique<RankTeam>(*world, *registry, own, team);
  }
  /// Sets up the stop conditions (`stop_when`). `world` must already be set.
  void watch_for_the_end(Diagnostics& diagnostics) {
    const std::vector<engine::StopSpec>& conditions = world->spec().experiment.stop_when;
    if (conditions.empty()) return;
    stop = std::make_unique<engine::StopConditions>(*world, *registry, conditions, diagnostics);
    diagnostics.throw_if_errors();
  }
};

/// A body of a world and the index of one of its parts; 0: the body itself.
struct Model::Place {
  engine::World* world;
  BodyId body;
  std::size_t part;
  std::string name;

  /// Returns the row of the body in the state tables. Throws std::logic_error for static geometry, which has
  /// no row, and if the state is incomplete after a failed step.
  Row row() const {
    world->require_whole();
    const Row row = world->row(body);
    if (!row.valid())
      throw std::logic_error(fmt::format(
          "\"{}\" is static: it has no drive and no sensor, hence no motion, command or reading", name));
    return row;
  }
  /// Returns the row of the body in the state tables, for functions that do not apply to parts. Throws
  /// std::logic_error for a part and for static geometry.
  Row whole() const {
    if (part > 0)
      throw std::logic_error(fmt::format("\"{}\" is a part of a body: give the body itself", name));
    const Row row = world->row(body);
    if (!row.valid())
      throw std::logic_error(
          fmt::format("\"{}\" is static: only bodies with a drive, a sensor or a controller can be moved, "
                      "removed or disabled",
                      name));
    return row;
  }
  const engine::BodyType& type() const {
    return world->types()[world->spec().bodies[body.index()].type.index()];
  }
  std::size_t slot() const { return world->slot(row()); }
  /// Returns the drive of this part; null if the part has none, and for the body itself, whose drive is not a
  /// device.
  const engine::BodyType::Device* wheels() const {
    for (const engine::BodyType::Device& device : type().devices)
      if (part > 0 && device.part == part && device.kind->drives) return &device;
    return nullptr;
  }
  /// Whether a device belongs to this model: a body owns the devices of all its parts, a part only its own.
  bool owns(const engine::BodyType::Device& device) const {
    const auto& parts = world->spec().types[world->spec().bodies[body.index()].type.index()].parts;
    return part == 0 || device.name == parts[part].name;
  }
  /// Returns the first device of this model that satisfies `wanted`; null if there is none.
  template <class Wanted>
  const engine::BodyType::Device* find(Wanted&& wanted) const {
    for (const engine::BodyType::Device& device : type().devices)
      if (owns(device) && wanted(device)) return &device;
    return nullptr;
  }
  /// Throws std::out_of_range, `"r0" has no sensor "eye"; it has: ...`. The text lists the devices that
  /// satisfy `counted`.
  template <class Counted>
  [[noreturn]] void throw_unknown(std::string_view what, std::string_view wanted, Counted&& counted) const {
    std::vector<std::string_view> known;
    for (const engine::BodyType::Device& device : type().devices)
      if (owns(device) && counted(device)) known.push_back(device.name);
    if (known.empty() || wanted.empty()) throw std::out_of_range(fmt::format("\"{}\" has no {}", name, what));
    throw std::out_of_range(
        fmt::format("\"{}\" has no {} \"{}\"; it has: {}", name, what, wanted, comma_list(known)));
  }
  void check_running(const engine::BodyType::Device& device) const {
    if (!world->senses(row(), device))
      throw std::logic_error(fmt::format(
          "sensor \"{}\" of \"{}\" does not run: call subscribe() before the first step", device.name, name));
  }
  const engine::BodyType::Device& ranger(std::string_view wanted) const {
    const auto is_ranger = [](const engine::BodyType::Device& d) { return d.is_ranger(); };
    const auto* found = find([&](const engine::BodyType::Device& d) {
      return is_ranger(d) && (wanted.empty() || d.name == wanted);
    });
    if (!found) throw_unknown("ranging sensor", wanted, is_ranger);
    check_running(*found);
    return *found;
  }
  const engine::BodyType::Device& device(std::string_view wanted) const {
    const auto* found = find([&](const engine::BodyType::Device& d) { return d.name == wanted; });
    if (!found) throw_unknown("device", wanted, [](const auto&) { return true; });
    return *found;
  }
};

Model::Model(std::shared_ptr<const Place> place) : place_(std::move(place)) {}

Model::Visit::Visit(const Model& robot) : before_(visited_robot) { visited_robot = &robot; }
Model::Visit::~Visit() { visited_robot = before_; }

void Model::refuse_in_for_each(const engine::World& world, std::string_view what) {
  if (visited_robot != nullptr && visited_robot->place_->world == &world)
    throw std::logic_error(
        fmt::format("{} is not allowed in for_each(), here for \"{}\": for_each() calls the function for "
                    "several robots at once, and each call may change only the commands of its own robot; "
                    "collect other changes and apply them after for_each()",
                    what, visited_robot->name()));
}

void Model::refuse_others_in_for_each() const {
  if (visited_robot != nullptr && visited_robot->place_->body != place_->body)
    refuse_in_for_each(*place_->world, fmt::format("a command for \"{}\"", name()));
}

Model Model::of(engine::World& world, BodyId body) {
  return Model(std::make_shared<Place>(Place{&world, body, 0, world.spec().name(body)}));
}

const std::string& Model::name() const { return place_->name; }

BodyId Model::id() const { return place_->body; }

Random Model::random(std::string_view name) const {
  const engine::World& world = *place_->world;
  return {world.spec().seed, stream_id("program", name), place_->body.value,
          static_cast<std::uint32_t>(world.tick())};
}

Pose Model::pose() const {
  const engine::World& world = *place_->world;
  world.require_whole();
  const engine::WorldSpec& spec = world.spec();
  const auto& part = spec.types[spec.bodies[place_->body.index()].type.index()].parts[place_->part];
  if (part.joint != engine::k_rigid)
    return compose(world.mount(place_->row(), part.joint), part.pose_body_part);
  return compose(world.pose(place_->body), part.pose_body_part);
}

Eigen::Vector3d Model::size() const {
  const engine::WorldSpec& spec = place_->world->spec();
  return spec.types[spec.bodies[place_->body.index()].type.index()].parts[place_->part].size;
}

void Model::command(engine::ControlMode mode, double x, double y, double turn) {
  refuse_others_in_for_each();
  if (const auto* wheels = place_->wheels()) {
    place_->world->asked_of(*wheels).as<engine::Command>(place_->slot()) = {x, y, turn, mode};
    return;
  }
  if (!place_->type().drive) throw std::logic_error(fmt::format("\"{}\" has no drive", place_->name));
  if (!is_alive())
    throw std::logic_error(
        fmt::format("\"{}\" is not in the world: it is not yet born, or dead", place_->name));
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
    const auto& state = place_->world->percepts(*wheels).as<models::WheelsState>(place_->slot());
    return {state.forward, state.left, state.turn};
  }
  const engine::Velocity v = place_->world->velocities()[place_->row().index()];
  return {v.x, v.y, v.turn};
}

bool Model::is_alive() const {
  place_->world->require_whole();
  const Row row = place_->world->row(place_->body);
  return !row.valid() || place_->world->is_there(row);
}

bool Model::stalled() const {
  if (const auto* wheels = place_->wheels())
    return place_->world->percepts(*wheels).as<models::WheelsState>(place_->slot()).stalled != 0;
  return place_->world->stalled(place_->row());
}

Pose Model::estimate() const { return place_->wheels() ? pose() : place_->world->estimate(place_->row()); }

void Model::set_estimate(const Pose& pose) {
  refuse_others_in_for_each();
  place_->world->set_estimate(place_->row(), pose);
}

void Model::set_pose(const Pose& pose) {
  refuse_in_for_each(*place_->world, "set_pose()");
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
  return place_->world->percepts(found).cell<float>(place_->world->slot(place_->row()), 0);
}

std::span<const float> Model::intensities(std::string_view sensor) const {
  const auto& found = place_->ranger(sensor);
  const engine::StateTable& table = place_->world->percepts(found);
  if (table.fields().size() < 2) return {};
  return table.cell<float>(place_->world->slot(place_->row()), 1);
}

Model::Reading Model::reading(std::string_view field, std::string_view wanted) const {
  const engine::World& world = *place_->world;
  const auto index_in = [&](const engine::BodyType::Device& device) {
    const std::span<const engine::StateField> fields = world.percepts(device).fields();
    const auto found = std::ranges::find(fields, field, &engine::StateField::name);
    return found == fields.end() ? std::optional<std::size_t>()
                                 : static_cast<std::size_t>(found - fields.begin());
  };
  const engine::BodyType::Device* device =
      wanted.empty()
          ? place_->find([&](const engine::BodyType::Device& each) { return index_in(each).has_value(); })
          : &place_->device(wanted);
  const std::optional<std::size_t> f = device ? index_in(*device) : std::nullopt;
  if (!f) {
    std::vector<std::string_view> known;
    for (const engine::BodyType::Device& each : place_->type().devices)
      if (place_->owns(each) && (!device || device == &each))
        for (const engine::StateField& other : world.percepts(each).fields())
          if (std::ranges::find(known, other.name) == known.end()) known.push_back(other.name);
    const std::string of = device ? fmt::format("field (device \"{}\" of \"{}\")", device->name, name())
                                  : fmt::format("field (all devices of \"{}\")", name());
    throw std::out_of_range(unknown_name(of, field, known));
  }
  if (device->kind->is_sensor()) place_->check_running(*device);
  const engine::StateTable& table = world.percepts(*device);
  const engine::StateField& found = table.fields()[*f];
  return {device->name,
          &found,
          {table.cell<std::byte>(place_->slot(), *f).data(),
           found.columns * engine::element_size(found.element)}};
}

std::span<const std::byte> Model::cell(std::string_view field, std::string_view wanted,
                                       engine::Element element) const {
  const Reading found = reading(field, wanted);
  if (const engine::Element own = found.field->element; own != element)
    throw std::invalid_argument(fmt::format("field \"{}\" of device \"{}\" of \"{}\" has the type {}, not {}",
                                            field, found.device, name(), engine::element_name(own),
                                            engine::element_name(element)));
  return found.bytes;
}

std::span<const engine::StateField> Model::fields(std::string_view device) const {
  return place_->world->percepts(place_->device(device)).fields();
}

std::byte* Model::asked(std::string_view wanted, std::size_t bytes, std::string_view fields) {
  refuse_others_in_for_each();
  const auto takes = [](const engine::BodyType::Device& d) { return d.command_table.has_value(); };
  const auto takes_these = [&](const engine::BodyType::Device& d) {
    return takes(d) && d.prepared.command_bytes == bytes && are_listed(d.prepared.commands, fields);
  };
  const auto* device = place_->find([&](const engine::BodyType::Device& d) {
    return wanted.empty() ? takes_these(d) : takes(d) && d.name == wanted;
  });
  if (!device) place_->throw_unknown("device that takes this command struct", wanted, takes);
  if (!takes_these(*device)) {
    std::vector<std::string_view> own;
    for (const engine::StateField& field : device->prepared.commands) own.push_back(field.name);
    throw std::invalid_argument(
        fmt::format("\"{}\" of \"{}\" takes commands of kind {}, with the fields {} in {} bytes; the given "
                    "struct has the fields {} in {} bytes",
                    device->name, name(), device->kind->name, fmt::join(own, ", "),
                    device->prepared.command_bytes, fields, bytes));
  }
  return place_->world->asked_of(*device).row(place_->slot());
}

Model::Asked Model::asked(std::string_view wanted) {
  refuse_others_in_for_each();
  const auto takes = [](const engine::BodyType::Device& d) { return d.command_table.has_value(); };
  const auto* device =
      place_->find([&](const engine::BodyType::Device& d) { return takes(d) && d.name == wanted; });
  if (!device) place_->throw_unknown("device that takes commands", wanted, takes);
  return {device->prepared.commands,
          {place_->world->asked_of(*device).row(place_->slot()), device->prepared.command_bytes}};
}

std::optional<Model::Energy> Model::energy() const {
  const engine::World& world = *place_->world;
  const engine::TypeSpec& spec = world.spec().types[world.spec().bodies[place_->body.index()].type.index()];
  for (std::size_t part = place_->part;; part = spec.parts[part].parent) {
    if (const auto* pack = device_on(place_->type(), part, &engine::DeviceKind::energy))
      return pack->kind->energy(world.percepts(*pack), world.slot(place_->row()));
    if (part == 0) return {};
  }
}

std::size_t Model::flag_count() const {
  const engine::World& world = *place_->world;
  const auto* holder = device_on(place_->type(), place_->part, &engine::DeviceKind::flags);
  return holder ? holder->kind->flags(world.percepts(*holder), world.slot(place_->row())).count : 0;
}

Simulation::Simulation(const std::filesystem::path& file, const SimulationOptions& options)
    : Simulation(file, options, make_registry()) {}

Simulation::Simulation(const std::filesystem::path& file, const SimulationOptions& options,
                       engine::Registry registry)
    : Simulation(load(file, options, std::move(registry), {},
                      [&](const engine::Registry& kinds, const worldio::LoadOptions& how,
                          Diagnostics& found) { return worldio::load_world(file, kinds, how, found); })) {}

Simulation Simulation::from_text(std::string text, const std::filesystem::path& name,
                                 const SimulationOptions& options) {
  return from_text(std::move(text), name, options, make_registry());
}

Simulation Simulation::from_text(std::string text, const std::filesystem::path& name,
                                 const SimulationOptions& options, engine::Registry registry) {
  return load(name, options, std::move(registry), {},
              [&](const engine::Registry& kinds, const worldio::LoadOptions& how, Diagnostics& found) {
                return worldio::load_world_text(name, std::move(text), kinds, how, found);
              });
}

Simulation::Simulation(const WorldBuilder& world, const SimulationOptions& options)
    : Simulation(world, options, make_registry()) {}

Simulation::Simulation(const WorldBuilder& world, const SimulationOptions& options, engine::Registry registry)
    : Simulation(
          load(world.name(), options, std::move(registry), {},
               [&](const engine::Registry& kinds, const worldio::LoadOptions& how, Diagnostics& found) {
                 return worldio::load_json_node(world.node(found.files()->add(world.name().string())),
                                                world.name(), kinds, how, found);
               })) {}

Simulation::Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name,
                       const SimulationOptions& options)
    : Simulation(world, name, options, make_registry()) {}

Simulation::Simulation(const worldio::WorldDocument& world, const std::filesystem::path& name,
                       const SimulationOptions& options, engine::Registry registry)
    : Simulation(
          load(name, options, std::move(registry), world.files,
               [&](const engine::Registry& kinds, const worldio::LoadOptions& how, Diagnostics& found) {
                 return worldio::load_json_node(worldio::json_world_node(world, name, kinds, found), name,
                                                kinds, how, found);
               })) {}

/// Loads a world with `read`, which parses it. file: the name of the world. files: the source files that a
/// document states, for the file names in errors; null if the world is not loaded from a document.
Simulation Simulation::load(const std::filesystem::path& file, const SimulationOptions& options,
                            engine::Registry registry, std::shared_ptr<SourceFiles> files,
                            const ReadWorld& read) {
  restore_fp_environment();  // before anything is computed from the file
  auto impl = std::make_unique<Impl>();
  for (const auto& [pointer, value] : options.set) impl->changes.emplace_back("set " + pointer, value);
  impl->file = file;
  impl->registry = std::make_shared<engine::Registry>(std::move(registry));
  impl->plugins = add_plugins(*impl->registry, options.plugin_path, options.scripts);
  Diagnostics diagnostics(std::move(files));
  worldio::LoadOptions how{options.seed, options.robots, options.set, options.search_path, options.threads};
  how.place_again = &impl->place_again;
  engine::WorldSpec spec = read(*impl->registry, how, diagnostics);
  diagnostics.throw_if_errors();
  assign_controllers(options.scripts, spec, diagnostics);
  diagnostics.throw_if_errors();
  impl->start(std::move(spec), options, diagnostics);
  return Simulation(std::move(impl));
}

Simulation::Simulation(engine::WorldSpec world, const SimulationOptions& options)
    : Simulation(std::move(world), options, make_registry()) {}

Simulation::Simulation(engine::WorldSpec world, const SimulationOptions& options, engine::Registry registry)
    : Simulation(make(std::move(world), options, std::move(registry))) {}

Simulation Simulation::make(engine::WorldSpec spec, const SimulationOptions& options,
                            engine::Registry registry) {
  if (!options.robots.empty() || !options.set.empty() || !options.search_path.empty())
    throw std::invalid_argument(
        "SimulationOptions: robots, set and search_path apply to world files only; for a WorldSpec, change "
        "its members instead");
  restore_fp_environment();
  auto impl = std::make_unique<Impl>();
  impl->file = spec.title.empty() ? "world" : spec.title;
  impl->registry = std::make_shared<engine::Registry>(std::move(registry));
  impl->plugins = add_plugins(*impl->registry, options.plugin_path, options.scripts);
  Diagnostics diagnostics(spec.files);
  worldio::check_spec(spec, *impl->registry, diagnostics);
  diagnostics.throw_if_errors();
  assign_controllers(options.scripts, spec, diagnostics);
  diagnostics.throw_if_errors();
  if (options.seed) spec.seed = *options.seed;
  impl->start(std::move(spec), options, diagnostics);
  return Simulation(std::move(impl));
}

Simulation::Simulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Simulation Simulation::resume(const std::filesystem::path& file, const ResumeOptions& options) {
  return resume(file, options, make_registry());
}

Simulation Simulation::resume(const std::filesystem::path& file, const ResumeOptions& options,
                              engine::Registry registry) {
  restore_fp_environment();
  const worldio::Checkpoint checkpoint(file);
  auto impl = std::make_unique<Impl>();
  if (const std::string warning = check_version(checkpoint, options.across_versions); !warning.empty())
    impl->warnings.push_back(warning);
  impl->registry = std::make_shared<engine::Registry>(std::move(registry));
  impl->plugins = add_plugins(*impl->registry, options.plugin_path, options.scripts);
  append(impl->warnings, load_plugins(checkpoint, *impl->plugins, options.across_plugins));
  append(impl->warnings, impl->plugins->warnings());
  impl->file = checkpoint.header("world");
  Diagnostics diagnostics;
  engine::WorldSpec spec = checkpoint.spec(*impl->registry, options.set, diagnostics);
  diagnostics.throw_if_errors();
  // Warnings about the world were reported when it was loaded, and are not repeated here.
  impl->make_world(std::move(spec), options, diagnostics);
  checkpoint.restore(*impl->world);
  impl->resumed_at = checkpoint.tick();
  impl->memories = checkpoint.memories();
  impl->watch_for_the_end(diagnostics);
  if (impl->stop) {
    const auto memory = impl->memories.find(impl->stop->memory_name());
    if (memory != impl->memories.end()) impl->stop->remember(memory->second);
    if (impl->world->tick() > 0) impl->stop->ask();
  }
  if (const auto holds = impl->memories.find(k_holds);
      holds != impl->memories.end() &&
      !impl->holds.remember(holds->second, impl->world->spec().bodies.size()))
    throw InputError(fmt::format(
        "{}: error: the list of held robots (docs/live.md) in the checkpoint is invalid: the file is damaged",
        file.string()));
  for (const auto& [key, value] : checkpoint.header())
    if (key.starts_with("set ") || key == k_spare) impl->changes.emplace_back(key, value);
  for (const auto& [pointer, value] : options.set)
    impl->changes.emplace_back(fmt::format("set {} at tick {}", pointer, checkpoint.tick()), value);
  return Simulation(std::move(impl));
}

std::optional<std::uint64_t> Simulation::resumed_at_tick() const { return impl_->resumed_at; }

void Simulation::save(const std::filesystem::path& checkpoint) const {
  impl_->world->require_whole();
  worldio::FileHeader header = effective_options();
  header.insert(header.begin(), {"version", version_line()});
  header.emplace_back("title", title());
  if (impl_->recording) impl_->recording->flush();  // a resumed recording must reach the checkpoint's tick
  worldio::Memories memories;
  for (const auto& [name, memory] : impl_->on_save) memories[name] = memory();
  if (impl_->stop) memories[impl_->stop->memory_name()] = impl_->stop->memory();
  if (!impl_->holds.empty()) memories[k_holds] = impl_->holds.memory();
  worldio::write_checkpoint(checkpoint, *impl_->world, *impl_->registry, header, memories);
}

void Simulation::on_save(const std::string& name, std::function<std::vector<std::byte>()> memory) {
  if (memory)
    impl_->on_save[name] = std::move(memory);
  else
    impl_->on_save.erase(name);
}

std::optional<std::vector<std::byte>> Simulation::saved_memory(const std::string& name) const {
  const auto found = impl_->memories.find(name);
  return found == impl_->memories.end() ? std::nullopt : std::optional(found->second);
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

const std::vector<std::string>& Simulation::warnings() const { return impl_->warnings; }

std::vector<std::pair<std::string, std::string>> Simulation::effective_options() const {
  const engine::WorldSpec& spec = impl_->world->spec();
  std::vector<std::pair<std::string, std::string>> out{
      {"world", impl_->file.string()},
      {"seed", fmt::format("{}", spec.seed)},
      {"tick_s", fmt::format("{}", impl_->world->tick_s())},
      {"ranging", std::string(engine::ranging_engine_name(spec.ranging))},
      {"robots", fmt::format("{}", impl_->world->robots_at_start())},
      {"threads", fmt::format("{}", threads())},
      {"tile_m", fmt::format("{}", impl_->world->geometry().tile_m())},
      {"simd", partition::simd_target()},
  };
  if (ranks() > 1) out.emplace_back("ranks", fmt::format("{}", ranks()));
  if (spec.ranging == RangingEngine::grid)
    out.emplace_back("resolution_m", fmt::format("{}", spec.resolution_m));
  for (const Plugins::Library& library : impl_->plugins->libraries())
    out.emplace_back(fmt::format("{}{}", k_plugin, library.name), hex(library.contents));
  for (const auto& [key, value] : impl_->changes) out.emplace_back(key, value);
  if (impl_->resumed_at) out.emplace_back("resumed_at_tick", fmt::format("{}", *impl_->resumed_at));
  return out;
}

void Simulation::step() {
  impl_->refuse_in_callbacks("step()");
  Model::refuse_in_for_each(*impl_->world, "step()");
  // A library loaded since the last step may have switched on flush-to-zero for this thread.
  if (!check_fp_environment()) restore_fp_environment();
  if (impl_->before_tick || !impl_->holds.empty())
    impl_->world->before_tick([this] {
      if (impl_->before_tick) impl_->before_tick(*this);
      impl_->holds.apply(*this);
    });
  else
    impl_->world->before_tick(nullptr);
  impl_->world->step();
  if (impl_->stop) impl_->stop->see();
  if (impl_->recording) impl_->recording->observe(*this);
  if (impl_->on_tick.empty()) return;
  struct Calling {
    bool& flag;
    explicit Calling(bool& f) : flag(f) { flag = true; }
    ~Calling() { flag = false; }
  };
  const Calling calling(impl_->in_callbacks);
  for (const auto& callback : impl_->on_tick) callback(*this);
}

void Simulation::on_tick(std::function<void(Simulation&)> callback) {
  impl_->refuse_in_callbacks("on_tick()");
  Model::refuse_in_for_each(*impl_->world, "on_tick()");
  if (callback)
    impl_->on_tick.push_back(std::move(callback));
  else
    impl_->on_tick.clear();
}

void Simulation::before_tick(std::function<void(Simulation&)> callback) {
  Model::refuse_in_for_each(*impl_->world, "before_tick()");
  impl_->before_tick = std::move(callback);
}

void Simulation::act(const engine::Act& act) {
  Model::refuse_in_for_each(*impl_->world, "act()");
  impl_->world->require_whole();
  carry_out(*this, act, impl_->holds);
}

void Simulation::record(const std::filesystem::path& file) { record(file, RecordingOptions{}); }

void Simulation::record(const std::filesystem::path& file, const RecordingOptions& options) {
  if (impl_->recording)
    throw std::logic_error(
        fmt::format("{}: this run is already being recorded; call stop_recording() first", file.string()));
  impl_->world->require_whole();
  impl_->recording = std::make_unique<Recording>(file, *this, options);
}

void Simulation::stop_recording() {
  if (const std::unique_ptr<Recording> recording = std::move(impl_->recording)) recording->close();
}

std::optional<std::string> Simulation::stopped() const {
  const auto holding = impl_->stop ? impl_->stop->holding() : std::nullopt;
  if (!holding) return std::nullopt;
  return engine::text_of(impl_->world->spec().experiment.stop_when[*holding]);
}

void Simulation::run_for(double seconds) {
  const std::uint64_t ticks = ticks_of("run_for", seconds, tick_s());
  for (std::uint64_t i = 0; i < ticks && !(impl_->stop && impl_->stop->holding()); ++i) step();
}

bool Simulation::run_until(const std::function<bool(const Simulation&)>& done, double at_most_s) {
  const std::uint64_t ticks = ticks_of("run_until", at_most_s, tick_s());
  for (std::uint64_t i = 0; i < ticks && !(impl_->stop && impl_->stop->holding()); ++i) {
    step();
    if (done(*this)) return true;
  }
  return false;
}

void Simulation::reset() {
  impl_->refuse_in_callbacks("reset()");
  Model::refuse_in_for_each(*impl_->world, "reset()");
  stop_recording();
  impl_->world->reset();
  impl_->holds.clear();
  if (impl_->stop) impl_->stop->begin();
}

/// Returns the bodies of this world with the places that they have with another seed. Throws std::logic_error
/// for a resumed run. call: name of the calling function, for the error.
std::vector<engine::BodySpec> Simulation::bodies_placed_by(std::uint64_t seed, std::string_view call) const {
  if (impl_->resumed_at)
    throw std::logic_error(
        fmt::format("{} needs the rules by which bodies are placed, but this run was resumed from a "
                    "checkpoint, which does not store these rules",
                    call));
  std::vector<engine::BodySpec> bodies = impl_->world->spec().bodies;
  if (impl_->place_again) impl_->place_again(bodies, seed);
  return bodies;
}

void Simulation::reset(std::uint64_t seed) {
  impl_->refuse_in_callbacks("reset()");
  Model::refuse_in_for_each(*impl_->world, "reset()");
  const std::vector<engine::BodySpec> bodies = bodies_placed_by(seed, "reset(seed)");
  stop_recording();
  impl_->world->restart(seed, bodies, *impl_->registry);
  impl_->holds.clear();
  if (impl_->stop) impl_->stop->begin();
}

Simulation Simulation::another(std::uint64_t seed, unsigned threads) const {
  std::vector<engine::BodySpec> bodies = bodies_placed_by(seed, "another()");
  auto impl = std::make_unique<Impl>();
  impl->registry = impl_->registry;
  impl->plugins = impl_->plugins;
  impl->file = impl_->file;
  impl->tile_size_m = impl_->tile_size_m;
  impl->place_again = impl_->place_again;
  impl->changes = impl_->changes;
  engine::WorldSpec spec = impl_->world->spec();
  spec.experiment.at.resize(spec.experiment.at.size() - impl_->world->settings_made());
  spec.bodies = std::move(bodies);
  spec.seed = seed;
  Diagnostics diagnostics(spec.files);
  impl->world = std::make_unique<engine::World>(
      std::move(spec), *impl->registry, engine::WorldOptions{threads, impl->tile_size_m}, diagnostics);
  impl->watch_for_the_end(diagnostics);
  return Simulation(std::move(impl));
}

double Simulation::time_s() const { return impl_->world->time_s(); }
std::uint64_t Simulation::tick() const { return impl_->world->tick(); }
double Simulation::tick_s() const { return impl_->world->tick_s(); }
std::size_t Simulation::robots() const { return impl_->world->robots(); }
std::uint64_t Simulation::seed() const { return impl_->world->spec().seed; }
std::string Simulation::title() const { return impl_->world->spec().title; }
std::optional<double> Simulation::quit_time_s() const { return impl_->world->spec().quit_time_s; }

Model Simulation::find(std::string_view name) {
  engine::World& world = *impl_->world;
  const engine::WorldSpec& spec = world.spec();
  const auto parts_of = [&](BodyId body) -> const std::vector<engine::PartSpec>& {
    return spec.types[spec.bodies[body.index()].type.index()].parts;
  };
  const auto place = [&](BodyId body, std::size_t part) {
    return Model(std::make_shared<Model::Place>(Model::Place{&world, body, part, std::string(name)}));
  };
  if (const BodyId body = world.find(name); body.valid()) return place(body, 0);
  if (const auto global = spec.part_aliases.find(std::string(name)); global != spec.part_aliases.end()) {
    const auto& parts = parts_of(global->second.body);
    const auto part = std::ranges::find(parts, global->second.part, &engine::PartSpec::name);
    return place(global->second.body, static_cast<std::size_t>(part - parts.begin()));
  }
  std::vector<std::string> known;
  // The name of a part follows that of its body: "r0.ranger:1".
  for (std::size_t dot = name.rfind('.'); dot != std::string_view::npos && dot > 0;
       dot = name.rfind('.', dot - 1)) {
    const BodyId body = world.find(name.substr(0, dot));
    if (!body.valid()) continue;
    const auto& parts = parts_of(body);
    const std::string_view below = name.substr(dot + 1);
    for (std::size_t p = 1; p < parts.size(); ++p) {
      if (parts[p].name == below || parts[p].alias == below) return place(body, p);
      known.push_back(fmt::format("{}.{}", name.substr(0, dot), parts[p].name));
    }
  }
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) known.push_back(spec.name(BodyId(b)));
  const std::vector<std::string_view> names(known.begin(), known.end());
  throw std::out_of_range(
      fmt::format("no model \"{}\" in {}{}", name, impl_->file.string(), did_you_mean(name, names)));
}

Model Simulation::model(BodyId id) {
  if (const std::size_t bodies = impl_->world->spec().bodies.size(); !id.valid() || id.index() >= bodies)
    throw std::out_of_range(
        fmt::format("no model with id {}: the world has {} bodies, whose ids begin at 0", id.value, bodies));
  return Model::of(*impl_->world, id);
}

RayHit Simulation::cast(const Pose& from, double range_max, const Model* without) const {
  impl_->world->require_whole();
  for (const double value : {from.x, from.y, from.z, from.heading})
    if (!std::isfinite(value))
      throw std::invalid_argument("cast(): x, y, z and heading of the start of the ray must be finite");
  if (!(range_max >= 0 && range_max <= k_longest_ray_m))
    throw std::invalid_argument(
        fmt::format("cast(): range_max is {} m; allowed are 0 to {:g} m", range_max, k_longest_ray_m));
  if (without != nullptr && without->place_->world != impl_->world.get())
    throw std::logic_error(fmt::format("\"{}\" is a model of another simulation", without->name()));
  const Rotation rotation(from.heading);
  return engine::first_met(impl_->world->view(),
                           {.origin = from.position(),
                            .direction = {rotation.cos, rotation.sin},
                            .length = range_max,
                            .own = without != nullptr ? impl_->world->row(without->place_->body) : Row(),
                            .z = from.z,
                            .stops = [](const engine::Returns& returns) { return returns.ranger >= 0; }});
}

void Simulation::set_poses(std::span<const std::pair<Model, Pose>> poses) {
  Model::refuse_in_for_each(*impl_->world, "set_poses()");
  std::vector<engine::World::Placed> placed;
  placed.reserve(poses.size());
  for (const auto& [model, pose] : poses) {
    if (model.place_->world != impl_->world.get())
      throw std::logic_error(fmt::format("\"{}\" is a model of another simulation", model.name()));
    placed.push_back({model.place_->whole(), pose});
  }
  impl_->world->set_poses(placed);
}

std::optional<Model> Simulation::spawn(std::string_view population, const Pose& pose) {
  engine::World& world = *impl_->world;
  Model::refuse_in_for_each(world, "spawn()");
  const engine::Birth birth = world.spawn(reserve_of(population), pose);
  if (birth.status != engine::BirthStatus::born) return std::nullopt;
  return Model::of(world, birth.body);
}

std::size_t Simulation::unborn(std::string_view population) const {
  impl_->world->require_whole();
  return impl_->world->unborn(reserve_of(population));
}

std::size_t Simulation::reserve_of(std::string_view population) const {
  if (const auto reserve = impl_->world->reserve(population)) return *reserve;
  std::vector<std::string_view> known;
  for (const engine::ReserveSpec& reserve : impl_->world->spec().reserves)
    known.push_back(reserve.population);
  throw std::out_of_range(fmt::format("no population \"{}\" with a reserve in {}{}", population,
                                      impl_->file.string(),
                                      known.empty() ? "; no population of this world has a reserve"
                                                    : fmt::format("; known: {}", comma_list(known))));
}

void Simulation::remove(const Model& model) {
  if (model.place_->world != impl_->world.get())
    throw std::logic_error(fmt::format("\"{}\" is a model of another simulation", model.name()));
  Model::refuse_in_for_each(*impl_->world, "remove()");
  impl_->world->remove(model.place_->whole());
}

bool Simulation::set_disabled(const Model& model, bool disabled) {
  if (model.place_->world != impl_->world.get())
    throw std::logic_error(fmt::format("\"{}\" is a model of another simulation", model.name()));
  Model::refuse_in_for_each(*impl_->world, disabled ? "disable()" : "enable()");
  return impl_->world->set_disabled(model.place_->whole(), disabled);
}

bool Simulation::disable(const Model& model) { return set_disabled(model, true); }
bool Simulation::enable(const Model& model) { return set_disabled(model, false); }

void Simulation::set(std::string_view type, std::string_view setting) {
  Model::refuse_in_for_each(*impl_->world, "set()");
  impl_->world->require_whole();
  Diagnostics diagnostics;
  const auto read = worldio::read_setting(type, setting, *impl_->registry, impl_->world->spec(), diagnostics);
  try {
    diagnostics.throw_if_errors();
  } catch (const InputError& error) {
    throw std::invalid_argument(error.what());
  }
  if (const Result<> done = impl_->world->set(*read, *impl_->registry); !done)
    throw std::invalid_argument(done.error().text);
}

std::string Simulation::parameters(std::string_view type) const {
  const std::vector<engine::TypeSpec>& types = impl_->world->spec().types;
  const auto found = std::ranges::find(types, type, &engine::TypeSpec::name);
  if (found == types.end()) {
    std::vector<std::string_view> known;
    for (const engine::TypeSpec& each : types) known.push_back(each.name);
    throw std::out_of_range(unknown_name("type", type, known));
  }
  const TypeId id(static_cast<std::size_t>(found - types.begin()));
  return worldio::parameters_json(impl_->world->present_type(id), *impl_->registry);
}

std::vector<std::string> Simulation::robot_names() const {
  std::vector<std::string> names;
  const engine::World& world = *impl_->world;
  world.require_whole();
  for (std::size_t b = 0; b < world.spec().bodies.size(); ++b)
    if (const Row row = world.row(BodyId(b)); row.valid() && world.type(row).drive && world.is_there(row))
      names.push_back(world.spec().name(BodyId(b)));
  return names;
}

void Simulation::subscribe(std::string_view model) {
  Model::refuse_in_for_each(*impl_->world, "subscribe()");
  if (tick() > 0) throw std::logic_error("subscribe() must be called before the first step");
  const BodyId body = find(model).place_->body;
  // A body without drive, sensor and controller has no row, and no sensor to run.
  if (impl_->world->row(body).valid()) impl_->world->subscribe(body);
}

std::uint64_t Simulation::state_hash() const { return impl_->world->hashes().state; }

Simulation::Hashes Simulation::hashes() const {
  const engine::Hashes h = impl_->world->hashes();
  return {h.state, h.groups[0], h.groups[1], h.groups[2], h.groups[3]};
}

std::string Simulation::hash_log_header() const {
  std::string out = fmt::format("# troupe hash log 1\n# version: {}\n", version_line());
  for (const auto& [key, value] : effective_options()) out += fmt::format("# {}: {}\n", key, value);
  return out;
}

std::string Simulation::hash_log_line() const {
  const engine::Hashes h = impl_->world->hashes();
  std::string line = fmt::format("{} {}", tick(), hex(h.state));
  for (std::size_t g = 0; g < engine::k_hash_groups; ++g)
    line +=
        fmt::format(" {}={}", engine::hash_group_name(static_cast<engine::HashGroup>(g)), hex(h.groups[g]));
  return line;
}

Statistics Simulation::statistics() const {
  const engine::World& w = *impl_->world;
  std::size_t state_bytes = 0;
  for (const engine::StateTable& table : w.tables()) state_bytes += table.bytes();
  return {w.robots(),
          w.tick(),
          w.time_s(),
          w.beams_cast(),
          w.stalled_count(),
          w.out_of_bounds_count(),
          w.mean_displacement(),
          w.conflict_rounds(),
          state_bytes};
}

Model::Energy Simulation::energy() const {
  const engine::World& w = *impl_->world;
  w.require_whole();
  Model::Energy sum;
  for (std::size_t b = 0; b < w.spec().bodies.size(); ++b) {
    const Row row = w.row(BodyId(b));
    if (!row.valid()) continue;
    for (const engine::BodyType::Device& device : w.type(row).devices) {
      if (!device.kind->energy) continue;
      const Model::Energy pack = device.kind->energy(w.percepts(device), w.slot(row));
      sum.stored_j += pack.stored_j;
      sum.capacity_j += pack.capacity_j;
      sum.dissipated_j += pack.dissipated_j;
      sum.received_j += pack.received_j;
      sum.given_j += pack.given_j;
      sum.infinite = sum.infinite || pack.infinite;
      sum.charging = sum.charging || pack.charging;
    }
  }
  return sum;
}

unsigned Simulation::threads() const { return impl_->world->parallel().threads(); }
unsigned Simulation::ranks() const { return rank_statistics().ranks; }
RankStatistics Simulation::rank_statistics() const {
  if (!impl_->ranks) return {};
  const engine::Replica& replica = impl_->ranks->replica();
  const partition::Transport& transport = replica.transport();
  return {.ranks = transport.ranks(),
          .nodes = impl_->ranks->nodes(),
          .messages = transport.traffic().messages,
          .bytes = transport.traffic().bytes,
          .waited_s = transport.waited_s(),
          .rebalanced = replica.rebalanced(),
          .requests = replica.requests()};
}

std::span<const RankWork> Simulation::rank_work() const {
  if (!impl_->ranks) return {};
  return impl_->ranks->replica().work();
}

void Simulation::on_phase(std::function<void(std::optional<Phase>)> callback) {
  impl_->world->on_phase(std::move(callback));
}

void Simulation::on_task(std::function<void(std::size_t, bool)> callback) {
  impl_->world->parallel().on_task(std::move(callback));
}

void Simulation::on_loop(std::function<void(bool)> callback) {
  impl_->world->parallel().on_loop(std::move(callback));
}

engine::World& Simulation::world() { return *impl_->world; }
const engine::World& Simulation::world() const { return *impl_->world; }
const engine::Registry& Simulation::registry() const { return *impl_->registry; }

void Simulation::snapshot(const std::filesystem::path& png, int width, int height) const {
  snapshot(png, {.width = width, .height = height});
}

void Simulation::snapshot(const std::filesystem::path& png, const PictureOptions& options) const {
  Pictures& pictures = impl_->pictures_of(*this, options);
  pictures.write(pictures.take(*this), png);
}

std::vector<std::uint8_t> Simulation::picture(int width, int height) const {
  if (width < 1 || height < 1)
    throw std::invalid_argument(
        fmt::format("picture of {} x {} pixels: width and height must be 1 or more", width, height));
  return picture({.width = width, .height = height});
}

std::vector<std::uint8_t> Simulation::picture(const PictureOptions& options) const {
  if (options.background == "transparent")
    throw std::invalid_argument(
        "picture(): an RGB picture cannot have the background \"transparent\": use paper, white or dark, or "
        "draw into a file");
  Pictures& pictures = impl_->pictures_of(*this, options);
  const std::vector<std::uint8_t> rgba = pictures.draw(pictures.take(*this));
  std::vector<std::uint8_t> rgb(rgba.size() / 4 * 3);
  for (std::size_t i = 0, k = 0; i < rgba.size(); i += 4, k += 3)
    std::copy_n(rgba.begin() + static_cast<std::ptrdiff_t>(i), 3,
                rgb.begin() + static_cast<std::ptrdiff_t>(k));
  return rgb;
}

std::string version_line() {
  return fmt::format("troupe {} ({}; {}; {}; assertions {})", k_build_version, k_build_compiler,
                     k_build_flags, k_build_instruction_set, k_build_assertions ? "on" : "off");
}

}  // namespace troupe
