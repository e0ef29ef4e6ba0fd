#include "engine/spec/add_device.hpp"
#include "engine/spec/world_spec.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/json_document.hpp"
#include "worldio/json/json_world.hpp"
#include "worldio/json/spec_difference.hpp"
#include "worldio/load.hpp"
#include "worldio/stage/stage_body.hpp"
#include "worldio/stage/stage_demos.hpp"
#include "worldio/stage/stage_kinds.hpp"
#include "worldio/stage/stage_limits.hpp"
#include "worldio/stage/stage_lint.hpp"
#include "worldio/stage/stage_models.hpp"
#include "worldio/stage/stage_parser.hpp"
#include "worldio/stage/stage_power.hpp"
#include "worldio/stage/stage_properties.hpp"
#include "worldio/stage/stage_values.hpp"
#include "worldio/stage/stage_watch.hpp"

#include "base/random.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

namespace troupe::worldio {
namespace {

using engine::TypeSpec;
using engine::WorldSpec;

/// Returns the field that describes a key of JSON worlds. The limits of the field also apply to the
/// corresponding property of a `.world` file.
template <class Document>
const engine::Field& json_field(std::string_view key) {
  return document_table<Document>().find(key)->field;
}

constexpr std::size_t k_most_entities = 20000;  // in one top-level model, after its macros are expanded
// Maximum number of entities in all distinct top-level models together. The limit exists because macros can
// multiply the entities of a file.
constexpr std::size_t k_most_parts = 1000000;

/// Properties in which bodies of one type may differ. For `fiducial_return`, only numbers other than 0 may
/// differ: it is 0 either for all bodies of the type or for none.
constexpr std::string_view k_own_keys[] = {"name", "pose", "color", "color_rgba", "fiducial_return"};
enum OwnKey : std::size_t { k_name, k_pose, k_color, k_color_rgba, k_fiducial };
using OwnProperties = std::array<const StageProperty*, std::size(k_own_keys)>;

bool is_zero(std::string_view text) { return text.find_first_not_of("+-.0") == text.npos; }

/// Makes the spec of a world from a parsed `.world` file.
class StageWorld {
 public:
  StageWorld(const StageDocument& document, std::filesystem::path file, const engine::Registry& registry,
             const LoadOptions& options, Diagnostics& diagnostics)
      : document_(document),
        file_(std::move(file)),
        registry_(registry),
        options_(options),
        values_(document, diagnostics),
        macros_(document, registry, values_),
        lint_(document, macros_, values_),
        bodies_(document, file_.parent_path(), values_, diagnostics),
        kinds_(document, registry, values_),
        power_(document, registry, values_) {}

  void read(WorldSpec& spec) {
    spec_ = &spec;
    spec.bodies.reserve(document_.items.size() + 1);
    read_world();
    engine::add_ground(spec);
    spec.aliases.push_back({generate_name("model"), BodyId(0)});  // the ground is model:0
    for (const StageItem& item : document_.items) {
      if (item.is_define) {
        macros_.define(item);
        prototypes_.clear();  // from here on, the same text may use the new macro
      } else {
        add_body(item.entity);
      }
    }
    if (values_.thorough()) macros_.report_unused();
    lint_.finish();
  }

 private:
  /// The result of reading a top-level model. Models share a Prototype if their texts are equal, apart from
  /// the properties in k_own_keys.
  struct Prototype {
    bool usable = false;                      ///< whether the model was read without errors
    const engine::ModelKind* kind = nullptr;  ///< null: the text is not a model
    TypeId type;
    OwnProperties inherited{};  ///< the properties of k_own_keys in the macros of the model
    /// Names of the parts that programs can look up without the name of the body.
    std::vector<std::string> global_parts;
  };

  /// A type that is being built.
  struct Draft {
    TypeSpec type;
    std::vector<std::string> global_parts;   ///< as in Prototype
    std::vector<const StageEntity*> inside;  ///< the macros and entities that enclose the current entity
    std::size_t entities = 0;
    Where where;  ///< place of the top-level model
    bool broken = false;
    engine::UniqueNames joint_names{engine::k_device_mark};  ///< of all joints of `type`
  };

  struct Contents {
    std::vector<StageModel> blocks;
    std::vector<StageModel> sensors;  // the sensors of a ranger
    // Each child with the entity or macro that contains it.
    std::vector<std::pair<StageModel, const StageEntity*>> children;
  };

  /// The place and the names of a part in its body.
  struct Place {
    std::uint32_t parent = 0;
    std::int32_t joint = engine::k_rigid;
    Pose pose_body_part;
    std::string name;
    std::string alias;
    bool has_own_name = false;  ///< the part or an enclosing model has a global name: "/name"
  };

  double read_unit(std::string_view key, std::initializer_list<std::pair<std::string_view, double>> units);
  void read_tick(const StageProperty& property);
  void read_resolution(const StageProperty& property);
  void read_quit_time(const StageProperty& property);
  void read_seed(const StageProperty& property);
  void read_world();
  void add_body(const StageEntity& entity);
  engine::Name generate_name(std::string_view kind);
  Prototype make_prototype(const StageEntity& entity);
  TypeId share_type(TypeSpec type, const std::vector<std::string_view>& names);
  std::optional<Contents> contents(const StageModel& model, Draft& draft);
  void add_part(const StageModel& model, const Place& place, Draft& draft);
  bool make_solids(const StageModel& model, const engine::ModelKind& kind,
                   const std::vector<StageModel>& blocks, const Pose& origin, engine::PartSpec& part,
                   Draft& draft);
  void set_appearance(const StageModel& model, const engine::ModelKind& kind, bool is_root,
                      engine::PartSpec& part);
  std::int32_t add_device(const StageModel& model, const engine::ModelKind& model_kind,
                          const std::vector<StageModel>& sensors, const Place& place,
                          const Pose& pose_body_frame, Draft& draft);
  std::int32_t add_wheels(const StageModel& model, const Place& place, Draft& draft);
  void check_extent(const StageModel& model, const engine::PartSpec& part);
  engine::Returns returns(const StageModel& model);
  std::optional<std::int64_t> mark(const StageProperty& property);
  void check_start(const StageModel& model, const engine::DriveSpec& drive);
  /// Adds the drive and the controllers of a model.
  void add_behaviour(const StageModel& model, std::uint32_t part, Draft& draft);
  void bring_devices(const engine::ControllerKind& kind, const engine::ControllerSpec& controller,
                     TypeSpec& type);
  void add_children(const StageModel& model, const Place& place, double height,
                    const std::vector<std::pair<StageModel, const StageEntity*>>& children, Draft& draft);
  /// Stores a window. Only the first window of the file is used, at any level of nesting.
  void add_window(const StageModel& window) {
    if (!spec_->window) {
      spec_->window = read_stage_window(window, document_, values_);
      window_ = window.layers.back();
    } else if (values_.thorough() && window.layers.back() != window_) {
      values_.warning(window.where,
                      fmt::format("this window has no effect: the first window, at {}, is used",
                                  values_.place(document_.token(window_->word).where(), window.where)));
    }
  }
  void write_key(const StageEntity& entity, bool is_root, std::string& key) const;
  /// Returns the colour that `name` or, without it, `rgba` gives; `fallback` if both are null. `stream` and
  /// `body` select the random numbers of the colour "random".
  Color color(const StageProperty* name, const StageProperty* rgba, const Color& fallback,
              std::string_view stream, BodyId body);

  const StageDocument& document_;
  std::filesystem::path file_;
  const engine::Registry& registry_;
  const LoadOptions& options_;
  StageValues values_;
  StageMacros macros_;
  StageLint lint_;
  StageBodies bodies_;
  StageKinds kinds_;
  StagePower power_;
  WorldSpec* spec_ = nullptr;
  const StageEntity* window_ = nullptr;  ///< the entity from which the window of `spec_` was read

  std::unordered_map<std::string, Prototype> prototypes_;
  std::unordered_map<std::string, TypeId> types_;             // keyed by compared_bytes()
  std::vector<std::vector<std::string_view>> type_names_;     // the macro names of each type, outermost first
  std::map<std::string_view, engine::Name> generated_names_;  // the last of each kind of top-level model
  engine::NameMap names_;
  std::size_t parts_ = 0;
  std::size_t vertices_ = 0;
};

/// Returns the factor of the unit that the world property `key` names; that of the first unit if the world
/// does not have the property, or if the property is wrong, which is an error.
double StageWorld::read_unit(std::string_view key,
                             std::initializer_list<std::pair<std::string_view, double>> units) {
  const StageProperty* property = document_.world_property(key);
  if (!property) return units.begin()->second;
  const auto given = values_.text(*property);
  std::vector<std::string_view> known;
  for (const auto& [unit, factor] : units) {
    if (given == unit) return factor;
    known.push_back(unit);
  }
  if (given)
    values_.error(values_.where(*property),
                  fmt::format("unknown {} \"{}\"; known: {}", key, *given, comma_list(known)));
  return units.begin()->second;
}

void StageWorld::read_tick(const StageProperty& property) {
  const auto ms = values_.number(property);
  if (!ms) return;
  const double us = std::floor(*ms * 1000);  // Stage's clock counts whole microseconds
  if (us < 1)
    values_.error(values_.where(property),
                  fmt::format("\"interval_sim\" must be at least 0.001 ms, found {}", *ms));
  else if (values_.is_within(property, json_field<WorldDocument>("tick"), us / 1e6, *ms))
    spec_->tick_s = us / 1e6;
}

void StageWorld::read_resolution(const StageProperty& property) {
  spec_->resolution_where = values_.where(property);
  const auto metres = values_.number(property);  // always in metres, not in unit_length
  if (!metres) return;
  spec_->resolution_m = *metres;
  if (!(engine::k_min_resolution_m <= *metres && *metres <= engine::k_max_resolution_m))
    values_.may_exceed(values_.where(property),
                       fmt::format("\"resolution\" must be from {} to {} m, found {}",
                                   engine::k_min_resolution_m, engine::k_max_resolution_m, *metres),
                       "only the grid ray engine (--raytracer grid) uses it");
}

void StageWorld::read_quit_time(const StageProperty& property) {
  const auto seconds = values_.number(property);
  if (!seconds) return;
  if (*seconds > 0 && values_.is_within(property, json_field<WorldDocument>("quit_time"), *seconds, *seconds))
    spec_->quit_time_s = *seconds;
  if (*seconds == 0)
    values_.explain(
        values_.where(property),
        "\"quit_time 0\" has no effect: the run does not end by itself; write quit_time 60, or give "
        "--for 60");
  if (*seconds < 0)
    values_.error(values_.where(property),
                  fmt::format("\"quit_time\" must be 0 (never) or above, in s, found {}", *seconds));
}

void StageWorld::read_seed(const StageProperty& property) {
  const auto seed = values_.integer(property);
  if (!seed) return;
  if (*seed >= 0)
    spec_->seed = static_cast<std::uint64_t>(*seed);
  else
    values_.error(values_.where(property), fmt::format("\"seed\" must be 0 or above, found {}", *seed));
}

void StageWorld::read_world() {
  lint_.check_world();
  const double length = read_unit("unit_length", {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}});
  const double angle = read_unit("unit_angle", {{"degrees", radians(1)}, {"radians", 1}});
  values_.set_units(length, angle);
  const auto property = [this](std::string_view key) { return document_.world_property(key); };
  values_.set_wraps_headings(values_.flag(property("wrap_headings"), true));
  if (const StageProperty* tick = property("interval_sim")) read_tick(*tick);
  if (const StageProperty* resolution = property("resolution")) read_resolution(*resolution);
  if (const StageProperty* quit_time = property("quit_time")) read_quit_time(*quit_time);
  if (const StageProperty* seed = property("seed")) read_seed(*seed);
  if (options_.seed) spec_->seed = *options_.seed;
  spec_->watch = read_stage_watch(document_, values_);
  spec_->title = file_.string();
  if (const StageProperty* name = property("name"))
    if (const auto title = values_.text(*name)) spec_->title = *title;
}

/// Appends the text of an entity to `key`, without the properties in k_own_keys if it is the root. Entities
/// with equal keys have equal types.
void StageWorld::write_key(const StageEntity& entity, bool is_root, std::string& key) const {
  const auto add = [&key](std::string_view text) {
    key += text;
    key += '\n';
  };
  add(document_.word(entity));
  for (const StageProperty& property : document_.properties(entity)) {
    const std::string_view name = document_.key(property);
    if (is_root && name == k_own_keys[k_fiducial] && property.count > 0) {
      add(name);
      add(is_zero(document_.value(property, 0).text) ? "0" : "marked");
      continue;
    }
    if (is_root && std::ranges::find(k_own_keys, name) != std::end(k_own_keys)) continue;
    if (is_without_effect(name)) continue;
    add(name);
    if (property.tuple) add(fmt::format("[{}", property.count));
    for (std::uint32_t i = 0; i < property.count; ++i) add(document_.value(property, i).text);
  }
  add("(");
  for (const StageEntity& child : document_.children(entity)) write_key(child, false, key);
  add(")");
}

void StageWorld::add_body(const StageEntity& entity) {
  lint_.check(entity);
  std::string key;
  write_key(entity, true, key);
  auto entry = prototypes_.find(key);
  const bool is_new = entry == prototypes_.end();
  if (is_new) entry = prototypes_.emplace(std::move(key), make_prototype(entity)).first;
  const Prototype& prototype = entry->second;
  if (!prototype.kind) {
    if (!is_new) make_prototype(entity);  // a window, or an error that has a place of its own
    return;
  }

  OwnProperties own = prototype.inherited;
  for (const StageProperty& property : document_.properties(entity))
    for (std::size_t i = 0; i < own.size(); ++i)
      if (document_.key(property) == k_own_keys[i]) own[i] = &property;

  // A body that cannot be built also uses up a generated name, so that later messages have the right names.
  const engine::Name generated = generate_name(prototype.kind->name);
  const BodyId id(spec_->bodies.size());
  engine::BodySpec body{
      .name = generated, .type = prototype.type, .where = document_.token(entity.word).where()};
  if (own[k_name])
    if (auto given = values_.name(*own[k_name])) {
      if (given->starts_with('/')) given->remove_prefix(1);
      body.name = spec_->names.add(*given);
    }
  if (own[k_pose])
    if (const auto pose = values_.pose(*own[k_pose])) body.pose_world_body = *pose;
  body.color = color(own[k_color], own[k_color_rgba], prototype.kind->color, "body", id);
  if (!prototype.usable) return;
  if (own[k_fiducial])
    if (const auto number = mark(*own[k_fiducial]);
        number && *number != spec_->types[body.type.index()].parts.front().returns.fiducial)
      body.fiducial = static_cast<std::int32_t>(*number);

  if (body.name != generated) spec_->aliases.push_back({generated, id});
  for (const std::string& part : prototype.global_parts)
    spec_->part_aliases.insert_or_assign(part, engine::PartName{id, part});
  if (const BodyId first = names_.add(body.name, id); first != id) {
    const Where where = own[k_name] ? values_.where(*own[k_name]) : body.where;
    values_.warning_once(
        where,
        fmt::format(
            "the name \"{}\" is already used by the model at {}: a search for this name finds only the "
            "last model that has it",
            spec_->names.text(body.name), values_.place(spec_->bodies[first.index()].where, where)));
  }
  spec_->bodies.push_back(body);
}

/// Returns the next generated name of a top-level model: model:0, model:1, ..., counted separately for each
/// kind.
engine::Name StageWorld::generate_name(std::string_view kind) {
  const auto [last, is_first] = generated_names_.try_emplace(kind);
  if (is_first)
    last->second = spec_->names.add(fmt::format("{}:", kind), 0);
  else
    ++last->second.number;
  return last->second;
}

StageWorld::Prototype StageWorld::make_prototype(const StageEntity& entity) {
  Prototype prototype;
  const auto model = macros_.resolve(entity);
  if (!model) return prototype;
  if (model->type == "window") {
    add_window(*model);
    return prototype;
  }
  if (model->type == "block" || model->type == "sensor") {
    values_.error(model->where, fmt::format("a {} must be inside a {}, not at the top level", model->type,
                                            model->type == "block" ? "model" : "ranger"));
    return prototype;
  }
  prototype.kind = registry_.model(model->type);

  StageModel inherited = *model;
  inherited.layers.pop_back();
  for (std::size_t i = 0; i < prototype.inherited.size(); ++i)
    prototype.inherited[i] = inherited.find(document_, k_own_keys[i]);

  Draft draft{.where = model->where};
  add_part(*model, Place{}, draft);
  if (draft.broken) return prototype;
  power_.finish(draft.type);
  prototype.global_parts = std::move(draft.global_parts);
  prototype.type = share_type(std::move(draft.type), model->names);
  prototype.usable = true;
  return prototype;
}

/// Returns the id of a type that equals `type`; adds `type` if there is none. `names` are the macros that the
/// body is made from. A type is named after the outermost macro that all its bodies have in common, or after
/// their model type.
TypeId StageWorld::share_type(TypeSpec type, const std::vector<std::string_view>& names) {
  // Each body has its own fiducial number, so types are only compared by whether the root has one at all.
  std::int32_t& mark = type.parts.front().returns.fiducial;
  const std::int32_t number = std::exchange(mark, mark != 0 ? 1 : 0);
  const auto [entry, is_new] = types_.try_emplace(compared_bytes(type), TypeId(spec_->types.size()));
  mark = number;
  const TypeId id = entry->second;
  if (is_new) {
    spec_->types.push_back(std::move(type));
    type_names_.resize(spec_->types.size());
    type_names_[id.index()] = names;
  }
  std::vector<std::string_view>& common = type_names_[id.index()];
  std::size_t shared = 0;
  while (shared < std::min(common.size(), names.size()) &&
         common[common.size() - 1 - shared] == names[names.size() - 1 - shared])
    ++shared;
  if (shared > 0) common.erase(common.begin(), common.end() - static_cast<std::ptrdiff_t>(shared));
  spec_->types[id.index()].name = common.front();
  return id;
}

/// Resolves the children of a model and divides them into blocks, sensors and models. Empty, with an error,
/// if the macros of the model expand beyond a limit.
std::optional<StageWorld::Contents> StageWorld::contents(const StageModel& model, Draft& draft) {
  Contents out;
  const auto fail = [&](Where where, std::string message) {
    values_.error(where, std::move(message));
    draft.broken = true;
    return std::nullopt;
  };
  for (const StageModel::Child& child : model.children(document_)) {
    if (++parts_ > k_most_parts)
      return fail(draft.where,
                  fmt::format("too large: with its macros expanded, the world contains more than {} "
                              "models and blocks: use smaller macros",
                              k_most_parts));
    if (++draft.entities > k_most_entities)
      return fail(draft.where,
                  fmt::format("with its macros expanded, this model contains more than {} models and blocks: "
                              "use smaller macros",
                              k_most_entities));
    if (draft.inside.size() >= k_deepest_nesting)
      return fail(draft.where,
                  fmt::format("with its macros expanded, this model contains models or blocks nested more "
                              "than {} levels deep: nest fewer",
                              k_deepest_nesting));
    auto resolved = macros_.resolve(*child.entity);
    if (!resolved) {
      draft.broken = true;
      continue;
    }
    const auto itself = std::ranges::find_if(resolved->layers, [&](const StageEntity* layer) {
      return layer == child.layer || std::ranges::find(draft.inside, layer) != draft.inside.end();
    });
    if (itself != resolved->layers.end()) {
      fail(resolved->where, fmt::format("macro \"{}\" contains itself: remove this model from the macro",
                                        document_.word(**itself)));
      continue;
    }
    const bool is_piece = resolved->type == "block" || resolved->type == "sensor";
    if (is_piece)
      for (const StageModel::Child& inner : resolved->children(document_))
        fail(document_.token(inner.entity->word).where(),
             fmt::format("a {} can contain only properties, not \"{}\"", resolved->type,
                         document_.word(*inner.entity)));
    if (resolved->type == "block")
      out.blocks.push_back(std::move(*resolved));
    else if (resolved->type == "sensor" && model.type == "ranger")
      out.sensors.push_back(std::move(*resolved));
    else if (resolved->type == "sensor")
      fail(resolved->where,
           fmt::format("a sensor must be inside a ranger, not inside a model of type {}", model.type));
    else if (resolved->type == "window")
      add_window(*resolved);
    else
      out.children.emplace_back(std::move(*resolved), child.layer);
  }
  return out;
}

/// Adds a model as a part of a body, with its devices, its controllers and the models inside it.
void StageWorld::add_part(const StageModel& model, const Place& place, Draft& draft) {
  const engine::ModelKind& kind = *registry_.model(model.type);
  const std::optional<Contents> holds = contents(model, draft);
  if (!holds) return;

  engine::PartSpec part{.name = place.name, .alias = place.alias, .kind = std::string(kind.name)};
  part.parent = place.parent;
  part.joint = place.joint;
  part.pose_body_part = place.pose_body_part;
  part.where = model.where;
  part.size = kind.size;
  if (const StageProperty* property = model.find(document_, "size"))
    if (const auto size = values_.size(*property, kind.size.z())) part.size = *size;
  Pose origin;
  if (const StageProperty* property = model.find(document_, "origin"))
    if (const auto given = values_.pose(*property)) origin = *given;
  if (!make_solids(model, kind, holds->blocks, origin, part, draft)) return;
  check_extent(model, part);
  set_appearance(model, kind, draft.type.parts.empty(), part);
  const double height = part.size.z();
  const auto index = static_cast<std::uint32_t>(draft.type.parts.size());
  draft.type.parts.push_back(std::move(part));

  Place below = place;
  below.parent = index;
  below.joint = add_device(model, kind, holds->sensors, place, compose(place.pose_body_part, origin), draft);
  if (model.type == "position" && index > 0) below.joint = add_wheels(model, place, draft);
  power_.read(model, index, draft.type);
  add_behaviour(model, index, draft);
  add_children(model, below, height, holds->children, draft);
}

/// Sets the solids of a part, in the frame of the body, and the image or blocks that they come from.
/// `origin` is the value of the property `origin`. False, with an error, if the world then has too many
/// vertices.
bool StageWorld::make_solids(const StageModel& model, const engine::ModelKind& kind,
                             const std::vector<StageModel>& blocks, const Pose& origin,
                             engine::PartSpec& part, Draft& draft) {
  StageBody body = bodies_.make(model, kind, part.size, blocks);
  part.solids = std::move(body.solids);
  part.image = std::move(body.image);
  if (part.image) part.image->origin = origin;
  if (!body.blocks.empty()) part.fitted = engine::FittedBlocks{std::move(body.blocks), origin};
  vertices_ += count_vertices(part.solids);
  if (vertices_ > engine::k_most_vertices) {
    values_.error(
        draft.where,
        fmt::format("the outlines of all models together have more than {} corners: use simpler shapes",
                    engine::k_most_vertices));
    draft.broken = true;
    return false;
  }
  const Pose pose_body_frame = compose(part.pose_body_part, origin);
  const Transform to_body(pose_body_frame);
  for (Solid& solid : part.solids) {
    for (Ring& ring : solid.contours)
      for (Vec2& point : ring) point = to_body * point;
    solid.z = solid.z.shifted(pose_body_frame.z);
  }
  return true;
}

/// Sets how other bodies collide with a part and sense it, and how the part is drawn.
void StageWorld::set_appearance(const StageModel& model, const engine::ModelKind& kind, bool is_root,
                                engine::PartSpec& part) {
  const auto find = [&](std::string_view key) { return model.find(document_, key); };
  part.returns = returns(model);
  if (!is_root) part.color = color(find("color"), find("color_rgba"), kind.color, part.name, BodyId(0));
  part.floor_plan = find("bitmap") != nullptr;
}

/// Adds the device of a model. The part of the model must be the last part of the draft. Returns the joint
/// that moves this part and the parts that are mounted on it.
std::int32_t StageWorld::add_device(const StageModel& model, const engine::ModelKind& model_kind,
                                    const std::vector<StageModel>& sensors, const Place& place,
                                    const Pose& pose_body_frame, Draft& draft) {
  const engine::DeviceKind* kind = registry_.device(model_kind.device);
  if (!kind) return place.joint;
  const std::size_t index = draft.type.parts.size() - 1;
  auto device = model.type == "ranger"    ? kinds_.ranger(model, sensors)
                : model.type == "gripper" ? kinds_.gripper(model, *kind, draft.type.parts[index].size)
                                          : kinds_.device(model, *kind);
  if (!device) return place.joint;
  device->name = place.name;
  device->part = static_cast<std::uint32_t>(index);
  device->joint = place.joint;
  device->pose_body_device = pose_body_frame;
  const std::size_t d = engine::add_device(draft.type, std::move(*device), *kind, draft.joint_names);
  std::int32_t joint = place.joint;
  if (model.type == "actuator")  // an actuator moves its own part and the parts on it
    draft.type.parts[index].joint = joint = draft.type.devices[d].moves;
  if (draft.type.parts[index].solids.empty() && !values_.flag(model.find(document_, "noblocks"), false))
    engine::add_device_body(draft.type, d, *kind);
  return joint;
}

/// Adds the drive of a position model inside another model. The part of the position model must be the last
/// part of the draft. Returns the joint that moves this part and the parts that are mounted on it.
std::int32_t StageWorld::add_wheels(const StageModel& model, const Place& place, Draft& draft) {
  const engine::DeviceKind* kind = registry_.device("wheels");
  if (!kind) return place.joint;
  auto device = kinds_.wheels(model, *kind);
  if (!device) return place.joint;
  const std::size_t index = draft.type.parts.size() - 1;
  device->name = place.name;
  device->part = static_cast<std::uint32_t>(index);
  device->joint = place.joint;
  device->pose_body_device = place.pose_body_part;
  const std::size_t d = engine::add_device(draft.type, std::move(*device), *kind, draft.joint_names);
  return draft.type.parts[index].joint = draft.type.devices[d].moves;
}

/// Checks the size of a model that has a body. Reports an error if the size is 0 along x or y, and a warning
/// if only the height is 0; for a gripper, a height of 0 is also an error. Warns of a bumper whose size is
/// the default.
void StageWorld::check_extent(const StageModel& model, const engine::PartSpec& part) {
  const StageProperty* property = model.find(document_, "size");
  const Where where = property ? values_.where(*property) : model.where;
  const bool is_gripper = model.type == "gripper";  // it gets its body together with its paddles
  const bool has_body = !part.solids.empty() || is_gripper;
  const bool is_flat = part.size.head<2>().minCoeff() > 0 && !is_gripper;
  if (has_body && !(part.size.minCoeff() > 0)) {
    if (is_flat)
      values_.warning_once(where,
                           "\"size\" gives this model a height (third value) of 0, so only bodies and beams "
                           "exactly at the z of the model meet the model: give a height above 0");
    else if (part.size.minCoeff() == 0)
      values_.error(where, is_gripper ? "\"size\" of a gripper must be above 0 in every direction, found 0"
                                      : "\"size\" must be above 0 in x and y, found 0");
  }
  if (model.type == "bumper" && !property && !part.solids.empty())
    values_.warning_once(
        model.where, fmt::format("as in Stage, a bumper without \"size\" has a body of {:g} m x {:g} m x "
                                 "{:g} m; give it a \"size\" (or \"noblocks 1\", if it should have no body)",
                                 part.size.x(), part.size.y(), part.size.z()));
}

/// Reads the `..._return` properties and `fiducial_key`, which say how other bodies collide with the model
/// and sense it.
engine::Returns StageWorld::returns(const StageModel& model) {
  engine::Returns returns;
  const auto read = [&](std::string_view key, auto& member, auto value) {
    if (const StageProperty* property = model.find(document_, key))
      if (const auto given = value(*property)) member = static_cast<std::decay_t<decltype(member)>>(*given);
  };
  const auto flag = [this](const StageProperty& property) { return values_.flag(property); };
  const auto intensity = [this](const StageProperty& property) {
    std::optional<double> given = values_.number(property);
    if (given && !values_.is_within(property, json_field<PartDocument>("ranger_return"), *given, *given))
      given.reset();
    return given;
  };
  read("obstacle_return", returns.obstacle, flag);
  read("ranger_return", returns.ranger, intensity);
  const auto mark_of = [this](const StageProperty& property) { return mark(property); };
  read("fiducial_return", returns.fiducial, mark_of);
  read("fiducial_key", returns.fiducial_key, mark_of);
  read("gripper_return", returns.gripper, flag);
  read("blob_return", returns.blob, flag);
  return returns;
}

/// Reads a number for fiducial finders: a whole number that fits in 32 bits. Empty, with an error, for any
/// other value.
std::optional<std::int64_t> StageWorld::mark(const StageProperty& property) {
  using Limits = std::numeric_limits<std::int32_t>;
  const auto given = values_.integer(property);
  if (!given || (Limits::min() <= *given && *given <= Limits::max())) return given;
  values_.error(values_.where(property),
                fmt::format("\"{}\" must be a whole number from -2147483648 to 2147483647, found {}",
                            values_.key(property), *given));
  return {};
}

/// Warns of a `velocity` that the drive replaces before the first motion.
void StageWorld::check_start(const StageModel& model, const engine::DriveSpec& drive) {
  const StageProperty* property = model.find(document_, "velocity");
  if (property == nullptr || drive.period_s > spec_->tick_s) return;
  const engine::FieldTable& table = registry_.drive(drive.kind)->params;
  const bool is_zero =
      std::ranges::all_of(std::array{"start_x", "start_y", "start_turn"}, [&](const char* name) {
        return table.find(name) < 0 || engine::get(table, drive.params, name).number() == 0;
      });
  if (is_zero) return;
  values_.explain(
      values_.where(*property),
      fmt::format("\"velocity\" has no effect: at its first update, after {:g} ms and before the first "
                  "motion, the drive replaces this initial speed; write update_interval 3600000 to keep "
                  "it for an hour, or command the speed with a controller",
                  drive.period_s * 1000));
}

void StageWorld::add_behaviour(const StageModel& model, std::uint32_t part, Draft& draft) {
  const bool is_root = part == 0;
  const bool is_position = model.type == "position";
  if (is_position && is_root) {
    draft.type.drive = kinds_.drive(model);
    if (draft.type.drive) check_start(model, *draft.type.drive);
  }
  const StageProperty* ctrl = model.find(document_, "ctrl");
  if (!ctrl) return;
  for (engine::ControllerSpec& controller : kinds_.controllers(model)) {
    const engine::ControllerKind* kind = registry_.controller(controller.kind);
    if (kind != nullptr && kind->needs_drive && !is_position) {
      values_.error(values_.where(*ctrl),
                    fmt::format("controller \"{}\" must be in a model of type position, which "
                                "has a drive; {} is of type {}",
                                controller.kind, is_root ? "this model" : "this model, inside another model,",
                                model.type));
      continue;
    }
    controller.part = part;
    if (kind != nullptr) bring_devices(*kind, controller, draft.type);
    if (kind != nullptr)
      if (const StageAddition add = stage_addition(controller.kind))
        if (const Result<> added =
                add(controller.params, spec_->seed, registry_, draft.type, controller.part);
            !added)
          values_.warning_once(values_.where(*ctrl), fmt::format("controller \"{}\" has no effect: it {}",
                                                                 controller.kind, added.error().text));
    draft.type.controllers.push_back(std::move(controller));
  }
}

/// Adds the devices that a controller needs and that every model of Stage has without declaring them.
void StageWorld::bring_devices(const engine::ControllerKind& kind, const engine::ControllerSpec& controller,
                               TypeSpec& type) {
  for (const std::string_view name : kind.brings) {
    const engine::DeviceKind* device = registry_.device(name);
    const bool is_there = std::ranges::any_of(type.devices, [&](const engine::DeviceSpec& spec) {
      return spec.kind == name && spec.part == controller.part;
    });
    if (device == nullptr || is_there) continue;
    const std::string& below = type.parts[controller.part].name;
    type.devices.push_back({.name = below.empty() ? std::string(name) : fmt::format("{}.{}", below, name),
                            .kind = std::string(name),
                            .part = controller.part,
                            .joint = type.parts[controller.part].joint,
                            .params = device->params.defaults(),
                            .period_s = controller.period_s,
                            .where = controller.where});
  }
}

void StageWorld::add_children(const StageModel& model, const Place& place, double height,
                              const std::vector<std::pair<StageModel, const StageEntity*>>& children,
                              Draft& draft) {
  const bool is_stacked = values_.flag(model.find(document_, "stack_children"), true);
  std::map<std::string_view, std::size_t> generated_names;
  const auto below = [&place](std::string_view last) {
    return place.name.empty() ? std::string(last) : fmt::format("{}.{}", place.name, last);
  };
  for (const auto& [child, layer] : children) {
    Place child_place{.parent = place.parent,
                      .joint = place.joint,
                      .pose_body_part = place.pose_body_part,
                      .has_own_name = place.has_own_name};
    child_place.name = below(fmt::format("{}:{}", child.type, generated_names[child.type]++));
    if (const StageProperty* property = child.find(document_, "name"))
      if (const auto given = values_.name(*property)) {
        child_place.alias = std::move(child_place.name);
        const bool is_global = given->starts_with('/');
        child_place.has_own_name = child_place.has_own_name || is_global;
        child_place.name = is_global ? std::string(given->substr(1)) : below(*given);
      }
    if (child_place.has_own_name) draft.global_parts.push_back(child_place.name);
    if (is_stacked) child_place.pose_body_part.z += height;
    if (const StageProperty* property = child.find(document_, "pose"))
      if (const auto pose = values_.pose(*property))
        child_place.pose_body_part = compose(child_place.pose_body_part, *pose);
    values_.is_in_reach(child.where, child_place.pose_body_part.z - place.pose_body_part.z,
                        "this model, with the height of the model that carries it,");
    draft.inside.push_back(layer);
    add_part(child, child_place, draft);
    draft.inside.pop_back();
  }
}

Color StageWorld::color(const StageProperty* name, const StageProperty* rgba, const Color& fallback,
                        std::string_view stream, BodyId body) {
  if (name) {
    if (values_.text(*name) == "random") {
      Random random(spec_->seed, stream_id("color", stream), body.value, 0);
      Color drawn;
      for (float* part : {&drawn.r, &drawn.g, &drawn.b}) *part = static_cast<float>(random.uniform());
      return drawn;
    }
    return values_.color(*name).value_or(fallback);
  }
  if (rgba) return values_.color_rgba(*rgba).value_or(fallback);
  return fallback;
}

/// Returns the world with the changes of --set. A `.world` file has no JSON keys, so the values are set in
/// the JSON document that `troupe convert` would write for the world.
WorldSpec changed(const WorldSpec& spec, const std::filesystem::path& file, const engine::Registry& registry,
                  const LoadOptions& options, Diagnostics& diagnostics) {
  std::optional<JsonNode> document = write_json_world(spec, file, registry, diagnostics);
  if (!document) return spec;
  for (const auto& [pointer, value] : options.set) set_json_value(*document, pointer, value, diagnostics);
  LoadOptions reading = options;
  reading.most_bodies = LoadOptions().most_bodies;  // the caller's limit is only for JSON worlds
  return read_json_world(file, *document, registry, reading, diagnostics);
}

}  // namespace

WorldSpec load_stage_world(const std::filesystem::path& file, std::string text,
                           const engine::Registry& registry, const LoadOptions& options,
                           Diagnostics& diagnostics) {
  WorldSpec spec;
  spec.files = diagnostics.files();
  const Where whole{diagnostics.files()->add(file.string()), 0};
  spec.resolution_where = whole;
  if (!options.robots.empty())
    diagnostics.error(whole,
                      "the number of robots can be set only in a .json world with populations; a .world "
                      "file lists its robots one by one");
  const StageDocument document = parse_stage(file, std::move(text), options.search_path, diagnostics);
  if (document.well_nested) StageWorld(document, file, registry, options, diagnostics).read(spec);
  if (options.set.empty() || diagnostics.has_errors()) return spec;
  return changed(spec, file, registry, options, diagnostics);
}

}  // namespace troupe::worldio
