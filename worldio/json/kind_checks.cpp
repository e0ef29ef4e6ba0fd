#include "worldio/json/kind_checks.hpp"

#include "base/diagnostics.hpp"
#include "engine/kinds/components.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/world_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {
namespace {

/// Returns an error if a parameter in `params` has the name of a key of `table`, unless the key has another
/// name (DocumentKey::other) or objects of this kind do not have the key. `kind` is the argument of
/// DocumentKey::is_of.
Result<> check_names(const engine::FieldTable& params, const DocumentTable& table, const void* kind) {
  for (const engine::Field& field : params.fields) {
    const DocumentKey* key = table.find(field.name);
    if (key == nullptr || key->other || (key->is_of && !key->is_of(kind))) continue;
    return Error{fmt::format(
        "has a parameter \"{}\", but \"{}\" is a key that every {} has in JSON worlds: rename the parameter",
        field.name, field.name, table.kinds->what)};
  }
  return {};
}

/// Checks the name of a kind and whether its hooks are set. hooks: the name of each hook that must not be
/// null, and whether it is set
Result<> check_hooks(std::string_view name, std::initializer_list<std::pair<std::string_view, bool>> hooks) {
  if (!engine::is_name(name))
    return Error{
        "has an invalid name: give one word that does not begin with a dot and contains none of : = / \\ and "
        "quotation marks"};
  for (const auto& [hook, is_set] : hooks)
    if (!is_set) return Error{fmt::format("does not set its member `{}`", hook)};
  return {};
}

}  // namespace

Result<> check_kind(const engine::DeviceKind& kind) {
  if (Result<> hooks = check_hooks(kind.name, {{"prepare", kind.prepare}}); !hooks) return hooks;
  const DocumentTable& table =
      kind.is_sensor() ? document_table<SensorDocument>() : document_table<DeviceDocument>();
  if (Result<> listed = check_names(kind.params, table, &kind); !listed) return listed;
  return check_names(kind.params, document_table<OwnDeviceDocument>(), &kind);
}

Result<> check_kind(const engine::DriveKind& kind) {
  if (Result<> hooks =
          check_hooks(kind.name, {{"prepare", kind.prepare}, {"check", kind.check}, {"drive", kind.drive}});
      !hooks)
    return hooks;
  return check_names(kind.params, document_table<DriveDocument>(), nullptr);
}

Result<> check_kind(const engine::ControllerKind& kind) {
  if (Result<> hooks = check_hooks(
          kind.name,
          {{"prepare", kind.prepare}, {"decide", kind.decide}, {"start", kind.start || kind.memory.empty()}});
      !hooks)
    return hooks;
  return check_names(kind.params, document_table<ControllerDocument>(), nullptr);
}

Result<> check_kind(const engine::MeasureKind& kind) {
  if (Result<> hooks = check_hooks(kind.name, {{"make", kind.make}}); !hooks) return hooks;
  return check_names(kind.params, document_table<MeasureDocument>(), nullptr);
}

Result<> check_kind(const engine::FaultKind& kind) {
  return check_hooks(kind.name, {{"prepare", kind.prepare}});
}

Result<> check_different(std::vector<std::string_view> names, std::string_view what) {
  std::ranges::sort(names);
  const auto twice = std::ranges::adjacent_find(names);
  if (twice == names.end()) return {};
  return Error{fmt::format("has two kinds with the name \"{}\", each a {}: rename one", *twice, what)};
}

Result<> check_kind_name(std::string_view name) {
  std::vector<std::string_view> taken(engine::k_engine_components.begin(), engine::k_engine_components.end());
  taken.insert(taken.begin(), "alive");  // recordings have an array /state/alive
  if (std::ranges::find(taken, name) == taken.end()) return {};
  return Error{
      fmt::format("has the name of a component of the state that Troupe defines: rename it; all names except "
                  "{} are allowed",
                  comma_list(taken))};
}

Result<> check_kinds(const engine::Registry& registry) {
  Result<> all;
  const auto report = [&all](std::string_view what, std::string_view kind, const Result<>& found) {
    if (all && !found) all = Error{fmt::format("{} \"{}\" {}", what, kind, found.error().text)};
  };
  const auto check = [&](std::string_view what, const auto& kinds, std::vector<std::string_view> names = {}) {
    for (const auto& kind : kinds) {
      report(fmt::format("the {} kind", what), kind.name, check_kind(kind));
      names.push_back(kind.name);
    }
    if (const Result<> different = check_different(std::move(names), what); all && !different)
      all = Error{"the registry " + different.error().text};
  };
  std::vector<std::string_view> presets;
  for (const engine::Registry::Preset& preset : registry.presets) {
    presets.push_back(preset.name);
    const auto kind = std::ranges::find(registry.controllers, preset.kind, &engine::ControllerKind::name);
    if (kind == registry.controllers.end()) continue;  // it may be a kind of a plug-in
    for (const auto& [name, value] : preset.params)
      if (all && kind->params.find(name) < 0)
        all = Error{fmt::format(
            "the preset \"{}\" sets the parameter \"{}\", which its kind \"{}\" does not have: {}",
            preset.name, name, preset.kind, unknown_name("parameter", name, name_list(kind->params.fields)))};
  }
  check("device", registry.devices);
  check("drive", registry.drives);
  check("controller", registry.controllers, std::move(presets));
  check("measure", registry.measures);
  check("fault", registry.faults);
  for (const engine::DeviceKind& kind : registry.devices)
    report("the device kind", kind.name, check_kind_name(kind.name));
  for (const engine::ControllerKind& kind : registry.controllers)
    report("the controller kind", kind.name, check_kind_name(kind.name));
  return all;
}

}  // namespace troupe::worldio
