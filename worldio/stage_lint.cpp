#include "worldio/stage_lint.hpp"

#include "worldio/stage_properties.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace troupe::worldio {
namespace {

constexpr std::size_t k_deepest = 200;  // as deep as the parser and the macros go

/// Models that load as bodies, but whose own part is still missing.
bool is_only_a_body(std::string_view type) {
  return type != "model" && type != "position" && type != "ranger" && type != "block" && type != "sensor" &&
         type != "window";
}

std::string with_article(std::string_view type) {
  if (type == "world") return "the world";
  return fmt::format("{} {}", type == "actuator" ? "an" : "a", type);
}

/// How a property is called in messages: "mass", but "noise of a sensor".
std::string called(const StageRow& row) {
  if (row.type == "model" || row.type == "world") return std::string(row.name);
  return fmt::format("{} of {}", row.name, with_article(row.type));
}

}  // namespace

void StageLint::Summary::add(Where where, std::string name) {
  if (names.empty()) first = where;
  if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
}

void StageLint::check_world() {
  for (const StageProperty& property : document_.world) check_property(property, "world");
}

void StageLint::check(const StageEntity& entity, std::size_t depth) {
  if (depth > k_deepest) return;
  const auto model = macros_.resolve(entity);
  if (!model) return;
  if (model->type == "window") window_only_.add(model->where, "window");
  if (is_only_a_body(model->type))
    values_.warning_once(model->where, fmt::format("not supported yet: what {} does; it is only a body here",
                                                   with_article(model->type)));
  for (const StageEntity* layer : model->layers) {
    if (layer != &entity && !macros_seen_.insert(layer).second) continue;
    for (const StageProperty& property : document_.properties(*layer)) check_property(property, model->type);
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
        where, fmt::format("{} has no property \"{}\"; it is ignored{}", with_article(type), key,
                           is_transducers ? ", it belongs into a sensor( ... )" : did_you_mean(key, known)));
    return;
  }
  switch (row->support) {
    case StageSupport::honoured:
    case StageSupport::fixed: break;
    case StageSupport::no_effect: no_effect_.add(where, called(*row)); break;
    case StageSupport::window_only:
      if (type != "window") window_only_.add(where, called(*row));
      break;
    case StageSupport::obsolete: obsolete_.add(where, called(*row)); break;
    case StageSupport::unsupported:
      values_.warning_once(where, fmt::format("not supported yet: {}", called(*row)));
      break;
  }
}

void StageLint::finish() {
  const auto write = [this](const Summary& summary, std::string_view what) {
    if (!summary.names.empty())
      values_.warning(summary.first, fmt::format("{}: {}", what, fmt::join(summary.names, ", ")));
  };
  write(no_effect_, "accepted without effect, docs/stage-worlds.md says why");
  write(window_only_, "accepted, but only Stage's window would use it");
  write(obsolete_, "obsolete, ignored by Stage too");
}

}  // namespace troupe::worldio
