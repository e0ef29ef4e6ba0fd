#include "troupe/script.hpp"

#include "engine/spec/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe {
namespace {

using engine::TypeSpec;
using engine::WorldSpec;

constexpr std::size_t k_most_names = 100;  // names in an error

/// Returns the error that `robots` names neither a type nor a population nor a robot.
Error unknown_name_of_robots(const WorldSpec& world, const std::string& robots) {
  std::vector<std::string> names;
  for (const TypeSpec& type : world.types)
    if (engine::is_mobile(type)) names.push_back(type.name);
  for (std::size_t b = 1; b < world.bodies.size(); ++b) {
    if (!engine::is_mobile(world.type(BodyId(b)))) continue;
    const std::string name = world.name(BodyId(b));
    const std::string_view population = engine::without_number(name);
    const std::string_view listed = population.empty() ? std::string_view(name) : population;
    if (std::ranges::find(names, listed) == names.end()) names.emplace_back(listed);
    if (names.size() >= k_most_names) break;
  }
  return {unknown_name("type, population or robot", robots, {names.begin(), names.end()})};
}

/// Returns the types that `robots` selects (Script::Controller::robots). The error says why there are none.
Result<std::vector<std::size_t>> types_of(const WorldSpec& world, const std::string& robots) {
  std::vector<std::size_t> types;
  for (std::size_t t = 0; t < world.types.size(); ++t)
    if (robots.empty() ? engine::is_mobile(world.types[t]) : world.types[t].name == robots)
      types.push_back(t);
  if (!types.empty()) return types;
  if (robots.empty())
    return Error{
        "without `robots`, a controller is given to all types with a drive, but no type of this world has "
        "one: give a type a drive, or set `robots` of the controller to the name of a type"};
  std::vector<bool> has(world.types.size(), false);
  std::vector<bool> has_others(world.types.size(), false);
  for (const engine::EmptyPopulation& empty : world.empty_populations)
    if (empty.name == robots) has[empty.type.index()] = true;
  for (std::size_t b = 1; b < world.bodies.size(); ++b) {
    const std::size_t type = world.bodies[b].type.index();
    const std::string name = world.name(BodyId(b));
    const bool is_meant = name == robots || engine::is_of_population(name, robots);
    (is_meant ? has : has_others)[type] = true;
  }
  for (std::size_t t = 0; t < world.types.size(); ++t) {
    if (!has[t]) continue;
    if (has_others[t])
      return Error{fmt::format(
          "\"{1}\" shares the type \"{0}\" with other robots, and all robots of a type have the same "
          "controllers: write \"{0}\" for all of them, or give \"{1}\" a type of its own, with \"extends\"",
          world.types[t].name, robots)};
    types.push_back(t);
  }
  if (types.empty()) return unknown_name_of_robots(world, robots);
  return types;
}

/// Adapts the interventions that set parameters of controllers of the type `t`, whose controllers are now
/// only `script`. kept: the index of the controller that the type keeps; not set: it keeps none. replaced:
/// the controllers of the type until now. Reports an error for an intervention that sets a replaced
/// controller.
void adapt_interventions(WorldSpec& world, std::size_t t, const std::string& script,
                         std::optional<std::size_t> kept, std::span<const engine::ControllerSpec> replaced,
                         Diagnostics& diagnostics) {
  for (std::size_t i = 0; i < world.experiment.at.size(); ++i) {
    engine::InterventionSpec& intervention = world.experiment.at[i];
    if (!intervention.setting || intervention.setting->type.index() != t ||
        intervention.setting->of != engine::SettingSpec::Of::controller)
      continue;
    std::uint32_t& index = intervention.setting->index;
    if (index == kept)
      index = 0;
    else
      diagnostics.error(
          intervention.where,
          fmt::format("/at/{}/set/controller: the controller \"{}\" of type \"{}\" does not run, because the "
                      "controller \"{}\" of the script replaces it: remove this entry, or set parameters of "
                      "\"{}\", which the world must then name",
                      i, replaced[index].kind, world.types[t].name, script, script));
  }
}

/// Makes a controller of a script the only controller of the type `t`. If the world already gives this
/// controller to the type, its parameters are kept; otherwise it has its default parameters and the place
/// `where`.
void assign(const Script& script, const Script::Controller& controller, Where where, std::size_t t,
            WorldSpec& world, Diagnostics& diagnostics) {
  std::vector<engine::ControllerSpec>& controllers = world.types[t].controllers;
  engine::ControllerSpec spec;
  spec.kind = script.name_in_worlds(controller.kind.name);
  const auto own = std::ranges::find(controllers, spec.kind, &engine::ControllerSpec::kind);
  std::optional<std::size_t> kept;
  if (own != controllers.end()) kept = static_cast<std::size_t>(own - controllers.begin());
  adapt_interventions(world, t, spec.kind, kept, controllers, diagnostics);
  if (kept) {
    spec = std::move(*own);
  } else {
    spec.params = controller.kind.params.defaults();
    spec.where = where;
  }
  controllers = {std::move(spec)};
}

}  // namespace

void assign_controllers(std::span<const std::shared_ptr<const Script>> scripts, WorldSpec& world,
                        Diagnostics& diagnostics) {
  std::vector<const Script::Controller*> given(world.types.size(), nullptr);
  for (const std::shared_ptr<const Script>& script : scripts) {
    for (const Script::Controller& controller : script->controllers) {
      const Where where{diagnostics.files()->add(script->file.string()), controller.line};
      const auto types = types_of(world, controller.robots);
      if (!types) {
        diagnostics.error(where, fmt::format("controller {}: {}", controller.kind.name, types.error().text));
        continue;
      }
      for (const std::size_t t : *types) {
        if (given[t] != nullptr) {
          diagnostics.error(
              where, fmt::format("controller {}: the robots of type \"{}\" already get the controller {}; a "
                                 "type can have only one controller from scripts",
                                 controller.kind.name, world.types[t].name, given[t]->kind.name));
          continue;
        }
        given[t] = &controller;
        assign(*script, controller, where, t, world, diagnostics);
      }
    }
  }
}

}  // namespace troupe
