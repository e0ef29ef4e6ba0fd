#include "troupe/simulation.hpp"

#include "base/diagnostics.hpp"
#include "base/fp_environment.hpp"
#include "base/hash.hpp"
#include "engine/world.hpp"
#include "troupe/build_info.hpp"
#include "troupe/registry.hpp"
#include "worldio/load.hpp"
#include "worldio/png.hpp"

#ifdef TROUPE_HAS_RENDER
#include "render/draw.hpp"
#endif

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace troupe {

struct Simulation::Impl {
  engine::Registry registry;
  std::unique_ptr<engine::World> world;
  std::vector<std::string> warnings;
  SimulationOptions options;
  std::filesystem::path file;
};

/// A body of a world and one of its parts.
struct Model::Place {
  engine::World* world;
  BodyId body;
  std::size_t part;
  std::string name;

  Row row() const {
    const Row row = world->row(body);
    if (!row.valid()) throw std::logic_error(fmt::format("\"{}\" has no drive and no sensor", name));
    return row;
  }
  const engine::BodyType& type() const {
    return world->types()[world->spec().bodies[body.index()].type.index()];
  }
};

Model::Model(std::shared_ptr<const Place> place) : place_(std::move(place)) {}

const std::string& Model::name() const { return place_->name; }

Pose Model::pose() const {
  const engine::WorldSpec& spec = place_->world->spec();
  const auto& part = spec.types[spec.bodies[place_->body.index()].type.index()].parts[place_->part];
  return compose(place_->world->pose(place_->body), part.pose_body_part);
}

Eigen::Vector3d Model::size() const {
  const engine::WorldSpec& spec = place_->world->spec();
  return spec.types[spec.bodies[place_->body.index()].type.index()].parts[place_->part].size;
}

void Model::set_speed(double forward, double left, double turn) {
  if (!place_->type().drive) throw std::logic_error(fmt::format("\"{}\" has no drive", place_->name));
  place_->world->set_command(place_->row(), {forward, left, turn});
}

Model::Speed Model::speed() const {
  const engine::Velocity v = place_->world->velocities()[place_->row().index()];
  return {v.x, v.y, v.turn};
}

bool Model::stalled() const { return place_->world->stalled(place_->row()); }

std::vector<std::string> Model::sensors() const {
  std::vector<std::string> names;
  for (const auto& sensor : place_->type().sensors) names.push_back(sensor.name);
  return names;
}

namespace {

const engine::BodyType::Sensor& find_sensor(const engine::BodyType& type, const std::string& model,
                                            std::string_view name) {
  std::vector<std::string_view> known;
  for (const auto& sensor : type.sensors) {
    if (name.empty() || sensor.name == name) {
      if (!sensor.active) {
        throw std::logic_error(
            fmt::format("sensor \"{}\" of \"{}\" does not run: subscribe to the robot first", sensor.name, model));
      }
      return sensor;
    }
    known.push_back(sensor.name);
  }
  if (known.empty()) throw std::out_of_range(fmt::format("\"{}\" has no sensor", model));
  throw std::out_of_range(fmt::format("\"{}\" has no sensor \"{}\"; it has: {}", model, name, comma_list(known)));
}

}  // namespace

std::span<const float> Model::ranges(std::string_view sensor) const {
  const auto& found = find_sensor(place_->type(), place_->name, sensor);
  return place_->world->percepts(found).cell<float>(place_->world->slot(place_->row()), 0);
}

std::span<const float> Model::intensities(std::string_view sensor) const {
  const auto& found = find_sensor(place_->type(), place_->name, sensor);
  const engine::StateTable& table = place_->world->percepts(found);
  if (table.fields().size() < 2) return {};
  return table.cell<float>(place_->world->slot(place_->row()), 1);
}

Simulation::Simulation(const std::filesystem::path& file, const SimulationOptions& options)
    : impl_(std::make_unique<Impl>()) {
  if (const std::string fault = fp_environment_fault(); !fault.empty()) restore_fp_environment();
  impl_->options = options;
  impl_->file = file;
  impl_->registry = make_registry();
  Diagnostics diagnostics;
  worldio::LoadOptions load{options.seed, options.robots, options.set, options.search_path};
  engine::WorldSpec spec = worldio::load_world(file, impl_->registry, load, diagnostics);
  diagnostics.throw_if_errors();
  impl_->world = std::make_unique<engine::World>(
      std::move(spec), impl_->registry, engine::WorldOptions{options.threads, options.tile_size_m}, diagnostics);
  impl_->warnings = diagnostics.warnings();
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

const std::vector<std::string>& Simulation::warnings() const { return impl_->warnings; }

std::vector<std::pair<std::string, std::string>> Simulation::effective_options() const {
  std::vector<std::pair<std::string, std::string>> out{
      {"world", impl_->file.string()},
      {"seed", fmt::format("{}", impl_->world->spec().seed)},
      {"tick_s", fmt::format("{}", impl_->world->tick_s())},
      {"ranging", "exact"},
      {"robots", fmt::format("{}", robots())},
      {"threads", fmt::format("{}", threads())},
      {"tile_m", fmt::format("{}", impl_->world->geometry().tile_m())},
  };
  for (const auto& [pointer, value] : impl_->options.set) out.emplace_back("set " + pointer, value);
  return out;
}

void Simulation::step() { impl_->world->step(); }

void Simulation::run_for(double seconds) {
  const auto ticks = static_cast<std::uint64_t>(std::ceil(seconds / tick_s() - 1e-6));
  for (std::uint64_t i = 0; i < ticks; ++i) step();
}

double Simulation::time_s() const { return impl_->world->time_s(); }
std::uint64_t Simulation::tick() const { return impl_->world->tick(); }
double Simulation::tick_s() const { return impl_->world->tick_s(); }
std::size_t Simulation::robots() const { return impl_->world->robots(); }
std::string Simulation::title() const { return impl_->world->spec().title; }
std::optional<double> Simulation::quit_time_s() const { return impl_->world->spec().quit_time_s; }

Model Simulation::find(std::string_view name) {
  engine::World& world = *impl_->world;
  if (const BodyId body = world.find(name); body.valid())
    return Model(std::make_shared<Model::Place>(&world, body, 0, std::string(name)));
  // A part is named below its body: "r0.ranger:1".
  for (std::size_t dot = name.rfind('.'); dot != std::string_view::npos && dot > 0; dot = name.rfind('.', dot - 1)) {
    const BodyId body = world.find(name.substr(0, dot));
    if (!body.valid()) continue;
    const auto& parts = world.spec().types[world.spec().bodies[body.index()].type.index()].parts;
    for (std::size_t p = 1; p < parts.size(); ++p)
      if (parts[p].name == name.substr(dot + 1))
        return Model(std::make_shared<Model::Place>(&world, body, p, std::string(name)));
  }
  std::vector<std::string_view> known;
  for (const engine::BodySpec& body : world.spec().bodies) known.push_back(body.name);
  throw std::out_of_range(fmt::format("no model \"{}\" in {}{}", name, impl_->file.string(), did_you_mean(name, known)));
}

std::vector<std::string> Simulation::robot_names() const {
  std::vector<std::string> names;
  for (std::size_t r = 0; r < impl_->world->rows(); ++r)
    if (impl_->world->type(Row(r)).drive)
      names.push_back(impl_->world->spec().bodies[impl_->world->body(Row(r)).index()].name);
  return names;
}

void Simulation::subscribe(std::string_view model) {
  if (tick() > 0) throw std::logic_error("subscribe before the first step");
  impl_->world->activate(find(model).place_->body);
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
    line += fmt::format(" {}={}", engine::hash_group_name(static_cast<engine::HashGroup>(g)), hex(h.groups[g]));
  return line;
}

Statistics Simulation::statistics() const {
  const engine::World& w = *impl_->world;
  return {w.robots(),        w.tick(),       w.time_s(),           w.beams_cast(),
          w.stalled_count(), w.held_count(), w.mean_displacement(), w.conflict_rounds()};
}

unsigned Simulation::threads() const { return impl_->world->parallel().threads(); }

void Simulation::on_phase(std::function<void(std::optional<Phase>)> callback) {
  impl_->world->on_phase(std::move(callback));
}

void Simulation::snapshot(const std::filesystem::path& png, int width, int height) const {
#ifdef TROUPE_HAS_RENDER
  const engine::World& world = *impl_->world;
  render::Picture picture =
      render::draw(world.frame_scene(), world.frame(), {.width = width, .height = height, .region = {}});
  worldio::write_png(png, {picture.width, picture.height, std::move(picture.rgba)},
                     {{"Software", version_line()},
                      {"world", impl_->file.string()},
                      {"time_s", fmt::format("{}", time_s())},
                      {"seed", fmt::format("{}", world.spec().seed)},
                      {"state_hash", hex(state_hash())}});
#else
  static_cast<void>(png);
  static_cast<void>(width);
  static_cast<void>(height);
  throw std::runtime_error("this build draws no pictures: it was configured with TROUPE_RENDER=OFF");
#endif
}

std::string version_line() {
  return fmt::format("troupe {} ({}; {}; {}; assertions {})", k_build_version, k_build_compiler, k_build_flags,
                     k_build_instruction_set, k_build_assertions ? "on" : "off");
}

}  // namespace troupe
