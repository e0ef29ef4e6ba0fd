#include "worldio/json/experiment_json.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

// Every struct is taken apart by a structured binding, so that a field that is added to one does not compile
// here until it is written (and then the tests ask that it is read).

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::Record;
using engine::Value;
using Json = nlohmann::ordered_json;

double finite(double x) {
  if (!std::isfinite(x)) throw std::runtime_error("the world holds a number that is not finite");
  return x;
}

/// Texts of Stage's files may be in any encoding. What is no UTF-8 is written as {"latin1": ...}, a character
/// for each byte.
Json text_json(const std::string& text) {
  Json json = text;
  try {
    static_cast<void>(json.dump());
    return json;
  } catch (const Json::type_error&) {
  }
  std::string characters;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      characters += c;
    } else {
      characters += static_cast<char>(0xc0 | byte >> 6);
      characters += static_cast<char>(0x80 | (byte & 0x3f));
    }
  }
  Json other;
  other["latin1"] = characters;
  return other;
}

Json where_json(const Where& where) {
  const auto& [file, line] = where;
  return {file, line};
}

Json pose_json(const Pose& pose) {
  const auto& [x, y, z, heading] = pose;
  return {finite(x), finite(y), finite(z), finite(heading)};
}

Json color_json(const Color& color) {
  const auto& [r, g, b, a] = color;
  return {finite(r), finite(g), finite(b), finite(a)};
}

bool within(const Field& field, double x) {
  return std::isfinite(x) && x >= field.min && x <= field.max && !(field.above_min && x == field.min);
}

/// Whether a field takes the value where somebody gives it: a default may stand outside of the limits, to
/// mean that nothing was given.
bool takes(const Field& field, const Value& value) {
  switch (field.type) {
    case FieldType::integer: return within(field, static_cast<double>(value.integer()));
    case FieldType::number: return within(field, value.number());
    case FieldType::text:
      return field.choices.empty() || std::ranges::find(field.choices, value.text()) != field.choices.end();
    case FieldType::numbers:
      return (field.columns == 0 || value.numbers().size() == field.columns) &&
             std::ranges::all_of(value.numbers(), [&field](double x) { return within(field, x); });
    default: return true;
  }
}

Json params_json(const Record& record, const FieldTable& table);

Json value_json(const Value& value, const Field& field) {
  switch (field.type) {
    case FieldType::boolean: return value.boolean();
    case FieldType::integer: return value.integer();
    case FieldType::number: return finite(value.number());
    case FieldType::text: return value.text();
    case FieldType::numbers: {
      Json list = Json::array();
      for (const double x : value.numbers()) list.push_back(finite(x));
      return list;
    }
    case FieldType::texts: return value.texts();
    case FieldType::color: {
      Json list = Json::array();
      for (const double x : value.numbers()) list.push_back(finite(x));
      return list;
    }
    case FieldType::colors: {
      Json list = Json::array();
      const std::vector<double>& parts = value.numbers();
      for (std::size_t i = 0; i + 2 < parts.size(); i += 3)
        list.push_back({finite(parts[i]), finite(parts[i + 1]), finite(parts[i + 2])});
      return list;
    }
    case FieldType::record: return params_json(value.records().front(), *field.record);
    case FieldType::records: break;
  }
  Json list = Json::array();
  for (const Record& record : value.records()) list.push_back(params_json(record, *field.record));
  return list;
}

Json params_json(const Record& record, const FieldTable& table) {
  Json json = Json::object();
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    const Field& field = table.fields[i];
    const Value& value = record[i];
    if (!value.given() || (value == field.fallback && !takes(field, value))) continue;
    json[fmt::format("{}{}", field.name, engine::unit_suffixes(field.unit).front().suffix)] =
        value_json(value, field);
  }
  return json;
}

template <class Kind>
const FieldTable& params_of(const Kind* kind, const std::string& name) {
  if (!kind)
    throw std::runtime_error(fmt::format("the world uses a kind \"{}\" that nobody registered", name));
  return kind->params;
}

Json solid_json(const Solid& solid) {
  const auto& [contours, z] = solid;
  const auto& [low, high] = z;
  Json rings = Json::array();
  for (const Ring& ring : contours) {
    Json points = Json::array();
    for (const Vec2& point : ring) points.push_back({finite(point.x()), finite(point.y())});
    rings.push_back(std::move(points));
  }
  return {{"z_m", {finite(low), finite(high)}}, {"contours_m", std::move(rings)}};
}

Json part_json(const engine::PartSpec& part) {
  const auto& [name, alias, kind, parent, joint, pose_body_part, size, solids, returns, floor_plan, image,
               fitted, color, where] = part;
  static_cast<void>(image);  // what they make stands here: no other file is needed
  static_cast<void>(fitted);
  const auto& [obstacle, ranger, fiducial, fiducial_key, gripper, pushable, blob] = returns;
  Json json;
  json["name"] = text_json(name);
  json["alias"] = text_json(alias);
  json["kind"] = text_json(kind);
  json["parent"] = parent;
  if (joint != engine::k_rigid) json["joint"] = joint;
  json["pose"] = pose_json(pose_body_part);
  json["size_m"] = {finite(size.x()), finite(size.y()), finite(size.z())};
  json["solids"] = Json::array();
  for (const Solid& solid : solids) json["solids"].push_back(solid_json(solid));
  json["obstacle"] = obstacle;
  json["ranger_return"] = finite(ranger);
  json["fiducial_return"] = fiducial;
  json["fiducial_key"] = fiducial_key;
  json["gripper_return"] = gripper;
  json["blob_return"] = blob;
  if (pushable) json["pushable"] = pushable;
  json["floor_plan"] = floor_plan;
  if (color) json["color"] = color_json(*color);
  json["where"] = where_json(where);
  return json;
}

Json joint_json(const engine::JointSpec& joint) {
  const auto& [name, parent, pose_body_joint] = joint;
  Json json;
  json["name"] = text_json(name);
  if (parent != engine::k_rigid) json["parent"] = parent;
  json["pose"] = pose_json(pose_body_joint);
  return json;
}

Json drive_json(const engine::DriveSpec& drive, const engine::Registry& registry) {
  const auto& [kind, params, period_s, where] = drive;
  Json json;
  json["kind"] = text_json(kind);
  json["period_s"] = finite(period_s);
  json["params"] = params_json(params, params_of(registry.drive(kind), kind));
  json["where"] = where_json(where);
  return json;
}

Json sensor_json(const engine::DeviceSpec& sensor, const engine::Registry& registry) {
  const auto& [name, kind, part, joint, moves, params, pose_body_sensor, period_s, active, where] = sensor;
  Json json;
  json["name"] = text_json(name);
  json["kind"] = text_json(kind);
  json["part"] = part;
  if (joint != engine::k_rigid) json["joint"] = joint;
  if (moves != engine::k_rigid) json["moves"] = moves;
  json["pose"] = pose_json(pose_body_sensor);
  json["period_s"] = finite(period_s);
  json["active"] = active;
  json["params"] = params_json(params, params_of(registry.device(kind), kind));
  json["where"] = where_json(where);
  return json;
}

Json controller_json(const engine::ControllerSpec& controller, const engine::Registry& registry) {
  const auto& [kind, part, params, period_s, where] = controller;
  Json json;
  json["kind"] = text_json(kind);
  json["part"] = part;
  json["period_s"] = finite(period_s);
  json["params"] = params_json(params, params_of(registry.controller(kind), kind));
  json["where"] = where_json(where);
  return json;
}

Json type_json(const engine::TypeSpec& type, const engine::Registry& registry) {
  const auto& [name, parts, joints, drive, sensors, controllers] = type;
  Json json;
  json["name"] = text_json(name);
  json["parts"] = Json::array();
  for (const engine::PartSpec& part : parts) json["parts"].push_back(part_json(part));
  for (const engine::JointSpec& joint : joints) json["joints"].push_back(joint_json(joint));
  if (drive) json["drive"] = drive_json(*drive, registry);
  json["sensors"] = Json::array();
  for (const engine::DeviceSpec& sensor : sensors) json["sensors"].push_back(sensor_json(sensor, registry));
  json["controllers"] = Json::array();
  for (const engine::ControllerSpec& controller : controllers)
    json["controllers"].push_back(controller_json(controller, registry));
  return json;
}

Json record_json(const engine::RecordSpec& record) {
  const auto& [file, fields, every_s, where, where_fields] = record;
  Json json;
  json["file"] = text_json(file);
  json["fields"] = Json::array();
  for (const std::string& field : fields) json["fields"].push_back(text_json(field));
  if (every_s) json["every_s"] = finite(*every_s);
  json["where"] = where_json(where);
  json["where_fields"] = where_json(where_fields);
  return json;
}

Json reserve_json(const engine::ReserveSpec& reserve) {
  const auto& [population, first, count] = reserve;
  Json json;
  json["population"] = text_json(population);
  json["first"] = first.value;
  json["count"] = count;
  return json;
}

Json measure_json(const engine::MeasureSpec& measure, const engine::Registry& registry) {
  const auto& [kind, name, of, params, where] = measure;
  Json json;
  json["kind"] = text_json(kind);
  json["name"] = text_json(name);
  json["of"] = text_json(of);
  json["params"] = params_json(params, params_of(registry.measure(kind), kind));
  json["where"] = where_json(where);
  return json;
}

/// As JSON worlds say it, but that types are called by their numbers.
Json experiment_json(const engine::WorldSpec& spec, const engine::Registry& registry) {
  JsonNode::Object object;
  write_experiment(spec, numbers_of_types(spec), registry, object);
  return Json::parse(json_text(json_node(std::move(object))));
}

Json files_json(const SourceFiles* files) {
  Json json = Json::array();
  for (std::uint32_t i = 0; files && i < files->size(); ++i) json.push_back(text_json(files->name(i)));
  return json;
}

BodyColumns body_columns(const engine::WorldSpec& spec) {
  BodyColumns columns;
  for (const engine::BodySpec& body : spec.bodies) {
    const auto& [name, type, pose_world_body, color, fiducial, where] = body;
    const auto& [x, y, z, heading] = pose_world_body;
    const auto& [r, g, b, a] = color;
    columns.word.push_back(name.word);
    columns.number.push_back(name.number);
    columns.type.push_back(type.value);
    columns.pose.insert(columns.pose.end(), {x, y, z, heading});
    columns.color.insert(columns.color.end(), {r, g, b, a});
    columns.fiducial.push_back(fiducial);
    columns.file.push_back(where.file);
    columns.line.push_back(where.line);
  }
  if (std::ranges::all_of(columns.fiducial, [](std::int32_t mark) { return mark == 0; }))
    columns.fiducial.clear();
  for (const engine::NamedBody& alias : spec.aliases) {
    const auto& [name, body] = alias;
    columns.alias_word.push_back(name.word);
    columns.alias_number.push_back(name.number);
    columns.alias_body.push_back(body.value);
  }
  return columns;
}

}  // namespace

std::vector<std::string> numbers_of_types(const engine::WorldSpec& spec) {
  std::vector<std::string> numbers;
  for (std::size_t t = 0; t < spec.types.size(); ++t) numbers.push_back(std::to_string(t));
  return numbers;
}

std::string spec_to_json(const engine::WorldSpec& spec, const engine::Registry& registry) {
  const auto& [title, files, seed, tick_s, quit_time_s, record, ranging, resolution_m, resolution_where,
               bounds, types, names, bodies, reserves, mortal, aliases, part_aliases, measures,
               measure_every_s, watch, window, experiment] = spec;
  static_cast<void>(bodies);  // columns, as are:
  static_cast<void>(aliases);
  Json json;
  json["title"] = text_json(title);
  json["seed"] = seed;
  json["tick_s"] = finite(tick_s);
  if (quit_time_s) json["quit_time_s"] = finite(*quit_time_s);
  if (record) json["record"] = record_json(*record);
  json["measures"] = Json::array();
  for (const engine::MeasureSpec& measure : measures)
    json["measures"].push_back(measure_json(measure, registry));
  json["measure_every_s"] = finite(measure_every_s);
  json["watch"] = params_json(engine::watch_record(watch), engine::watch_fields());
  if (window) json["window"] = params_json(*window, window_fields());
  json["ranging"] = engine::ranging_engine_name(ranging);
  json["resolution_m"] = finite(resolution_m);
  json["resolution_where"] = where_json(resolution_where);
  if (bounds)
    json["bounds_m"] = {finite(bounds->min.x()), finite(bounds->min.y()), finite(bounds->max.x()),
                        finite(bounds->max.y())};
  json["files"] = files_json(files.get());
  json["words"] = Json::array();
  for (const std::string& word : names.words()) json["words"].push_back(text_json(word));
  json["part_names"] = Json::array();
  const std::map<std::string, engine::PartName> sorted(part_aliases.begin(), part_aliases.end());
  for (const auto& [name, place] : sorted) {
    const auto& [body, part] = place;
    json["part_names"].push_back(
        {{"name", text_json(name)}, {"body", body.value}, {"part", text_json(part)}});
  }
  for (const engine::ReserveSpec& reserve : reserves) json["reserves"].push_back(reserve_json(reserve));
  if (mortal) json["mortal"] = mortal;
  json["types"] = Json::array();
  for (const engine::TypeSpec& type : types) json["types"].push_back(type_json(type, registry));
  if (!experiment.empty()) json.update(experiment_json(spec, registry));
  try {
    return json.dump();
  } catch (const Json::type_error&) {
    throw std::runtime_error("a parameter of the world holds a text that is no UTF-8");
  }
}

StoredSpec store_spec(const engine::WorldSpec& spec, const engine::Registry& registry) {
  return {spec_to_json(spec, registry), body_columns(spec)};
}

}  // namespace troupe::worldio
