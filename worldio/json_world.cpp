#include "base/math.hpp"
#include "base/random.hpp"
#include "engine/placement.hpp"
#include "worldio/bitmap.hpp"
#include "worldio/fields_json.hpp"
#include "worldio/floor_image.hpp"
#include "worldio/json_document.hpp"
#include "worldio/json_reader.hpp"
#include "worldio/json_record.hpp"
#include "worldio/json_types.hpp"
#include "worldio/load.hpp"
#include "worldio/measures_json.hpp"
#include "worldio/ros_map.hpp"

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

constexpr std::int64_t k_version = 1;
constexpr double k_max_cells = 100000000;  // of a grid rule: each may be looked at
constexpr double k_scene_cell_m = 0.5;
constexpr Color k_floorplan_color{0.3f, 0.3f, 0.3f, 1};
constexpr Color k_body_color{1, 0, 0, 1};

struct Model {
  BodySpec body;
  std::string pointer;
};

struct Population {
  std::string name;
  TypeId type;
  std::size_t count = 0;
  Color color;
  bool random_color = false;
  PlacementRule rule;
  Where where;
  Where where_place;
  std::string pointer;
};

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
    read_settings(object);
    each(object, "floorplans", [&](const JsonCursor& at) { read_floorplan(at); });
    read_types(object);
    each(object, "models", [&](const JsonCursor& at) { read_model(at); });
    each(object, "populations", [&](const JsonCursor& at) { read_population(at); });
    each(object, "measures", [&](const JsonCursor& at) {
      if (auto measure = read_measure(at, registry_)) spec_.measures.push_back(std::move(*measure));
    });
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

  void read_settings(JsonObject& object);
  void read_floorplan(const JsonCursor& at);
  /// What a floor plan's image makes of it.
  struct Walls {
    Eigen::Vector3d size;
    std::vector<Solid> solids;
    Pose pose_body_center;  ///< of the box of this size
  };
  std::optional<Walls> read_walls(JsonObject& object);
  void read_types(JsonObject& object);
  void read_model(const JsonCursor& at);
  void read_mark(JsonObject& object, engine::BodySpec& body);
  void read_population(const JsonCursor& at);
  PlacementRule read_rule(const JsonCursor& at);
  void read_heading(JsonObject& object, PlacementRule& rule);
  void place_bodies();
  void check_model(const Model& model, const partition::StaticScene& scene, engine::Crowd& crowd);
  void place_population(const Population& population, const partition::StaticScene& scene,
                        engine::Crowd& crowd, partition::Parallel& parallel);
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
  std::vector<std::optional<Color>> type_colors_;          // beside spec_.types
  std::unordered_map<std::string_view, TypeId> type_ids_;  // names of the document
  FloorImages images_;                                     // plans may share one
  std::size_t vertices_ = 0;                               // of the floor plans
  double cells_ = 0;                                       // of the populations on grids
  std::vector<Model> models_;
  std::vector<Population> populations_;
  std::vector<partition::ObstacleShape> shapes_;  // beside spec_.types
};

void WorldReader::read_settings(JsonObject& object) {
  if (const JsonNode* node =
          object.require("troupe", fmt::format("the version of the format, {}", k_version))) {
    const auto* version = std::get_if<std::int64_t>(&node->value);
    const JsonCursor at(object.at(), "troupe", *node);
    if (!version)
      at.expected(fmt::format("the version of the format, {}", k_version));
    else if (*version != k_version)
      at.error(fmt::format("format version {} is not known: this version reads {}", *version, k_version));
  }
  if (const JsonNode* node = object.find("title")) {
    if (const std::string* title = read_text(JsonCursor(object.at(), "title", *node), "the world's title"))
      spec_.title = *title;
  }
  if (const JsonNode* node = object.find("seed")) {
    const auto* small = std::get_if<std::int64_t>(&node->value);
    const auto* big = std::get_if<std::uint64_t>(&node->value);
    if (big)
      spec_.seed = *big;
    else if (small && *small >= 0)
      spec_.seed = static_cast<std::uint64_t>(*small);
    else
      JsonCursor(object.at(), "seed", *node).expected("a whole number from 0 to 2^64 - 1");
  }
  if (options_.seed) spec_.seed = *options_.seed;

  const Value tick = read_field(object, {.name = "tick", .unit = Unit::seconds, .min = 1e-6, .max = 3600});
  if (tick.given()) spec_.tick_s = tick.number();
  const Value quit = read_field(
      object, {.name = "quit_time", .unit = Unit::seconds, .min = 0, .max = 1e9, .above_min = true});
  if (quit.given()) spec_.quit_time_s = quit.number();
  const Value every =
      read_field(object, {.name = "measure_every", .unit = Unit::seconds, .min = 0, .max = 1e9});
  if (every.given()) spec_.measure_every_s = every.number();
  const auto& names = engine::k_ranging_engines;
  const Value ranging = read_field(
      object, {.name = "ranging", .type = FieldType::text, .choices = {names.begin(), names.end()}});
  if (ranging.given())
    spec_.ranging =
        static_cast<engine::RangingEngine>(std::ranges::find(names, ranging.text()) - names.begin());
  const Field resolution_field{.name = "resolution",
                               .unit = Unit::meters,
                               .min = engine::k_min_resolution_m,
                               .max = engine::k_max_resolution_m};
  const Value resolution = read_field(object, resolution_field);
  spec_.resolution_where = object.at().where();
  for (const engine::UnitSuffix& unit : engine::unit_suffixes(Unit::meters))
    if (const JsonNode* node = object.find(fmt::format("resolution{}", unit.suffix)))
      spec_.resolution_where = node->where;
  if (resolution.given()) spec_.resolution_m = resolution.number();
  if (const JsonNode* node = object.find("record"))
    spec_.record = read_record(JsonCursor(object.at(), "record", *node));
  if (const auto watch = read_block(object, "watch", engine::watch_fields()))
    spec_.watch = engine::watch_spec(*watch);
  spec_.window = read_block(object, "window", engine::window_fields());
}

void WorldReader::read_floorplan(const JsonCursor& at) {
  JsonObject object(at);
  const std::string name = read_name(object, "floor plan");
  BodySpec body{.name = spec_.names.add(name), .color = k_floorplan_color, .where = at.where()};
  body.pose_world_body = read_pose(object);
  if (const JsonNode* node = object.find("color"))
    body.color = read_color(JsonCursor(at, "color", *node)).value_or(body.color);
  engine::PartSpec part{
      .kind = "model", .returns = read_returns(object), .floor_plan = true, .where = at.where()};
  if (const auto walls = read_walls(object)) {
    part.size = walls->size;
    part.solids = walls->solids;
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

/// Every key is looked at, so that all that is wrong is reported; empty when anything is.
std::optional<WorldReader::Walls> WorldReader::read_walls(JsonObject& object) {
  constexpr std::string_view k_path =
      "the path of an image, or of the YAML of a map, relative to the world file";
  const JsonNode* node = object.require("bitmap", k_path);
  const std::string* path = node ? read_text(JsonCursor(object.at(), "bitmap", *node), k_path) : nullptr;
  const bool is_map = path && is_ros_map(*path);
  const engine::FieldTable common{{
      {.name = "boundary", .type = FieldType::boolean, .fallback = false},
      is_map ? Field{.name = "unknown",
                     .type = FieldType::text,
                     .fallback = "free",
                     .choices = {"free", "solid"}}
             : Field{.name = "margins",
                     .type = FieldType::text,
                     .fallback = "trim",
                     .choices = {"trim", "keep"}},
      is_map ? Field{.name = "height",
                     .unit = Unit::meters,
                     .fallback = 1.0,
                     .min = 0,
                     .max = k_max_size_m,
                     .above_min = true}
             : Field{.name = "size",
                     .type = FieldType::numbers,
                     .unit = Unit::meters,
                     .min = 0,
                     .max = k_max_size_m,
                     .text = "[x, y, height]",
                     .columns = 3,
                     .above_min = true},
  }};
  const engine::Record record = read_fields(object, common);
  if (!path || !record[2].given()) return {};
  const bool choice = record[1].text() == (is_map ? "solid" : "keep");
  const FloorImage* image = images_.read(file_.parent_path() / *path, is_map && choice, node->where);
  if (!image) return {};
  if (image->contours.empty()) {
    JsonCursor(object.at(), "bitmap", *node)
        .error(is_map ? fmt::format("\"{}\" has no occupied cell", *path)
                      : fmt::format("\"{}\" has no dark pixel: nothing of it is solid", *path));
    return {};
  }
  Walls walls;
  if (is_map) {
    walls.size << image->place->size_m, record[2].number();
    walls.pose_body_center = image->place->pose_map_center;
  } else {
    walls.size = Eigen::Vector3d::Map(record[2].numbers().data());
  }
  if (is_map || choice) {
    walls.solids.push_back(image->solid(walls.size));
  } else {
    walls.solids.push_back({image->contours, {0, 1}});
    normalise(walls.solids, walls.size);
  }
  if (record[0].boolean()) add_boundary(walls.size, walls.solids);
  if (is_map)
    for (Solid& solid : walls.solids) solid = placed(std::move(solid), walls.pose_body_center);
  return walls;
}

void WorldReader::read_types(JsonObject& object) {
  if (const JsonNode* node = object.find("types")) {
    const JsonCursor at(object.at(), "types", *node);
    if (!node->object()) at.expected("an object of types by name");
    type_colors_.resize(spec_.types.size());
    if (const JsonNode::Object* members = node->object())
      for (const JsonMember& member : *members) {
        JsonType type = read_type(JsonCursor(at, member.key, member.node), member.key, registry_);
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
                                   .text = "how many bodies"}}};
  const Value count = read_fields(object, table)[0];
  if (count.given()) population.count = static_cast<std::size_t>(count.integer());
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
  const engine::FieldTable table{
      {{.name = "rule", .type = FieldType::text, .text = "grid or uniform", .choices = {"grid", "uniform"}}}};
  const Value kind = read_fields(object, table)[0];
  const bool known = kind.given();
  if (known && kind.text() == "uniform") rule.kind = PlacementRule::Kind::uniform;

  const auto read_region = [&](std::string_view key, Box& box) {
    const JsonNode* node = object.find(key);
    if (!node) return false;
    const JsonCursor cursor(at, key, *node);
    const std::vector<Vec2> corners = read_points(cursor, 2, 2);
    if (!corners.empty() && (corners[0].x() > corners[1].x() || corners[0].y() > corners[1].y()))
      cursor.error("the corners stand the wrong way round: give [[x_min, y_min], [x_max, y_max]]");
    for (const Vec2& corner : corners) box.extend(corner);
    return true;
  };
  if (!read_region("region_m", rule.region)) {
    if (spec_.bounds)
      rule.region = *spec_.bounds;
    else
      object.missing("region_m", "[[x_min, y_min], [x_max, y_max]], as there is no floor plan to fill");
  }
  if (rule.kind == PlacementRule::Kind::grid && known) {
    read_region("spill_m", rule.spill);
    const engine::FieldTable grid{{
        {.name = "pitch",
         .unit = Unit::meters,
         .min = 0,
         .max = k_max_size_m,
         .text = "the distance between neighbours",
         .above_min = true},
        {.name = "jitter", .unit = Unit::meters, .fallback = 0.0, .min = 0, .max = k_max_size_m},
    }};
    const engine::Record record = read_fields(object, grid);
    rule.jitter_m = record[1].number();
    if (record[0].given() && !rule.region.empty()) {
      rule.pitch_m = record[0].number();
      const double cells = grid_cells(rule);
      cells_ += cells;
      if (cells > k_max_cells)
        at.error(fmt::format("the region has {:.4g} cells of {:.10g} m; at most {:.0f} are looked at", cells,
                             rule.pitch_m, k_max_cells));
      else if (cells_ > k_max_cells)
        at.error(fmt::format(
            "the regions of all populations have {:.4g} cells so far; at most {:.0f} are looked at", cells_,
            k_max_cells));
    }
  }
  read_heading(object, rule);
  const Value z =
      read_field(object, {.name = "z", .unit = Unit::meters, .min = -k_max_size_m, .max = k_max_size_m});
  if (z.given()) rule.z = z.number();
  if (known) object.finish();
  return rule;
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
  for (const Population& population : populations_) total += static_cast<double>(population.count);
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
  const partition::StaticScene scene(std::move(walls), k_scene_cell_m);
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
  for (const Model& model : models_) spec_.bodies.push_back(model.body);
  partition::Parallel parallel(options_.threads);
  for (const Population& population : populations_) place_population(population, scene, crowd, parallel);
}

void WorldReader::check_model(const Model& model, const partition::StaticScene& scene, engine::Crowd& crowd) {
  const BodySpec& body = model.body;
  const partition::ObstacleShape& shape = shapes_[body.type.index()];
  const auto overlaps = [&](const BodySpec& other) {
    diagnostics_.error(body.where, fmt::format("{}: \"{}\" overlaps \"{}\" at the start", model.pointer,
                                               spec_.names.text(body.name), spec_.names.text(other.name)));
  };
  if (!shape.empty())
    for (const BodyId wall : scene.overlapping(shape, body.pose_world_body))
      overlaps(spec_.bodies[wall.index()]);
  for (const std::size_t i : crowd.overlapping(shape, body.pose_world_body)) overlaps(models_[i].body);
  if (spec_.bounds && engine::is_mobile(spec_.types[body.type.index()]) &&
      !spec_.bounds->contains(body.pose_world_body.position()))
    diagnostics_.error(body.where, fmt::format("{}: \"{}\" stands outside of the floor plans", model.pointer,
                                               spec_.names.text(body.name)));
  crowd.add(shape, body.pose_world_body);
}

void WorldReader::place_population(const Population& population, const partition::StaticScene& scene,
                                   engine::Crowd& crowd, partition::Parallel& parallel) {
  const std::vector<Pose> poses =
      engine::place(population.rule, shapes_[population.type.index()], population.count, spec_.seed,
                    population.name, spec_.bounds, scene, crowd, parallel);
  if (poses.size() < population.count) {
    const bool grid = population.rule.kind == PlacementRule::Kind::grid;
    diagnostics_.error(
        population.where_place,
        fmt::format("{}/place: placed {} of {} bodies: {}", population.pointer, poses.size(),
                    population.count,
                    grid ? fmt::format("the region has no more free cells (of {:.0f})",
                                       engine::grid_cells(population.rule))
                         : fmt::format("{} draws found no free place for the next", population.rule.trials)));
  }
  const std::uint32_t colors = stream_id("color", population.name);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    BodySpec& body = spec_.bodies.emplace_back();
    body.name = spec_.names.add(population.name, static_cast<std::uint32_t>(i));
    body.type = population.type;
    body.pose_world_body = poses[i];
    body.color = population.color;
    body.where = population.where;
    if (!population.random_color) continue;
    Random random(spec_.seed, colors, static_cast<std::uint32_t>(i), 0);
    body.color.r = static_cast<float>(random.uniform());
    body.color.g = static_cast<float>(random.uniform());
    body.color.b = static_cast<float>(random.uniform());
    body.color.a = 1;
  }
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
  return WorldReader(file, registry, options, diagnostics).read(*document);
}

}  // namespace troupe::worldio
