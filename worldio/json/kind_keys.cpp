#include "worldio/json/kind_keys.hpp"

#include "base/diagnostics.hpp"
#include "engine/kinds/components.hpp"
#include "worldio/json/document_table.hpp"
#include "worldio/json/world_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
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

}  // namespace

Result<> check_parameter_names(const engine::DeviceKind& kind) {
  const DocumentTable& table =
      kind.is_sensor() ? document_table<SensorDocument>() : document_table<DeviceDocument>();
  if (Result<> listed = check_names(kind.params, table, &kind); !listed) return listed;
  return check_names(kind.params, document_table<OwnDeviceDocument>(), &kind);
}

Result<> check_parameter_names(const engine::DriveKind& kind) {
  return check_names(kind.params, document_table<DriveDocument>(), nullptr);
}

Result<> check_parameter_names(const engine::ControllerKind& kind) {
  return check_names(kind.params, document_table<ControllerDocument>(), nullptr);
}

Result<> check_parameter_names(const engine::MeasureKind& kind) {
  return check_names(kind.params, document_table<MeasureDocument>(), nullptr);
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
  const auto check = [&](std::string_view what, const auto& kinds) {
    for (const auto& kind : kinds) report(what, kind.name, check_parameter_names(kind));
  };
  check("the device kind", registry.devices);
  check("the drive kind", registry.drives);
  check("the controller kind", registry.controllers);
  check("the measure kind", registry.measures);
  for (const engine::DeviceKind& kind : registry.devices)
    report("the device kind", kind.name, check_kind_name(kind.name));
  for (const engine::ControllerKind& kind : registry.controllers)
    report("the controller kind", kind.name, check_kind_name(kind.name));
  return all;
}

}  // namespace troupe::worldio
