#include "worldio/stage/stage_lint.hpp"

#include "base/split.hpp"
#include "worldio/stage/stage_limits.hpp"
#include "worldio/stage/stage_properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <unordered_map>

namespace troupe::worldio {
namespace {

std::string with_article(std::string_view type) {
  if (type == "world") return "the world";
  return fmt::format("{} {}", type == "actuator" ? "an" : "a", type);
}

/// Returns the name of a property for messages: "mass" for a property of every model or of the world, but
/// "noise of a sensor" for a property of one type.
std::string called(const StageRow& row) {
  if (row.type == "model" || row.type == "world") return std::string(row.name);
  return fmt::format("{} of {}", row.name, with_article(row.type));
}

}  // namespace

void StageLint::add(Summary& summary, Where where, std::string name) {
  if (values_.thorough()) {
    values_.warning(where, fmt::format("{}: {}", name, summary.each));
    return;
  }
  if (summary.names.empty()) summary.first = where;
  if (std::ranges::find(summary.names, name) == summary.names.end()) summary.names.push_back(std::move(name));
}

void StageLint::check_world() {
  check_repeated(document_.world);
  check_old(document_.world, "world");
  for (const StageProperty& property : document_.world) check_property(property, "world");
}

void StageLint::check(const StageEntity& entity, std::size_t depth) {
  if (depth > k_deepest_nesting) return;
  const auto model = macros_.resolve(entity);
  if (!model) return;
  if (macros_.is_only_a_body(model->type))
    values_.warning_once(
        model->where,
        fmt::format("Troupe does not implement {}: this model is a body that neither senses nor acts",
                    with_article(model->type)));
  if (values_.thorough()) check_overruled(*model, depth == 0);
  for (const StageEntity* layer : model->layers) {
    if (layer != &entity && !macros_seen_.insert(layer).second) continue;
    check_repeated(document_.properties(*layer));
    check_old(document_.properties(*layer), model->alias.empty() ? model->type : model->alias);
    for (const StageProperty& property : document_.properties(*layer))
      check_property(property, model->alias.empty() ? model->type : model->alias);
    for (const StageEntity& child : document_.children(*layer)) check(child, depth + 1);
  }
}

void StageLint::check_property(const StageProperty& property, std::string_view type) {
  const std::string_view key = values_.key(property);
  const Where where = values_.where(property);
  const StageRow* row = find_stage_row(type, key);
  if (!row) {
    const bool is_transducers = type == "ranger" && find_stage_row("sensor", key) != nullptr;
    const std::vector<std::string_view> known = stage_property_names(type);
    values_.warning_once(
        where, fmt::format("{} has no property \"{}\"; the property is ignored{}", with_article(type), key,
                           is_transducers ? ": write it inside a sensor( ... )" : did_you_mean(key, known)));
    return;
  }
  switch (row->support) {
    case StageSupport::honoured:
    case StageSupport::fixed:
    case StageSupport::window_camera: break;
    case StageSupport::no_effect: add(no_effect_, where, called(*row)); break;
    case StageSupport::window_only: add(window_only_, where, called(*row)); break;
    case StageSupport::obsolete:
      if (row->note.empty()) add(obsolete_, where, called(*row));  // check_old() reports the others
  }
}

/// Reports the obsolete properties of an entity for which there is something to write today, those with the
/// same replacement together.
void StageLint::check_old(std::span<const StageProperty> properties, std::string_view type) {
  struct Old {
    const StageRow* row;
    Where first;
    std::vector<std::string_view> names;
  };
  std::vector<Old> all;
  for (const StageProperty& property : properties) {
    const StageRow* row = find_stage_row(type, values_.key(property));
    if (!row || row->support != StageSupport::obsolete || row->note.empty()) continue;
    auto old = std::ranges::find(all, row->note, [](const Old& each) { return each.row->note; });
    if (old == all.end()) old = all.insert(all.end(), {row, values_.where(property), {}});
    if (std::ranges::find(old->names, row->name) == old->names.end()) old->names.push_back(row->name);
  }
  for (const Old& old : all)
    values_.explain(old.first, old_words_text(old.names, sensor_of(properties), old.row->note));
}

/// Returns the sensor( ) block for the first transducer of a ranger in old syntax, with its numbers; empty if
/// the properties do not have them.
std::string StageLint::sensor_of(std::span<const StageProperty> properties) const {
  const auto numbers = [&](std::string_view key) {
    std::vector<std::string_view> texts;
    for (const StageProperty& property : properties)
      if (values_.key(property) == key) texts = values_.texts(property);
    return texts;
  };
  const std::vector<std::string_view> pose = numbers("spose[0]");
  const std::vector<std::string_view> view = numbers("sview");
  if (pose.size() != 3 || view.size() != 3) return {};
  return fmt::format("sensor( pose [{} {} 0 {}] range [{} {}] fov {} )", pose[0], pose[1], pose[2], view[0],
                     view[1], view[2]);
}

/// Warns of each property that the same entity sets again later, because only the last value counts.
void StageLint::check_repeated(std::span<const StageProperty> properties) {
  if (!values_.thorough()) return;
  std::unordered_map<std::string_view, Where> later;
  for (auto property = properties.rbegin(); property != properties.rend(); ++property) {
    const auto [next, is_last] = later.try_emplace(values_.key(*property), values_.where(*property));
    if (is_last) continue;
    const Where where = values_.where(*property);
    values_.warning(where, fmt::format("\"{}\" has no effect: {} sets it again", values_.key(*property),
                                       values_.place(next->second, where)));
  }
}

/// Warns of properties that have no effect because of other properties of the model or because of its type.
void StageLint::check_overruled(const StageModel& model, bool is_top_level) {
  const auto report = [&](std::string_view key, std::string_view why) {
    if (const StageProperty* property = model.find(document_, key))
      values_.warning(values_.where(*property), fmt::format("\"{}\" has no effect: {}", key, why));
  };
  const bool runs = macros_.is_device(model.type);
  const bool is_position = model.type == "position";
  const bool is_model = model.type != "block" && model.type != "sensor" && model.type != "window";
  if (is_model && model.find(document_, "color")) report("color_rgba", "\"color\" is also given");
  const auto has_any = [&](std::initializer_list<std::string_view> keys) {
    return std::ranges::any_of(keys, [&](std::string_view key) { return model.find(document_, key); });
  };
  const bool has_energy =
      has_any({"watts", "give_watts", "take_watts"}) ||
      (is_position && has_any({"joules", "kjoules", "joules_capacity", "kjoules_capacity"}));
  if (is_model && !runs && !has_energy)
    report("alwayson", "this model is not a sensor itself (set it in the sensor)");
  if (is_model && !runs && !is_position && !model.find(document_, "ctrl"))
    report("update_interval", "this model is not a device itself and has no drive (set it in the device)");
  const std::vector<StageModel::Child> children = model.children(document_);
  const bool has_sensors = std::ranges::any_of(children, [&](const StageModel::Child& child) {
    const auto resolved = macros_.resolve(*child.entity);
    return resolved && resolved->type == "sensor";
  });
  if (!model.alias.empty() && has_sensors)
    for (const std::string_view key :
         {"samples", "fov", "range", "range_min", "range_max", "noise", "beam_width", "apply_range_min"})
      report(key, "in a model with sensor( ) blocks, only the properties in these blocks count");
  if (model.type == "blobfinder" && !has_any({"colors_count"}))
    report("colors", "it needs \"colors_count\", the number of these colours that the blobfinder reports");
  if (model.type == "blobfinder" && !has_any({"colors"})) report("colors_count", "\"colors\" is not given");
  if (is_model && !has_any({"bitmap"}))
    for (const std::string_view key : {"bitmap_margins", "bitmap_unknown"})
      report(key, "this model has no \"bitmap\"");
  if (!is_position) return;
  // The reader warns of the localization of a position inside another model, which always has its true pose.
  if (is_top_level) {
    const StageProperty* localization = model.find(document_, "localization");
    if (localization && values_.text(*localization) == "odom")
      report("gps_origin", "only a model with localization \"gps\" has a \"gps_origin\"");
    else {
      report("odom_error", "only a model with localization \"odom\" has errors of odometry");
      if (!has_any({"localization_origin"})) report("gps_origin", "\"localization_origin\" is not given");
    }
  }
  const StageProperty* drive = model.find(document_, "drive");
  if (!drive || values_.text(*drive) != "car")
    report("wheelbase", "only a model with drive \"car\" has a wheelbase");
}

void StageLint::finish() {
  for (const Summary* summary : {&no_effect_, &window_only_, &obsolete_})
    if (!summary->names.empty())
      values_.warning(summary->first, fmt::format("{}: {}", summary->all, joined(summary->names, ", ")));
}

}  // namespace troupe::worldio
