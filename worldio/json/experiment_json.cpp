#include "worldio/json/experiment_json.hpp"

#include "worldio/json/fields_json.hpp"
#include "worldio/json/json_text.hpp"
#include "worldio/json/read_document.hpp"
#include "worldio/json/write_document.hpp"
#include "worldio/load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::FaultSpec;
using engine::Field;
using engine::FieldTable;
using engine::GroupSpec;
using engine::InterventionSpec;
using engine::Record;
using engine::SettingSpec;
using engine::StopSpec;
using engine::Value;
using Action = InterventionSpec::Action;

GroupSpec expand_group(const GroupDocument& document) {
  GroupSpec group;
  for (const auto& [by, name] :
       {std::pair(GroupSpec::By::population, &document.population),
        std::pair(GroupSpec::By::type, &document.type), std::pair(GroupSpec::By::model, &document.model)})
    if (*name) {
      group.by = by;
      group.name = **name;
    }
  group.count = document.count;
  group.share = document.share;
  return group;
}

void contract_group(const GroupSpec& group, GroupDocument& document) {
  switch (group.by) {
    case GroupSpec::By::population: document.population = group.name; break;
    case GroupSpec::By::type: document.type = group.name; break;
    case GroupSpec::By::model: document.model = group.name; break;
  }
  document.count = group.count;
  document.share = group.share;
}

/// Reads those fields of a table that an object has; the other values of the record are not given. Reports an
/// error for every other key of the object, and for an object without any field.
Record read_some(JsonObject& object, const FieldTable& table) {
  const std::size_t before = object.at().diagnostics().findings().size();
  Record record;
  for (const Field& field : table.fields) record.push_back(read_field(object, field));
  object.finish();
  if (object.is_object() && std::ranges::none_of(record, &Value::given) &&
      object.at().diagnostics().findings().size() == before)
    object.at().error("no parameter is given: expected at least one parameter with its new value");
  return record;
}

void write_some(const Record& record, const FieldTable& table, JsonNode::Object& object) {
  for (std::size_t i = 0; i < table.fields.size() && i < record.size(); ++i)
    write_field(table.fields[i], record[i], object);
}

/// Whether parameters_json() writes this value. It leaves out blocks (records and lists of records), and
/// values with a number that is not finite, because JSON has no such numbers.
bool is_simple(const Value& value) {
  if (const auto* x = std::get_if<double>(&value.v)) return std::isfinite(*x);
  if (const auto* list = std::get_if<std::vector<double>>(&value.v))
    return std::ranges::all_of(*list, [](double x) { return std::isfinite(x); });
  return !std::holds_alternative<std::vector<Record>>(value.v);
}

/// Reads the new parameters that an intervention gives to a type. The document stores them as unread JSON,
/// because the type determines which parameters are valid.
class SettingExpander {
 public:
  SettingExpander(std::span<const std::string> type_keys, const engine::Registry& registry,
                  const engine::WorldSpec& spec)
      : type_keys_(type_keys), registry_(registry), spec_(spec) {
    for (std::size_t t = 0; t < type_keys.size(); ++t)
      if (!type_keys[t].empty()) type_ids_.emplace(type_keys[t], t);
  }

  std::optional<SettingSpec> expand(const SettingDocument& document, const DocumentPath& at) const;

 private:
  Record expand_drive(const JsonCursor& at, const engine::TypeSpec& type, const std::string& key) const;
  Record expand_device(const JsonCursor& at, const engine::TypeSpec& type, SettingSpec& setting) const;
  Record expand_controller(const JsonCursor& at, const engine::TypeSpec& type, SettingSpec& setting) const;

  std::span<const std::string> type_keys_;
  std::unordered_map<std::string_view, TypeId> type_ids_;  // by key
  const engine::Registry& registry_;
  const engine::WorldSpec& spec_;
};

std::optional<SettingSpec> SettingExpander::expand(const SettingDocument& document,
                                                   const DocumentPath& at) const {
  if (document.type.empty() || has_error_in(at.diagnostics(), "/types")) return std::nullopt;
  const auto found = type_ids_.find(document.type);
  if (found == type_ids_.end()) {
    std::vector<std::string_view> known;
    for (const auto& [key, type] : type_ids_) known.push_back(key);
    std::string text = unknown_name("type", document.type, std::move(known));
    const auto named = std::ranges::find(spec_.types, document.type, &engine::TypeSpec::name);
    const auto t = static_cast<std::size_t>(named - spec_.types.begin());
    if (t < type_keys_.size() && !type_keys_[t].empty())
      text += fmt::format("; \"{}\" is the \"name\" of a type: give its key in \"types\", \"{}\"",
                          document.type, type_keys_[t]);
    DocumentPath(at, "type", document.where_of("type")).error(text);
    return std::nullopt;
  }
  SettingSpec setting{.type = found->second};
  const engine::TypeSpec& type = spec_.types[setting.type.index()];
  if (document.drive) {
    setting.of = SettingSpec::Of::drive;
    setting.params = expand_drive(JsonCursor(at, "drive", *document.drive), type, document.type);
  } else if (document.device) {
    setting.of = SettingSpec::Of::device;
    setting.params = expand_device(JsonCursor(at, "device", *document.device), type, setting);
  } else if (document.controller) {
    setting.of = SettingSpec::Of::controller;
    setting.params = expand_controller(JsonCursor(at, "controller", *document.controller), type, setting);
  }
  return setting;
}

Record SettingExpander::expand_drive(const JsonCursor& at, const engine::TypeSpec& type,
                                     const std::string& key) const {
  JsonObject object(at);
  const engine::DriveKind* kind = type.drive ? registry_.drive(type.drive->kind) : nullptr;
  if (kind) return read_some(object, kind->params);
  at.error(fmt::format("type \"{}\" has no drive whose parameters could be set: remove this key", key));
  return {};
}

Record SettingExpander::expand_device(const JsonCursor& at, const engine::TypeSpec& type,
                                      SettingSpec& setting) const {
  JsonObject object(at);
  const JsonNode* node = object.require("name", "the name of a sensor or device of the type");
  const std::string* name = node ? read_text(JsonCursor(at, "name", *node), "a name") : nullptr;
  if (!name) return {};
  const auto device = std::ranges::find(type.devices, *name, &engine::DeviceSpec::name);
  const engine::DeviceKind* kind = device == type.devices.end() ? nullptr : registry_.device(device->kind);
  if (!kind) {
    JsonCursor(at, "name", *node).error(unknown_name("device", *name, name_list(type.devices)));
    return {};
  }
  setting.index = static_cast<std::uint32_t>(device - type.devices.begin());
  return read_some(object, kind->params);
}

Record SettingExpander::expand_controller(const JsonCursor& at, const engine::TypeSpec& type,
                                          SettingSpec& setting) const {
  JsonObject object(at);
  const JsonNode* node = object.require("kind", "the kind of one of the controllers of the type");
  const std::string* name =
      node ? read_text(JsonCursor(at, "kind", *node), "the kind of a controller") : nullptr;
  if (!name) return {};
  const engine::Registry::Preset* preset = registry_.preset(*name);
  const std::string_view wanted = preset ? preset->kind : std::string_view(*name);
  const auto controller = std::ranges::find(type.controllers, wanted, &engine::ControllerSpec::kind);
  const engine::ControllerKind* kind =
      controller == type.controllers.end() ? nullptr : registry_.controller(controller->kind);
  if (!kind) {
    std::vector<std::string_view> kinds;
    for (const engine::ControllerSpec& each : type.controllers) kinds.push_back(each.kind);
    JsonCursor(at, "kind", *node).error(unknown_name("controller of this type", *name, std::move(kinds)));
    return {};
  }
  setting.index = static_cast<std::uint32_t>(controller - type.controllers.begin());
  return read_some(object, kind->params);
}

InterventionSpec expand_intervention(const InterventionDocument& document, const DocumentPath& at,
                                     const SettingExpander& settings) {
  InterventionSpec intervention{.time_s = document.time.value_or(0), .where = document.where};
  if (document.set) {
    intervention.action = Action::set;
    intervention.setting = settings.expand(*document.set, DocumentPath(at, "set", document.set->where));
  } else if (document.add) {
    intervention.action = Action::add;
    intervention.whom = {
        .by = GroupSpec::By::population, .name = document.add->population, .count = document.add->count};
    intervention.pose = document.add->pose;
    intervention.region = document.add->region;
  } else if (document.move) {
    intervention.action = Action::move;
    intervention.whom = {.by = GroupSpec::By::model, .name = document.move->model};
    intervention.pose = document.move->pose;
  } else {
    intervention.action = document.disable  ? Action::disable
                          : document.enable ? Action::enable
                                            : Action::remove;
    const auto& group = document.disable  ? document.disable
                        : document.enable ? document.enable
                                          : document.remove;
    if (group) intervention.whom = expand_group(*group);
  }
  return intervention;
}

SettingDocument contract_setting(const SettingSpec& setting, const engine::WorldSpec& spec,
                                 std::span<const std::string> type_keys, const engine::Registry& registry) {
  const engine::TypeSpec& type = spec.types[setting.type.index()];
  SettingDocument document;
  document.type = type_keys[setting.type.index()];
  JsonNode::Object object;
  switch (setting.of) {
    case SettingSpec::Of::drive:
      if (const auto* kind = registry.drive(type.drive->kind))
        write_some(setting.params, kind->params, object);
      document.drive = json_node(std::move(object));
      break;
    case SettingSpec::Of::device: {
      const engine::DeviceSpec& device = type.devices[setting.index];
      add_member(object, "name", device.name);
      if (const auto* kind = registry.device(device.kind)) write_some(setting.params, kind->params, object);
      document.device = json_node(std::move(object));
      break;
    }
    case SettingSpec::Of::controller: {
      const engine::ControllerSpec& controller = type.controllers[setting.index];
      add_member(object, "kind", controller.kind);
      if (const auto* kind = registry.controller(controller.kind))
        write_some(setting.params, kind->params, object);
      document.controller = json_node(std::move(object));
      break;
    }
  }
  return document;
}

InterventionDocument contract_intervention(const InterventionSpec& intervention,
                                           const engine::WorldSpec& spec,
                                           std::span<const std::string> type_keys,
                                           const engine::Registry& registry) {
  InterventionDocument document;
  document.where = intervention.where;
  document.time = intervention.time_s;
  const GroupSpec& whom = intervention.whom;
  switch (intervention.action) {
    case Action::remove: contract_group(whom, document.remove.emplace()); break;
    case Action::disable: contract_group(whom, document.disable.emplace()); break;
    case Action::enable: contract_group(whom, document.enable.emplace()); break;
    case Action::add: {
      AddDocument& add = document.add.emplace();
      add.population = whom.name;
      add.count = whom.count;
      add.pose = intervention.pose;
      add.region = intervention.region;
      break;
    }
    case Action::move: {
      MoveDocument& move = document.move.emplace();
      move.model = whom.name;
      move.pose = intervention.pose;
      break;
    }
    case Action::set:
      if (intervention.setting)
        document.set = contract_setting(*intervention.setting, spec, type_keys, registry);
      break;
  }
  return document;
}

}  // namespace

engine::MeasureSpec expand_measure(const MeasureDocument& document) {
  return {.kind = document.kind,
          .name = document.name,
          .of = document.of,
          .params = document.params,
          .where = document.where};
}

MeasureDocument contract_measure(const engine::MeasureSpec& measure) {
  MeasureDocument document;
  document.where = measure.where;
  document.kind = measure.kind;
  document.of = measure.of;
  document.name = measure.name;
  document.params = measure.params;
  return document;
}

void expand_experiment(const ExperimentDocument& document, const DocumentPath& world, Where where_at,
                       std::span<const std::string> type_keys, const engine::Registry& registry,
                       engine::WorldSpec& spec) {
  engine::ExperimentSpec& experiment = spec.experiment;
  for (const ConditionDocument& condition : document.stop_when)
    if (condition.measure && condition.is)
      experiment.stop_when.push_back(
          {expand_measure(*condition.measure), condition.is->how, condition.is->with});
  const SettingExpander settings(type_keys, registry, spec);
  const DocumentPath all(world, "at", where_at);
  for (std::size_t i = 0; i < document.at.size(); ++i) {
    const InterventionDocument& entry = document.at[i];
    experiment.at.push_back(expand_intervention(entry, DocumentPath(all, i, entry.where), settings));
  }
  for (const FaultDocument& entry : document.faults) {
    FaultSpec fault{.whom = expand_group(entry), .from_s = entry.from, .where = entry.where};
    for (const FaultDocument::Impairment& one : entry.impairments)
      fault.impairments.push_back({one.kind, one.params});
    experiment.faults.push_back(std::move(fault));
  }
}

void contract_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                         const engine::Registry& registry, ExperimentDocument& document) {
  for (const StopSpec& condition : spec.experiment.stop_when) {
    ConditionDocument& entry = document.stop_when.emplace_back();
    entry.where = condition.measure.where;
    entry.measure = contract_measure(condition.measure);
    entry.is = {condition.comparison, condition.value};
  }
  for (const InterventionSpec& intervention : spec.experiment.at)
    document.at.push_back(contract_intervention(intervention, spec, type_keys, registry));
  for (const FaultSpec& fault : spec.experiment.faults) {
    FaultDocument& entry = document.faults.emplace_back();
    entry.where = fault.where;
    contract_group(fault.whom, entry);
    entry.from = fault.from_s;
    for (const FaultSpec::Impairment& one : fault.impairments)
      entry.impairments.push_back({one.kind, one.params});
  }
}

std::optional<SettingSpec> read_setting(std::string_view type, std::string_view json,
                                        const engine::Registry& registry, const engine::WorldSpec& spec,
                                        Diagnostics& diagnostics) {
  std::optional<JsonNode> node = parse_json(json, {}, true, diagnostics);
  if (!node) return {};
  const std::size_t before = diagnostics.findings().size();
  const JsonCursor at(*node, diagnostics);
  if (node->find("type"))
    at.error(
        "unknown key \"type\": another argument already names the type; remove the key from this JSON text");
  if (auto* object = std::get_if<JsonNode::Object>(&node->value))
    add_member(*object, "type", std::string(type));
  const auto document = read_document<SettingDocument>(at, {registry, LoadOptions().most_bodies});
  if (diagnostics.findings().size() > before) return {};
  std::vector<std::string> names;
  for (const engine::TypeSpec& each : spec.types) names.push_back(each.name);
  std::optional<SettingSpec> setting = SettingExpander(names, registry, spec).expand(document, at);
  return diagnostics.findings().size() > before ? std::nullopt : setting;
}

std::string parameters_json(const engine::TypeSpec& type, const engine::Registry& registry) {
  JsonNode::List all;
  const auto add = [&](std::string_view of, std::string_view key, const std::string& name,
                       const Record& params, const FieldTable* table) {
    if (!table || table->fields.empty()) return;
    JsonNode::Object owner;
    if (!key.empty()) add_member(owner, key, name);
    for (std::size_t i = 0; i < std::min(table->fields.size(), params.size()); ++i)
      if (is_simple(params[i])) write_field(table->fields[i], params[i], owner);
    JsonNode::Object setting;
    add_member(setting, of, std::move(owner));
    all.push_back(json_node(std::move(setting)));
  };
  if (type.drive)
    if (const auto* kind = registry.drive(type.drive->kind))
      add("drive", "", "", type.drive->params, &kind->params);
  for (const engine::DeviceSpec& device : type.devices)
    if (const auto* kind = registry.device(device.kind))
      add("device", "name", device.name, device.params, &kind->params);
  for (const engine::ControllerSpec& controller : type.controllers)
    if (const auto* kind = registry.controller(controller.kind))
      add("controller", "kind", controller.kind, controller.params, &kind->params);
  return json_line(json_node(std::move(all)));
}

void read_experiment(JsonObject& object, std::span<const std::string> type_keys,
                     const engine::Registry& registry, engine::WorldSpec& spec) {
  ExperimentDocument document;
  read_described_keys(object, document_table<ExperimentDocument>(), {registry, LoadOptions().most_bodies},
                      &document);
  expand_experiment(document, object.at(), document.where_of("at"), type_keys, registry, spec);
}

void write_experiment(const engine::WorldSpec& spec, std::span<const std::string> type_keys,
                      const engine::Registry& registry, JsonNode::Object& object) {
  ExperimentDocument document;
  contract_experiment(spec, type_keys, registry, document);
  JsonNode node = write_document(document, registry);
  for (JsonMember& member : std::get<JsonNode::Object>(node.value)) object.push_back(std::move(member));
}

}  // namespace troupe::worldio
