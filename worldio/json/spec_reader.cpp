#include "worldio/json/experiment_json.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/spec_json.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldType;
using engine::Value;

constexpr double k_most_s = 1e15;  // more than any world says, and its ticks still count in 64 bits
constexpr double k_reach = 1e6;    // m: ten times as far as worlds reach, and cells still count in 32 bits

std::vector<std::string_view> tokens_of(std::string_view pointer) {
  std::vector<std::string_view> tokens;
  while (pointer.starts_with('/')) {
    pointer.remove_prefix(1);
    const std::size_t end = std::min(pointer.find('/'), pointer.size());
    tokens.push_back(pointer.substr(0, end));
    pointer.remove_prefix(end);
  }
  return tokens;
}

/// Whether a pointer is one of k_changeable.
bool is_changeable(std::string_view pointer) {
  const std::vector<std::string_view> tokens = tokens_of(pointer);
  const auto token = [&tokens](std::size_t i) { return i < tokens.size() ? tokens[i] : std::string_view(); };
  if (tokens.size() == 1)
    return token(0) == "seed" || token(0) == "quit_time_s" || token(0) == "stop_when" ||
           token(0) == "ranging" || token(0) == "resolution_m" || token(0) == "bounds_m";
  if (token(0) == "bounds_m") return tokens.size() == 2;
  if (token(0) != "types") return false;
  const bool is_drive = token(2) == "drive";
  if (!is_drive && token(2) != "sensors" && token(2) != "controllers") return false;
  const std::size_t at = is_drive ? 3 : 4;
  if (token(at) == "params") return tokens.size() > at + 1;
  if (tokens.size() != at + 1 || token(2) == "controllers") return false;
  return token(at) == "period_s" || (token(at) == "active" && !is_drive);
}

/// A text as spec_to_json() writes it; the characters of a "latin1" are the bytes. Nothing where it is no
/// such text.
std::optional<std::string> text_of(const JsonNode& node) {
  if (const std::string* text = node.text()) return *text;
  const JsonNode* latin1 = node.find("latin1");
  const std::string* characters = latin1 ? latin1->text() : nullptr;
  if (!characters) return std::nullopt;
  std::string bytes;
  for (std::size_t i = 0; i < characters->size(); ++i) {
    const auto first = static_cast<unsigned char>((*characters)[i]);
    if (first < 0x80) {
      bytes += static_cast<char>(first);
      continue;
    }
    if (first > 0xc3 || ++i == characters->size()) return std::nullopt;
    bytes += static_cast<char>((first & 3) << 6 | ((*characters)[i] & 0x3f));
  }
  return bytes;
}

/// Reads what spec_writer.cpp writes. What is wrong is reported; what is read then is harmless and of no use.
class SpecReader {
 public:
  SpecReader(const engine::Registry& registry, Where file, Diagnostics& diagnostics)
      : registry_(registry), file_(file), diagnostics_(diagnostics) {}

  engine::WorldSpec read(const JsonNode& document);
  void add_bodies(engine::WorldSpec& spec, const BodyColumns& columns);
  void check_part_names(const engine::WorldSpec& spec);
  void check_reserves(const engine::WorldSpec& spec);

 private:
  const JsonNode* require(JsonObject& object, std::string_view key) {
    return object.require(key, "every stored world has it");
  }
  std::string text(JsonObject& object, std::string_view key);
  /// Numbers of a list; zeros where they are not there.
  std::vector<double> numbers(JsonObject& object, std::string_view key, std::size_t count);
  double number(JsonObject& object, std::string_view key, double min, double max, double fallback);
  bool boolean(JsonObject& object, std::string_view key);
  std::uint32_t index(JsonObject& object, std::string_view key);
  std::int32_t joint_index(JsonObject& object, std::string_view key);
  std::int32_t int32(JsonObject& object, std::string_view key);
  Where where(JsonObject& object, std::string_view key = "where");
  Pose pose(JsonObject& object);
  /// read(cursor) for each entry of the list under a key.
  template <class Read>
  void each_of(JsonObject& object, std::string_view key, Read&& read);

  void read_settings(JsonObject& object, engine::WorldSpec& spec);
  engine::RecordSpec record(const JsonCursor& at);
  engine::MeasureSpec measure(const JsonCursor& at);
  engine::ReserveSpec reserve(const JsonCursor& at);
  void read_names(JsonObject& object, engine::WorldSpec& spec);
  Ring ring(const JsonCursor& at);
  Solid solid(const JsonCursor& at);
  engine::PartSpec part(const JsonCursor& at);
  template <class Kinds>
  engine::Record params(JsonObject& object, std::string_view what, const std::string& kind,
                        const Kinds& kinds);
  engine::JointSpec joint(const JsonCursor& at);
  /// By the kind's table; null where there is none.
  engine::Record params(JsonObject& object, const engine::FieldTable* table);
  engine::DriveSpec drive(const JsonCursor& at);
  engine::DeviceSpec sensor(const JsonCursor& at);
  engine::ControllerSpec controller(const JsonCursor& at);
  engine::TypeSpec type(const JsonCursor& at);

  /// A Where of the stored world in the files of this load.
  Where here(std::uint32_t file, std::uint32_t line) const {
    return {file < files_.size() ? files_[file] : Where::k_no_file, line};
  }
  void error(const std::string& message) const { diagnostics_.error(file_, message); }

  const engine::Registry& registry_;
  Where file_;
  Diagnostics& diagnostics_;
  std::vector<std::uint32_t> files_;  // of the stored world, as this load numbers them
};

std::string SpecReader::text(JsonObject& object, std::string_view key) {
  const JsonNode* node = require(object, key);
  if (!node) return {};
  if (std::optional<std::string> text = text_of(*node)) return std::move(*text);
  JsonCursor(object.at(), key, *node).expected("a text");
  return {};
}

std::vector<double> SpecReader::numbers(JsonObject& object, std::string_view key, std::size_t count) {
  std::vector<double> none(count, 0.0);
  const JsonNode* node = require(object, key);
  if (!node) return none;
  const Value value = read_value(
      JsonCursor(object.at(), key, *node),
      {.name = key, .type = FieldType::numbers, .min = -k_reach, .max = k_reach, .columns = count});
  return value.given() ? value.numbers() : none;
}

double SpecReader::number(JsonObject& object, std::string_view key, double min, double max, double fallback) {
  const JsonNode* node = require(object, key);
  if (!node) return fallback;
  const Value value = read_value(JsonCursor(object.at(), key, *node), {.name = key, .min = min, .max = max});
  return value.given() ? value.number() : fallback;
}

bool SpecReader::boolean(JsonObject& object, std::string_view key) {
  const JsonNode* node = require(object, key);
  if (!node) return false;
  const Value value =
      read_value(JsonCursor(object.at(), key, *node), {.name = key, .type = FieldType::boolean});
  return value.given() && value.boolean();
}

std::int32_t SpecReader::int32(JsonObject& object, std::string_view key) {
  using Limits = std::numeric_limits<std::int32_t>;
  const JsonNode* node = require(object, key);
  if (!node) return 0;
  const Value value =
      read_value(JsonCursor(object.at(), key, *node),
                 {.name = key, .type = FieldType::integer, .min = Limits::min(), .max = Limits::max()});
  return value.given() ? static_cast<std::int32_t>(value.integer()) : 0;
}

std::uint32_t SpecReader::index(JsonObject& object, std::string_view key) {
  const JsonNode* node = require(object, key);
  if (!node) return 0;
  const Value value = read_value(JsonCursor(object.at(), key, *node),
                                 {.name = key,
                                  .type = FieldType::integer,
                                  .min = 0,
                                  .max = static_cast<double>(std::numeric_limits<std::uint32_t>::max())});
  return value.given() ? static_cast<std::uint32_t>(value.integer()) : 0;
}

/// Of a joint; rigid where the object does not say.
std::int32_t SpecReader::joint_index(JsonObject& object, std::string_view key) {
  return object.find(key) ? static_cast<std::int32_t>(std::min(index(object, key), 0x7fffffffu))
                          : engine::k_rigid;
}

Where SpecReader::where(JsonObject& object, std::string_view key) {
  const JsonNode* node = require(object, key);
  const JsonNode::List* list = node ? read_list(JsonCursor(object.at(), key, *node)) : nullptr;
  if (!list) return {};
  const auto entry = [&](std::size_t i) -> std::uint32_t {
    const auto* x = i < list->size() ? std::get_if<std::int64_t>(&(*list)[i].value) : nullptr;
    if (x && *x >= 0 && *x <= std::numeric_limits<std::uint32_t>::max())
      return static_cast<std::uint32_t>(*x);
    JsonCursor(object.at(), key, *node).expected("a place, [file, line]");
    return Where::k_no_file;
  };
  const std::uint32_t file = entry(0);
  return here(file, entry(1));
}

Pose SpecReader::pose(JsonObject& object) {
  const std::vector<double> p = numbers(object, "pose", 4);
  return {p[0], p[1], p[2], p[3]};
}

template <class Read>
void SpecReader::each_of(JsonObject& object, std::string_view key, Read&& read) {
  const JsonNode* node = require(object, key);
  if (!node) return;
  const JsonCursor cursor(object.at(), key, *node);
  const JsonNode::List* list = read_list(cursor);
  for (std::size_t i = 0; list && i < list->size(); ++i) read(JsonCursor(cursor, i, (*list)[i]));
}

void SpecReader::read_settings(JsonObject& object, engine::WorldSpec& spec) {
  spec.title = text(object, "title");
  if (const JsonNode* node = require(object, "seed")) {
    const auto* small = std::get_if<std::int64_t>(&node->value);
    const auto* big = std::get_if<std::uint64_t>(&node->value);
    if (big || (small && *small >= 0))
      spec.seed = big ? *big : static_cast<std::uint64_t>(*small);
    else
      JsonCursor(object.at(), "seed", *node).expected("a whole number from 0 to 2^64 - 1");
  }
  spec.tick_s = number(object, "tick_s", 1e-6, k_most_s, spec.tick_s);
  if (object.find("quit_time_s")) spec.quit_time_s = number(object, "quit_time_s", 0, k_most_s, 0);
  if (const JsonNode* node = require(object, "ranging")) {
    const auto& engines = engine::k_ranging_engines;
    const Value name =
        read_value(JsonCursor(object.at(), "ranging", *node),
                   {.name = "ranging", .type = FieldType::text, .choices = {engines.begin(), engines.end()}});
    if (name.given())
      spec.ranging =
          static_cast<engine::RangingEngine>(std::ranges::find(engines, name.text()) - engines.begin());
  }
  spec.resolution_m = number(object, "resolution_m", engine::k_min_resolution_m, engine::k_max_resolution_m,
                             spec.resolution_m);
  each_of(object, "files", [&](const JsonCursor& at) {
    const std::optional<std::string> name = text_of(at.node());
    if (!name) at.expected("the name of a file");
    files_.push_back(diagnostics_.files()->add(name.value_or("")));
  });
  spec.resolution_where = where(object, "resolution_where");
  if (const JsonNode* node = object.find("record"))
    spec.record = record(JsonCursor(object.at(), "record", *node));
  each_of(object, "measures", [&](const JsonCursor& at) { spec.measures.push_back(measure(at)); });
  spec.measure_every_s = number(object, "measure_every_s", 0, k_most_s, spec.measure_every_s);
  if (const auto watch = read_block(object, "watch", engine::watch_fields()))
    spec.watch = engine::watch_spec(*watch);
  spec.window = read_block(object, "window", window_fields());
  if (object.find("bounds_m")) {
    const std::vector<double> b = numbers(object, "bounds_m", 4);
    spec.bounds.emplace();
    spec.bounds->min = {b[0], b[1]};
    spec.bounds->max = {b[2], b[3]};
    if (spec.bounds->empty()) object.at().error("bounds_m: these are [x_min, y_min, x_max, y_max]");
  }
}

engine::RecordSpec SpecReader::record(const JsonCursor& at) {
  JsonObject object(at);
  engine::RecordSpec record;
  record.file = text(object, "file");
  each_of(object, "fields", [&](const JsonCursor& field) {
    std::optional<std::string> name = text_of(field.node());
    if (!name) field.expected("the name of a field");
    record.fields.push_back(std::move(name).value_or(""));
  });
  if (object.find("every_s")) record.every_s = number(object, "every_s", 0, k_most_s, 0);
  record.where = where(object);
  record.where_fields = where(object, "where_fields");
  object.finish();
  return record;
}

engine::MeasureSpec SpecReader::measure(const JsonCursor& at) {
  JsonObject object(at);
  engine::MeasureSpec measure;
  measure.kind = text(object, "kind");
  measure.name = text(object, "name");
  measure.of = text(object, "of");
  measure.params = params(object, "measure", measure.kind, registry_.measures);
  measure.where = where(object);
  object.finish();
  return measure;
}

engine::ReserveSpec SpecReader::reserve(const JsonCursor& at) {
  JsonObject object(at);
  engine::ReserveSpec reserve;
  reserve.population = text(object, "population");
  reserve.first = BodyId(index(object, "first"));
  reserve.count = index(object, "count");
  object.finish();
  return reserve;
}

void SpecReader::read_names(JsonObject& object, engine::WorldSpec& spec) {
  std::vector<std::string> words;
  each_of(object, "words", [&](const JsonCursor& at) {
    std::optional<std::string> word = text_of(at.node());
    if (!word) at.expected("a word");
    words.push_back(std::move(word).value_or(""));
  });
  try {
    spec.names = engine::Names(std::move(words));
  } catch (const std::invalid_argument& fault) {
    object.at().error(fmt::format("words: {}", fault.what()));
  }
  each_of(object, "part_names", [&](const JsonCursor& at) {
    JsonObject entry(at);
    std::string name = text(entry, "name");
    const BodyId body(index(entry, "body"));
    spec.part_aliases[std::move(name)] = {body, text(entry, "part")};
    entry.finish();
  });
}

Ring SpecReader::ring(const JsonCursor& at) {
  const Field point{
      .name = "point", .type = FieldType::numbers, .min = -k_reach, .max = k_reach, .columns = 2};
  Ring ring;
  const JsonNode::List* list = read_list(at);
  for (std::size_t i = 0; list && i < list->size(); ++i) {
    const Value xy = read_value(JsonCursor(at, i, (*list)[i]), point);
    if (xy.given()) ring.emplace_back(xy.numbers()[0], xy.numbers()[1]);
  }
  return ring;
}

Solid SpecReader::solid(const JsonCursor& at) {
  JsonObject object(at);
  Solid solid;
  each_of(object, "contours_m", [&](const JsonCursor& contour) { solid.contours.push_back(ring(contour)); });
  const std::vector<double> z = numbers(object, "z_m", 2);
  solid.z = {z[0], z[1]};
  object.finish();
  return solid;
}

engine::PartSpec SpecReader::part(const JsonCursor& at) {
  JsonObject object(at);
  engine::PartSpec part;
  part.name = text(object, "name");
  part.alias = text(object, "alias");
  part.kind = text(object, "kind");
  part.parent = index(object, "parent");
  part.joint = joint_index(object, "joint");
  part.pose_body_part = pose(object);
  const std::vector<double> size = numbers(object, "size_m", 3);
  part.size = {size[0], size[1], size[2]};
  each_of(object, "solids", [&](const JsonCursor& entry) { part.solids.push_back(solid(entry)); });
  part.returns.obstacle = boolean(object, "obstacle");
  part.returns.ranger = static_cast<float>(number(object, "ranger_return", -1e30, 1e30, 1));
  part.returns.fiducial = int32(object, "fiducial_return");
  part.returns.fiducial_key = int32(object, "fiducial_key");
  part.returns.gripper = boolean(object, "gripper_return");
  part.returns.blob = boolean(object, "blob_return");
  part.returns.pushable = object.find("pushable") && boolean(object, "pushable");
  part.floor_plan = boolean(object, "floor_plan");
  if (object.find("color")) {
    const std::vector<double> c = numbers(object, "color", 4);
    part.color = {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]),
                  static_cast<float>(c[3])};
  }
  part.where = where(object);
  object.finish();
  return part;
}

template <class Kinds>
engine::Record SpecReader::params(JsonObject& object, std::string_view what, const std::string& name,
                                  const Kinds& kinds) {
  const auto kind = std::ranges::find(kinds, std::string_view(name), &Kinds::value_type::name);
  if (kind == kinds.end()) {
    std::vector<std::string_view> known;
    for (const auto& each : kinds) known.push_back(each.name);
    object.at().error(unknown_name(what, name, std::move(known)));
  }
  return params(object, kind == kinds.end() ? nullptr : &kind->params);
}

engine::Record SpecReader::params(JsonObject& object, const engine::FieldTable* table) {
  const JsonNode* node = require(object, "params");
  if (!table) return {};
  if (!node) return table->defaults();
  const JsonCursor cursor(object.at(), "params", *node);
  JsonObject fields(cursor);
  engine::Record record = read_fields(fields, *table);
  fields.finish();
  return record;
}

engine::JointSpec SpecReader::joint(const JsonCursor& at) {
  JsonObject object(at);
  engine::JointSpec joint;
  joint.name = text(object, "name");
  joint.parent = joint_index(object, "parent");
  joint.pose_body_joint = pose(object);
  object.finish();
  return joint;
}

engine::DriveSpec SpecReader::drive(const JsonCursor& at) {
  JsonObject object(at);
  engine::DriveSpec drive;
  drive.kind = text(object, "kind");
  drive.period_s = number(object, "period_s", 0, k_most_s, 0);
  drive.params = params(object, "drive", drive.kind, registry_.drives);
  drive.where = where(object);
  object.finish();
  return drive;
}

engine::DeviceSpec SpecReader::sensor(const JsonCursor& at) {
  JsonObject object(at);
  engine::DeviceSpec sensor;
  sensor.name = text(object, "name");
  sensor.kind = text(object, "kind");
  sensor.part = index(object, "part");
  sensor.joint = joint_index(object, "joint");
  sensor.moves = joint_index(object, "moves");
  sensor.pose_body_sensor = pose(object);
  sensor.period_s = number(object, "period_s", 0, k_most_s, 0);
  sensor.active = boolean(object, "active");
  std::vector<std::string_view> known;
  for (const engine::DeviceKind& each : registry_.devices) known.push_back(each.name);
  const auto kind = registry_.find_device(sensor.kind, unknown_name("sensor", sensor.kind, std::move(known)));
  if (!kind) at.error(kind.error().text);
  sensor.params = params(object, kind ? &(*kind)->params : nullptr);
  sensor.where = where(object);
  object.finish();
  return sensor;
}

engine::ControllerSpec SpecReader::controller(const JsonCursor& at) {
  JsonObject object(at);
  engine::ControllerSpec controller;
  controller.kind = text(object, "kind");
  controller.part = index(object, "part");
  controller.period_s = number(object, "period_s", 0, k_most_s, 0);
  const auto kind = registry_.find_controller(controller.kind);
  if (!kind) at.error(kind.error().text);
  controller.params = params(object, kind ? &(*kind)->params : nullptr);
  controller.where = where(object);
  object.finish();
  return controller;
}

engine::TypeSpec SpecReader::type(const JsonCursor& at) {
  JsonObject object(at);
  engine::TypeSpec type;
  type.name = text(object, "name");
  each_of(object, "parts", [&](const JsonCursor& entry) { type.parts.push_back(part(entry)); });
  if (type.parts.empty()) at.error("a type has at least one part");
  for (std::size_t p = 0; p < type.parts.size(); ++p)
    if (type.parts[p].parent >= std::max<std::size_t>(p, 1))
      at.error("a part stands on one that comes before it");
  if (object.find("joints"))
    each_of(object, "joints", [&](const JsonCursor& entry) { type.joints.push_back(joint(entry)); });
  if (const JsonNode* node = object.find("drive")) type.drive = drive(JsonCursor(at, "drive", *node));
  each_of(object, "sensors", [&](const JsonCursor& entry) { type.devices.push_back(sensor(entry)); });
  each_of(object, "controllers",
          [&](const JsonCursor& entry) { type.controllers.push_back(controller(entry)); });
  object.finish();
  const auto joints = static_cast<std::int32_t>(type.joints.size());
  const auto is_no_joint = [joints](const auto& placed) { return placed.joint >= joints; };
  if (std::ranges::any_of(type.parts, is_no_joint) || std::ranges::any_of(type.devices, is_no_joint))
    at.error("a part or device stands on a joint that the type does not have");
  for (std::int32_t j = 0; j < joints; ++j)
    if (type.joints[static_cast<std::size_t>(j)].parent >= j)
      at.error("a joint stands on one that comes before it");
  const auto is_no_part = [&](const auto& carried) { return carried.part >= type.parts.size(); };
  if (std::ranges::any_of(type.devices, is_no_part) || std::ranges::any_of(type.controllers, is_no_part))
    at.error("a sensor or controller belongs to a part that the type does not have");
  return type;
}

engine::WorldSpec SpecReader::read(const JsonNode& document) {
  engine::WorldSpec spec;
  spec.files = diagnostics_.files();
  const JsonCursor root(document, diagnostics_);
  JsonObject object(root);
  read_settings(object, spec);
  read_names(object, spec);
  if (object.find("reserves"))
    each_of(object, "reserves", [&](const JsonCursor& at) { spec.reserves.push_back(reserve(at)); });
  if (object.find("mortal")) spec.mortal = boolean(object, "mortal");
  each_of(object, "types", [&](const JsonCursor& at) { spec.types.push_back(type(at)); });
  read_experiment(object, numbers_of_types(spec), registry_, spec);
  object.finish();
  return spec;
}

void SpecReader::add_bodies(engine::WorldSpec& spec, const BodyColumns& c) {
  const std::size_t count = c.type.size();
  const std::size_t aliases = c.alias_body.size();
  if (c.word.size() != count || c.number.size() != count || c.pose.size() != 4 * count ||
      c.color.size() != 4 * count || (!c.fiducial.empty() && c.fiducial.size() != count) ||
      c.file.size() != count || c.line.size() != count || c.alias_word.size() != aliases ||
      c.alias_number.size() != aliases)
    return error("the columns of the bodies have not all the same length");
  if (count == 0) return error("there is no body: the first of every world is the ground");
  const std::size_t words = spec.names.words().size();
  if (!std::ranges::all_of(c.type, [&](std::uint32_t type) { return type < spec.types.size(); }))
    return error("a body is of a type that is not there");
  if (!std::ranges::all_of(c.word, [&](std::uint32_t word) { return word < words; }) ||
      !std::ranges::all_of(c.alias_word, [&](std::uint32_t word) { return word < words; }))
    return error("a body has a name that is not there");
  if (!std::ranges::all_of(c.alias_body, [&](std::uint32_t body) { return body < count; }))
    return error("a name is of a body that is not there");
  if (!std::ranges::all_of(c.pose, [](double x) { return std::abs(x) <= k_reach; }))
    return error("a body stands nowhere");

  spec.bodies.reserve(count);
  for (std::size_t b = 0; b < count; ++b)
    spec.bodies.push_back(
        {.name = {c.word[b], c.number[b]},
         .type = TypeId(c.type[b]),
         .pose_world_body = {c.pose[4 * b], c.pose[4 * b + 1], c.pose[4 * b + 2], c.pose[4 * b + 3]},
         .color = {c.color[4 * b], c.color[4 * b + 1], c.color[4 * b + 2], c.color[4 * b + 3]},
         .fiducial = c.fiducial.empty() ? 0 : c.fiducial[b],
         .where = here(c.file[b], c.line[b])});
  for (std::size_t a = 0; a < aliases; ++a)
    spec.aliases.push_back({{c.alias_word[a], c.alias_number[a]}, BodyId(c.alias_body[a])});
}

void SpecReader::check_part_names(const engine::WorldSpec& spec) {
  for (const auto& [name, place] : spec.part_aliases) {
    const std::size_t body = place.body.index();
    if (body >= spec.bodies.size() ||
        std::ranges::find(spec.types[spec.bodies[body].type.index()].parts, place.part,
                          &engine::PartSpec::name) == spec.types[spec.bodies[body].type.index()].parts.end())
      return error(fmt::format("\"{}\" names a part that is not there", name));
  }
}

void SpecReader::check_reserves(const engine::WorldSpec& spec) {
  std::size_t end = 1;  // the ground is always there
  for (const engine::ReserveSpec& reserve : spec.reserves) {
    const std::size_t first = reserve.first.index();
    const std::size_t last = first + reserve.count;
    if (first < end || last > spec.bodies.size() || reserve.count == 0)
      return error(
          fmt::format("the reserve of \"{}\" is of bodies that it cannot be of", reserve.population));
    for (std::size_t b = first; b < last; ++b)
      if (spec.bodies[b].type != spec.bodies[first].type)
        return error(fmt::format("the reserve of \"{}\" is of several types", reserve.population));
    end = last;
  }
}

}  // namespace

engine::WorldSpec restore_spec(const StoredSpec& stored, const engine::Registry& registry,
                               std::span<const std::pair<std::string, std::string>> changes, Where where,
                               Diagnostics& diagnostics) {
  std::optional<JsonNode> document = parse_json(stored.json, where, true, diagnostics);
  if (!document) return {};
  for (const auto& [pointer, value] : changes) {
    if (is_changeable(pointer))
      set_json_value(*document, pointer, value, diagnostics);
    else
      diagnostics.error(
          {diagnostics.files()->add("--set " + pointer), 0},
          fmt::format("a world that is under way keeps this; what can change: {}", k_changeable));
  }
  if (diagnostics.has_errors()) return {};
  SpecReader reader(registry, where, diagnostics);
  engine::WorldSpec spec = reader.read(*document);
  if (!diagnostics.has_errors()) reader.add_bodies(spec, stored.bodies);
  if (!diagnostics.has_errors()) reader.check_part_names(spec);
  if (!diagnostics.has_errors()) reader.check_reserves(spec);
  return spec;
}

}  // namespace troupe::worldio
