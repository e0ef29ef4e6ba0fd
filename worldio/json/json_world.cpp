#include "worldio/json/json_world.hpp"
#include "base/math.hpp"
#include "base/random.hpp"
#include "engine/placement.hpp"
#include "worldio/images/floor_image.hpp"
#include "worldio/json/experiment_json.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_reader.hpp"
#include "worldio/json/json_settings.hpp"
#include "worldio/json/json_types.hpp"
#include "worldio/json/measures_json.hpp"
#include "worldio/load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <unordered_map>

namespace troupe::worldio {
namespace {

using engine::BodySpec;
using engine::Field;
using engine::FieldType;
using engine::PlacementRule;
using engine::Unit;
using engine::Value;
using engine::WorldSpec;

constexpr double k_max_cells = 100000000;       // of a grid rule: each may be looked at
constexpr double k_max_floor_cells = 25000000;  // in each something may be looked for
constexpr double k_scene_cell_m = 0.5;
constexpr Color k_floorplan_color{0.3f, 0.3f, 0.3f, 1};
constexpr Color k_body_color{1, 0, 0, 1};
const partition::ObstacleShape k_no_shape;

/// In the order of PlacementRule::Kind.
const std::vector<std::string_view> k_rules{"grid", "uniform", "gaussian", "poisson_disc", "free_floor"};
const engine::FieldTable k_rule{{{.name = "rule",
                                  .type = FieldType::text,
                                  .text = "grid, uniform, gaussian, poisson_disc or free_floor",
                                  .choices = k_rules}}};
const engine::FieldTable k_grid{{
    {.name = "pitch",
     .unit = Unit::meters,
     .min = 0,
     .max = k_max_size_m,
     .text = "the distance between neighbours",
     .above_min = true},
    {.name = "jitter", .unit = Unit::meters, .fallback = 0.0, .min = 0, .max = k_max_size_m},
}};
const engine::FieldTable k_gaussian{{
    {.name = "mean",
     .type = FieldType::numbers,
     .unit = Unit::meters,
     .min = -k_max_size_m,
     .max = k_max_size_m,
     .text = "[x, y], about which they are normally distributed",
     .columns = 2},
    {.name = "deviation",
     .type = FieldType::numbers,
     .unit = Unit::meters,
     .min = 0,
     .max = k_max_size_m,
     .text = "the standard deviations, [x, y]",
     .columns = 2},
}};
const engine::FieldTable k_poisson_disc{{
    {.name = "distance",
     .unit = Unit::meters,
     .min = 0.001,
     .max = k_max_size_m,
     .text = "how near two of the population may be to one another"},
}};
const Field k_from{.name = "from",
                   .type = FieldType::numbers,
                   .unit = Unit::meters,
                   .min = -k_max_size_m,
                   .max = k_max_size_m,
                   .columns = 2};
const Field k_cell{.name = "cell", .unit = Unit::meters, .min = 0.001, .max = k_max_size_m};

struct Model {
  BodySpec body;
  std::optional<engine::Name> alias;
  std::vector<std::string> global_parts;  ///< parts that have names of their own
  std::optional<std::string> reserve_of;  ///< the population into which it may be born
  std::string pointer;
};

struct Population {
  std::string name;
  TypeId type;
  std::size_t count = 0;
  std::size_t reserve = 0;
  Color color;
  bool random_color = false;
  PlacementRule rule;
  Where where;
  Where where_place;
  std::string pointer;
};

std::string too_few_places(const Population& population, std::size_t placed) {
  const PlacementRule& rule = population.rule;
  const std::string why =
      rule.kind == PlacementRule::Kind::grid
          ? fmt::format("the region has no more free cells (of {:.0f})", engine::grid_cells(rule))
          : fmt::format("{} draws found no free place for the next{}", rule.trials,
                        rule.kind == PlacementRule::Kind::free_floor ? " on the floor that is reached" : "");
  return fmt::format("{}/place: placed {} of {} bodies: {}", population.pointer, placed, population.count,
                     why);
}

/// Of body i of a population whose colours are random.
void set_color(const Population& population, std::uint64_t seed, std::size_t i, BodySpec& body) {
  if (!population.random_color) return;
  Random random(seed, stream_id("color", population.name), static_cast<std::uint32_t>(i), 0);
  body.color.r = static_cast<float>(random.uniform());
  body.color.g = static_cast<float>(random.uniform());
  body.color.b = static_cast<float>(random.uniform());
  body.color.a = 1;
}

class WorldReader {
 public:
  WorldReader(const std::filesystem::path& file, const engine::Registry& registry, const LoadOptions& options,
              Diagnostics& diagnostics)
      : file_(file),
        registry_(registry),
        options_(options),
        diagnostics_(diagnostics),
        images_(diagnostics) {}

  WorldSpec read(const JsonNode& document) {
    spec_.title = file_.stem().string();
    spec_.files = diagnostics_.files();
    engine::add_ground(spec_);
    const JsonCursor root(document, diagnostics_);
    JsonObject object(root);
    checks_ = read_settings(object, options_, spec_);
    const std::optional<Box> bounds = spec_.bounds;  // beat those of the floor plans
    each(object, "floorplans", [&](const JsonCursor& at) { read_floorplan(at); });
    if (bounds) spec_.bounds = bounds;
    read_types(object);
    each(object, "models", [&](const JsonCursor& at) { read_model(at); });
    each(object, "populations", [&](const JsonCursor& at) { read_population(at); });
    each(object, "measures", [&](const JsonCursor& at) {
      if (auto measure = read_measure(at, registry_)) spec_.measures.push_back(std::move(*measure));
    });
    std::vector<std::string> type_keys(spec_.types.size());
    for (const auto& [key, type] : type_ids_) type_keys[type.index()] = key;
    read_experiment(object, type_keys, registry_, spec_);
    object.finish();
    // Bodies are placed only in a world that is otherwise right: their findings would follow from the others.
    if (!diagnostics_.has_errors()) place_bodies();
    if (!diagnostics_.has_errors()) report_repeated_names();
    return std::move(spec_);
  }

 private:
  template <class Read>
  void each(JsonObject& object, std::string_view key, Read read) {
    const JsonNode* node = object.find(key);
    if (!node) return;
    const JsonCursor cursor(object.at(), key, *node);
    const JsonNode::List* list = read_list(cursor);
    for (std::size_t i = 0; list && i < list->size(); ++i) read(JsonCursor(cursor, i, (*list)[i]));
  }

  void read_floorplan(const JsonCursor& at);
  /// What a floor plan's image makes of it.
  struct Walls {
    Eigen::Vector3d size;
    std::vector<Solid> solids;
    engine::ImageSpec image;
    Pose pose_body_center;  ///< of the box of this size
  };
  std::optional<Walls> read_walls(JsonObject& object);
  void read_types(JsonObject& object);
  void read_model(const JsonCursor& at);
  void read_mark(JsonObject& object, engine::BodySpec& body);
  void read_population(const JsonCursor& at);
  PlacementRule read_rule(const JsonCursor& at);
  void read_region(JsonObject& object, PlacementRule& rule);
  void read_grid(JsonObject& object, PlacementRule& rule);
  void read_gaussian(JsonObject& object, PlacementRule& rule);
  void read_free_floor(JsonObject& object, PlacementRule& rule);
  void read_heading(JsonObject& object, PlacementRule& rule);
  void place_bodies();
  void check_model(const Model& model, const partition::StaticScene& scene, engine::Crowd& crowd);
  void place_population(const Population& population, const partition::StaticScene& scene,
                        engine::Crowd& crowd, partition::Parallel& parallel);
  void name_parts(const Model& model, BodyId body);
  void add_to_reserve(const std::string& population, BodyId body, TypeId type);
  void report_repeated_names();

  std::string read_name(JsonObject& object, std::string_view what);
  /// The type that the key `type` names; type 0 is the ground, for when there is none.
  TypeId read_type_name(JsonObject& object);
  Color color_of(TypeId type) const { return type_colors_[type.index()].value_or(k_body_color); }

  const std::filesystem::path& file_;
  const engine::Registry& registry_;
  const LoadOptions& options_;
  Diagnostics& diagnostics_;
  WorldSpec spec_;
  JsonChecks checks_;
  std::vector<std::optional<Color>> type_colors_;          // beside spec_.types
  std::unordered_map<std::string_view, TypeId> type_ids_;  // names of the document
  FloorImages images_;                                     // plans may share one
  std::size_t vertices_ = 0;                               // of the floor plans
  double cells_ = 0;                                       // of the populations on grids
  std::vector<Model> models_;
  std::vector<Population> populations_;
  std::vector<partition::ObstacleShape> shapes_;  // beside spec_.types
};

void WorldReader::read_floorplan(const JsonCursor& at) {
  JsonObject object(at);
  const std::string name = read_name(object, "floor plan");
  BodySpec body{.name = spec_.names.add(name), .color = k_floorplan_color, .where = at.where()};
  body.pose_world_body = read_pose(object);
  body.pose_world_body.heading = wrap_angle(body.pose_world_body.heading);
  if (const JsonNode* node = object.find("color"))
    body.color = read_color(JsonCursor(at, "color", *node)).value_or(body.color);
  engine::PartSpec part{
      .kind = "model", .returns = read_returns(object), .floor_plan = true, .where = at.where()};
  if (const auto walls = read_walls(object)) {
    part.size = walls->size;
    part.solids = walls->solids;
    part.image = walls->image;
    vertices_ += count_vertices(part.solids);
    if (vertices_ > engine::k_most_vertices) {
      at.error(fmt::format("too large: the outlines of the floor plans have more than {} corners",
                           engine::k_most_vertices));
      part.solids.clear();
    }
    const Transform transform(compose(body.pose_world_body, walls->pose_body_center));
    if (!spec_.bounds) spec_.bounds.emplace();
    for (const double x : {-part.size.x() / 2, part.size.x() / 2})
      for (const double y : {-part.size.y() / 2, part.size.y() / 2})
        spec_.bounds->extend(transform * Vec2(x, y));
  } else if (!spec_.bounds) {
    spec_.bounds.emplace().extend(
        Vec2::Zero());  // else populations would be told that there is no floor plan
  }
  object.finish();
  body.type = TypeId(spec_.types.size());
  engine::TypeSpec type{.name = name};
  type.parts.push_back(std::move(part));
  spec_.types.push_back(std::move(type));
  spec_.bodies.push_back(body);
}

/// Empty when anything is wrong, which is then reported.
std::optional<WorldReader::Walls> WorldReader::read_walls(JsonObject& object) {
  const auto given = read_image(object, images_, file_.parent_path());
  if (!given) return {};
  Walls walls{.size = given->size, .image = given->spec};
  walls.solids = floor_plan_body(*given->image, given->spec, walls.size);
  if (given->image->place) walls.pose_body_center = given->image->place->pose_map_center;
  return walls;
}

void WorldReader::read_types(JsonObject& object) {
  if (const JsonNode* node = object.find("types")) {
    const JsonCursor at(object.at(), "types", *node);
    if (!node->object()) at.expected("an object of types by name");
    type_colors_.resize(spec_.types.size());
    ImageFolder images{images_, file_.parent_path()};
    if (const JsonNode::Object* members = node->object())
      for (const JsonMember& member : *members) {
        JsonType type = read_type(JsonCursor(at, member.key, member.node), member.key, registry_, images);
        type_ids_.emplace(member.key, TypeId(spec_.types.size()));
        spec_.types.push_back(std::move(type.spec));
        type_colors_.push_back(type.color);
      }
  }
  type_colors_.resize(spec_.types.size());
}

/// A number of its own for fiducial finders, of a body whose type is marked.
void WorldReader::read_mark(JsonObject& object, engine::BodySpec& body) {
  using Limits = std::numeric_limits<std::int32_t>;
  const JsonNode* node = object.find("fiducial_return");
  const engine::Value value = read_field(object, {.name = "fiducial_return",
                                                  .type = engine::FieldType::integer,
                                                  .min = Limits::min(),
                                                  .max = Limits::max()});
  if (!node || !value.given()) return;
  body.fiducial = static_cast<std::int32_t>(value.integer());
  const JsonCursor at(object.at(), "fiducial_return", *node);
  if (body.fiducial == 0)
    at.error("must not be 0: only a type without one is not marked");
  else if (spec_.types[body.type.index()].parts.front().returns.fiducial == 0)
    at.error("needs a type with a \"fiducial_return\", which says that its robots are marked");
}

void WorldReader::read_model(const JsonCursor& at) {
  JsonObject object(at);
  Model model;
  model.pointer = at.pointer();
  model.body.where = at.where();
  model.body.name = spec_.names.add(read_name(object, "model"));
  model.body.type = read_type_name(object);
  model.body.pose_world_body = read_pose(object);
  model.body.pose_world_body.heading = wrap_angle(model.body.pose_world_body.heading);
  model.body.color = color_of(model.body.type);
  if (const JsonNode* node = object.find("color"))
    model.body.color = read_color(JsonCursor(at, "color", *node)).value_or(model.body.color);
  if (const JsonNode* node = object.find("alias"))
    if (const std::string* alias = read_text(JsonCursor(at, "alias", *node), "another name of the model"))
      model.alias = spec_.names.add(*alias);
  each(object, "global_parts", [&](const JsonCursor& part) {
    if (const std::string* name = read_text(part, "the name of a part")) {
      const auto& parts = spec_.types[model.body.type.index()].parts;
      if (std::ranges::find(parts, *name, &engine::PartSpec::name) == parts.end())
        part.error(fmt::format("the model has no part \"{}\"", *name));
      model.global_parts.push_back(*name);
    }
  });
  if (const JsonNode* node = object.find("reserve_of"))
    if (const std::string* of = read_text(JsonCursor(at, "reserve_of", *node), "the name of a population"))
      model.reserve_of = *of;
  read_mark(object, model.body);
  object.finish();
  models_.push_back(std::move(model));
}

void WorldReader::read_population(const JsonCursor& at) {
  JsonObject object(at);
  Population population{.where = at.where(), .pointer = at.pointer()};
  population.name = read_name(object, "population");
  population.type = read_type_name(object);
  const engine::FieldTable table{{{.name = "count",
                                   .type = FieldType::integer,
                                   .min = 0,
                                   .max = options_.most_bodies,
                                   .text = "how many bodies"},
                                  {.name = "reserve",
                                   .type = FieldType::integer,
                                   .fallback = 0,
                                   .min = 0,
                                   .max = options_.most_bodies,
                                   .text = "how many more may be born"}}};
  const engine::Record counts = read_fields(object, table);
  if (counts[0].given()) population.count = static_cast<std::size_t>(counts[0].integer());
  population.reserve = static_cast<std::size_t>(counts[1].integer());
  population.color = color_of(population.type);
  if (const JsonNode* node = object.find("color")) {
    const std::string* name = node->text();
    population.random_color = name && *name == "random";
    if (!population.random_color)
      population.color = read_color(JsonCursor(at, "color", *node)).value_or(population.color);
  }
  if (const JsonNode* node = object.require("place", "{\"rule\": ..., \"region_m\": ...}")) {
    population.rule = read_rule(JsonCursor(at, "place", *node));
    population.where_place = node->where;
  }
  object.finish();
  populations_.push_back(std::move(population));
}

PlacementRule WorldReader::read_rule(const JsonCursor& at) {
  JsonObject object(at);
  PlacementRule rule;
  const Value kind = read_fields(object, k_rule)[0];
  const bool known = kind.given();
  if (known)
    rule.kind = static_cast<PlacementRule::Kind>(std::ranges::find(k_rules, kind.text()) - k_rules.begin());
  read_region(object, rule);
  if (known) switch (rule.kind) {
      case PlacementRule::Kind::grid: read_grid(object, rule); break;
      case PlacementRule::Kind::uniform: break;
      case PlacementRule::Kind::gaussian: read_gaussian(object, rule); break;
      case PlacementRule::Kind::poisson_disc: {
        const Value distance = read_fields(object, k_poisson_disc)[0];
        if (distance.given()) rule.distance_m = distance.number();
        break;
      }
      case PlacementRule::Kind::free_floor: read_free_floor(object, rule); break;
    }
  read_heading(object, rule);
  const Value z =
      read_field(object, {.name = "z", .unit = Unit::meters, .min = -k_max_size_m, .max = k_max_size_m});
  if (z.given()) rule.z = z.number();
  if (known) object.finish();
  return rule;
}

/// Where the bodies' origins may lie: in a box, a polygon, or both; else where robots may be.
void WorldReader::read_region(JsonObject& object, PlacementRule& rule) {
  if (const JsonNode* node = object.find("polygon_m")) {
    const JsonCursor at(object.at(), "polygon_m", *node);
    rule.polygon = read_points(at, 3);
    if (!rule.polygon.empty())
      if (const Result<> outline = check_outline(rule.polygon); !outline) at.error(outline.error().text);
    for (const Vec2& corner : rule.polygon) rule.region.extend(corner);
  }
  const bool has_box = object.find("region_m") != nullptr;
  if (const auto box = read_box(object, "region_m")) rule.region = *box;
  if (has_box || !rule.polygon.empty()) return;
  if (spec_.bounds)
    rule.region = *spec_.bounds;
  else if (rule.kind == PlacementRule::Kind::gaussian)
    rule.region = Box::around(Vec2::Zero(), k_max_size_m);
  else
    object.missing("region_m",
                   "[[x_min, y_min], [x_max, y_max]], or \"polygon_m\", as there is no floor plan to fill");
}

void WorldReader::read_grid(JsonObject& object, PlacementRule& rule) {
  rule.spill = read_box(object, "spill_m").value_or(Box());
  const engine::Record record = read_fields(object, k_grid);
  rule.jitter_m = record[1].number();
  if (!record[0].given() || rule.region.empty()) return;
  rule.pitch_m = record[0].number();
  const double cells = grid_cells(rule);
  cells_ += cells;
  if (cells > k_max_cells)
    object.at().error(fmt::format("the region has {:.4g} cells of {:.10g} m; at most {:.0f} are looked at",
                                  cells, rule.pitch_m, k_max_cells));
  else if (cells_ > k_max_cells)
    object.at().error(
        fmt::format("the regions of all populations have {:.4g} cells so far; at most {:.0f} are looked at",
                    cells_, k_max_cells));
}

void WorldReader::read_gaussian(JsonObject& object, PlacementRule& rule) {
  const engine::Record record = read_fields(object, k_gaussian);
  if (record[0].given()) rule.mean = {record[0].numbers()[0], record[0].numbers()[1]};
  if (record[1].given()) rule.deviation = {record[1].numbers()[0], record[1].numbers()[1]};
}

void WorldReader::read_free_floor(JsonObject& object, PlacementRule& rule) {
  const Value from = read_field(object, k_from);
  if (from.given()) rule.from = Vec2(from.numbers()[0], from.numbers()[1]);
  const Value cell = read_field(object, k_cell);
  if (cell.given()) rule.cell_m = cell.number();
}

void WorldReader::read_heading(JsonObject& object, PlacementRule& rule) {
  const Field field = engine::pose_fields().fields[3];
  const JsonNode* word = object.at().node().find("heading");
  if (word && word->text() && *word->text() == "random") {
    object.find("heading");
    for (const auto& suffix : engine::unit_suffixes(field.unit))
      if (object.find(std::string(field.name) + std::string(suffix.suffix)))
        object.at().error_at(word->where,
                             fmt::format("give \"heading\": \"random\" or {}, not both", quoted_keys(field)));
    return;
  }
  const Value heading = read_field(object, field);
  if (heading.given())
    rule.heading = wrap_angle(heading.number());
  else if (rule.kind == PlacementRule::Kind::grid)
    rule.heading = 0;
}

std::string WorldReader::read_name(JsonObject& object, std::string_view what) {
  const JsonNode* node = object.require("name", fmt::format("the {}'s name", what));
  if (!node) return {};
  const std::string* name = read_text(JsonCursor(object.at(), "name", *node), "a name");
  return name ? *name : std::string();
}

TypeId WorldReader::read_type_name(JsonObject& object) {
  const JsonNode* node = object.require("type", "the name of one of /types");
  if (!node) return TypeId(0);
  const JsonCursor at(object.at(), "type", *node);
  const std::string* name = read_text(at, "the name of one of /types");
  if (!name) return TypeId(0);
  if (const auto found = type_ids_.find(*name); found != type_ids_.end()) return found->second;
  std::vector<std::string_view> known;
  for (const auto& [known_name, id] : type_ids_) known.push_back(known_name);
  at.error(unknown_name("type", *name, std::move(known)));
  return TypeId(0);
}

void WorldReader::place_bodies() {
  double total = static_cast<double>(spec_.bodies.size() + models_.size());
  for (const Population& population : populations_)
    total += static_cast<double>(population.count) + static_cast<double>(population.reserve);
  if (total > options_.most_bodies) {
    diagnostics_.error(populations_.empty() ? models_.back().body.where : populations_.back().where,
                       fmt::format("the world would hold {:.0f} bodies; at most {:.0f} are allowed", total,
                                   options_.most_bodies));
    return;
  }
  spec_.bodies.reserve(static_cast<std::size_t>(total));

  std::vector<partition::FixedSolid> walls;
  for (std::size_t i = 0; i < spec_.bodies.size(); ++i) {
    const BodySpec& body = spec_.bodies[i];
    for (const engine::PartSpec& part : spec_.types[body.type.index()].parts)
      for (const Solid& solid : part.solids)
        if (part.returns.obstacle)  // whether rangers see it, nobody asks here
          walls.push_back({placed(solid, body.pose_world_body), BodyId(i), true, -1});
  }
  partition::StaticScene scene(std::move(walls), k_scene_cell_m);
  shapes_.resize(spec_.types.size());
  for (const auto& [name, type] : type_ids_) try {
      shapes_[type.index()] = engine::obstacle_shape(spec_.types[type.index()]);
    } catch (const std::length_error& fault) {
      diagnostics_.error(spec_.types[type.index()].parts.front().where,
                         fmt::format("/types/{}: {}", escape_pointer_token(std::string(name)), fault.what()));
    }
  if (diagnostics_.has_errors()) return;

  engine::Crowd crowd;
  for (const Model& model : models_) check_model(model, scene, crowd);
  for (const Model& model : models_) {
    const BodyId body(spec_.bodies.size());
    name_parts(model, body);
    if (model.reserve_of) add_to_reserve(*model.reserve_of, body, model.body.type);
    spec_.bodies.push_back(model.body);
  }
  const engine::Crowd of_models = options_.place_again ? crowd : engine::Crowd();
  const std::size_t first = spec_.bodies.size();
  partition::Parallel parallel(options_.threads);
  for (const Population& population : populations_) place_population(population, scene, crowd, parallel);
  if (!options_.place_again || populations_.empty() || diagnostics_.has_errors()) return;
  // Crowds refer to shapes, which stay where they are while the list of them moves.
  auto shapes = std::make_shared<const std::vector<partition::ObstacleShape>>(std::move(shapes_));
  auto kept = std::make_shared<const partition::StaticScene>(std::move(scene));
  *options_.place_again = [shapes, kept, of_models, first, populations = populations_, bounds = spec_.bounds,
                           files = spec_.files](std::vector<BodySpec>& bodies, std::uint64_t seed) {
    engine::Crowd placed = of_models;
    partition::Parallel one_thread(1);
    std::size_t body = first;
    for (const Population& population : populations) {
      const std::vector<Pose> poses =
          engine::place(population.rule, (*shapes)[population.type.index()], population.count, seed,
                        population.name, bounds, *kept, placed, one_thread);
      if (poses.size() < population.count) {
        Diagnostics found(files);
        found.error(population.where_place, too_few_places(population, poses.size()));
        found.throw_if_errors();
      }
      for (std::size_t i = 0; i < poses.size(); ++i) bodies[body + i].pose_world_body = poses[i];
      for (std::size_t i = 0; i < population.count + population.reserve; ++i)
        set_color(population, seed, i, bodies[body + i]);
      body += population.count + population.reserve;
    }
  };
}

/// Bodies of one reserve follow one another.
void WorldReader::add_to_reserve(const std::string& population, BodyId body, TypeId type) {
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

void WorldReader::check_model(const Model& model, const partition::StaticScene& scene, engine::Crowd& crowd) {
  if (model.reserve_of) return crowd.add(k_no_shape, {});  // it is not there yet
  const BodySpec& body = model.body;
  const partition::ObstacleShape& shape = shapes_[body.type.index()];
  const auto overlaps = [&](const BodySpec& other) {
    diagnostics_.error(body.where, fmt::format("{}: \"{}\" overlaps \"{}\" at the start", model.pointer,
                                               spec_.names.text(body.name), spec_.names.text(other.name)));
  };
  if (checks_.overlaps && !shape.empty())
    for (const BodyId wall : scene.overlapping(shape, body.pose_world_body))
      overlaps(spec_.bodies[wall.index()]);
  if (checks_.overlaps)
    for (const std::size_t i : crowd.overlapping(shape, body.pose_world_body)) overlaps(models_[i].body);
  if (spec_.bounds && engine::is_mobile(spec_.types[body.type.index()]) &&
      !spec_.bounds->contains(body.pose_world_body.position()))
    diagnostics_.error(body.where, fmt::format("{}: \"{}\" stands outside of the floor plans", model.pointer,
                                               spec_.names.text(body.name)));
  crowd.add(shape, body.pose_world_body);
}

void WorldReader::place_population(const Population& population, const partition::StaticScene& scene,
                                   engine::Crowd& crowd, partition::Parallel& parallel) {
  const bool on_floor = population.rule.kind == PlacementRule::Kind::free_floor;
  const double cells =
      on_floor ? engine::floor_cells(population.rule, shapes_[population.type.index()]) : 0.0;
  if (cells > k_max_floor_cells) {
    diagnostics_.error(population.where_place,
                       fmt::format("{}/place: the region has {:.4g} cells; at most {:.0f} are looked at: "
                                   "give a larger \"cell_m\"",
                                   population.pointer, cells, k_max_floor_cells));
    return;
  }
  const std::vector<Pose> poses =
      engine::place(population.rule, shapes_[population.type.index()], population.count, spec_.seed,
                    population.name, spec_.bounds, scene, crowd, parallel);
  if (poses.size() < population.count)
    diagnostics_.error(population.where_place, too_few_places(population, poses.size()));
  if (population.reserve > 0)
    spec_.reserves.push_back({population.name, BodyId(spec_.bodies.size() + poses.size()),
                              static_cast<std::uint32_t>(population.reserve)});
  for (std::size_t i = 0; i < poses.size() + population.reserve; ++i) {
    BodySpec& body = spec_.bodies.emplace_back();
    body.name = spec_.names.add(population.name, static_cast<std::uint32_t>(i));
    body.type = population.type;
    if (i < poses.size()) body.pose_world_body = poses[i];
    body.color = population.color;
    body.where = population.where;
    set_color(population, spec_.seed, i, body);
  }
}

void WorldReader::name_parts(const Model& model, BodyId body) {
  if (model.alias) spec_.aliases.push_back({*model.alias, body});
  for (const std::string& part : model.global_parts)
    spec_.part_aliases.insert_or_assign(part, engine::PartName{body, part});
}

void WorldReader::report_repeated_names() {
  engine::NameMap taken;
  taken.reserve(spec_.bodies.size());
  const Where* reported = nullptr;  // one finding a population is enough
  for (std::size_t i = 0; i < spec_.bodies.size(); ++i) {
    const BodySpec& body = spec_.bodies[i];
    const BodyId first = taken.add(body.name, BodyId(i));
    if (first == BodyId(i) ||
        (reported && reported->file == body.where.file && reported->line == body.where.line))
      continue;
    if (!checks_.same_names) {
      diagnostics_.warning_once(body.where,
                                fmt::format("the name \"{}\" is taken already; looking it up finds the last",
                                            spec_.name(BodyId(i))));
      continue;
    }
    const Where other = spec_.bodies[first.index()].where;
    diagnostics_.error(
        body.where,
        fmt::format("the name \"{}\" is taken{}", spec_.name(BodyId(i)),
                    other.line > 0 ? fmt::format(" by the body of line {}", other.line) : std::string()));
    reported = &body.where;
  }
}

/// The member that `--robots` sets: the count of the population of this name, or of the only one.
std::optional<std::size_t> population_index(const JsonNode& document, const std::string& name, Where where,
                                            Diagnostics& diagnostics) {
  const JsonNode* node = document.find("populations");
  const JsonNode::List* populations = node ? node->list() : nullptr;
  std::vector<std::string_view> names;
  if (populations)
    for (const JsonNode& population : *populations) {
      const JsonNode* its_name = population.find("name");
      names.push_back(its_name && its_name->text() ? std::string_view(*its_name->text())
                                                   : std::string_view());
    }
  if (names.empty()) {
    diagnostics.error(where, "the world has no population whose size could be set");
    return std::nullopt;
  }
  if (name.empty()) {
    if (names.size() == 1) return 0;
    diagnostics.error(where,
                      fmt::format("the world has {} populations: say which, NAME=COUNT with NAME one of {}",
                                  names.size(), comma_list(names)));
    return std::nullopt;
  }
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  diagnostics.error(where, unknown_name("population", name, names));
  return std::nullopt;
}

void set_robots(JsonNode& document, const std::string& name, std::size_t count, Diagnostics& diagnostics) {
  const std::string option =
      name.empty() ? fmt::format("--robots {}", count) : fmt::format("--robots {}={}", name, count);
  const Where where{diagnostics.files()->add(option), 0};
  const auto index = population_index(document, name, where, diagnostics);
  if (!index) return;
  JsonNode& population = std::get<JsonNode::List>(document.find("populations")->value)[*index];
  auto* members = std::get_if<JsonNode::Object>(&population.value);
  if (!members) return;  // reported when it is read
  JsonNode* node = population.find("count");
  if (!node) node = &members->emplace_back(JsonMember{"count", where, {}}).node;
  node->value = static_cast<std::uint64_t>(count);
  if (count <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
    node->value = static_cast<std::int64_t>(count);
  node->where = where;
}

}  // namespace

WorldSpec read_json_world(const std::filesystem::path& file, const JsonNode& document,
                          const engine::Registry& registry, const LoadOptions& options,
                          Diagnostics& diagnostics) {
  return WorldReader(file, registry, options, diagnostics).read(document);
}

WorldSpec load_json_world(const std::filesystem::path& file, const std::string& text,
                          const engine::Registry& registry, const LoadOptions& options,
                          Diagnostics& diagnostics) {
  const Where start{diagnostics.files()->add(file.string()), 0};
  std::optional<JsonNode> document = parse_json(text, start, false, diagnostics);
  if (!document) {
    WorldSpec nothing;
    nothing.files = diagnostics.files();
    return nothing;
  }
  for (const auto& [pointer, value] : options.set) set_json_value(*document, pointer, value, diagnostics);
  for (const auto& [name, count] : options.robots) set_robots(*document, name, count, diagnostics);
  return read_json_world(file, *document, registry, options, diagnostics);
}

}  // namespace troupe::worldio
