#include "troupe/lint.hpp"

#include "base/fp_environment.hpp"
#include "engine/observing/lint_view.hpp"
#include "engine/observing/measures.hpp"
#include "engine/observing/stop_conditions.hpp"
#include "engine/sensing/shown_color.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "sensors/blobfinder.hpp"
#include "troupe/lint_experiment.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "troupe/script.hpp"
#include "worldio/colors.hpp"
#include "worldio/load.hpp"
#include "worldio/results/recording_fields.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <any>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t k_most_listed = 100;  // limit for findings that may concern every robot
constexpr double k_scene_cell_m = 0.5;

class Lint {
 public:
  /// base_types: names of the types that other types extend.
  Lint(const engine::World& world, const engine::LintWorld& linted, const std::set<std::string>& base_types,
       Diagnostics& diagnostics)
      : world_(world),
        linted_(linted),
        spec_(world.spec()),
        base_types_(base_types),
        diagnostics_(diagnostics) {}

  /// Findings about one line of a file are listed in the order of these calls.
  void check() {
    using enum engine::LintTopic;
    call_hooks();
    check_types();
    report({drive});
    check_periods();
    report({energy, charging, decision, goal, sight, light, ground, color});
    check_hidden_colors();
    report({message, grip, other});
    check_floor_plans();
    check_window();
  }

 private:
  void check_types();
  void call_hooks();
  void report(std::initializer_list<engine::LintTopic> topics);
  void check_periods();
  void check_controller_period(std::uint32_t t, std::size_t c);
  void check_hidden_colors();
  std::vector<std::uint32_t> color_hiding_parts(std::uint32_t t) const;
  void check_floor_plans();
  Result<> can_block(const engine::BodySpec& body, const engine::PartSpec& plan) const;
  void check_robots_in_walls(const std::vector<BodyId>& plans);
  void check_window();

  const engine::World& world_;
  const engine::LintWorld& linted_;
  const engine::WorldSpec& spec_;
  const std::set<std::string>& base_types_;
  Diagnostics& diagnostics_;
  std::vector<engine::LintFinding> found_;  // by call_hooks()
};

void Lint::check_types() {
  const auto is_used = [&](std::size_t t) {
    return linted_.bodies[t] > 0 || base_types_.contains(spec_.types[t].name);
  };
  const auto file_of = [&](std::size_t t) { return spec_.types[t].parts.front().where.file; };
  std::set<std::uint32_t> used_files;
  for (std::size_t t = 0; t < spec_.types.size(); ++t)
    if (is_used(t) && file_of(t) != 0) used_files.insert(file_of(t));
  for (std::size_t t = 0; t < spec_.types.size(); ++t)
    if (!is_used(t) && !used_files.contains(file_of(t)))  // a world rarely uses all types of an included file
      diagnostics_.warning(spec_.types[t].parts.front().where,
                           fmt::format("type \"{}\" is never used", spec_.types[t].name));
}

/// Calls the hooks of all drives, devices and controllers, and checks the periods of controllers.
void Lint::call_hooks() {
  for (std::uint32_t t = 0; t < spec_.types.size(); ++t) {
    const engine::TypeSpec& given = spec_.types[t];
    const engine::BodyType& type = world_.view().types()[t];
    const auto call = [&](const auto& kind, const std::any& data, std::size_t index, const auto& one) {
      if (kind.lint != nullptr && linted_.bodies[t] > 0)
        kind.lint(data, {linted_, t, index, one.params, one.where, found_});
    };
    if (type.drive) call(*type.drive->kind, type.drive->data, 0, *given.drive);
    for (std::size_t d = 0; d < type.devices.size(); ++d)
      call(*type.devices[d].kind, type.devices[d].prepared.data, d, given.devices[d]);
    for (std::size_t c = 0; c < type.controllers.size(); ++c) {
      call(*type.controllers[c].kind, type.controllers[c].data, c, given.controllers[c]);
      check_controller_period(t, c);
    }
  }
}

/// Reports the findings of the hooks about these topics, one topic after the other.
void Lint::report(std::initializer_list<engine::LintTopic> topics) {
  for (const engine::LintTopic topic : topics)
    for (const engine::LintFinding& found : found_)
      if (found.topic == topic) diagnostics_.warning(found.where, found.text);
}

/// Warns if a controller has a period but runs with another one: that of its first device or of the drive.
void Lint::check_controller_period(std::uint32_t t, std::size_t c) {
  const engine::BodyType& type = world_.view().types()[t];
  const engine::ControllerSpec& given = spec_.types[t].controllers[c];
  const engine::BodyType::Controller& controller = type.controllers[c];
  if (!(given.period_s > 0) || engine::period_ticks(given.period_s, spec_.tick_s) == controller.period)
    return;
  const std::string with =
      controller.devices.empty()
          ? std::string("the drive")
          : fmt::format("its first device \"{}\"", type.devices[controller.devices.front()].name);
  found_.push_back(
      {engine::LintTopic::decision, given.where,
       fmt::format(
           "the period of {:.10g} s of {} has no effect: the controller runs whenever {} has run, every "
           "{:.10g} s",
           given.period_s, engine::device_text("the controller", given.kind, spec_.types[t].name), with,
           static_cast<double>(controller.period) * spec_.tick_s)});
}

/// Warns of drives and devices that never run because their first run, at the end of their first period, is
/// after the end of the run.
void Lint::check_periods() {
  if (!spec_.quit_time_s) return;
  const std::uint64_t end = std::max<std::uint64_t>(engine::ticks_until(*spec_.quit_time_s, spec_.tick_s), 1);
  for (std::size_t t = 0; t < spec_.types.size(); ++t) {
    if (linted_.bodies[t] == 0) continue;
    const engine::BodyType& type = world_.view().types()[t];
    const auto check = [&](std::string_view what, std::string_view name, std::uint64_t period, Where where) {
      if (period > end)
        diagnostics_.warning(
            where,
            fmt::format("the {} never runs unless --for makes the run longer: its period is {:.10g} s, but "
                        "\"quit_time_s\" ends the run at {:.10g} s",
                        engine::device_text(what, name, type.name),
                        static_cast<double>(period) * spec_.tick_s, *spec_.quit_time_s));
    };
    if (type.drive) check("drive", type.drive->kind->name, type.drive->period, spec_.types[t].drive->where);
    for (std::size_t d = 0; d < type.devices.size(); ++d)
      check(type.devices[d].kind->name, type.devices[d].name, type.devices[d].period,
            spec_.types[t].devices[d].where);
  }
}

/// Returns the parts of a type that never show the colour of the world file, because a device sets their
/// colour, such as an LED. A device whose parameters are not the default ones has a chosen colour: its part
/// is left out. So is a part without a colour of its own if another part shows the body's colour.
std::vector<std::uint32_t> Lint::color_hiding_parts(std::uint32_t t) const {
  const engine::TypeSpec& type = spec_.types[t];
  const engine::BodyType& built = world_.view().types()[t];
  std::vector<std::uint32_t> parts;
  bool shows_color_of_body = false;
  for (std::uint32_t p = 0; p < type.parts.size(); ++p) {
    if (type.parts[p].solids.empty()) continue;
    const engine::BodyType::Device* device = engine::color_device(built, p);
    if (device == nullptr)
      shows_color_of_body = shows_color_of_body || !type.parts[p].color;
    else if (type.devices[static_cast<std::size_t>(device - built.devices.data())].params ==
             device->kind->params.defaults())
      parts.push_back(p);
  }
  if (shows_color_of_body) std::erase_if(parts, [&](std::uint32_t p) { return !type.parts[p].color; });
  return parts;
}

/// Warns of colours that are not the default ones, but that no part shows (color_hiding_parts()).
void Lint::check_hidden_colors() {
  const std::vector<Color> default_colors = worldio::default_colors(spec_.types);
  std::vector<std::vector<std::uint32_t>> hiding(spec_.types.size());
  for (std::uint32_t t = 0; t < spec_.types.size(); ++t) hiding[t] = color_hiding_parts(t);
  const auto text = [](const Color& color) {
    return fmt::format("[{:.3g}, {:.3g}, {:.3g}]", color.r, color.g, color.b);
  };
  for (std::size_t b = 0; b < spec_.bodies.size(); ++b) {
    const std::uint32_t t = spec_.bodies[b].type.value;
    const Row row = world_.view().row(BodyId(b));
    if (hiding[t].empty() || !row.valid()) continue;
    std::erase_if(hiding[t], [&](std::uint32_t p) {
      const std::optional<Color>& own = spec_.types[t].parts[p].color;
      const Color color = own.value_or(spec_.bodies[b].color);
      const Color shown = engine::shown_color(world_.view(), row, p).value_or(color);
      if (sensors::is_same_color(shown, color) || (!own && color == default_colors[t])) return false;
      const engine::BodyType& built = world_.view().types()[t];
      const auto d = static_cast<std::size_t>(engine::color_device(built, p) - built.devices.data());
      const engine::DeviceSpec& device = spec_.types[t].devices[d];
      diagnostics_.warning(
          device.where,
          fmt::format("the \"color\" {} has no effect on the part with {}, which gives the part its own "
                      "colour, {} at the start: give the device the colour, or a part of its own",
                      text(color), engine::device_text(device.kind, device.name, spec_.types[t].name),
                      text(shown)));
      return true;
    });
  }
}

/// Returns success if a floor plan can block a robot, else an error that states why it cannot. body: the
/// floor plan; plan: its part with the walls.
Result<> Lint::can_block(const engine::BodySpec& body, const engine::PartSpec& plan) const {
  if (!plan.returns.obstacle) return Error{"it is not an obstacle"};
  const double height = body.pose_world_body.z;
  std::optional<ZInterval> robots;
  for (std::size_t t = 0; t < spec_.types.size(); ++t) {
    const engine::BodyType& type = world_.view().types()[t];
    if (!type.drive) continue;
    for (const auto& level : linted_.levels[t])
      for (const ConvexPrism& piece : type.obstacle.pieces) {
        const ZInterval z = piece.z.shifted(level.first);
        for (const Solid& solid : plan.solids)
          if (z.overlaps(solid.z.shifted(height))) return {};
        robots = robots ? ZInterval{std::min(robots->min, z.min), std::max(robots->max, z.max)} : z;
      }
  }
  if (!robots) return Error{"no robot is an obstacle, and only obstacles block one another"};
  ZInterval walls = *robots;
  if (!plan.solids.empty()) walls = plan.solids.front().z.shifted(height);
  return Error{
      fmt::format("its walls are at a height of {:.4g} to {:.4g} m, but the robots are at {:.4g} to {:.4g} m",
                  walls.min, walls.max, robots->min, robots->max)};
}

void Lint::check_floor_plans() {
  if (world_.robots() == 0) return;
  std::vector<BodyId> open;  // floor plans that robots drive through
  for (std::size_t b = 0; b < spec_.bodies.size(); ++b) {
    const engine::BodySpec& body = spec_.bodies[b];
    if (world_.view().row(BodyId(b)).valid()) continue;
    for (const engine::PartSpec& part : spec_.types[body.type.index()].parts) {
      if (!part.floor_plan) continue;
      const Result<> blocks = can_block(body, part);
      if (blocks) continue;
      diagnostics_.warning(body.where, fmt::format("floor plan \"{}\" blocks no robot: {}",
                                                   spec_.name(BodyId(b)), blocks.error().text));
      if (!part.returns.obstacle) open.push_back(BodyId(b));
      break;
    }
  }
  if (!open.empty()) check_robots_in_walls(open);
}

/// Warns of robots that start inside the walls of the floor plans `plans`, which are not obstacles.
/// engine::World gives this warning for floor plans that are obstacles.
void Lint::check_robots_in_walls(const std::vector<BodyId>& plans) {
  std::vector<partition::FixedSolid> solids;
  for (const BodyId plan : plans) {
    const engine::BodySpec& body = spec_.bodies[plan.index()];
    for (const engine::PartSpec& part : spec_.types[body.type.index()].parts)
      for (const Solid& solid : part.solids)
        if (part.floor_plan) solids.push_back({placed(solid, body.pose_world_body), plan, true, -1});
  }
  const partition::StaticScene scene(std::move(solids), k_scene_cell_m);
  std::size_t found = 0;
  Where last;
  for (std::size_t b = 0; b < spec_.bodies.size(); ++b) {
    const engine::BodySpec& body = spec_.bodies[b];
    const engine::BodyType& type = world_.view().types()[body.type.index()];
    if (!type.drive || type.obstacle.empty() || !spec_.starts(BodyId(b))) continue;
    for (const BodyId plan : scene.overlapping(type.obstacle, body.pose_world_body)) {
      if (found++ >= k_most_listed) continue;
      last = body.where;
      diagnostics_.warning(last, fmt::format("\"{}\" overlaps a wall of floor plan \"{}\" at the start, and "
                                             "can drive through the wall, because the plan "
                                             "is no obstacle: move the robot, or make the plan an obstacle",
                                             spec_.name(BodyId(b)), spec_.name(plan)));
    }
  }
  if (found > k_most_listed)
    diagnostics_.warning(last,
                         fmt::format("{} more robot{} inside walls of floor plans", found - k_most_listed,
                                     found - k_most_listed == 1 ? " starts" : "s start"));
}

/// Warns of a window that follows a body that the world does not have.
void Lint::check_window() {
  if (!spec_.window) return;
  const std::string& name = get(worldio::window_fields(), *spec_.window, "follow").text();
  if (name.empty() || world_.state().names.find(name).valid()) return;
  diagnostics_.warning(
      {spec_.resolution_where.file, 0},
      fmt::format("the window follows the model \"{}\", but there is no such model: correct the name", name));
}

/// Reports the errors that a run with the measures, the stop conditions and the recording of the world would
/// report.
void check_outputs(engine::World& world, const engine::Registry& registry, Diagnostics& diagnostics) {
  const engine::WorldSpec& spec = world.spec();
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < spec.measures.size(); ++i) paths.push_back(fmt::format("/measures/{}", i));
  const engine::MeasureSet measures(world, registry, spec.measures, diagnostics, paths);
  const engine::StopConditions conditions(world, registry, spec.experiment.stop_when, diagnostics);
  if (!spec.record) return;
  worldio::check_recording_file(*spec.record, diagnostics);
  if (spec.record->fields.empty()) return;
  try {
    worldio::recorded_components(world, spec.record->fields);
  } catch (const std::invalid_argument& error) {
    diagnostics.error(spec.record->where_fields, fmt::format("/record/fields: {}", error.what()));
  }
}

}  // namespace

std::vector<std::string> lint(const std::filesystem::path& file, const SimulationOptions& options) {
  restore_fp_environment();  // before anything is computed from the file
  Diagnostics diagnostics(true);
  engine::Registry registry = make_registry();
  const std::shared_ptr<const Plugins> plugins = add_plugins(registry, options.plugin_path, options.scripts);
  std::vector<std::string> bases;
  const worldio::LoadOptions load{.seed = options.seed,
                                  .robots = options.robots,
                                  .set = options.set,
                                  .search_path = options.search_path,
                                  .threads = options.threads,
                                  .base_types = &bases};
  engine::WorldSpec spec = worldio::load_world(file, registry, load, diagnostics);
  diagnostics.throw_if_errors();
  assign_controllers(options.scripts, spec, diagnostics);
  diagnostics.throw_if_errors();
  engine::World world(std::move(spec), registry, {options.threads, options.tile_size_m}, diagnostics);
  check_outputs(world, registry, diagnostics);
  diagnostics.throw_if_errors();
  const engine::LintWorld linted(world);
  const std::set<std::string> base_types(bases.begin(), bases.end());
  Lint(world, linted, base_types, diagnostics).check();
  lint_experiment(world, linted, registry, base_types, diagnostics);

  // By file and line. Findings about one line keep their order.
  std::multimap<std::pair<std::uint32_t, std::uint32_t>, std::string> texts;
  for (const Finding& finding : diagnostics.findings())
    texts.emplace(std::pair(finding.where.file, finding.where.line), diagnostics.text(finding));
  std::vector<std::string> lines;
  for (auto& [place, text] : texts) lines.push_back(std::move(text));
  for (const std::string& warning : plugins->warnings()) lines.push_back(warning);
  return lines;
}

}  // namespace troupe
