#include "worldio/json/experiment_json.hpp"

#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_parts.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/measures_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::Comparison;
using engine::FaultSpec;
using engine::Field;
using engine::FieldTable;
using engine::FieldType;
using engine::GroupSpec;
using engine::InterventionSpec;
using engine::Record;
using engine::SettingSpec;
using engine::StopSpec;
using engine::Unit;
using engine::Value;
using Action = InterventionSpec::Action;

constexpr double k_most_s = 1e9;
constexpr double k_most_bodies = 1e9;

const Field k_time{.name = "time", .unit = Unit::seconds, .min = 0, .max = k_most_s};
const Field k_from{.name = "from", .unit = Unit::seconds, .min = 0, .max = k_most_s};
const Field k_count{.name = "count", .type = FieldType::integer, .min = 0, .max = k_most_bodies};
const Field k_share{.name = "share", .min = 0, .max = 1};

/// In the order of GroupSpec::By.
constexpr std::array<std::string_view, 3> k_groups{"population", "type", "model"};
/// In the order of SettingSpec::Of.
constexpr std::array<std::string_view, 3> k_settings{"drive", "device", "controller"};

constexpr std::string_view k_condition =
    "a condition on a measure, as \"coverage >= 0.9\": one of <, <=, >, >=, ==, != and a number";

template <class Read>
void each(JsonObject& object, std::string_view key, Read read) {
  const JsonNode* node = object.find(key);
  if (!node) return;
  const JsonCursor cursor(object.at(), key, *node);
  const JsonNode::List* list = read_list(cursor);
  for (std::size_t i = 0; list && i < list->size(); ++i) read(JsonCursor(cursor, i, (*list)[i]), cursor, i);
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// `>= 0.9`; nothing where it is none.
std::optional<std::pair<Comparison, double>> comparison_of(std::string_view text) {
  std::optional<std::size_t> longest;
  for (std::size_t i = 0; i < engine::k_comparisons.size(); ++i)
    if (text.starts_with(engine::k_comparisons[i]) &&
        (!longest || engine::k_comparisons[i].size() > engine::k_comparisons[*longest].size()))
      longest = i;
  if (!longest) return std::nullopt;
  const std::string_view number = trimmed(text.substr(engine::k_comparisons[*longest].size()));
  double value = 0;
  const auto [end, fault] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (number.empty() || fault != std::errc() || end != number.data() + number.size() || !std::isfinite(value))
    return std::nullopt;
  return std::pair(static_cast<Comparison>(*longest), value);
}

std::optional<StopSpec> read_condition(const JsonCursor& at, const JsonCursor& list, std::size_t index,
                                       const engine::Registry& registry) {
  std::string_view compares;
  std::optional<engine::MeasureSpec> measure;
  if (at.node().object()) {
    JsonObject object(at);
    if (const JsonNode* node = object.require("measure", "the name of a measure, or {\"kind\": ..., ...}"))
      measure = read_measure(JsonCursor(at, "measure", *node), registry);
    const JsonNode* node = object.require("is", "what it is compared with, as \">= 0.9\"");
    object.finish();
    const std::string* text =
        node ? read_text(JsonCursor(at, "is", *node), "what it is compared with, as \">= 0.9\"") : nullptr;
    if (text) compares = trimmed(*text);
    if (!text || !measure) return std::nullopt;
  } else {
    const std::string* text = read_text(at, k_condition);
    if (!text) return std::nullopt;
    const std::size_t sign = std::min(text->find_first_of("<>=!"), text->size());
    JsonNode name = json_node(std::string(trimmed(std::string_view(*text).substr(0, sign))), at.where());
    compares = trimmed(std::string_view(*text).substr(sign));
    if (compares.empty() || name.text()->empty()) {
      at.expected(k_condition);
      return std::nullopt;
    }
    measure = read_measure(JsonCursor(list, index, name), registry);
    if (!measure) return std::nullopt;
  }
  const auto comparison = comparison_of(compares);
  if (!comparison) {
    at.error(fmt::format("\"{}\" is no comparison with a number: one of <, <=, >, >=, ==, != and the number",
                         compares));
    return std::nullopt;
  }
  return StopSpec{std::move(*measure), comparison->first, comparison->second};
}

/// One of the groups, and how many of it.
GroupSpec read_group(JsonObject& object, bool with_number) {
  GroupSpec group;
  std::size_t given = 0;
  for (std::size_t i = 0; i < k_groups.size(); ++i) {
    const JsonNode* node = object.find(k_groups[i]);
    if (!node) continue;
    const std::string* name = read_text(JsonCursor(object.at(), k_groups[i], *node), "a name");
    group.by = static_cast<GroupSpec::By>(i);
    if (name) group.name = *name;
    ++given;
  }
  if (object.is_object() && given != 1)
    object.at().error(fmt::format("give one of \"population\", \"type\" and \"model\": whom is it about?{}",
                                  given > 1 ? " Here are several" : ""));
  if (!with_number) return group;
  if (const Value count = read_field(object, k_count); count.given()) group.count = count.integer();
  if (const Value share = read_field(object, k_share); share.given()) group.share = share.number();
  if (group.count && group.share) object.at().error("give \"count\" or \"share\", not both");
  return group;
}

GroupSpec read_named(JsonObject& object, GroupSpec::By by, std::string_view hint) {
  GroupSpec group{.by = by, .name = {}, .count = {}, .share = {}};
  const std::string_view key = k_groups[static_cast<std::size_t>(by)];
  if (const JsonNode* node = object.require(key, hint))
    if (const std::string* name = read_text(JsonCursor(object.at(), key, *node), "a name"))
      group.name = *name;
  return group;
}

/// Those of a table that are given; the others are not. The last of what an object has.
Record read_some(JsonObject& object, const FieldTable& table) {
  const std::size_t before = object.at().diagnostics().findings().size();
  Record record;
  for (const Field& field : table.fields) record.push_back(read_field(object, field));
  object.finish();
  if (object.is_object() && std::ranges::none_of(record, &Value::given) &&
      object.at().diagnostics().findings().size() == before)
    object.at().error("nothing is set: give the parameters that change");
  return record;
}

void write_some(const Record& record, const FieldTable& table, JsonNode::Object& object) {
  for (std::size_t i = 0; i < table.fields.size() && i < record.size(); ++i)
    write_field(table.fields[i], record[i], object);
}

template <class List, class Projection>
std::vector<std::string_view> names_of(const List& list, Projection name) {
  std::vector<std::string_view> names;
  for (const auto& entry : list) names.push_back(entry.*name);
  return names;
}

class ExperimentReader {
 public:
  ExperimentReader(std::span<const std::string> type_keys, const engine::Registry& registry,
                   engine::WorldSpec& spec)
      : type_keys_(type_keys), registry_(registry), spec_(spec) {}

  void read(JsonObject& object) {
    engine::ExperimentSpec& experiment = spec_.experiment;
    each(object, "stop_when", [&](const JsonCursor& at, const JsonCursor& list, std::size_t index) {
      if (auto condition = read_condition(at, list, index, registry_))
        experiment.stop_when.push_back(std::move(*condition));
    });
    each(object, "at", [&](const JsonCursor& at, const JsonCursor&, std::size_t) {
      if (auto intervention = read_intervention(at)) experiment.at.push_back(std::move(*intervention));
    });
    each(object, "faults", [&](const JsonCursor& at, const JsonCursor&, std::size_t) {
      experiment.faults.push_back(read_fault(at));
    });
  }

 private:
  std::optional<InterventionSpec> read_intervention(const JsonCursor& at);
  void read_action(const JsonCursor& at, InterventionSpec& intervention);
  std::optional<SettingSpec> read_setting(JsonObject& object);
  Record read_device(const JsonCursor& at, const engine::TypeSpec& type, SettingSpec& setting);
  Record read_controller(const JsonCursor& at, const engine::TypeSpec& type, SettingSpec& setting);
  FaultSpec read_fault(const JsonCursor& at);

  std::span<const std::string> type_keys_;
  const engine::Registry& registry_;
  engine::WorldSpec& spec_;
};

std::optional<InterventionSpec> ExperimentReader::read_intervention(const JsonCursor& at) {
  JsonObject object(at);
  if (!object.is_object()) return std::nullopt;
  InterventionSpec intervention{.where = at.where()};
  const std::size_t before = at.diagnostics().findings().size();
  if (const Value time = read_field(object, k_time); time.given())
    intervention.time_s = time.number();
  else if (at.diagnostics().findings().size() == before)
    object.missing("time_s", "when it is done");
  std::size_t given = 0;
  for (std::size_t i = 0; i < engine::k_actions.size(); ++i) {
    const JsonNode* node = object.find(engine::k_actions[i]);
    if (!node) continue;
    if (++given > 1) {
      at.error_at(node->where, "one thing is done at a time: give each an entry of its own");
      continue;
    }
    intervention.action = static_cast<Action>(i);
    read_action(JsonCursor(at, engine::k_actions[i], *node), intervention);
  }
  object.finish();
  if (given == 0) at.error(fmt::format("nothing is done: give one of {}", comma_list(engine::k_actions)));
  return intervention;
}

void ExperimentReader::read_action(const JsonCursor& at, InterventionSpec& intervention) {
  JsonObject object(at);
  switch (intervention.action) {
    case Action::remove:
    case Action::disable:
    case Action::enable: intervention.whom = read_group(object, true); break;
    case Action::add:
      intervention.whom = read_named(object, GroupSpec::By::population, "one that has a reserve");
      if (const Value count = read_field(object, k_count); count.given())
        intervention.whom.count = count.integer();
      if (object.find("pose")) intervention.pose = read_pose(object);
      intervention.region = read_box(object, "region_m");
      if (intervention.pose && object.find("region_m")) at.error("give \"pose\" or \"region_m\", not both");
      break;
    case Action::move:
      intervention.whom = read_named(object, GroupSpec::By::model, "the body that is put elsewhere");
      intervention.pose = read_pose(object);
      if (!object.find("pose")) object.missing("pose", "where it is put");
      break;
    case Action::set: intervention.setting = read_setting(object); break;
  }
  object.finish();
}

std::optional<SettingSpec> ExperimentReader::read_setting(JsonObject& object) {
  const JsonCursor& at = object.at();
  const JsonNode* type_node = object.require("type", "the name of one of /types");
  const std::string* key =
      type_node ? read_text(JsonCursor(at, "type", *type_node), "the name of one of /types") : nullptr;
  for (const std::string_view of : k_settings) object.find(of);
  if (!key) return std::nullopt;
  const auto found = std::ranges::find(type_keys_, *key);
  if (key->empty() || found == type_keys_.end()) {
    std::vector<std::string_view> known(type_keys_.begin(), type_keys_.end());
    std::erase(known, std::string_view());
    JsonCursor(at, "type", *type_node).error(unknown_name("type", *key, std::move(known)));
    return std::nullopt;
  }
  SettingSpec setting{.type = TypeId(static_cast<std::size_t>(found - type_keys_.begin())), .params = {}};
  const engine::TypeSpec& type = spec_.types[setting.type.index()];
  std::size_t given = 0;
  for (std::size_t i = 0; i < k_settings.size(); ++i) {
    const JsonNode* node = object.find(k_settings[i]);
    if (!node || ++given > 1) continue;
    const JsonCursor cursor(at, k_settings[i], *node);
    setting.of = static_cast<SettingSpec::Of>(i);
    switch (setting.of) {
      case SettingSpec::Of::drive: {
        JsonObject drive(cursor);
        const engine::DriveKind* kind = type.drive ? registry_.drive(type.drive->kind) : nullptr;
        if (!kind) {
          cursor.error(fmt::format("type \"{}\" has no drive", *key));
          break;
        }
        setting.params = read_some(drive, kind->params);
        break;
      }
      case SettingSpec::Of::device: setting.params = read_device(cursor, type, setting); break;
      case SettingSpec::Of::controller: setting.params = read_controller(cursor, type, setting); break;
    }
  }
  if (given != 1) at.error(fmt::format("give one of {}: what of the type is set?", comma_list(k_settings)));
  return setting;
}

Record ExperimentReader::read_device(const JsonCursor& at, const engine::TypeSpec& type,
                                     SettingSpec& setting) {
  JsonObject object(at);
  const JsonNode* node = object.require("name", "which of the type's sensors and devices");
  const std::string* name = node ? read_text(JsonCursor(at, "name", *node), "a name") : nullptr;
  if (!name) return {};
  const auto device = std::ranges::find(type.devices, *name, &engine::DeviceSpec::name);
  const engine::DeviceKind* kind = device == type.devices.end() ? nullptr : registry_.device(device->kind);
  if (!kind) {
    JsonCursor(at, "name", *node)
        .error(unknown_name("device", *name, names_of(type.devices, &engine::DeviceSpec::name)));
    return {};
  }
  setting.index = static_cast<std::uint32_t>(device - type.devices.begin());
  return read_some(object, kind->params);
}

Record ExperimentReader::read_controller(const JsonCursor& at, const engine::TypeSpec& type,
                                         SettingSpec& setting) {
  JsonObject object(at);
  const JsonNode* node = object.require("kind", "which of the type's controllers");
  const std::string* name =
      node ? read_text(JsonCursor(at, "kind", *node), "the kind of a controller") : nullptr;
  if (!name) return {};
  const engine::Registry::Preset* preset = registry_.preset(*name);
  const std::string_view wanted = preset ? preset->kind : std::string_view(*name);
  const auto controller = std::ranges::find(type.controllers, wanted, &engine::ControllerSpec::kind);
  const engine::ControllerKind* kind =
      controller == type.controllers.end() ? nullptr : registry_.controller(controller->kind);
  if (!kind) {
    JsonCursor(at, "kind", *node)
        .error(unknown_name("controller of the type", *name,
                            names_of(type.controllers, &engine::ControllerSpec::kind)));
    return {};
  }
  setting.index = static_cast<std::uint32_t>(controller - type.controllers.begin());
  return read_some(object, kind->params);
}

FaultSpec ExperimentReader::read_fault(const JsonCursor& at) {
  JsonObject object(at);
  FaultSpec fault{.whom = read_group(object, true), .ailments = {}, .where = at.where()};
  if (const Value from = read_field(object, k_from); from.given()) fault.from_s = from.number();
  for (const engine::FaultKind& kind : registry_.faults)
    if (auto params = read_block(object, kind.name, kind.params))
      fault.ailments.push_back({std::string(kind.name), std::move(*params)});
  object.finish();
  if (object.is_object() && fault.ailments.empty())
    at.error(fmt::format("nobody fails: give one of {}",
                         comma_list(names_of(registry_.faults, &engine::FaultKind::name))));
  return fault;
}

// ---- writing

JsonNode condition_node(const StopSpec& condition, const engine::Registry& registry) {
  const engine::MeasureSpec& measure = condition.measure;
  const engine::MeasureKind* kind = registry.measure(measure.kind);
  const Record defaults = kind ? kind->params.defaults() : Record();
  const bool is_plain = measure.name.empty() &&
                        std::ranges::equal(measure.params, defaults,
                                           [](const Value& a, const Value& b) { return same_bits(a, b); });
  if (is_plain) return json_node(engine::text_of(condition), measure.where);
  JsonNode::Object object;
  add_node(object, "measure", measure_node(measure, registry));
  add_member(object, "is",
             fmt::format("{} {}", engine::k_comparisons[static_cast<std::size_t>(condition.comparison)],
                         condition.value));
  return json_node(std::move(object), measure.where);
}

void write_group(const GroupSpec& group, JsonNode::Object& object) {
  add_member(object, k_groups[static_cast<std::size_t>(group.by)], group.name);
  if (group.count) write_field(k_count, *group.count, object);
  if (group.share) write_field(k_share, *group.share, object);
}

JsonNode setting_node(const SettingSpec& setting, const engine::WorldSpec& spec,
                      std::span<const std::string> type_keys, const engine::Registry& registry) {
  const engine::TypeSpec& type = spec.types[setting.type.index()];
  JsonNode::Object inner;
  switch (setting.of) {
    case SettingSpec::Of::drive:
      if (const auto* kind = registry.drive(type.drive->kind))
        write_some(setting.params, kind->params, inner);
      break;
    case SettingSpec::Of::device: {
      const engine::DeviceSpec& device = type.devices[setting.index];
      add_member(inner, "name", device.name);
      if (const auto* kind = registry.device(device.kind)) write_some(setting.params, kind->params, inner);
      break;
    }
    case SettingSpec::Of::controller: {
      const engine::ControllerSpec& controller = type.controllers[setting.index];
      add_member(inner, "kind", controller.kind);
      if (const auto* kind = registry.controller(controller.kind))
        write_some(setting.params, kind->params, inner);
      break;
    }
  }
  JsonNode::Object object;
  add_member(object, "type", type_keys[setting.type.index()]);
  add_member(object, k_settings[static_cast<std::size_t>(setting.of)], std::move(inner));
  return json_node(std::move(object));
}

JsonNode intervention_node(const InterventionSpec& intervention, const engine::WorldSpec& spec,
                           std::span<const std::string> type_keys, const engine::Registry& registry) {
  JsonNode::Object object;
  write_field(k_time, intervention.time_s, object);
  const std::string_view action = engine::k_actions[static_cast<std::size_t>(intervention.action)];
  if (intervention.setting) {
    add_node(object, action, setting_node(*intervention.setting, spec, type_keys, registry));
  } else {
    JsonNode::Object inner;
    write_group(intervention.whom, inner);
    if (intervention.pose) write_place(*intervention.pose, inner);
    if (intervention.region)
      add_node(inner, "region_m",
               points_node(std::array{intervention.region->min, intervention.region->max}));
    add_member(object, action, std::move(inner));
  }
  return json_node(std::move(object), intervention.where);
}

JsonNode fault_node(const FaultSpec& fault, const engine::Registry& registry) {
  JsonNode::Object object;
  write_group(fault.whom, object);
  if (!same_bits(fault.from_s, 0)) write_field(k_from, fault.from_s, object);
  for (const FaultSpec::Ailment& ailment : fault.ailments) {
    JsonNode::Object params;
    if (const engine::FaultKind* kind = registry.fault(ailment.kind))
      write_fields(ailment.params, kind->params, params);
    add_member(object, ailment.kind, std::move(params));
  }
  return json_node(std::move(object), fault.where);
}

}  // namespace

void read_experiment(JsonObject& object, std::span<const std::string> type_keys,
                     const engine::Registry& registry, engine::WorldSpec& spec) {
  ExperimentReader(type_keys, registry, spec).read(object);
}

void write_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                      const engine::Registry& registry, JsonNode::Object& object) {
  const auto write = [&](std::string_view key, const auto& entries, auto node) {
    JsonNode::List list;
    for (const auto& entry : entries) list.push_back(node(entry));
    if (!list.empty()) add_member(object, key, std::move(list));
  };
  const engine::ExperimentSpec& experiment = spec.experiment;
  write("stop_when", experiment.stop_when,
        [&](const StopSpec& condition) { return condition_node(condition, registry); });
  write("at", experiment.at, [&](const InterventionSpec& intervention) {
    return intervention_node(intervention, spec, type_keys, registry);
  });
  write("faults", experiment.faults, [&](const FaultSpec& fault) { return fault_node(fault, registry); });
}

}  // namespace troupe::worldio
