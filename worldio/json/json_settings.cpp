#include "worldio/json/json_settings.hpp"

#include "engine/watch_spec.hpp"
#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_record.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/window_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

namespace troupe::worldio {
namespace {

using engine::Field;
using engine::FieldType;
using engine::Unit;
using engine::Value;
using engine::WorldSpec;

constexpr std::int64_t k_version = 1;

const Field k_tick{.name = "tick", .unit = Unit::seconds, .min = 1e-6, .max = 3600};
const Field k_quit_time{.name = "quit_time", .unit = Unit::seconds, .min = 0, .max = 1e9, .above_min = true};
const Field k_measure_every{.name = "measure_every", .unit = Unit::seconds, .min = 0, .max = 1e9};
const Field k_resolution{.name = "resolution",
                         .unit = Unit::meters,
                         .min = engine::k_min_resolution_m,
                         .max = engine::k_max_resolution_m};
const Field k_overlaps{.name = "overlaps", .type = FieldType::text, .choices = {"error", "warn"}};
const Field k_mortal{.name = "mortal", .type = FieldType::boolean};
const Field k_same_names{.name = "same_names", .type = FieldType::text, .choices = {"error", "warn"}};

void read_version(JsonObject& object) {
  const JsonNode* node = object.require("troupe", fmt::format("the version of the format, {}", k_version));
  if (!node) return;
  const auto* version = std::get_if<std::int64_t>(&node->value);
  const JsonCursor at(object.at(), "troupe", *node);
  if (!version)
    at.expected(fmt::format("the version of the format, {}", k_version));
  else if (*version != k_version)
    at.error(fmt::format("format version {} is not known: this version reads {}", *version, k_version));
}

void read_seed(JsonObject& object, WorldSpec& spec) {
  const JsonNode* node = object.find("seed");
  if (!node) return;
  const auto* small = std::get_if<std::int64_t>(&node->value);
  const auto* big = std::get_if<std::uint64_t>(&node->value);
  if (big)
    spec.seed = *big;
  else if (small && *small >= 0)
    spec.seed = static_cast<std::uint64_t>(*small);
  else
    JsonCursor(object.at(), "seed", *node).expected("a whole number from 0 to 2^64 - 1");
}

void read_resolution(JsonObject& object, WorldSpec& spec) {
  const Value resolution = read_field(object, k_resolution);
  spec.resolution_where = object.at().where();
  for (const engine::UnitSuffix& unit : engine::unit_suffixes(Unit::meters))
    if (const JsonNode* node = object.find(fmt::format("resolution{}", unit.suffix)))
      spec.resolution_where = node->where;
  if (resolution.given()) spec.resolution_m = resolution.number();
}

/// The ground is a body, too, and may have another name, as in Stage.
void read_ground(JsonObject& object, WorldSpec& spec) {
  const JsonNode* node = object.find("ground");
  if (!node) return;
  const JsonCursor at(object.at(), "ground", *node);
  JsonObject ground(at);
  if (const JsonNode* alias = ground.require("alias", "another name of the ground"))
    if (const std::string* name = read_text(JsonCursor(at, "alias", *alias), "another name of the ground"))
      spec.aliases.push_back({spec.names.add(*name), BodyId(0)});
  ground.finish();
}

}  // namespace

JsonChecks read_settings(JsonObject& object, const LoadOptions& options, WorldSpec& spec) {
  if (const JsonNode* node = object.find("$schema"))  // of editors
    read_text(JsonCursor(object.at(), "$schema", *node), "where the schema of this file is");
  read_version(object);
  if (const JsonNode* node = object.find("title"))
    if (const std::string* title = read_text(JsonCursor(object.at(), "title", *node), "the world's title"))
      spec.title = *title;
  read_seed(object, spec);
  if (options.seed) spec.seed = *options.seed;
  if (const Value tick = read_field(object, k_tick); tick.given()) spec.tick_s = tick.number();
  if (const Value quit = read_field(object, k_quit_time); quit.given()) spec.quit_time_s = quit.number();
  if (const Value every = read_field(object, k_measure_every); every.given())
    spec.measure_every_s = every.number();
  const auto& names = engine::k_ranging_engines;
  const Value ranging = read_field(
      object, {.name = "ranging", .type = FieldType::text, .choices = {names.begin(), names.end()}});
  if (ranging.given())
    spec.ranging =
        static_cast<engine::RangingEngine>(std::ranges::find(names, ranging.text()) - names.begin());
  read_resolution(object, spec);
  spec.bounds = read_box(object, "bounds_m");
  read_ground(object, spec);
  if (const JsonNode* node = object.find("record"))
    spec.record = read_record(JsonCursor(object.at(), "record", *node));
  if (const auto watch = read_block(object, "watch", engine::watch_fields()))
    spec.watch = engine::watch_spec(*watch);
  spec.window = read_block(object, "window", window_fields());
  if (const Value mortal = read_field(object, k_mortal); mortal.given()) spec.mortal = mortal.boolean();
  const auto is_error = [&](const Field& field) {
    const Value value = read_field(object, field);
    return !value.given() || value.text() == "error";
  };
  JsonChecks checks;
  checks.overlaps = is_error(k_overlaps);
  checks.same_names = is_error(k_same_names);
  return checks;
}

void write_settings(const WorldSpec& spec, const JsonChecks& checks, std::string_view default_title,
                    bool with_bounds, JsonNode::Object& object) {
  const WorldSpec usual;
  add_member(object, "troupe", k_version);
  if (!spec.title.empty() && spec.title != default_title) add_member(object, "title", spec.title);
  add_member(object, "seed", spec.seed);
  write_field(k_tick, spec.tick_s, object);
  if (spec.quit_time_s) write_field(k_quit_time, *spec.quit_time_s, object);
  if (!same_bits(spec.measure_every_s, usual.measure_every_s))
    write_field(k_measure_every, spec.measure_every_s, object);
  if (spec.ranging != usual.ranging)
    add_member(object, "ranging", std::string(engine::ranging_engine_name(spec.ranging)));
  if (!same_bits(spec.resolution_m, usual.resolution_m)) write_field(k_resolution, spec.resolution_m, object);
  if (spec.bounds && with_bounds)
    add_node(object, "bounds_m", points_node(std::array{spec.bounds->min, spec.bounds->max}));
  for (const engine::NamedBody& alias : spec.aliases)
    if (alias.body == BodyId(0)) {
      JsonNode::Object ground;
      add_member(ground, "alias", spec.names.text(alias.name));
      add_member(object, "ground", std::move(ground));
      break;  // more than one nobody can say
    }
  if (spec.record) add_node(object, "record", record_node(*spec.record));
  const auto write_block = [&](std::string_view key, const engine::Record& record,
                               const engine::FieldTable& table) {
    JsonNode::Object block;
    write_fields(record, table, block);
    add_member(object, key, std::move(block));
  };
  if (spec.watch != usual.watch)
    write_block("watch", engine::watch_record(spec.watch), engine::watch_fields());
  if (spec.window) write_block("window", *spec.window, window_fields());
  if (spec.mortal) write_field(k_mortal, true, object);
  if (!checks.overlaps) write_field(k_overlaps, "warn", object);
  if (!checks.same_names) write_field(k_same_names, "warn", object);
}

}  // namespace troupe::worldio
