#include "worldio/stage/stage_models.hpp"

#include "base/split.hpp"
#include "worldio/stage/stage_properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <unordered_set>

namespace troupe::worldio {
namespace {

constexpr std::size_t k_most_macro_steps = 20000000;  // steps from a macro to its base, in a whole world
constexpr std::string_view k_ranger_aliases[] = {"laser", "sonar"};
constexpr std::string_view k_radio_alias = "wifi";
// With more macros, comparing their names would delay the error message.
constexpr std::size_t k_names_compared = 2000;

}  // namespace

const StageProperty* StageModel::find(const StageDocument& document, std::string_view key) const {
  for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
    const std::span<const StageProperty> properties = document.properties(**layer);
    for (auto property = properties.rbegin(); property != properties.rend(); ++property)
      if (document.key(*property) == key) return &*property;
  }
  return nullptr;
}

std::vector<StageModel::Child> StageModel::children(const StageDocument& document) const {
  std::vector<Child> out;
  for (const StageEntity* layer : layers)
    for (const StageEntity& child : document.children(*layer)) out.push_back({&child, layer});
  return out;
}

StageMacros::StageMacros(const StageDocument& document, const engine::Registry& registry, StageValues& values)
    : document_(document), registry_(registry), values_(values) {}

void StageMacros::define(const StageItem& item) {
  const StageToken name = document_.token(item.entity.word);
  const auto [first, is_new] = macros_.emplace(name.text, Macro{&item.entity, document_.token(item.base)});
  const Where before = document_.token(first->second.body->word).where();
  // The file is included twice.
  const bool is_read_again = before.file == name.file && before.line == name.line;
  if (!is_new && !is_read_again)
    values_.warning(
        name.where(),
        fmt::format("macro \"{}\" is already defined at {}; this later definition is ignored: remove it",
                    name.text, values_.place(before, name.where())));
}

std::optional<StageModel> StageMacros::resolve(const StageEntity& entity) {
  StageModel model{.type = document_.word(entity), .where = document_.token(entity.word).where()};
  model.layers.push_back(&entity);
  model.names.push_back(model.type);
  Where where_of_type = model.where;
  std::unordered_set<std::string_view> met;
  for (auto macro = macros_.find(model.type); macro != macros_.end(); macro = macros_.find(model.type)) {
    if (!met.insert(model.type).second) {
      values_.error(
          document_.token(macro->second.body->word).where(),
          fmt::format("macro \"{}\" is based on itself: base the macro on a model type", model.type));
      return {};
    }
    if (++steps_ > k_most_macro_steps) {
      values_.error(model.where,
                    fmt::format("the world is too large: macros that are based on other macros were looked "
                                "up more than {} times; use fewer models or shorter chains of macros",
                                k_most_macro_steps));
      return {};
    }
    macro->second.is_used = true;
    model.layers.push_back(macro->second.body);
    model.type = macro->second.base.text;
    where_of_type = macro->second.base.where();
    model.names.push_back(model.type);
  }
  std::ranges::reverse(model.layers);
  if (std::ranges::find(k_ranger_aliases, model.type) != std::end(k_ranger_aliases)) {
    model.alias = model.type;
    model.type = "ranger";
    model.names.push_back(model.type);
  }
  if (model.type == k_radio_alias) {
    model.alias = model.type;
    model.type = "radio";
    model.names.push_back(model.type);
  }

  const bool is_known = model.type == "block" || model.type == "sensor" || model.type == "window" ||
                        registry_.model(model.type) != nullptr;
  if (is_known) return model;
  report_unknown_type(model.type, where_of_type);
  return {};
}

void StageMacros::report_unknown_type(std::string_view type, Where where) {
  // Many models may use the same macro, and the names that are similar to its unknown base take time to find.
  if (!reported_.insert(type.data()).second) return;
  if (const StageRow* old = find_stage_row("type", type)) {
    if (reported_.insert(old->name.data()).second) values_.error(where, old_type_text(*old));
    return;
  }
  if (!document_.missing_includes.empty()) {
    values_.error(where, fmt::format("\"{}\" is no model type; {} may define it as a macro, but is missing",
                                     type, joined(document_.missing_includes, " or ")));
    return;
  }
  std::vector<std::string_view> types;
  for (const engine::ModelKind& kind : registry_.models) types.push_back(kind.name);
  std::vector<std::string_view> near = types;
  near.insert(near.end(), std::begin(k_ranger_aliases), std::end(k_ranger_aliases));
  near.push_back(k_radio_alias);
  if (macros_.size() <= k_names_compared)
    for (const auto& [name, macro] : macros_) near.push_back(name);
  // Sorted, because the order of the hash table must not decide between two names that are equally similar.
  std::ranges::sort(near);
  values_.error(where, fmt::format("\"{}\" is neither a model type nor a macro defined above; types: {}{}",
                                   type, comma_list(types), did_you_mean(type, near)));
}

bool StageMacros::is_device(std::string_view type) const {
  const engine::ModelKind* kind = registry_.model(type);
  return kind != nullptr && registry_.device(kind->device) != nullptr;
}

bool StageMacros::is_only_a_body(std::string_view type) const {
  return registry_.model(type) != nullptr && type != "model" && type != "position" && !is_device(type);
}

void StageMacros::report_unused() {
  struct File {
    std::size_t macros = 0;
    bool is_used = false;
  };
  const std::uint32_t own = document_.sources.front().file;
  std::map<std::uint32_t, File> included;
  for (const StageItem& item : document_.items) {
    const StageToken name = document_.token(item.entity.word);
    const auto macro = macros_.find(name.text);
    const bool is_ours = item.is_define && macro != macros_.end() && macro->second.body == &item.entity;
    const bool is_used = !item.is_define || (is_ours && macro->second.is_used);
    if (name.file != own) {
      File& file = included[name.file];
      file.macros += item.is_define;
      file.is_used = file.is_used || is_used;
    } else if (is_ours && !is_used) {
      values_.warning(name.where(), fmt::format("macro \"{}\" is never used", name.text));
    }
  }
  for (const StageProperty& property : document_.world)
    included[document_.token(property.key).file].is_used = true;
  for (const auto& [file, holds] : included)
    if (!holds.is_used)
      values_.warning(
          {file, 0},
          fmt::format(
              "nothing in this included file is used; the file defines {} macro{}: remove the include",
              holds.macros, holds.macros == 1 ? "" : "s"));
}

}  // namespace troupe::worldio
