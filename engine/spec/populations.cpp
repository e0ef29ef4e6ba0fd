#include "engine/spec/populations.hpp"

#include "base/limits.hpp"
#include "base/number_text.hpp"
#include "base/random.hpp"
#include "partition/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <stdexcept>
#include <string_view>

namespace troupe::engine {
namespace {

// Limit on the cells of all grid rules together, each of which may be tested, and on those of all free_floor
// rules together, each of which is tested.
constexpr double k_max_cells = 100000000;
// Limit on the cells of one free_floor rule.
constexpr double k_max_floor_cells = 25000000;
constexpr double k_scene_cell_m = 0.5;

template <class IsFixed>
partition::StaticScene scene_of(const WorldSpec& spec, IsFixed is_fixed) {
  std::vector<partition::FixedSolid> walls;
  for (std::size_t i = 0; i < spec.bodies.size(); ++i) {
    if (!is_fixed(BodyId(i))) continue;
    const BodySpec& body = spec.bodies[i];
    for (const PartSpec& part : spec.types[body.type.index()].parts)
      for (const Solid& solid : part.solids)
        if (part.returns.obstacle)  // no ray is cast in this scene, so ranger returns do not matter
          walls.push_back({placed(solid, body.pose_world_body), BodyId(i), true, -1});
  }
  return {std::move(walls), k_scene_cell_m};
}

std::string path_of(const PopulationSpec& population, std::size_t index) {
  if (!population.path.empty()) return population.path;
  return fmt::format("populations[{}].rule", index);
}

std::string too_few_places(const PopulationSpec& population, std::size_t placed,
                           const std::optional<Box>& bounds, Occupancy& occupancy,
                           partition::Parallel& parallel) {
  const PlacementRule& rule = population.rule;
  if (bounds && !rule.region.touches(*bounds))
    return fmt::format("the region ({}) lies outside the world's bounds ({}): check its units and signs",
                       extent_text(rule.region), extent_text(*bounds));
  if (rule.kind == PlacementRule::Kind::free_floor && rule.from) {
    const std::string from =
        fmt::format("\"from_m\" [{}, {}]", plain_number(rule.from->x()), plain_number(rule.from->y()));
    if (!rule.region.contains(*rule.from))
      return fmt::format("{} lies outside the region ({}): give a point in the region", from,
                         extent_text(rule.region));
    if (!is_on_floor(rule, occupancy.shape(population.type), occupancy.scene(), parallel))
      return fmt::format(
          "{} is no free floor: a disc as wide as the body overlaps a wall there; give a point "
          "with more room",
          from);
  }
  const std::string why =
      rule.kind == PlacementRule::Kind::grid
          ? fmt::format("the region has no further free cell (it has {:.0f} cells)", grid_cells(rule))
          : fmt::format("none of {} random poses for the next body was free{}", rule.trials,
                        rule.kind == PlacementRule::Kind::free_floor ? " and on the reachable floor" : "");
  return fmt::format("placed {} of {} {}: {}; enlarge the region or lower the count", placed,
                     population.count, population.count == 1 ? "body" : "bodies", why);
}

/// Gives body i of a population a random colour if PopulationSpec::random_color is true.
void set_color(const PopulationSpec& population, std::uint64_t seed, std::size_t i, BodySpec& body) {
  if (!population.random_color) return;
  Random random(seed, stream_id("color", population.name), static_cast<std::uint32_t>(i), 0);
  body.color.r = static_cast<float>(random.uniform());
  body.color.g = static_cast<float>(random.uniform());
  body.color.b = static_cast<float>(random.uniform());
  body.color.a = 1;
}

class Placer {
 public:
  Placer(std::span<const PopulationSpec> populations, WorldSpec& spec, Occupancy& occupancy,
         const PlaceOptions& options, Diagnostics& diagnostics)
      : populations_(populations),
        spec_(spec),
        occupancy_(occupancy),
        options_(options),
        diagnostics_(diagnostics) {}

  void run() {
    const std::size_t before = errors();
    check_total();
    if (errors() == before) check_rules();
    if (errors() > before) return;
    partition::Parallel parallel(options_.threads);
    for (const PopulationSpec& population : populations_) add(population, parallel);
  }

 private:
  std::size_t errors() const { return diagnostics_.findings().size(); }
  std::string path(const PopulationSpec& population) const {
    return path_of(population, static_cast<std::size_t>(&population - populations_.data()));
  }
  void error(const PopulationSpec& population, const std::string& message) {
    diagnostics_.error(population.where_place, fmt::format("{}: {}", path(population), message));
  }

  void check_total();
  void check_numbers(const PopulationSpec& population);
  void check_rules();
  void check_floor(const PopulationSpec& population, double& cells_so_far);
  const partition::ObstacleShape* find_shape(const PopulationSpec& population);
  void add(const PopulationSpec& population, partition::Parallel& parallel);
  void add_bodies(const PopulationSpec& population, std::span<const Pose> poses);

  std::span<const PopulationSpec> populations_;
  WorldSpec& spec_;
  Occupancy& occupancy_;
  const PlaceOptions& options_;
  Diagnostics& diagnostics_;
};

void Placer::check_total() {
  double total = static_cast<double>(spec_.bodies.size());
  for (const PopulationSpec& population : populations_)
    total += static_cast<double>(population.count) + static_cast<double>(population.reserve);
  if (total <= options_.most_bodies) {
    spec_.bodies.reserve(static_cast<std::size_t>(total));
    return;
  }
  diagnostics_.error(populations_.empty() ? spec_.bodies.back().where : populations_.back().where,
                     fmt::format("the world would hold {:.0f} bodies; at most {:.0f} are allowed", total,
                                 options_.most_bodies));
}

/// Checks the type of a population and the limits of the numbers of its rule. The readers of world files
/// check them too, but a program may fill a PopulationSpec with any values.
void Placer::check_numbers(const PopulationSpec& population) {
  if (population.type.index() >= spec_.types.size())
    error(population,
          fmt::format("the world has {} types, but this population has the type {} (counted from 0)",
                      spec_.types.size(), population.type.value));
  const auto check = [&](std::string_view member, double least, std::initializer_list<double> values) {
    for (const double value : values)
      if (!(least <= value && value <= k_spec_reach_m))
        error(population, fmt::format("{} must be from {} to {}, found {}", member, plain_number(least),
                                      plain_number(k_spec_reach_m), exact_number(value)));
  };
  const auto check_place = [&](std::string_view member, std::initializer_list<double> values) {
    check(member, -k_spec_reach_m, values);
  };
  const auto check_box = [&](std::string_view member, const Box& box) {
    if (!box.empty()) check_place(member, {box.min.x(), box.min.y(), box.max.x(), box.max.y()});
  };
  const PlacementRule& rule = population.rule;
  check_box("region", rule.region);
  check_box("spill", rule.spill);
  for (const Vec2& corner : rule.polygon) check_place("polygon", {corner.x(), corner.y()});
  check("pitch_m", 0, {rule.pitch_m});
  if (rule.pitch_m == 0) error(population, "pitch_m must not be 0");
  check("jitter_m", 0, {rule.jitter_m});
  check_place("mean", {rule.mean.x(), rule.mean.y()});
  check("deviation", 0, {rule.deviation.x(), rule.deviation.y()});
  check("distance_m", k_least_placement_step_m, {rule.distance_m});
  if (rule.from) check_place("from", {rule.from->x(), rule.from->y()});
  check("cell_m", 0, {rule.cell_m});
  if (rule.heading) check_place("heading", {*rule.heading});
  check_place("z", {rule.z});
}

void Placer::check_rules() {
  const std::size_t before = errors();
  for (const PopulationSpec& population : populations_) check_numbers(population);
  if (errors() > before) return;
  double cells_so_far = 0;
  double floor_cells_so_far = 0;
  for (const PopulationSpec& population : populations_) {
    const PlacementRule& rule = population.rule;
    if (rule.region.empty())
      error(population,
            fmt::format(
                "the region is empty: x from {} to {} m, y from {} to {} m; x_min must not exceed x_max, "
                "and y_min must not exceed y_max",
                plain_number(rule.region.min.x()), plain_number(rule.region.max.x()),
                plain_number(rule.region.min.y()), plain_number(rule.region.max.y())));
    else if (rule.kind == PlacementRule::Kind::free_floor)
      check_floor(population, floor_cells_so_far);
    if (rule.kind != PlacementRule::Kind::grid) continue;
    const double cells = grid_cells(rule);
    cells_so_far += cells;
    if (cells > k_max_cells)
      error(population,
            fmt::format("the region has {} million cells of {} m; at most {} million are allowed: give a "
                        "larger \"pitch_m\"",
                        plain_number(cells / 1e6, 4), plain_number(rule.pitch_m), k_max_cells / 1e6));
    else if (cells_so_far > k_max_cells)
      error(population,
            fmt::format("the grids of this population and of the grid populations before it have {} million "
                        "cells in total; at most {} million are allowed: give a larger \"pitch_m\"",
                        plain_number(cells_so_far / 1e6, 4), k_max_cells / 1e6));
  }
}

/// Checks the number of positions that a rule of the kind free_floor tests, and adds it to `cells_so_far`.
void Placer::check_floor(const PopulationSpec& population, double& cells_so_far) {
  const partition::ObstacleShape* shape = find_shape(population);
  if (shape == nullptr) return;
  const double cells = floor_cells(population.rule, *shape);
  cells_so_far += cells;
  if (cells > k_max_floor_cells)
    error(population,
          fmt::format(
              "the region has {} million cells; at most {} million are allowed: give a larger \"cell_m\"",
              plain_number(cells / 1e6, 4), k_max_floor_cells / 1e6));
  else if (cells_so_far > k_max_cells)
    error(population,
          fmt::format("the regions of this population and of the free_floor populations before it have {} "
                      "million cells in total; at most {} million are allowed: give a larger \"cell_m\"",
                      plain_number(cells_so_far / 1e6, 4), k_max_cells / 1e6));
}

/// Returns the shape of the bodies of a population. If the outlines are too complex, reports this and returns
/// null.
const partition::ObstacleShape* Placer::find_shape(const PopulationSpec& population) try {
  return &occupancy_.shape(population.type);
} catch (const std::length_error& error) {
  const TypeSpec& type = spec_.types[population.type.index()];
  diagnostics_.error(type.parts.front().where, fmt::format("type \"{}\": {}", type.name, error.what()));
  return nullptr;
}

void Placer::add(const PopulationSpec& population, partition::Parallel& parallel) {
  const partition::ObstacleShape* shape = find_shape(population);
  if (shape == nullptr) return;
  const std::vector<Pose> poses = place({.rule = population.rule,
                                         .shape = *shape,
                                         .count = population.count,
                                         .seed = spec_.seed,
                                         .population = population.name,
                                         .bounds = spec_.bounds,
                                         .scene = occupancy_.scene()},
                                        occupancy_.crowd(), parallel);
  if (poses.size() < population.count)
    error(population, too_few_places(population, poses.size(), spec_.bounds, occupancy_, parallel));
  add_bodies(population, poses);
}

void Placer::add_bodies(const PopulationSpec& population, std::span<const Pose> poses) {
  if (population.count == 0 && population.reserve == 0)
    spec_.empty_populations.push_back({population.name, population.type});
  if (population.reserve > 0)
    spec_.reserves.push_back({population.name, BodyId(spec_.bodies.size() + poses.size()),
                              static_cast<std::uint32_t>(population.reserve)});
  for (std::size_t i = 0; i < poses.size() + population.reserve; ++i) {
    BodySpec& body = spec_.bodies.emplace_back();
    body.name = spec_.names.add(population.name, static_cast<std::uint32_t>(i));
    body.type = population.type;
    body.pose_world_body = i < poses.size() ? poses[i] : Pose{0, 0, population.rule.z, 0};
    body.color = population.color;
    body.where = population.where;
    set_color(population, spec_.seed, i, body);
  }
}

}  // namespace

Occupancy::Occupancy(const WorldSpec& spec, std::size_t fixed)
    : types_(spec.types),
      scene_(scene_of(spec, [fixed](BodyId body) { return body.index() < fixed; })),
      shapes_(spec.types.size()) {}

Occupancy::Occupancy(const WorldSpec& spec)
    : types_(spec.types),
      scene_(
          scene_of(spec, [&spec](BodyId body) { return is_static(spec.type(body)) && spec.starts(body); })),
      shapes_(spec.types.size()) {
  for (std::size_t i = 0; i < spec.bodies.size(); ++i) {
    const BodySpec& body = spec.bodies[i];
    if (!is_static(spec.types[body.type.index()]) && spec.starts(BodyId(i)))
      crowd_.add(shape(body.type), body.pose_world_body);
  }
}

const partition::ObstacleShape& Occupancy::shape(TypeId type) {
  std::optional<partition::ObstacleShape>& shape = shapes_[type.index()];
  if (!shape) shape = obstacle_shape(types_[type.index()]);
  return *shape;
}

void place(std::span<const PopulationSpec> populations, WorldSpec& spec, Occupancy& occupancy,
           const PlaceOptions& options, Diagnostics& diagnostics) {
  Placer(populations, spec, occupancy, options, diagnostics).run();
}

void place(std::span<const PopulationSpec> populations, WorldSpec& spec, Diagnostics& diagnostics,
           const PlaceOptions& options) {
  bool is_right = true;
  check_rules(spec, [&](Where where, const std::string& text) {
    diagnostics.error(where, text);
    is_right = false;
  });
  if (!is_right) return;
  std::optional<Occupancy> occupancy;
  try {
    occupancy.emplace(spec);
  } catch (const std::length_error& error) {
    diagnostics.error({}, error.what());
    return;
  }
  place(populations, spec, *occupancy, options, diagnostics);
}

void place_again(std::span<const PopulationSpec> populations, std::span<BodySpec> bodies, std::uint64_t seed,
                 const std::optional<Box>& bounds, Occupancy& occupancy, Crowd crowd,
                 Diagnostics& diagnostics) {
  partition::Parallel one_thread(1);
  for (std::size_t p = 0; p < populations.size(); ++p) {
    const PopulationSpec& population = populations[p];
    const std::vector<Pose> poses = place({.rule = population.rule,
                                           .shape = occupancy.shape(population.type),
                                           .count = population.count,
                                           .seed = seed,
                                           .population = population.name,
                                           .bounds = bounds,
                                           .scene = occupancy.scene()},
                                          crowd, one_thread);
    if (poses.size() < population.count)
      return diagnostics.error(
          population.where_place,
          fmt::format("{}: {}", path_of(population, p),
                      too_few_places(population, poses.size(), bounds, occupancy, one_thread)));
    for (std::size_t i = 0; i < poses.size(); ++i) bodies[i].pose_world_body = poses[i];
    for (std::size_t i = 0; i < population.count + population.reserve; ++i)
      set_color(population, seed, i, bodies[i]);
    bodies = bodies.subspan(population.count + population.reserve);
  }
}

}  // namespace troupe::engine
