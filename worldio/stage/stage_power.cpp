#include "worldio/stage/stage_power.hpp"

#include "engine/spec/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace troupe::worldio {
namespace {

using engine::DeviceSpec;
using engine::FieldTable;
using engine::Record;
using engine::TypeSpec;
using engine::Value;

/// Types of models whose power draw follows from their activity, as in Stage. Their property `watts` is
/// ignored. (A camera draws 100 W, as Stage's manual says; Stage's code does not implement this.)
constexpr std::array<std::string_view, 6> k_own_draw{"actuator", "blobfinder", "bumper",
                                                     "camera",   "position",   "ranger"};

/// A property that gives a model a power pack.
struct Amount {
  std::string_view key;
  double joules;       ///< joules per unit of the property
  bool capacity_only;  ///< false: the property also sets the stored energy
};
constexpr std::array<Amount, 4> k_amounts{{{"joules", 1, false},
                                           {"joules_capacity", 1, true},
                                           {"kjoules", 1000, false},
                                           {"kjoules_capacity", 1000, true}}};

std::string device_name(const TypeSpec& type, std::uint32_t part, std::string_view last) {
  const std::string& below = type.parts[part].name;
  return below.empty() ? std::string(last) : fmt::format("{}.{}", below, last);
}

/// Renames each power pack and each contact whose name a device before it has, as body types rename devices.
/// The models of two packs may have the same name, but in a JSON world, two entries of `devices` may not.
void give_unique_names(std::vector<DeviceSpec>& devices) {
  engine::UniqueNames names(engine::k_device_mark);
  for (DeviceSpec& device : devices) {
    const std::string name = names.add(device.name);
    if (device.kind == "power_pack" || device.kind == "power_contact") device.name = name;
  }
}

}  // namespace

bool has_own_draw(std::string_view model_type) {
  return std::ranges::find(k_own_draw, model_type) != k_own_draw.end();
}

std::optional<std::size_t> pack_of(const TypeSpec& type, std::uint32_t part) {
  for (;; part = type.parts[part].parent) {
    for (std::size_t d = 0; d < type.devices.size(); ++d)
      if (type.devices[d].kind == "power_pack" && type.devices[d].part == part) return d;
    if (part == 0) return std::nullopt;
  }
}

Record effective_params(const TypeSpec& type, const DeviceSpec& device, const FieldTable& table) {
  Record params = device.params;
  if (device.kind != "power_pack") return params;
  const auto value = [&](std::string_view name) -> Value& { return get(table, params, name); };
  if (value("infinite").boolean()) value("capacity") = 0.0;
  value("stored") = std::min(value("stored").number(), value("capacity").number());
  if (!type.drive || device.part != 0) value("mass") = value("idle") = 0.0;
  return params;
}

bool StagePower::is_on(const StageModel& model) {
  return model.find(document_, "ctrl") != nullptr || values_.flag(model.find(document_, "alwayson"), false);
}

double StagePower::watts(const StageModel& model, std::string_view key) {
  const StageProperty* property = model.find(document_, key);
  const double watts = property ? values_.number(*property).value_or(0) : 0;
  if (watts >= 0 && watts <= engine::k_most_watts) return watts;
  values_.may_exceed(
      values_.where(*property),
      fmt::format("\"{}\" must be from 0 to {}, in W, found {}", key, engine::k_most_watts, watts),
      key == "watts" && has_own_draw(model.type)
          ? fmt::format("Troupe computes the power of a model of type {}", model.type)
          : "");
  return 0;
}

void StagePower::read(const StageModel& model, std::uint32_t part, TypeSpec& type) {
  if (part == 0) {
    draws_.clear();
    mass_ = 0;
    drives_ = is_on(model);
  }
  const double constant = watts(model, "watts");
  if (constant > 0 && !has_own_draw(model.type))
    draws_.push_back({part, constant, is_on(model)});
  else if (constant > 0)
    values_.warning_once(
        values_.where(*model.find(document_, "watts")),
        fmt::format("\"watts\" of a model of type {} has no effect: Troupe computes the power of "
                    "such a model (docs/stage-worlds.md): remove this property",
                    model.type));
  if (const StageProperty* property = model.find(document_, "mass")) {
    const double kg = values_.number(*property).value_or(0);
    const bool has_pack = std::ranges::any_of(
        k_amounts, [&](const Amount& amount) { return model.find(document_, amount.key) != nullptr; });
    const bool has_effect = model.type == "position" && part == 0 && has_pack;
    if (!(kg >= 0 && kg <= engine::k_most_mass_kg))
      values_.may_exceed(
          values_.where(*property),
          fmt::format("\"mass\" must be from 0 to {}, in kg, found {}", engine::k_most_mass_kg, kg),
          has_effect ? "" : "only the power pack of a top-level position uses it");
    else if (part == 0)
      mass_ = kg;
  }
  read_pack(model, part, type);
  read_contact(model, part, type);
}

/// Reads the properties in the order in which Stage reads them, because a later property overwrites the
/// stored energy.
std::optional<engine::Energy> StagePower::read_energy(const StageModel& model) {
  std::optional<engine::Energy> energy;
  for (const Amount& amount : k_amounts) {
    const StageProperty* property = model.find(document_, amount.key);
    const std::optional<double> given = property ? values_.number(*property) : std::nullopt;
    if (!given) continue;
    const double joules = *given * amount.joules;
    constexpr double k_most_joules = 1e12;
    if (joules > k_most_joules || (amount.capacity_only && joules < 0)) {
      values_.error(values_.where(*property),
                    fmt::format("\"{}\" must be {}at most {:.0f} {}, found {}", amount.key,
                                amount.capacity_only ? "0 or above, and " : "", k_most_joules / amount.joules,
                                amount.joules == 1 ? "J" : "kJ", *given));
      continue;
    }
    if (!energy) energy.emplace();
    energy->capacity_j = std::max(joules, 0.0);
    if (amount.capacity_only) {
      energy->stored_j = std::min(energy->stored_j, energy->capacity_j);
    } else {
      energy->stored_j = energy->capacity_j;
      energy->infinite = joules < 0;
    }
  }
  return energy;
}

/// Adds the power pack of a part if its model stores energy.
void StagePower::read_pack(const StageModel& model, std::uint32_t part, TypeSpec& type) {
  const std::optional<engine::Energy> energy = read_energy(model);
  const engine::DeviceKind* kind = registry_.device("power_pack");
  const StageProperty* empty = model.find(document_, "when_empty");
  if (empty && !energy)
    values_.warning(values_.where(*empty),
                    "\"when_empty\" has no effect without \"joules\" or \"joules_capacity\"");
  if (!energy || !kind) return;
  DeviceSpec pack{.name = device_name(type, part, "power"),
                  .kind = "power_pack",
                  .part = part,
                  .joint = type.parts[part].joint,
                  .params = kind->params.defaults(),
                  .where = model.where};
  get(kind->params, pack.params, "capacity") = energy->capacity_j;
  get(kind->params, pack.params, "stored") = energy->stored_j;
  get(kind->params, pack.params, "infinite") = energy->infinite;
  get(kind->params, pack.params, "idle") = 0.0;
  if (const auto text = empty ? values_.text(*empty) : std::nullopt) {
    if (*text == "stop" || *text == "nothing")
      get(kind->params, pack.params, "when_empty") = std::string(*text);
    else
      values_.error(values_.where(*empty),
                    fmt::format("\"when_empty\" must be \"stop\" or \"nothing\", found \"{}\"", *text));
  }
  type.devices.push_back(std::move(pack));
}

void StagePower::read_contact(const StageModel& model, std::uint32_t part, TypeSpec& type) {
  const double give = watts(model, "give_watts");
  const double take = watts(model, "take_watts");
  const engine::DeviceKind* kind = registry_.device("power_contact");
  if (!kind || (give == 0 && take == 0)) return;
  DeviceSpec contact{.name = device_name(type, part, "contact"),
                     .kind = "power_contact",
                     .part = part,
                     .joint = type.parts[part].joint,
                     .params = kind->params.defaults(),
                     .active = is_on(model),
                     .where = model.where};
  get(kind->params, contact.params, "give") = give;
  get(kind->params, contact.params, "take") = take;
  if (give > 0 && !contact.active)
    values_.warning_once(values_.where(*model.find(document_, "give_watts")),
                         "\"give_watts\" has no effect: a model gives energy only while it runs, for which "
                         "it needs \"alwayson 1\" or \"ctrl\"");
  type.devices.push_back(std::move(contact));
}

void StagePower::finish(TypeSpec& type) {
  std::erase_if(type.devices, [&](const DeviceSpec& device) {
    if (device.kind != "power_contact" || pack_of(type, device.part)) return false;
    values_.warning_once(device.where,
                         "\"give_watts\" and \"take_watts\" have no effect without \"joules\" or "
                         "\"joules_capacity\" in this model or in a model that contains it");
    return true;
  });
  give_unique_names(type.devices);
  const bool is_controlled = !type.controllers.empty();
  const FieldTable* table =
      registry_.device("power_pack") ? &registry_.device("power_pack")->params : nullptr;
  if (!table) return;
  for (const Draw& draw : draws_) {
    const std::optional<std::size_t> pack = pack_of(type, draw.part);
    const bool is_device = std::ranges::any_of(type.devices, [&](const DeviceSpec& device) {
      return device.part == draw.part && device.kind != "power_pack" && device.kind != "power_contact";
    });
    if (!pack || !(draw.runs || (is_device && is_controlled))) continue;
    Value& power = get(*table, type.devices[*pack].params, "draw");
    power = power.number() + draw.watts;
  }
  const std::optional<std::size_t> own = type.drive ? pack_of(type, 0) : std::nullopt;
  if (!own) return;
  Record& params = type.devices[*own].params;
  get(*table, params, "mass") = mass_;
  get(*table, params, "idle") = drives_ || is_controlled ? 1.0 : 0.0;
}

}  // namespace troupe::worldio
