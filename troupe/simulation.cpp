#include "troupe/simulation.hpp"

#include "base/diagnostics.hpp"
#include "base/fp_environment.hpp"
#include "base/hash.hpp"
#include "base/scoped_flag.hpp"
#include "engine/observing/displacement.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/sensing/sight.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/state/kind_calls.hpp"
#include "partition/transport.hpp"
#include "troupe/build_info.hpp"
#include "troupe/effective_options.hpp"
#include "troupe/input_files.hpp"
#include "troupe/simulation_impl.hpp"
#include "troupe/swarm.hpp"
#include "worldio/json/experiment_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace troupe {
namespace {

constexpr double k_longest_ray_m = 3e5;  // from corner to corner of the largest world

std::uint64_t ticks_of(std::string_view call, double seconds, double tick_s) {
  if (!(seconds >= 0 && seconds <= engine::k_longest_run_s))
    throw std::invalid_argument(
        fmt::format("{}({}): give a time from 0 to {} s", call, seconds, engine::k_longest_run_s));
  return engine::ticks_until(seconds, tick_s);
}

}  // namespace

void Simulation::Impl::refuse_in_callbacks(std::string_view what) const {
  world->require_between_steps(what);
  if (!in_on_tick && !in_before_tick && !in_before_step) return;
  throw std::logic_error(fmt::format("{} is not allowed in a callback of {}: call it outside the callback",
                                     what,
                                     in_on_tick       ? "on_tick()"
                                     : in_before_tick ? "before_tick()"
                                                      : "before_step()"));
}

void Simulation::Impl::require_own(const Model& model) const {
  if (model.place_->world != world.get())
    throw std::logic_error(fmt::format(
        "\"{}\" is a model of another simulation: give the model that find() of this simulation returns",
        model.name()));
}

void Simulation::Impl::require_start(BodyId body, const Pose& pose) const {
  const engine::WorldSpec& spec = world->spec();
  for (const engine::ReserveSpec& reserve : spec.reserves)
    if (body.value >= reserve.first.value && body.value - reserve.first.value < reserve.count)
      throw std::invalid_argument(
          fmt::format("\"{}\" cannot be placed: it is not in the world at the start, because it is in the "
                      "reserve of the population \"{}\"",
                      spec.name(body), reserve.population));
  engine::require_place(world->state(), body, pose);
}

void Simulation::Impl::refuse_to_replace_inputs(const std::filesystem::path& output) const {
  std::vector<std::filesystem::path> inputs;
  if (!resumed_at) inputs = input_files(world->spec());
  for (const Plugins::Library& library : plugins->libraries()) inputs.push_back(library.file);
  for (const std::filesystem::path& input : inputs)
    if (same_file(output, input))
      throw std::runtime_error(fmt::format(
          "{}: error: cannot be written: the simulation was loaded from this file: choose another "
          "file name",
          output.string()));
}

Pictures& Simulation::Impl::pictures_of(const Simulation& simulation, const PictureOptions& options) {
  if (!pictures || picture_options != options) {
    pictures.reset();
    pictures = std::make_unique<Pictures>(simulation, options);
    picture_options = options;
  }
  pictures->forget();
  return *pictures;
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation Simulation::share() { return Simulation(impl_); }

const std::vector<std::string>& Simulation::warnings() const { return impl_->warnings; }

void Simulation::step() {
  impl_->refuse_in_callbacks("step()");
  Model::require_may_change(*impl_->world, "step()");
  // A library loaded since the last step may have switched on flush-to-zero for this thread.
  if (!check_fp_environment()) restore_fp_environment();
  if (impl_->before_step) {
    const ScopedFlag calling(impl_->in_before_step);
    impl_->before_step(*this);
  }
  if (impl_->before_tick || !impl_->holds.empty())
    impl_->world->before_tick([this] {
      const ScopedFlag calling(impl_->in_before_tick);
      if (impl_->before_tick) impl_->before_tick(*this);
      impl_->holds.apply(*this);
    });
  else
    impl_->world->before_tick(nullptr);
  impl_->world->step();
  if (impl_->stop) impl_->stop->see();
  if (impl_->recording) impl_->recording->observe(*this);
  std::erase_if(impl_->on_tick, [](const Impl::OnTick& callback) { return callback.has_expired(); });
  if (impl_->on_tick.empty()) return;
  const ScopedFlag calling(impl_->in_on_tick);
  for (const Impl::OnTick& callback : impl_->on_tick)
    if (!callback.has_expired()) callback.call(*this);
}

void Simulation::on_tick(std::function<void(Simulation&)> callback) {
  impl_->refuse_in_callbacks("on_tick()");
  Model::require_may_change(*impl_->world, "on_tick()");
  if (callback)
    impl_->on_tick.push_back({std::move(callback), {}});
  else
    std::erase_if(impl_->on_tick, [](const Impl::OnTick& each) { return !each.owner; });
}

void Simulation::on_tick(std::function<void(Simulation&)> callback, std::weak_ptr<const void> owner) {
  if (!callback)
    throw std::invalid_argument(
        "on_tick(): found a null function with an owner: give a function to call after each step");
  on_tick(std::move(callback));
  impl_->on_tick.back().owner = std::move(owner);
}

void Simulation::before_tick(std::function<void(Simulation&)> callback) {
  if (impl_->in_before_tick) impl_->refuse_in_callbacks("before_tick()");  // it would destroy the callback
  Model::require_may_change(*impl_->world, "before_tick()");
  impl_->before_tick = std::move(callback);
}

void Simulation::before_step(std::function<void(Simulation&)> callback) {
  if (impl_->in_before_step) impl_->refuse_in_callbacks("before_step()");  // it would destroy the callback
  Model::require_may_change(*impl_->world, "before_step()");
  impl_->before_step = std::move(callback);
}

bool Simulation::has_before_tick() const { return static_cast<bool>(impl_->before_tick); }

void Simulation::act(const engine::Act& act) {
  Model::require_may_change(*impl_->world, "act()");
  impl_->world->require_whole();
  carry_out(*this, act, impl_->holds);
}

void Simulation::record(const std::filesystem::path& file) { record(file, RecordingOptions{}); }

void Simulation::record(const std::filesystem::path& file, const RecordingOptions& options) {
  if (impl_->recording)
    throw std::logic_error(
        fmt::format("{}: this run is already being recorded; call stop_recording() first", file.string()));
  Model::require_may_change(*impl_->world, "record()");
  impl_->world->require_whole();
  impl_->refuse_to_replace_inputs(file);
  impl_->recording = std::make_unique<Recording>(file, *this, options);
}

void Simulation::stop_recording() {
  Model::require_may_change(*impl_->world, "stop_recording()");
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
  if (!done)
    throw std::invalid_argument(
        "run_until(): found a null function: give a function that returns whether to stop");
  const std::uint64_t ticks = ticks_of("run_until", at_most_s, tick_s());
  for (std::uint64_t i = 0; i < ticks && !(impl_->stop && impl_->stop->holding()); ++i) {
    step();
    if (done(*this)) return true;
  }
  return false;
}

void Simulation::reset() {
  impl_->refuse_in_callbacks("reset()");
  Model::require_may_change(*impl_->world, "reset()");
  stop_recording();
  impl_->world->reset();
  impl_->holds.clear();
  if (impl_->stop) impl_->stop->begin();
}

void Simulation::reset(std::uint64_t seed) { reset(seed, {}); }

void Simulation::reset(std::uint64_t seed, std::span<const std::pair<Model, Pose>> starts) {
  impl_->refuse_in_callbacks("reset()");
  Model::require_may_change(*impl_->world, "reset()");
  std::vector<engine::BodySpec> bodies = bodies_placed_by(seed, "reset(seed)");
  for (const auto& [model, pose] : starts) {
    impl_->require_own(model);
    const BodyId body = model.place_->of_body();
    impl_->require_start(body, pose);
    impl_->moved_starts.emplace(body.value, bodies[body.index()].pose_world_body);
    bodies[body.index()].pose_world_body = pose;
  }
  stop_recording();
  impl_->world->restart(seed, bodies, *impl_->registry);
  if (impl_->pictures) impl_->pictures->update_scene(*this);
  impl_->holds.clear();
  if (impl_->stop) impl_->stop->begin();
}

double Simulation::time_s() const { return impl_->world->view().time_s(); }
std::uint64_t Simulation::tick() const { return impl_->world->tick(); }
double Simulation::tick_s() const { return impl_->world->view().tick_s(); }
std::size_t Simulation::robots() const { return impl_->world->robots(); }
std::uint64_t Simulation::seed() const { return impl_->world->spec().seed; }
std::string Simulation::title() const { return impl_->world->spec().title; }
std::optional<double> Simulation::quit_time_s() const { return impl_->world->spec().quit_time_s; }

Model Simulation::find(std::string_view name) {
  engine::World& world = *impl_->world;
  const engine::WorldSpec& spec = world.spec();
  const auto parts_of = [&](BodyId body) -> const std::vector<engine::PartSpec>& {
    return spec.type(body).parts;
  };
  const auto place = [&](BodyId body, std::size_t part) {
    return Model(std::make_shared<Model::Place>(Model::Place{&world, body, part, std::string(name)}));
  };
  if (const BodyId body = world.state().names.find(name); body.valid()) return place(body, 0);
  if (const auto global = spec.part_aliases.find(std::string(name)); global != spec.part_aliases.end()) {
    const auto& parts = parts_of(global->second.body);
    const auto part = std::ranges::find(parts, global->second.part, &engine::PartSpec::name);
    return place(global->second.body, static_cast<std::size_t>(part - parts.begin()));
  }
  std::vector<std::string> known;
  // The name of a part follows that of its body: "r0.ranger:1".
  for (std::size_t dot = name.rfind('.'); dot != std::string_view::npos && dot > 0;
       dot = name.rfind('.', dot - 1)) {
    const BodyId body = world.state().names.find(name.substr(0, dot));
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

Swarm Simulation::swarm(const Model& robot) {
  impl_->require_own(robot);
  const BodyId body = robot.place_->body;
  if (!impl_->world->view().type(body).drive)
    throw std::out_of_range(fmt::format("\"{}\" is not a robot: it has no drive", robot.name()));
  return Swarm(*impl_->world, {body});
}

RayHit Simulation::cast(const Pose& from, double range_max, const Model* without) const {
  impl_->world->require_whole();
  for (const double value : {from.x, from.y, from.z, from.heading})
    if (!std::isfinite(value))
      throw std::invalid_argument(fmt::format(
          "cast(): x, y, z and heading of the start of the ray must be finite, found {}, {}, {}, {}", from.x,
          from.y, from.z, from.heading));
  if (!(range_max >= 0 && range_max <= k_longest_ray_m))
    throw std::invalid_argument(
        fmt::format("cast(): range_max is {} m; allowed are 0 to {} m", range_max, k_longest_ray_m));
  if (without != nullptr) impl_->require_own(*without);
  const Rotation rotation(from.heading);
  return engine::first_met(
      impl_->world->view(),
      {.origin = from.position(),
       .direction = {rotation.cos, rotation.sin},
       .length = range_max,
       .own = without != nullptr ? impl_->world->view().row(without->place_->body) : Row(),
       .z = from.z,
       .stops = [](const engine::Returns& returns) { return returns.ranger >= 0; }});
}

void Simulation::set_poses(std::span<const std::pair<Model, Pose>> poses) {
  Model::require_may_change(*impl_->world, "set_poses()");
  std::vector<engine::World::Placed> placed;
  placed.reserve(poses.size());
  for (const auto& [model, pose] : poses) {
    impl_->require_own(model);
    placed.push_back({model.place_->whole(), pose});
  }
  impl_->world->set_poses(placed);
}

std::optional<Model> Simulation::spawn(std::string_view population, const Pose& pose) {
  engine::World& world = *impl_->world;
  Model::require_may_change(world, "spawn()");
  const engine::Birth birth = world.spawn(reserve_of(population), pose);
  if (birth.status != engine::BirthStatus::born) return std::nullopt;
  return Model::of(world, birth.body);
}

std::size_t Simulation::unborn(std::string_view population) const {
  impl_->world->require_whole();
  return impl_->world->lives().unborn(reserve_of(population));
}

std::size_t Simulation::reserve_of(std::string_view population) const {
  const std::vector<engine::ReserveSpec>& reserves = impl_->world->spec().reserves;
  const auto found = std::ranges::find(reserves, population, &engine::ReserveSpec::population);
  if (found != reserves.end()) return static_cast<std::size_t>(found - reserves.begin());
  std::vector<std::string_view> known;
  for (const engine::ReserveSpec& reserve : reserves) known.push_back(reserve.population);
  throw std::out_of_range(fmt::format("no population \"{}\" with a reserve in {}{}", population,
                                      impl_->file.string(),
                                      known.empty() ? "; no population of this world has a reserve"
                                                    : fmt::format("; known: {}", comma_list(known))));
}

void Simulation::remove(const Model& model) {
  impl_->require_own(model);
  Model::require_may_change(*impl_->world, "remove()");
  impl_->world->remove(model.place_->whole());
}

bool Simulation::set_disabled(const Model& model, bool disabled) {
  impl_->require_own(model);
  Model::require_may_change(*impl_->world, disabled ? "disable()" : "enable()");
  return impl_->world->set_disabled(model.place_->whole(), disabled);
}

bool Simulation::disable(const Model& model) { return set_disabled(model, true); }
bool Simulation::enable(const Model& model) { return set_disabled(model, false); }

void Simulation::set(std::string_view type, std::string_view setting) {
  Model::require_may_change(*impl_->world, "set()");
  impl_->world->require_whole();
  restore_fp_environment();  // a library may have changed it: see step()
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
  if (found == types.end()) throw std::out_of_range(unknown_name("type", type, name_list(types)));
  const TypeId id(static_cast<std::size_t>(found - types.begin()));
  return worldio::parameters_json(impl_->world->interventions().settings().present_type(id),
                                  *impl_->registry);
}

std::vector<std::string> Simulation::robot_names() const {
  std::vector<std::string> names;
  const engine::World& world = *impl_->world;
  world.require_whole();
  for (std::size_t b = 0; b < world.spec().bodies.size(); ++b)
    if (const Row row = world.view().row(BodyId(b));
        row.valid() && world.view().type(row).drive && world.view().is_there(row))
      names.push_back(world.spec().name(BodyId(b)));
  return names;
}

void Simulation::subscribe(std::string_view model) {
  Model::require_may_change(*impl_->world, "subscribe()");
  check_subscribable(*impl_->world);
  const BodyId body = find(model).place_->body;
  // Static geometry has no row in the state tables, and no sensor to run.
  if (impl_->world->view().location(body) != engine::RowLocation::none) impl_->world->subscribe(body);
}

std::uint64_t Simulation::state_hash() const { return impl_->world->hashes().state; }

Simulation::Hashes Simulation::hashes() const {
  const engine::Hashes h = impl_->world->hashes();
  return {h.state, h.groups[0], h.groups[1], h.groups[2], h.groups[3]};
}

std::string Simulation::hash_log_header() const {
  std::string out = fmt::format("# troupe hash log 1\n# version: {}\n", version_line());
  for (const auto& [key, value] : effective_options())
    out += fmt::format("# {}: {}\n", to_one_line(key), to_one_line(value));
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
  return {.robots = w.robots(),
          .ticks = w.tick(),
          .time_s = w.view().time_s(),
          .beams = w.counters().beams,
          .stalled = w.view().counts().stalled,
          .held_at_bounds = w.view().counts().out_of_bounds,
          .mean_displacement_m = engine::mean_displacement(w),
          .conflict_rounds = w.counters().conflict_rounds,
          .state_bytes = state_bytes};
}

Model::Energy Simulation::energy() const {
  const engine::World& w = *impl_->world;
  w.require_whole();
  Model::Energy sum;
  for (std::size_t b = 0; b < w.spec().bodies.size(); ++b) {
    const Row row = w.view().row(BodyId(b));
    if (!row.valid()) continue;
    for (const engine::BodyType::Device& device : w.view().type(row).devices) {
      if (!device.kind->energy) continue;
      const Model::Energy pack = engine::energy_of(w.view(), row, device);
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
  const engine::Halo* const halo = replica.halo();
  return {.ranks = transport.ranks(),
          .nodes = impl_->ranks->nodes(),
          .messages = transport.traffic().messages,
          .bytes = transport.traffic().bytes,
          .waited_s = transport.waited_s(),
          .rebalanced = replica.rebalanced(),
          .requests = replica.requests().saves,
          .is_stop_requested = replica.requests().stop,
          .is_distributed = halo != nullptr,
          .why_replicated = impl_->why_replicated,
          .distributions = halo != nullptr ? halo->counts().distributions : 0};
}

std::vector<RankCounts> Simulation::rank_counts() {
  impl_->world->require_between_steps("rank_counts()");
  if (!impl_->ranks) return {};
  return impl_->ranks->replica().all_counts();
}

std::span<const RankWork> Simulation::rank_work() const {
  if (!impl_->ranks) return {};
  return impl_->ranks->replica().work();
}

void Simulation::on_phase(std::function<void(std::optional<Phase>)> callback) {
  Model::require_may_change(*impl_->world, "on_phase()");
  impl_->world->on_phase(std::move(callback));
}

void Simulation::on_task(std::function<void(std::size_t, bool)> callback) {
  Model::require_may_change(*impl_->world, "on_task()");
  impl_->world->parallel().on_task(std::move(callback));
}

void Simulation::on_loop(std::function<void(bool)> callback) {
  Model::require_may_change(*impl_->world, "on_loop()");
  impl_->world->parallel().on_loop(std::move(callback));
}

engine::World& Simulation::world() { return *impl_->world; }
const engine::World& Simulation::world() const { return *impl_->world; }
const engine::Registry& Simulation::registry() const { return *impl_->registry; }

void Simulation::snapshot(const std::filesystem::path& png, int width, int height) const {
  snapshot(png, {.width = width, .height = height});
}

void Simulation::snapshot(const std::filesystem::path& png, const PictureOptions& options) const {
  impl_->refuse_to_replace_inputs(png);
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
