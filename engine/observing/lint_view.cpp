#include "engine/observing/lint_view.hpp"

#include "engine/interventions/groups.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <set>

namespace troupe::engine {

LintWorld::LintWorld(const World& world)
    : spec(world.spec()), types(world.view().types()), bodies(spec.types.size()), levels(spec.types.size()) {
  for (const BodySpec& body : spec.bodies) {
    ++levels[body.type.index()][body.pose_world_body.z];
    ++bodies[body.type.index()];
  }
  add_levels_of_interventions(world);
  collect_set_params();
}

/// Adds the heights at which the interventions `move` and `add` put bodies, each once per body.
void LintWorld::add_levels_of_interventions(const World& world) {
  using Action = InterventionSpec::Action;
  Groups groups(world.state());
  std::set<std::pair<std::uint32_t, double>> known;  // bodies, of a reserve the first one, and their heights
  const auto add = [&](BodyId first, std::size_t count, double z) {
    const BodySpec& body = spec.bodies[first.index()];
    if (z != body.pose_world_body.z && known.emplace(first.value, z).second)
      levels[body.type.index()][z] += count;
  };
  for (const InterventionSpec& at : spec.experiment.at) {
    if (!at.pose) continue;
    if (at.action == Action::move) {
      add(world.state().names.find(at.whom.name), 1, at.pose->z);
    } else if (at.action == Action::add) {
      const ReserveSpec& reserve = spec.reserves.at(*groups.reserve(at.whom.name));
      add(reserve.first, reserve.count, at.pose->z);
    }
  }
}

void LintWorld::collect_set_params() {
  using Of = SettingSpec::Of;
  for (const InterventionSpec& at : spec.experiment.at) {
    if (!at.setting) continue;
    const TypeSpec& given = spec.types[at.setting->type.index()];
    const BodyType& type = types[at.setting->type.index()];
    const std::size_t index = at.setting->index;
    const auto collect = [&](const FieldTable& table, const Record& params) {
      for (std::size_t i = 0; i < table.fields.size(); ++i)
        if (const Value& value = at.setting->params[i]; value.given())
          set_params_.emplace(std::pair(&params, table.fields[i].name), &value);
    };
    switch (at.setting->of) {
      case Of::drive: collect(type.drive->kind->params, given.drive->params); break;
      case Of::device: collect(type.devices[index].kind->params, given.devices[index].params); break;
      case Of::controller:
        collect(type.controllers[index].kind->params, given.controllers[index].params);
        break;
    }
  }
}

bool LintWorld::is_set(const Record& params, std::initializer_list<std::string_view> names) const {
  return std::ranges::any_of(names, [&](std::string_view name) {
    return set_params_.contains({&params, name});
  });
}

std::vector<const Value*> LintWorld::set_values(const Record& params, std::string_view name) const {
  std::vector<const Value*> values;
  const auto [first, last] = set_params_.equal_range({&params, name});
  for (auto it = first; it != last; ++it) values.push_back(it->second);
  return values;
}

std::string device_text(std::string_view what, std::string_view name, std::string_view type) {
  return name.empty() ? fmt::format("{} of \"{}\"", what, type)
                      : fmt::format("{} \"{}\" of \"{}\"", what, name, type);
}

std::string sees_nothing_text(std::string_view name, std::string_view type) {
  return name.empty() ? fmt::format("sensor \"{}\" sees nothing: ", type)
                      : fmt::format("sensor \"{}\" of \"{}\" sees nothing: ", name, type);
}

}  // namespace troupe::engine
