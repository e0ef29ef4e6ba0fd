#include "worldio/json/world_schema.hpp"

#include "engine/ranging_engine.hpp"
#include "engine/watch_spec.hpp"
#include "engine/world_spec.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/json_types.hpp"
#include "worldio/load.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Unit;
using engine::UnitSuffix;
using engine::Value;
using Members = JsonNode::Object;

JsonNode object_of(std::initializer_list<std::pair<std::string_view, JsonNode>> members) {
  Members object;
  for (const auto& [key, node] : members) add_node(object, key, node);
  return json_node(std::move(object));
}

JsonNode list_of(std::vector<JsonNode> nodes) { return json_node(JsonNode::List(std::move(nodes))); }

JsonNode text(std::string_view value) { return json_node(std::string(value)); }

template <class Names>
JsonNode texts(const Names& names) {
  JsonNode::List list;
  for (const auto& name : names) list.push_back(text(name));
  return json_node(std::move(list));
}

JsonNode type(std::string_view name) { return object_of({{"type", text(name)}}); }

JsonNode reference(std::string_view name) {
  return object_of({{"$ref", text(fmt::format("#/definitions/{}", name))}});
}

JsonNode array_of(JsonNode items) {
  return object_of({{"type", text("array")}, {"items", std::move(items)}});
}

JsonNode array_of(JsonNode items, std::size_t count) {
  return object_of({{"type", text("array")},
                    {"items", std::move(items)},
                    {"minItems", json_node(static_cast<std::int64_t>(count))},
                    {"maxItems", json_node(static_cast<std::int64_t>(count))}});
}

JsonNode choice(std::vector<JsonNode> nodes, std::string_view how = "anyOf") {
  return object_of({{how, list_of(std::move(nodes))}});
}

JsonNode described(JsonNode schema, std::string_view about) {
  if (!about.empty()) add_node(std::get<Members>(schema.value), "description", text(about));
  return schema;
}

double rounded_to_digits(double x) {
  constexpr int k_digits = 10;
  std::array<char, 32> digits{};
  const auto [end, fault] =
      std::to_chars(digits.data(), digits.data() + digits.size(), x, std::chars_format::general, k_digits);
  double rounded = 0;
  std::from_chars(digits.data(), end, rounded);
  return rounded;
}

/// A limit in another unit, in few digits and no tighter than the reader's; `outward` is 1 for a maximum.
double limit_in(const UnitSuffix& suffix, double si, double outward) {
  if (suffix.to_si == 1) return si;
  constexpr double k_digits = 1e-9;
  const double limit = si / suffix.to_si;
  const double rounded = rounded_to_digits(limit);
  const bool is_tighter = (limit - rounded) * outward > 0;
  return is_tighter ? rounded_to_digits(limit + outward * k_digits * std::abs(limit)) : rounded;
}

void add_limits(const Field& field, const UnitSuffix& suffix, Members& schema) {
  if (std::isfinite(field.min))
    add_member(schema, field.above_min ? "exclusiveMinimum" : "minimum", limit_in(suffix, field.min, -1));
  if (std::isfinite(field.max)) add_member(schema, "maximum", limit_in(suffix, field.max, 1));
}

JsonNode number_schema(const Field& field, const UnitSuffix& suffix, std::string_view name) {
  Members schema;
  add_member(schema, "type", std::string(name));
  add_limits(field, suffix, schema);
  return json_node(std::move(schema));
}

JsonNode table_schema(const FieldTable& table);

JsonNode value_schema(const Field& field, const UnitSuffix& suffix) {
  switch (field.type) {
    case FieldType::boolean: return type("boolean");
    case FieldType::integer: return number_schema(field, suffix, "integer");
    case FieldType::number: return number_schema(field, suffix, "number");
    case FieldType::text:
      return field.choices.empty() ? type("string") : object_of({{"enum", texts(field.choices)}});
    case FieldType::numbers: {
      JsonNode numbers = number_schema(field, suffix, "number");
      return field.columns > 0 ? array_of(std::move(numbers), field.columns) : array_of(std::move(numbers));
    }
    case FieldType::colors: return array_of(reference("color"));
    case FieldType::record:
      return field.record == &engine::pose_fields() ? reference("pose") : table_schema(*field.record);
    case FieldType::records: return array_of(table_schema(*field.record));
  }
  return {};
}

void add_default(const Field& field, const UnitSuffix& suffix, Members& schema) {
  if (suffix.to_si != 1 || std::holds_alternative<std::vector<engine::Record>>(field.fallback.v)) return;
  Members one;
  Field bare = field;
  bare.unit = Unit::none;
  write_field(bare, field.fallback, one);
  if (!one.empty()) add_node(schema, "default", std::move(one.front().node));
}

/// The schema of an object that has these keys and no others.
class ObjectSchema {
 public:
  ObjectSchema& member(std::string_view key, JsonNode schema, std::string_view about = {}) {
    add_node(properties_, key, described(std::move(schema), about));
    return *this;
  }

  ObjectSchema& required(std::string_view key, JsonNode schema, std::string_view about = {}) {
    required_.push_back(text(key));
    return member(key, std::move(schema), about);
  }

  /// A field under each of its keys, of which one is given; `required`: and must be.
  ObjectSchema& field(const Field& field, bool required) {
    const auto suffixes = engine::unit_suffixes(field.unit);
    std::vector<JsonNode> one_of;
    for (const UnitSuffix& suffix : suffixes) {
      const std::string key = fmt::format("{}{}", field.name, suffix.suffix);
      JsonNode schema = described(value_schema(field, suffix), field.text);
      add_default(field, suffix, std::get<Members>(schema.value));
      add_node(properties_, key, std::move(schema));
      one_of.push_back(object_of({{"required", texts(std::array{key})}}));
    }
    if (suffixes.size() == 1) {
      if (required) required_.push_back(text(fmt::format("{}{}", field.name, suffixes.front().suffix)));
      return *this;
    }
    if (!required) one_of.push_back(object_of({{"not", choice(one_of)}}));
    rules_.push_back(choice(std::move(one_of), "oneOf"));
    return *this;
  }

  ObjectSchema& optional(const Field& one) { return field(one, false); }

  ObjectSchema& fields(const FieldTable& table, bool with_defaults = true) {
    const engine::Record defaults = table.defaults();
    for (std::size_t i = 0; i < table.fields.size(); ++i)
      field(table.fields[i], with_defaults && !defaults[i].given());
    return *this;
  }

  ObjectSchema& rule(JsonNode schema) {
    rules_.push_back(std::move(schema));
    return *this;
  }

  JsonNode done() {
    Members schema;
    add_member(schema, "type", std::string("object"));
    add_member(schema, "properties", std::move(properties_));
    add_member(schema, "additionalProperties", false);
    if (!required_.empty()) add_member(schema, "required", std::move(required_));
    if (!rules_.empty()) add_member(schema, "allOf", std::move(rules_));
    return json_node(std::move(schema));
  }

 private:
  Members properties_;
  JsonNode::List required_;
  JsonNode::List rules_;
};

JsonNode table_schema(const FieldTable& table) { return ObjectSchema().fields(table).done(); }

const Field k_size{.name = "size",
                   .type = FieldType::numbers,
                   .unit = Unit::meters,
                   .min = 0,
                   .max = k_max_size_m,
                   .text = "x, y and height of a box that stands on the floor",
                   .columns = 3,
                   .above_min = true};

/// A number or whole number without a unit, text or truth.
Field bare(std::string_view name, FieldType type, std::string_view about,
           double min = -std::numeric_limits<double>::infinity(),
           double max = std::numeric_limits<double>::infinity()) {
  return {.name = name, .type = type, .min = min, .max = max, .text = about};
}

Field measure(std::string_view name, Unit unit, std::string_view about, double min, double max,
              bool above_min = false) {
  return {.name = name, .unit = unit, .min = min, .max = max, .text = about, .above_min = above_min};
}

Field chosen(std::string_view name, std::vector<std::string_view> choices, std::string_view about) {
  return {.name = name, .type = FieldType::text, .text = about, .choices = std::move(choices)};
}

JsonNode color_schema() {
  JsonNode level = number_schema(bare("", FieldType::number, "", 0, 1), {"", "", 1}, "number");
  return choice({object_of({{"type", text("string")},
                            {"description", text("a name of X11's list: red, SteelBlue, gray30, ...")}}),
                 object_of({{"type", text("array")},
                            {"description", text("[red, green, blue] or [red, green, blue, opacity]")},
                            {"items", std::move(level)},
                            {"minItems", json_node(std::int64_t{3})},
                            {"maxItems", json_node(std::int64_t{4})}})});
}

void add_returns(ObjectSchema& object) {
  constexpr double k_most_return = 1e6;
  using Marks = std::numeric_limits<std::int32_t>;
  object.optional(bare("obstacle", FieldType::boolean, "whether it blocks bodies"))
      .optional(bare("ranger_return", FieldType::number,
                     "the intensity that rangers read; below 0, beams pass", -k_most_return, k_most_return))
      .optional(bare("fiducial_return", FieldType::integer, "what fiducial finders read of it; 0: nothing",
                     Marks::min(), Marks::max()))
      .optional(bare("fiducial_key", FieldType::integer, "finders find what has their key", Marks::min(),
                     Marks::max()))
      .optional(bare("gripper_return", FieldType::boolean, "whether grippers can take it"))
      .optional(bare("blob_return", FieldType::boolean, "whether blob finders see its colour"))
      .optional(
          bare("pushable", FieldType::boolean, "whether robots push the whole body, rather than stall"));
}

/// An image that is stretched to a size, or a map of ROS, which knows its own.
void add_image_fields(ObjectSchema& object) {
  object.optional(chosen("margins", {"trim", "keep"}, "trim: the solid pixels' box fills the size"))
      .optional(chosen("unknown", {"free", "solid"}, "of a map of ROS: what nobody has seen"))
      .optional(measure("height", Unit::meters, "of a map of ROS: of its walls", 0, k_max_size_m, true))
      .optional(bare("boundary", FieldType::boolean, "four walls just inside the edges of the box"));
}

void add_shape(ObjectSchema& object) {
  object.optional(k_size)
      .member("blocks", array_of(reference("block")), "upright prisms")
      .optional(bare("fit", FieldType::boolean, "the blocks are stretched to the size, as in Stage"))
      .member("origin", reference("pose"), "where the middle of the image or of the stretched blocks is")
      .member("bitmap", type("string"), "an image, relative to the world's file")
      .optional(bare("floor_plan", FieldType::boolean, "whether it is an image of walls"))
      .optional({.name = "extent",
                 .type = FieldType::numbers,
                 .unit = Unit::meters,
                 .min = 0,
                 .max = 2 * k_max_size_m,
                 .text = "the size as it is declared, where it is another",
                 .columns = 3});
  add_image_fields(object);
}

JsonNode block_schema() {
  const auto outline = [](std::int64_t least) {
    JsonNode points = array_of(reference("point_m"));
    add_member(std::get<Members>(points.value), "minItems", least);
    return points;
  };
  ObjectSchema block;
  block.member("points_m", outline(3), "the outline, which must not cross itself")
      .member("contours_m", array_of(outline(3)), "outlines; what lies within an odd number of them is solid")
      .field({.name = "z",
              .type = FieldType::numbers,
              .unit = Unit::meters,
              .min = -k_max_size_m,
              .max = k_max_size_m,
              .text = "the heights between which it stands",
              .columns = 2},
             true)
      .optional(chosen("frame", {"part", "body"}, "of the points, in parts"))
      .rule(choice({object_of({{"required", texts(std::array{"points_m"})}}),
                    object_of({{"required", texts(std::array{"contours_m"})}})},
                   "oneOf"));
  return block.done();
}

JsonNode kind_of(std::string_view name) { return object_of({{"const", text(name)}}); }

Field pause(const FieldTable& params, std::string_view about) {
  Field field = period_field(params);
  field.text = about;
  return field;
}

JsonNode joint_schema() { return choice({type("string"), type("null")}); }

/// A device in a list, or (`own`) what a part itself is, whose kind may follow from the part's.
JsonNode device_schema(const engine::DeviceKind& kind, bool own) {
  ObjectSchema device;
  if (own)
    device.member("kind", kind_of(kind.name), kind.text);
  else
    device.required("kind", kind_of(kind.name), kind.text);
  device.member("name", type("string"), "its name within the type")
      .member("pose", reference("pose"), "in the frame of what it stands on")
      .optional(bare("active", FieldType::boolean, "false: runs only when a controller reads it"))
      .optional(pause(kind.params, "between two readings; 0: every tick"))
      .fields(kind.params)
      .member("joint", joint_schema(), "what it moves with; null: nothing");
  if (!own) {
    device.member("on", type("string"), "the device that it stands on, and moves with");
    if (!kind.joints.empty()) {
      device.member("color", reference("color"));
      add_returns(device);
      if (!kind.body) device.optional(k_size).member("blocks", array_of(reference("block")));
    }
  }
  return device.done();
}

/// What only a plug-in knows the parameters of: of a kind that is none of these.
JsonNode kind_of_a_plug_in(std::string_view what, std::string_view page,
                           const std::vector<std::string_view>& known) {
  const JsonNode other =
      object_of({{"not", object_of({{"enum", texts(known)}})},
                 {"type", text("string")},
                 {"description", text(fmt::format("a {} of a plug-in, docs/{}.md", what, page))}});
  return object_of({{"type", text("object")},
                    {"properties", object_of({{"kind", other}})},
                    {"required", texts(std::array{"kind"})}});
}

template <class Kinds>
JsonNode device_schemas(const engine::Registry& registry, std::string_view what, const Kinds& kinds,
                        bool own) {
  std::vector<JsonNode> schemas;
  for (const engine::DeviceKind& kind : kinds) schemas.push_back(device_schema(kind, own));
  std::vector<std::string_view> known;
  for (const engine::DeviceKind& kind : registry.devices) known.push_back(kind.name);
  schemas.push_back(kind_of_a_plug_in(what, "extending", known));
  return choice(std::move(schemas));
}

JsonNode drive_schema(const engine::Registry& registry) {
  std::vector<JsonNode> schemas;
  for (const engine::DriveKind& kind : registry.drives)
    schemas.push_back(ObjectSchema()
                          .required("kind", kind_of(kind.name), kind.text)
                          .optional(pause(kind.params, "between two commands that it takes; 0: every tick"))
                          .fields(kind.params)
                          .done());
  return choice(std::move(schemas));
}

JsonNode controller_schema(const engine::Registry& registry) {
  std::vector<JsonNode> schemas;
  const auto add = [&](std::string_view name, std::string_view about, const FieldTable& params, bool preset) {
    schemas.push_back(ObjectSchema()
                          .required("kind", kind_of(name), about)
                          .optional(pause(params, "how often it runs, where it reads no sensor"))
                          .fields(params, !preset)
                          .done());
  };
  for (const engine::ControllerKind& kind : registry.controllers)
    add(kind.name, kind.text, kind.params, false);
  for (const engine::Registry::Preset& preset : registry.presets)
    if (const engine::ControllerKind* kind = registry.controller(preset.kind))
      add(preset.name, preset.text, kind->params, true);
  schemas.push_back(kind_of_a_plug_in("controller", "controllers", registry.controller_names()));
  return choice(std::move(schemas));
}

/// What types and parts have in common.
void add_body(ObjectSchema& object, const engine::Registry& registry) {
  std::vector<std::string_view> kinds;
  for (const engine::ModelKind& kind : registry.models) kinds.push_back(kind.name);
  add_shape(object);
  object.member("kind", object_of({{"enum", texts(kinds)}}), "what Stage calls it")
      .member("color", reference("color"))
      .member("device", reference("own_device"), "the device that it is itself")
      .member("sensors", array_of(reference("sensor")), "what only looks at the world")
      .member("devices", array_of(reference("device")), "what does something")
      .member("controller", reference("controller"))
      .member("controllers", array_of(reference("controller")))
      .member("parts", array_of(reference("part")), "what stands on it")
      .rule(object_of({{"not", object_of({{"required", texts(std::array{"controller", "controllers"})}})}}));
  add_returns(object);
}

JsonNode type_schema(const engine::Registry& registry) {
  ObjectSchema object;
  add_body(object, registry);
  const auto has = [](std::string_view key) { return object_of({{"required", texts(std::array{key})}}); };
  object.member("name", type("string"), "what the type is called, where several are called the same")
      .member("drive", reference("drive"), "a type without one never moves")
      .member("device_order", array_of(type("string")), "in which order the devices count")
      .rule(choice(
          {has("size_m"), has("size_cm"), has("size_mm"), has("blocks"), has("bitmap"), has("device")}));
  return object.done();
}

JsonNode part_schema(const engine::Registry& registry) {
  ObjectSchema object;
  object.required("name", type("string"), "below the body's name");
  add_body(object, registry);
  object.member("alias", type("string"), "another name")
      .member("pose", reference("pose"), "in the body's frame, while all joints are at rest")
      .member("joint", joint_schema(), "what it moves with; null: nothing");
  return object.done();
}

JsonNode floorplan_schema() {
  ObjectSchema plan;
  plan.required("name", type("string"))
      .required("bitmap", type("string"),
                "PNG, JPEG, BMP or PNM, or the YAML of a map of ROS; dark pixels are solid")
      .optional(k_size)
      .member("pose", reference("pose"), "of the centre")
      .member("color", reference("color"));
  add_image_fields(plan);
  add_returns(plan);
  return plan.done();
}

JsonNode model_schema() {
  using Marks = std::numeric_limits<std::int32_t>;
  return ObjectSchema()
      .optional(bare("fiducial_return", FieldType::integer, "its own number for fiducial finders",
                     Marks::min(), Marks::max()))
      .required("name", type("string"))
      .required("type", type("string"), "the name of one of the types")
      .member("pose", reference("pose"))
      .member("color", reference("color"))
      .member("alias", type("string"), "another name")
      .member("global_parts", array_of(type("string")), "parts that are found without the body's name")
      .member("reserve_of", type("string"), "the population into which it may be born, docs/lives.md")
      .done();
}

/// What all rules of placement take, and one of them more.
JsonNode place_schema(std::string_view rule) {
  JsonNode corners = array_of(reference("point_m"));
  add_member(std::get<Members>(corners.value), "minItems", std::int64_t{3});
  ObjectSchema place;
  place.required("rule", kind_of(rule))
      .member("region_m", reference("box_m"), "of the bodies' origins")
      .member("polygon_m", std::move(corners), "of the bodies' origins")
      .member("heading", object_of({{"const", text("random")}}))
      .optional(engine::pose_fields().fields[3])
      .optional(measure("z", Unit::meters, "height of the origins", -k_max_size_m, k_max_size_m));
  const auto pair = [](std::string_view name, std::string_view about, double min) {
    return Field{.name = name,
                 .type = FieldType::numbers,
                 .unit = Unit::meters,
                 .min = min,
                 .max = k_max_size_m,
                 .text = about,
                 .columns = 2};
  };
  if (rule == "grid")
    place.member("spill_m", reference("box_m"), "for the bodies that the first region cannot hold")
        .field(measure("pitch", Unit::meters, "between neighbours", 0, k_max_size_m, true), true)
        .optional(measure("jitter", Unit::meters, "how far each coordinate may be moved at random", 0,
                          k_max_size_m));
  if (rule == "gaussian")
    place.field(pair("mean", "about which they are normally distributed", -k_max_size_m), true)
        .field(pair("deviation", "the standard deviations", 0), true);
  if (rule == "poisson_disc")
    place.field(measure("distance", Unit::meters, "how near two may be to one another", 0.001, k_max_size_m),
                true);
  if (rule == "free_floor")
    place.optional(pair("from", "from where the floor is reached", -k_max_size_m))
        .optional(measure("cell", Unit::meters, "how finely the floor is looked at", 0.001, k_max_size_m));
  return place.done();
}

JsonNode population_schema() {
  const double most = LoadOptions().most_bodies;
  std::vector<JsonNode> places;
  for (const std::string_view rule : {"grid", "uniform", "gaussian", "poisson_disc", "free_floor"})
    places.push_back(place_schema(rule));
  return ObjectSchema()
      .required("name", type("string"), "bodies are called NAME0, NAME1, ...")
      .required("type", type("string"), "the name of one of the types")
      .field(bare("count", FieldType::integer, "how many bodies", 0, most), true)
      .optional(bare("reserve", FieldType::integer, "how many more may be born", 0, most))
      .member("color", reference("color"), "or \"random\"")
      .required("place", choice(std::move(places)))
      .done();
}

JsonNode measure_schema(const engine::Registry& registry) {
  std::vector<std::string_view> plain;
  std::vector<JsonNode> schemas;
  for (const engine::MeasureKind& kind : registry.measures) {
    if (std::ranges::all_of(kind.params.defaults(), &Value::given)) plain.push_back(kind.name);
    schemas.push_back(ObjectSchema()
                          .required("kind", kind_of(kind.name), kind.text)
                          .member("of", type("string"), "a type, a population or a robot")
                          .member("name", type("string"), "of the column")
                          .fields(kind.params)
                          .done());
  }
  std::string either;
  for (const std::string_view name : plain) either += fmt::format("{}{}", either.empty() ? "" : "|", name);
  schemas.push_back(object_of({{"enum", texts(plain)}}));
  schemas.push_back(
      object_of({{"type", text("string")}, {"pattern", text(fmt::format("^({}):.+$", either))}}));
  return choice(std::move(schemas));
}

constexpr double k_most_s = 1e9;

JsonNode has_key(std::string_view key) { return object_of({{"required", texts(std::array{key})}}); }

/// Adds whom something is about, and how many of them.
void add_group(ObjectSchema& object) {
  object.member("population", type("string"))
      .member("type", type("string"))
      .member("model", type("string"))
      .optional(bare("count", FieldType::integer, "so many of them, chosen by the seed", 0, 1e9))
      .optional(bare("share", FieldType::number, "this share of them, chosen by the seed", 0, 1))
      .rule(choice({has_key("population"), has_key("type"), has_key("model")}, "oneOf"))
      .rule(object_of({{"not", object_of({{"required", texts(std::array{"count", "share"})}})}}));
}

JsonNode group_schema() {
  ObjectSchema group;
  add_group(group);
  return group.done();
}

/// Which parameters there are depends on the type, which no schema can follow.
JsonNode setting_schema() {
  const auto with = [](std::string_view key) {
    return object_of({{"type", text("object")}, {"required", texts(std::array{key})}});
  };
  return ObjectSchema()
      .required("type", type("string"), "the name of one of the types")
      .member("drive", type("object"), "its parameters that change")
      .member("device", with("name"), "a device by its name, and its parameters that change")
      .member("controller", with("kind"), "a controller by its kind, and its parameters that change")
      .rule(choice({has_key("drive"), has_key("device"), has_key("controller")}, "oneOf"))
      .done();
}

/// An entry of `at`: one thing that is done at a time.
JsonNode intervention_schema() {
  ObjectSchema entry;
  entry.field(measure("time", Unit::seconds, "when it is done", 0, k_most_s), true);
  std::vector<JsonNode> one;
  for (const std::string_view action : engine::k_actions) {
    one.push_back(has_key(action));
    if (action == "add")
      entry.member(action, ObjectSchema()
                               .required("population", type("string"), "one that has a reserve")
                               .optional(bare("count", FieldType::integer, "how many are born", 0, 1e9))
                               .member("pose", reference("pose"))
                               .member("region_m", reference("box_m"))
                               .done());
    else if (action == "move")
      entry.member(
          action,
          ObjectSchema().required("model", type("string")).required("pose", reference("pose")).done());
    else
      entry.member(action, action == "set" ? setting_schema() : reference("group"));
  }
  return entry.rule(choice(std::move(one), "oneOf")).done();
}

JsonNode fault_schema(const engine::Registry& registry) {
  ObjectSchema fault;
  add_group(fault);
  fault.optional(measure("from", Unit::seconds, "from when on", 0, k_most_s));
  std::vector<JsonNode> any;
  for (const engine::FaultKind& kind : registry.faults) {
    any.push_back(has_key(kind.name));
    fault.member(kind.name, table_schema(kind.params), kind.text);
  }
  return fault.rule(choice(std::move(any))).done();
}

JsonNode condition_schema(const engine::Registry& registry) {
  constexpr std::string_view k_compares = "(<|<=|>|>=|==|!=) *[-+0-9.eE]+ *$";
  const auto matching = [](const std::string& pattern) {
    return object_of({{"type", text("string")}, {"pattern", text(pattern)}});
  };
  return choice({matching(fmt::format("^ *[^<>=!]+{}", k_compares)),
                 ObjectSchema()
                     .required("measure", measure_schema(registry))
                     .required("is", matching(fmt::format("^ *{}", k_compares)))
                     .done()});
}

JsonNode record_schema() {
  JsonNode fields = array_of(type("string"));
  add_member(std::get<Members>(fields.value), "minItems", std::int64_t{1});
  return ObjectSchema()
      .member("file", type("string"), "where troupe run records")
      .optional(measure("every", Unit::seconds, "of simulated time from frame to frame", 0, 1e9, true))
      .member("fields", std::move(fields), "what of the state, docs/recordings.md")
      .done();
}

JsonNode definitions(const engine::Registry& registry) {
  JsonNode point = array_of(
      number_schema(bare("", FieldType::number, "", -k_max_size_m, k_max_size_m), {"", "", 1}, "number"), 2);
  return object_of(
      {{"color", color_schema()},
       {"pose", table_schema(engine::pose_fields())},
       {"point_m", std::move(point)},
       {"box_m", described(array_of(reference("point_m"), 2), "[[x_min, y_min], [x_max, y_max]]")},
       {"block", block_schema()},
       {"drive", drive_schema(registry)},
       {"sensor", device_schemas(registry, "sensor", registry.sensors(), false)},
       {"device", device_schemas(registry, "device", registry.other_devices(), false)},
       {"own_device", device_schemas(registry, "device", registry.devices, true)},
       {"controller", controller_schema(registry)},
       {"group", group_schema()},
       {"part", part_schema(registry)},
       {"type", type_schema(registry)}});
}

}  // namespace

std::string world_schema(const engine::Registry& registry) {
  ObjectSchema world;
  world.member("$schema", type("string"), "of this file, for editors")
      .required("troupe", object_of({{"const", json_node(std::int64_t{1})}}), "the version of the format")
      .member("title", type("string"), "for people")
      .member("seed", object_of({{"type", text("integer")}, {"minimum", json_node(std::int64_t{0})}}),
              "of every random draw")
      .optional(measure("tick", Unit::seconds, "length of a tick; 0.1 s unless given", 1e-6, 3600))
      .optional(measure("quit_time", Unit::seconds, "where a run ends", 0, 1e9, true))
      .optional(chosen("ranging", {engine::k_ranging_engines.begin(), engine::k_ranging_engines.end()},
                       "what finds ranges, docs/sensing.md"))
      .optional(measure("resolution", Unit::meters, "edge of the cells of the grid engine",
                        engine::k_min_resolution_m, engine::k_max_resolution_m))
      .member("record", record_schema(), "what a run records")
      .member("floorplans", array_of(floorplan_schema()), "walls drawn as images")
      .member("types", object_of({{"type", text("object")}, {"additionalProperties", reference("type")}}),
              "what identical bodies share, by name")
      .member("models", array_of(model_schema()), "single bodies")
      .member("populations", array_of(population_schema()), "many bodies of one type, placed by a rule")
      .member("measures", array_of(measure_schema(registry)), "what troupe run --measures measures")
      .optional(measure("measure_every", Unit::seconds, "how often; 0: every tick", 0, 1e9))
      .optional(bare("mortal", FieldType::boolean, "programs may remove and disable bodies, docs/lives.md"))
      .member("stop_when", array_of(condition_schema(registry)), "when a run is over, docs/experiments.md")
      .member("at", array_of(intervention_schema()), "what is done to the world, and when")
      .member("faults", array_of(fault_schema(registry)), "how robots fail")
      .member("watch", table_schema(engine::watch_fields()), "how the world is watched")
      .member("window", table_schema(window_fields()), "the view it asks for")
      .member("bounds_m", reference("box_m"), "where robots may be")
      .optional(chosen("overlaps", {"error", "warn"}, "what models are that overlap something at the start"))
      .optional(chosen("same_names", {"error", "warn"}, "what two bodies of one name are"))
      .member("ground",
              ObjectSchema().required("alias", type("string"), "another name of the ground").done());
  JsonNode schema = world.done();
  Members& members = std::get<Members>(schema.value);
  Members head;
  add_member(head, "$schema", std::string("http://json-schema.org/draft-07/schema#"));
  add_member(head, "title", std::string("A world of Troupe"));
  members.insert(members.begin(), head.begin(), head.end());
  add_node(members, "definitions", definitions(registry));
  return json_text(schema);
}

}  // namespace troupe::worldio
