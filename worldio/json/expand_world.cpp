#include "base/math.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/populations.hpp"
#include "engine/spec/watch_spec.hpp"
#include "worldio/colors.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/json/experiment_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/type_document.hpp"
#include "worldio/json/wall_line.hpp"
#include "worldio/load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>

namespace troupe::worldio {
namespace {

using engine::BodySpec;
using engine::PlacementRule;
using engine::WorldSpec;

constexpr double k_wall_height_m = 1;  // default height of walls along a line
/// Number of robots of a population that are compared with closed walls. More would take long in worlds with
/// millions of robots.
constexpr std::size_t k_most_located = 10'000;
const partition::ObstacleShape k_no_shape;

struct Model {
  BodySpec body;
  std::optional<engine::Name> alias;
  std::vector<std::string> global_parts;  ///< ModelDocument::global_parts
  std::optional<std::string> reserve_of;  ///< population whose reserve has the body; empty: none
  std::string pointer;                    ///< JSON pointer to the model, for errors
};

/// Makes the spec of a world, the description that the engine uses, from a document.
class WorldExpander {
 public:
  WorldExpander(const WorldDocument& document, const std::filesystem::path& file,
                const engine::Registry& registry, const LoadOptions& options, Diagnostics& diagnostics)
      : document_(document),
        file_(file),
        registry_(registry),
        options_(options),
        diagnostics_(diagnostics),
        are_types_right_(!has_error_in(diagnostics, "/types")),
        images_(diagnostics),
        folder_{images_, file.parent_path()} {}

  WorldSpec expand() {
    spec_.files = diagnostics_.files();
    engine::add_ground(spec_);
    const DocumentPath world(document_.where, diagnostics_);
    expand_settings();
    each(world, "floorplans", document_.floorplans, &WorldExpander::expand_floorplan);
    if (document_.arena) expand_arena(*document_.arena);
    if (document_.bounds) spec_.bounds = document_.bounds;  // overrides those of floor plans and arena
    expand_types(world);
    for (const PopulationDocument& population : document_.populations)
      if (!population.name.empty()) population_names_.insert(population.name);
    each(world, "models", document_.models, &WorldExpander::expand_model);
    each(world, "populations", document_.populations, &WorldExpander::expand_population);
    for (const MeasureDocument& measure : document_.measures)
      spec_.measures.push_back(expand_measure(measure));
    std::vector<std::string> type_keys(spec_.types.size());
    for (const auto& [key, type] : type_ids_) type_keys[type.index()] = key;
    expand_experiment(document_.experiment, world, document_.where_of("at"), type_keys, registry_, spec_);
    // Bodies are placed only in a world without errors, because each error could cause further errors during
    // placement.
    if (!diagnostics_.has_errors()) place_bodies();
    if (!diagnostics_.has_errors()) report_repeated_names();
    return std::move(spec_);
  }

 private:
  template <class List, class Expand>
  void each(const DocumentPath& world, std::string_view key, const List& list, Expand function) {
    const DocumentPath all(world, key, document_.where_of(key));
    for (std::size_t i = 0; i < list.size(); ++i)
      (this->*function)(list[i], DocumentPath(all, i, list[i].where));
  }

  void expand_settings();
  void expand_floorplan(const FloorplanDocument& document, const DocumentPath& at);
  void expand_image_plan(const FloorplanDocument& document, const DocumentPath& at, const BodySpec& body,
                         engine::PartSpec& part);
  void expand_arena(const ArenaDocument& document);
  /// Adds a static body and a type for this body only. The type gets the name of the body.
  void add_walls(BodySpec body, engine::PartSpec part);
  void expand_types(const DocumentPath& world);
  void expand_model(const ModelDocument& document, const DocumentPath& at);
  void expand_population(const PopulationDocument& document, const DocumentPath& at);
  PlacementRule expand_rule(const PlaceDocument& document, const DocumentPath& at);
  void expand_region(const PlaceDocument& document, const DocumentPath& at, PlacementRule& rule);
  void place_bodies();
  void make_shapes(engine::Occupancy& occupancy);
  void check_model(const Model& model, engine::Occupancy& occupancy);
  void report_overlaps(const Model& model, const partition::ObstacleShape& shape,
                       engine::Occupancy& occupancy);
  /// Returns the populations to which a body of this name would belong (engine::is_of_population()), the
  /// shortest name first.
  std::vector<std::string_view> populations_of(std::string_view name) const;
  void check_population_of(const Model& model, const DocumentPath& at);
  void name_parts(const Model& model, BodyId body);
  void add_to_reserve(const std::string& population, BodyId body, TypeId type);
  void report_separated_robots(std::size_t first);
  void report_repeated_names();

  /// Returns the id of the type whose key in `types` is `name`. If there is none, reports an error at the key
  /// `type` of `object`, whose path is `at`, and returns type 0, that of the ground. An empty name also gives
  /// type 0, without an error, because the reader has already reported that the type is missing.
  TypeId type_of(const std::string& name, const Placed& object, const DocumentPath& at);
  Color color_of(TypeId type) const {
    return type_colors_[type.index()].value_or(default_colors_[type.index()]);
  }

  const WorldDocument& document_;
  const std::filesystem::path& file_;
  const engine::Registry& registry_;
  const LoadOptions& options_;
  Diagnostics& diagnostics_;
  const bool are_types_right_;  // whether all types were read without errors
  WorldSpec spec_;
  std::vector<std::optional<Color>> type_colors_;          // parallel to spec_.types
  std::vector<Color> default_colors_;                      // parallel to spec_.types
  std::unordered_map<std::string_view, TypeId> type_ids_;  // by key of the document
  FloorImages images_;                                     // shared: several objects may use one image
  ImageFolder folder_;
  std::size_t vertices_ = 0;                             // number of corners of all floor plans together
  std::set<std::string, std::less<>> population_names_;  // of the document
  std::vector<Model> models_;
  std::vector<engine::PopulationSpec> populations_;
};

void WorldExpander::expand_settings() {
  spec_.title = document_.title.empty() ? file_.stem().string() : document_.title;
  spec_.seed = options_.seed.value_or(document_.seed);
  spec_.tick_s = document_.tick;
  spec_.quit_time_s = document_.quit_time;
  spec_.measure_every_s = document_.measure_every;
  spec_.ranging = document_.ranging;
  spec_.resolution_m = document_.resolution;
  spec_.resolution_where = document_.where_of("resolution");
  // The ground is a body and may have another name, as in Stage.
  if (document_.ground && !document_.ground->alias.empty())
    spec_.aliases.push_back({spec_.names.add(document_.ground->alias), BodyId(0)});
  if (const auto& record = document_.record)
    spec_.record = engine::RecordSpec{.file = record->file,
                                      .fields = record->fields,
                                      .every_s = record->every,
                                      .where = record->where,
                                      .where_fields = record->where_of("fields")};
  if (document_.watch) spec_.watch = engine::watch_spec(*document_.watch);
  spec_.window = document_.window;
  spec_.mortal = document_.mortal;
  spec_.contacts = document_.contacts;
}

/// Sets the shape of a floor plan to that of its image, and extends the bounds of the world so that they
/// contain the whole image.
void WorldExpander::expand_image_plan(const FloorplanDocument& document, const DocumentPath& at,
                                      const BodySpec& body, engine::PartSpec& part) {
  const auto image = expand_image(document.image, document, at, folder_);
  if (!image) return;
  part.size = image->size;
  part.solids = floor_plan_body(*image->image, image->spec, part.size);
  part.image = image->spec;
  vertices_ += count_vertices(part.solids);
  if (vertices_ > engine::k_most_vertices) {
    at.error(
        fmt::format("the outlines of all floor plans together have more than {} corners: use simpler images",
                    engine::k_most_vertices));
    part.solids.clear();
  }
  const Pose pose_body_center = image->image->place ? image->image->place->pose_map_center : Pose();
  const Transform transform(compose(body.pose_world_body, pose_body_center));
  if (!spec_.bounds) spec_.bounds.emplace();
  for (const double x : {-part.size.x() / 2, part.size.x() / 2})
    for (const double y : {-part.size.y() / 2, part.size.y() / 2})
      spec_.bounds->extend(transform * Vec2(x, y));
}

void WorldExpander::expand_floorplan(const FloorplanDocument& document, const DocumentPath& at) {
  BodySpec body{.name = spec_.names.add(document.name), .where = document.where};
  body.pose_world_body = document.pose;
  body.pose_world_body.heading = wrap_angle(body.pose_world_body.heading);
  body.color = document.color.value_or(k_wall_color);
  engine::PartSpec part{
      .kind = "model", .returns = document.returns, .floor_plan = true, .where = document.where};
  if (document.walls) {
    if (!document.walls->empty() && check_wall_line(*document.walls, document.thickness))
      part.solids =
          wall_solids(*document.walls, document.thickness, document.image.height.value_or(k_wall_height_m));
    measure_part(part);
    if (!spec_.bounds) spec_.bounds.emplace();
    for (const Vec2& point : *document.walls) spec_.bounds->extend(Transform(body.pose_world_body) * point);
  } else {
    expand_image_plan(document, at, body, part);
  }
  // If the image has an error, the world still gets bounds. Otherwise each population without a region would
  // cause a further error.
  if (!spec_.bounds) spec_.bounds.emplace().extend(Vec2::Zero());
  add_walls(body, std::move(part));
}

void WorldExpander::expand_arena(const ArenaDocument& document) {
  if (!document.size) return;  // the reader has reported the missing size
  const Vec2 corner((*document.size)[0] / 2, (*document.size)[1] / 2);
  if (!spec_.bounds) spec_.bounds.emplace();
  spec_.bounds->extend(corner);
  spec_.bounds->extend(Vec2(-corner));
  if (!document.walls) return;
  const double x = corner.x() + document.thickness / 2;
  const double y = corner.y() + document.thickness / 2;
  const Ring middle{{-x, -y}, {x, -y}, {x, y}, {-x, y}, {-x, -y}};
  engine::PartSpec part{.kind = "model", .floor_plan = true, .where = document.where};
  part.solids = wall_solids(middle, document.thickness, document.height);
  measure_part(part);
  BodySpec body{.name = spec_.names.add("arena"), .where = document.where};
  body.color = document.color.value_or(k_wall_color);
  add_walls(body, std::move(part));
}

void WorldExpander::add_walls(BodySpec body, engine::PartSpec part) {
  body.type = TypeId(spec_.types.size());
  engine::TypeSpec type{.name = std::string(spec_.names.text(body.name))};
  type.parts.push_back(std::move(part));
  spec_.types.push_back(std::move(type));
  spec_.bodies.push_back(body);
}

void WorldExpander::expand_types(const DocumentPath& world) {
  type_colors_.resize(spec_.types.size());
  const DocumentPath all(world, "types", document_.where_of("types"));
  for (const auto& [key, type] : document_.types) {
    type_ids_.emplace(key, TypeId(spec_.types.size()));
    spec_.types.push_back(
        expand_type(type, key, DocumentPath(all, key, type.where), registry_, folder_, are_types_right_));
    type_colors_.push_back(type.color);
  }
  default_colors_ = default_colors(spec_.types);
}

void WorldExpander::expand_model(const ModelDocument& document, const DocumentPath& at) {
  Model model;
  model.pointer = at.pointer();
  model.body.where = document.where;
  model.body.name = spec_.names.add(document.name);
  model.body.type = type_of(document.type, document, at);
  model.body.pose_world_body = document.pose;
  model.body.pose_world_body.heading = wrap_angle(model.body.pose_world_body.heading);
  model.body.color = document.color.value_or(color_of(model.body.type));
  if (!document.alias.empty()) model.alias = spec_.names.add(document.alias);
  const bool has_right_type = model.body.type != TypeId(0) && are_types_right_;
  const std::vector<engine::PartSpec>& parts = spec_.types[model.body.type.index()].parts;
  const DocumentPath global(at, "global_parts", document.where_of("global_parts"));
  for (std::size_t i = 0; has_right_type && i < document.global_parts.size(); ++i) {
    const std::string& name = document.global_parts[i];
    if (std::ranges::find(parts, name, &engine::PartSpec::name) != parts.end()) continue;
    std::vector<std::string_view> known;
    for (const engine::PartSpec& part : parts)
      if (!part.name.empty()) known.push_back(part.name);  // the root part has no name
    DocumentPath(global, i, global.where())
        .error(fmt::format("the type \"{}\" of this model has no part \"{}\"; known: {}",
                           spec_.types[model.body.type.index()].name, name,
                           known.empty() ? "none" : comma_list(known)));
  }
  model.global_parts = document.global_parts;
  if (!document.reserve_of.empty()) model.reserve_of = document.reserve_of;
  if (document.fiducial_return) {
    model.body.fiducial = *document.fiducial_return;
    if (has_right_type && model.body.fiducial != 0 && !parts.empty() && parts.front().returns.fiducial == 0)
      DocumentPath(at, "fiducial_return", document.where_of("fiducial_return"))
          .error(fmt::format("a model can have its own \"fiducial_return\" only if its type has one: give "
                             "the type \"{}\" a \"fiducial_return\" that is not 0",
                             spec_.types[model.body.type.index()].name));
  }
  if (!model.reserve_of && has_right_type) check_population_of(model, at);
  models_.push_back(std::move(model));
}

std::vector<std::string_view> WorldExpander::populations_of(std::string_view name) const {
  std::vector<std::string_view> found;
  const std::size_t least = std::max<std::size_t>(engine::without_number(name).size(), 1);
  for (std::size_t size = least; size < name.size(); ++size)
    if (const auto one = population_names_.find(name.substr(0, size)); one != population_names_.end())
      found.push_back(*one);
  return found;
}

/// Reports an error if the name of a model that is not static is that of a population or of a body of a
/// population: measures and interventions find populations by the names of their bodies.
void WorldExpander::check_population_of(const Model& model, const DocumentPath& at) {
  if (population_names_.empty() || engine::is_static(spec_.types[model.body.type.index()])) return;
  const std::string name = spec_.names.text(model.body.name);
  if (population_names_.contains(name))
    at.error(fmt::format("\"{}\" is also the name of a population: choose another name for the model", name));
  for (const std::string_view population : populations_of(name))
    at.error(
        fmt::format("a body called \"{}\" would belong to the population \"{}\", whose bodies are "
                    "{}0, {}1, ...: choose another name for the model",
                    name, population, population, population));
}

void WorldExpander::expand_population(const PopulationDocument& document, const DocumentPath& at) {
  engine::PopulationSpec population{
      .name = document.name, .path = at.pointer() + "/place", .where = document.where};
  population.type = type_of(document.type, document, at);
  population.count = static_cast<std::size_t>(document.count.value_or(0));
  population.reserve = static_cast<std::size_t>(document.reserve);
  population.random_color = document.color && document.color->is_random;
  population.color = document.color ? document.color->color : color_of(population.type);
  if (document.place) {
    population.rule = expand_rule(*document.place, DocumentPath(at, "place", document.place->where));
    population.where_place = document.place->where;
  }
  // The bodies of "r" are r0, r1, ... and those of "r2" are r20, r21, ..., so that r20 could belong to
  // either.
  for (const std::string_view other : populations_of(document.name))
    DocumentPath(at, "name", document.where_of("name"))
        .error(fmt::format(
            "the names of the populations \"{}\" and \"{}\" differ only in digits at the end, so a body "
            "of one could have the same name as a body of the other: append a character that is not a "
            "digit to one of the two names, as in \"{}_\"",
            other, document.name, document.name));
  populations_.push_back(std::move(population));
}

PlacementRule WorldExpander::expand_rule(const PlaceDocument& document, const DocumentPath& at) {
  const auto pair = [](const std::array<double, 2>& xy) { return Vec2(xy[0], xy[1]); };
  PlacementRule rule;
  if (document.rule) rule.kind = *document.rule;
  expand_region(document, at, rule);
  rule.spill = document.spill.value_or(Box());
  Box polygon;
  for (const Vec2& corner : rule.polygon) polygon.extend(corner);
  if (document.spill && !polygon.empty() && !polygon.touches(rule.spill))
    DocumentPath(at, "spill_m", document.where_of("spill_m"))
        .error(
            "outside \"polygon_m\", in which all bodies must lie: give a rectangle that overlaps the "
            "polygon, or remove \"spill_m\"");
  rule.jitter_m = document.jitter;
  if (document.pitch) rule.pitch_m = *document.pitch;
  if (document.mean) rule.mean = pair(*document.mean);
  if (document.deviation) rule.deviation = pair(*document.deviation);
  if (document.distance) rule.distance_m = *document.distance;
  if (document.from) rule.from = pair(*document.from);
  if (document.cell) rule.cell_m = *document.cell;
  if (document.heading) {
    if (!document.heading->is_random) rule.heading = wrap_angle(document.heading->rad);
  } else if (rule.kind == PlacementRule::Kind::grid) {
    rule.heading = 0;
  }
  rule.z = document.z;
  return rule;
}

/// Sets the region in which the origins of the bodies must lie: a box, a polygon, or the intersection of
/// both. If the document has neither, the region is the bounds of the world. In a world without bounds, the
/// rule `gaussian` needs no region, and any other rule is then an error. If the world has no bounds because
/// of an error in the keys that give them, only that error is reported.
void WorldExpander::expand_region(const PlaceDocument& document, const DocumentPath& at,
                                  PlacementRule& rule) {
  if (document.polygon) rule.polygon = *document.polygon;
  for (const Vec2& corner : rule.polygon) rule.region.extend(corner);
  if (document.region) rule.region = *document.region;
  if (document.says("region_m") || document.region || !rule.polygon.empty()) return;
  if (spec_.bounds)
    rule.region = *spec_.bounds;
  else if (rule.kind == PlacementRule::Kind::gaussian)
    rule.region = Box::around(Vec2::Zero(), k_max_size_m);
  else if (!diagnostics_.has_errors() ||
           !(document_.says("bounds_m") || document_.says("floorplans") || document_.says("arena")))
    at.error(
        "missing \"region_m\", [[x_min, y_min], [x_max, y_max]] (or \"polygon_m\"), which is needed because "
        "the world has no bounds, floor plans or arena");
}

TypeId WorldExpander::type_of(const std::string& name, const Placed& object, const DocumentPath& at) {
  if (name.empty()) return TypeId(0);
  if (const auto found = type_ids_.find(name); found != type_ids_.end()) return found->second;
  if (type_ids_.empty() && !are_types_right_) return TypeId(0);  // the value of "types" is no object
  std::vector<std::string_view> known;
  for (const auto& [known_name, id] : type_ids_) known.push_back(known_name);
  DocumentPath(at, "type", object.where_of("type")).error(unknown_name("type", name, std::move(known)));
  return TypeId(0);
}

void WorldExpander::place_bodies() {
  // At this point, the only bodies are the ground, the floor plans and the walls of the arena.
  const auto kept = std::make_shared<engine::Occupancy>(spec_, spec_.bodies.size());
  engine::Occupancy& occupancy = *kept;
  make_shapes(occupancy);
  if (diagnostics_.has_errors()) return;
  for (const Model& model : models_) check_model(model, occupancy);
  for (const Model& model : models_) {
    const BodyId body(spec_.bodies.size());
    name_parts(model, body);
    if (model.reserve_of) add_to_reserve(*model.reserve_of, body, model.body.type);
    spec_.bodies.push_back(model.body);
  }
  const std::size_t first = spec_.bodies.size();
  const engine::Crowd of_models = options_.place_again != nullptr ? occupancy.crowd() : engine::Crowd();
  engine::place(populations_, spec_, occupancy,
                {.threads = options_.threads, .most_bodies = options_.most_bodies}, diagnostics_);
  occupancy.crowd() = engine::Crowd();  // place_again() does not read it, and it is large
  if (!diagnostics_.has_errors()) report_separated_robots(first);
  if (options_.populations)
    for (const engine::PopulationSpec& population : populations_)
      options_.populations->push_back(population.name);
  if (options_.place_again == nullptr || populations_.empty() || diagnostics_.has_errors()) return;
  *options_.place_again = [kept, of_models, first, populations = populations_, bounds = spec_.bounds,
                           files = spec_.files](std::vector<BodySpec>& bodies, std::uint64_t seed) {
    Diagnostics found(files);
    engine::place_again(populations, std::span(bodies).subspan(first), seed, bounds, *kept, of_models, found);
    found.throw_if_errors();
  };
}

/// Warns of each population whose robots start on both sides of the closed walls of a floor plan. The rule
/// `uniform` places them so in a round arena, because its region is a rectangle. first: index of the first
/// body of a population
void WorldExpander::report_separated_robots(std::size_t first) {
  for (const FloorplanDocument& plan : document_.floorplans) {
    if (!plan.walls || !is_closed(*plan.walls) || !plan.returns.obstacle) continue;
    const Solid area = placed(Solid{.contours = {*plan.walls}}, plan.pose);
    const auto is_inside = [&area](const BodySpec& body) {
      return contains(area, body.pose_world_body.position());
    };
    std::size_t next = first;
    for (const engine::PopulationSpec& population : populations_) {
      const std::span<const BodySpec> robots =
          std::span(spec_.bodies).subspan(next, std::min(population.count, k_most_located));
      next += population.count + population.reserve;
      if (!engine::is_mobile(spec_.types[population.type.index()])) continue;
      const auto inside = std::ranges::find_if(robots, is_inside);
      const auto outside = std::ranges::find_if_not(robots, is_inside);
      if (inside == robots.end() || outside == robots.end()) continue;
      diagnostics_.warning(
          population.where_place,
          fmt::format(
              "{}: \"{}\" starts inside the closed walls of floor plan \"{}\", and \"{}\" outside: use "
              "the rule free_floor, or give a \"polygon_m\" on one side of the walls; if both sides are "
              "meant, "
              "write one population for each side",
              population.path, spec_.names.text(inside->name), plan.name, spec_.names.text(outside->name)));
    }
  }
}

/// Reports every type whose shape is too complex for placing bodies, even if the type has no bodies.
void WorldExpander::make_shapes(engine::Occupancy& occupancy) {
  for (const auto& [name, type] : type_ids_) try {
      occupancy.shape(type);
    } catch (const std::length_error& error) {
      diagnostics_.error(spec_.types[type.index()].parts.front().where,
                         fmt::format("/types/{}: {}", escape_pointer_token(std::string(name)), error.what()));
    }
}

/// Adds a body to the reserve of a population: the bodies that may enter the world during the run. The spec
/// stores reserves as ranges (engine::ReserveSpec) of bodies with consecutive ids, of one population and one
/// type. The body extends the last range if its id, population and type fit; otherwise it starts a new range.
void WorldExpander::add_to_reserve(const std::string& population, BodyId body, TypeId type) {
  auto& reserves = spec_.reserves;
  if (!reserves.empty()) {
    engine::ReserveSpec& last = reserves.back();
    const bool follows = last.first.index() + last.count == body.index();
    if (follows && last.population == population && spec_.bodies[last.first.index()].type == type) {
      ++last.count;
      return;
    }
  }
  reserves.push_back({population, body, 1});
}

void WorldExpander::check_model(const Model& model, engine::Occupancy& occupancy) {
  engine::Crowd& crowd = occupancy.crowd();
  const bool overlaps_are_errors = document_.overlaps == WorldDocument::Check::error;
  if (model.reserve_of) return crowd.add(k_no_shape, {});  // not born yet
  const BodySpec& body = model.body;
  const partition::ObstacleShape& shape = occupancy.shape(body.type);
  if (overlaps_are_errors && !shape.empty()) report_overlaps(model, shape, occupancy);
  if (spec_.bounds && engine::is_mobile(spec_.types[body.type.index()]) &&
      !spec_.bounds->contains(body.pose_world_body.position()))
    diagnostics_.error(
        body.where,
        fmt::format(
            "{}: \"{}\" is at [{:.10g}, {:.10g}] m, outside the bounds of the world, [[{:.10g}, {:.10g}], "
            "[{:.10g}, {:.10g}]] m: move the model, or change \"bounds_m\"",
            model.pointer, spec_.names.text(body.name), body.pose_world_body.x, body.pose_world_body.y,
            spec_.bounds->min.x(), spec_.bounds->min.y(), spec_.bounds->max.x(), spec_.bounds->max.y()));
  crowd.add(shape, body.pose_world_body);
}

/// Bodies that should only touch may overlap by rounding errors.
constexpr double k_tolerance_m = 1e-9;

/// Returns the depth, m, of an overlap above the tolerance: the largest inset of the shape of a body at which
/// the body still overlaps the other one. Bisection finds this inset. still_overlaps(inner): whether the body
/// would overlap the other one if its shape were `inner`.
template <class StillOverlaps>
double overlap_depth(const partition::ObstacleShape& shape, const StillOverlaps& still_overlaps) {
  double low = k_tolerance_m;
  double high = shape.thinnest / 2;
  for (int i = 0; i < 40 && low < high; ++i) {
    const double middle = (low + high) / 2;
    (still_overlaps(partition::inset(shape, middle)) ? low : high) = middle;
  }
  return low;
}

/// Reports the bodies that a body overlaps by more than the tolerance. Two static bodies may overlap, because
/// neither will move: walls are drawn across one another at their corners.
void WorldExpander::report_overlaps(const Model& model, const partition::ObstacleShape& shape,
                                    engine::Occupancy& occupancy) {
  const BodySpec& body = model.body;
  const Pose& pose = body.pose_world_body;
  const auto is_static = [this](const BodySpec& one) {
    return engine::is_static(spec_.types[one.type.index()]);
  };
  const bool may_move = !is_static(body);
  const engine::Crowd& crowd = occupancy.crowd();
  // Returns the walls, or the numbers of the models in the crowd, that would overlap `body` if its shape were
  // `inner`.
  const auto walls_at = [&](const partition::ObstacleShape& inner) {
    return may_move ? occupancy.scene().overlapping(inner, pose) : std::vector<BodyId>();
  };
  const auto models_at = [&](const partition::ObstacleShape& inner) {
    return crowd.overlapping(inner, pose,
                             [&](std::size_t i) { return may_move || !is_static(models_[i].body); });
  };
  const auto report = [&](const BodySpec& other, const auto& still_overlaps) {
    std::string depth;
    if (diagnostics_.error_count() < Diagnostics::k_most_listed)  // further errors are only counted
      depth = fmt::format(" by {:.3g} m", overlap_depth(shape, still_overlaps));
    diagnostics_.error(
        body.where,
        fmt::format("{}: \"{}\" overlaps \"{}\"{} at the start; \"overlaps\": \"warn\" in the "
                    "world allows this",
                    model.pointer, spec_.names.text(body.name), spec_.names.text(other.name), depth));
  };
  if (walls_at(shape).empty() && models_at(shape).empty()) return;
  const partition::ObstacleShape inner = partition::inset(shape, k_tolerance_m);
  for (const BodyId wall : walls_at(inner))
    report(spec_.bodies[wall.index()], [&](const partition::ObstacleShape& smaller) {
      return std::ranges::binary_search(walls_at(smaller), wall);
    });
  // Each model is tested alone, because a large body may overlap thousands of models.
  for (const std::size_t i : models_at(inner))
    report(models_[i].body,
           [&](const partition::ObstacleShape& smaller) { return crowd.overlaps(i, smaller, pose); });
}

void WorldExpander::name_parts(const Model& model, BodyId body) {
  if (model.alias) spec_.aliases.push_back({*model.alias, body});
  for (const std::string& part : model.global_parts)
    spec_.part_aliases.insert_or_assign(part, engine::PartName{body, part});
}

void WorldExpander::report_repeated_names() {
  engine::NameMap taken;
  taken.reserve(spec_.bodies.size());
  const Where* reported = nullptr;  // place of the last error: bodies of one population have the same place
  for (std::size_t i = 0; i < spec_.bodies.size(); ++i) {
    const BodySpec& body = spec_.bodies[i];
    const BodyId first = taken.add(body.name, BodyId(i));
    if (first == BodyId(i) ||
        (reported && reported->file == body.where.file && reported->line == body.where.line))
      continue;
    const Where other = spec_.bodies[first.index()].where;
    const std::string used =
        fmt::format("the name \"{}\" is already used{}", spec_.name(BodyId(i)),
                    other.line > 0 ? fmt::format(" by the body on line {}", other.line) : std::string());
    if (document_.same_names == WorldDocument::Check::warn) {
      diagnostics_.warning_once(body.where,
                                used + ": a search for this name finds only the last body that has it");
      continue;
    }
    diagnostics_.error(body.where, used + "; \"same_names\": \"warn\" in the world allows this");
    reported = &body.where;
  }
}

}  // namespace

WorldSpec expand(const WorldDocument& document, const std::filesystem::path& file,
                 const engine::Registry& registry, const LoadOptions& options, Diagnostics& diagnostics) {
  return WorldExpander(document, file, registry, options, diagnostics).expand();
}

}  // namespace troupe::worldio
