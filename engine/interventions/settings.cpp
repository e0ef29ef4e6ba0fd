#include "engine/interventions/settings.hpp"

#include "engine/kinds/thrown_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <any>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {

struct Experiment::Basis {
  TypeSpec spec;                         // the type with all settings up to that of the intervention
  std::shared_ptr<const BodyType> type;  // the compiled type with the parameters of tick 0
};

namespace {

using Action = InterventionSpec::Action;
using Of = SettingSpec::Of;

/// Whether a setting may replace the data `b` of a device by the data `a` of the same device with other
/// parameters. It may if the readings and commands have the same layout, the effects and joints have the same
/// limits, the beams have the same directions, and the transducers have the same positions.
bool same_shape(const DeviceKind::Prepared& a, const DeviceKind::Prepared& b) {
  return same_fields(a.percepts, b.percepts) && a.percept_bytes == b.percept_bytes &&
         same_fields(a.commands, b.commands) && a.command_bytes == b.command_bytes &&
         a.most_effects == b.most_effects && a.ends_lives == b.ends_lives &&
         a.joints.size() == b.joints.size() && a.joint_reach_m == b.joint_reach_m &&
         a.bearings == b.bearings &&  // controllers may have stored these and the transducers
         std::ranges::equal(a.transducers, b.transducers, [](const Transducer& x, const Transducer& y) {
           return x.first == y.first &&
                  x.pose_sensor_transducer.position() == y.pose_sensor_transducer.position();
         });
}

/// Whether a device of this kind has the same solids with other parameters. A setting cannot change solids.
bool same_body(const DeviceKind& kind, const Record& before, const Record& params) {
  if (kind.body == nullptr) return true;
  return std::ranges::equal(kind.body(before), kind.body(params), [](const auto& x, const auto& y) {
    return x.solid == y.solid && x.joint == y.joint;
  });
}

constexpr std::string_view k_keeps_shape =
    "\"set\" cannot change a parameter that determines how many values a device reads or stores, where its "
    "beams start or point, the size of its solids, how far its joints move, how many effects it can have on "
    "other bodies, or which devices a controller uses; give such a parameter in the type";

/// Checks whether parameters may change from `before` to `params` while the world runs. The error says which
/// parameter cannot change.
Result<> check_fixed(const FieldTable& table, const Record& before, const Record& params) {
  for (std::size_t p = 0; p < table.fields.size(); ++p)
    if (const Field& field = table.fields[p]; field.fixed && before[p] != params[p])
      return Error{fmt::format("\"{}\" cannot change while the world runs; give it in the type", field.name)};
  return {};
}

/// As check_fixed(), for a drive. The error may also say which value is not allowed.
Result<> check_change(const DriveKind& kind, const Record& before, const Record& params) {
  if (const Result<> checked = check_fixed(kind.params, before, params); !checked) return checked.error();
  if (const Result<> checked = check_used(kind.params, params); !checked) return checked.error();
  return kind.check(params);
}

/// Compiles the first `count` controllers of a type again, with the parameters in `spec`, and returns their
/// data. The error says what a controller lacks, or that it would use other devices than before.
Result<std::vector<std::any>> prepare_controllers(std::size_t count, const WorldSpec& world,
                                                  const TypeSpec& spec, const BodyType& type,
                                                  const Registry& registry) {
  std::vector<std::any> data;
  std::vector<bool> claimed(type.devices.size(), false);  // devices that earlier controllers claim
  for (std::size_t c = 0; c < count; ++c) {
    const ControllerSpec& controller = spec.controllers[c];
    Result<ControllerKind::Prepared> prepared =
        prepare_controller(*registry.controller(controller.kind), controller, world, spec, type, claimed);
    if (!prepared) return Error{fmt::format("controller \"{}\" {}", controller.kind, prepared.error().text)};
    if (prepared->devices != type.controllers[c].devices)
      return Error{fmt::format("controller \"{}\": {}", controller.kind, k_keeps_shape)};
    data.push_back(std::move(prepared->data));
  }
  return data;
}

/// What a setting is compiled with. `type` is the type whose parameters it changes, as it was when the world
/// was loaded.
struct SettingContext {
  const SettingSpec& setting;
  const WorldSpec& world;
  const Registry& registry;
  const BodyType& type;
};

/// Compiles the controllers of the type again, after the setting of a drive, and stores their data in
/// `intervention`: only their hook bind_world shows the drive to controllers.
Result<> bind_controllers(const SettingContext& context, const TypeSpec& spec,
                          Experiment::Intervention& intervention) {
  const BodyType& type = context.type;
  if (!type.binds_controllers()) return {};
  Result<std::vector<std::any>> data =
      prepare_controllers(type.controllers.size(), context.world, spec, type, context.registry);
  if (!data) return data.error();
  intervention.controllers = *std::move(data);
  return {};
}

/// Compiles a setting of a drive, of a device or of a controller: applies it to `spec`, and stores the
/// prepared data in `intervention`. The error says why the parameter cannot have this value or cannot change.
/// spec  the spec of the type with all earlier settings applied
Result<> build_drive_setting(const SettingContext& context, TypeSpec& spec,
                             Experiment::Intervention& intervention) {
  const DriveKind& kind = *context.type.drive->kind;
  Record params = changed(spec.drive->params, context.setting);
  try {
    if (const Result<> checked = check_change(kind, spec.drive->params, params); !checked)
      return Error{fmt::format("drive \"{}\": {}", spec.drive->kind, checked.error().text)};
    spec.drive->params = std::move(params);
    intervention.data = kind.prepare(spec.drive->params);
  } catch (...) {
    return Error{fmt::format("drive \"{}\" {}", spec.drive->kind, thrown_text())};
  }
  return bind_controllers(context, spec, intervention);
}

Result<> build_device_setting(const SettingContext& context, TypeSpec& spec,
                              Experiment::Intervention& intervention) {
  DeviceSpec& device = spec.devices[context.setting.index];
  const BodyType::Device& now = context.type.devices[context.setting.index];
  const DeviceKind& kind = *now.kind;
  const std::string owner = fmt::format("device \"{}\"", device.name);
  Record params = changed(device.params, context.setting);
  if (const Result<> checked = check_fixed(kind.params, device.params, params); !checked)
    return Error{fmt::format("{}: {}", owner, checked.error().text)};
  if (const Result<> checked = check_used(kind.params, params); !checked)
    return Error{fmt::format("{}: {}", owner, checked.error().text)};
  // Checked before the device is prepared, because preparing too many samples could exhaust the memory.
  if (samples_asked_for(kind.params, params) != samples_asked_for(kind.params, device.params))
    return Error{fmt::format("{}: {}", owner, k_keeps_shape)};
  bool keeps_body = false;
  try {
    keeps_body = same_body(kind, device.params, params);
  } catch (...) {
    return Error{fmt::format("{} ({}) {}", owner, kind.name, thrown_text())};
  }
  device.params = std::move(params);
  Result<DeviceKind::Prepared> prepared = prepare_device(kind, device, context.world, spec);
  if (!prepared) return Error{fmt::format("{} {}", owner, prepared.error().text)};
  if (!keeps_body || !same_shape(*prepared, now.prepared))
    return Error{fmt::format("{}: {}", owner, k_keeps_shape)};
  intervention.device = *std::move(prepared);
  if (!kind.drives) return {};
  return bind_controllers(context, spec, intervention);
}

Result<> build_controller_setting(const SettingContext& context, TypeSpec& spec,
                                  Experiment::Intervention& intervention) {
  const std::size_t index = context.setting.index;
  Record& params = spec.controllers[index].params;
  params = changed(params, context.setting);
  Result<std::vector<std::any>> data =
      prepare_controllers(index + 1, context.world, spec, context.type, context.registry);
  if (!data) return data.error();
  intervention.data = std::move(data->back());
  return {};
}

}  // namespace

// ---- Compiling the spec

Result<> Settings::build(const SettingSpec& setting, const Registry& registry, const BodyType& type,
                         Types& types, Experiment::Intervention& intervention) const {
  TypeSpec& spec =
      types.try_emplace(setting.type.value, state_.spec.types[setting.type.index()]).first->second;
  const SettingContext context{setting, state_.spec, registry, type};
  switch (setting.of) {
    case Of::drive: return build_drive_setting(context, spec, intervention);
    case Of::device: return build_device_setting(context, spec, intervention);
    case Of::controller: break;
  }
  return build_controller_setting(context, spec, intervention);
}

void Settings::bind_kinds_again(const Registry& registry) {
  const auto require = [](const auto& prepared) {
    if (!prepared) throw std::logic_error(prepared.error().text);  // it was accepted with the old poses
  };
  bool has_bound = false;
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    BodyType& type = state_.types[t];
    const TypeSpec& spec = state_.spec.types[t];
    bool has_bound_device = false;
    for (std::size_t d = 0; d < type.devices.size(); ++d) {
      BodyType::Device& device = type.devices[d];
      if (!device.kind->bind_world) continue;
      Result<DeviceKind::Prepared> prepared =
          prepare_device(*device.kind, spec.devices[d], state_.spec, spec);
      require(prepared);
      device.prepared.data = std::move(prepared->data);
      device.prepared.reach_m = prepared->reach_m;
      has_bound = has_bound_device = true;
    }
    if (!has_bound_device && !type.binds_controllers()) continue;
    Result<std::vector<std::any>> data =
        prepare_controllers(type.controllers.size(), state_.spec, spec, type, registry);
    require(data);
    for (std::size_t c = 0; c < data->size(); ++c) type.controllers[c].data = std::move((*data)[c]);
    has_bound = true;
  }
  Types types;
  if (!has_bound) return;
  for (Experiment::Intervention& each : experiment_.interventions) {
    if (!is_setting(each)) continue;
    const SettingSpec& setting = *state_.spec.experiment.at[each.spec].setting;
    require(build(setting, registry, state_.types[setting.type.index()], types, each));
  }
}

// ---- Running

bool Settings::is_setting(const Experiment::Intervention& intervention) const {
  return state_.spec.experiment.at[intervention.spec].action == Action::set;
}

void Settings::swap(Experiment::Intervention& intervention) {
  const SettingSpec& setting = *state_.spec.experiment.at[intervention.spec].setting;
  BodyType& type = state_.types[setting.type.index()];
  switch (setting.of) {
    case Of::drive: std::swap(type.drive->data, intervention.data); break;
    case Of::device: std::swap(type.devices[setting.index].prepared, intervention.device); break;
    case Of::controller: std::swap(type.controllers[setting.index].data, intervention.data); break;
  }
  for (std::size_t c = 0; c < intervention.controllers.size(); ++c)
    std::swap(type.controllers[c].data, intervention.controllers[c]);
}

void Settings::swap_first(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (Experiment::Intervention& next = experiment_.interventions[i]; is_setting(next)) swap(next);
}

void Settings::swap_first_back(std::size_t count) {
  while (count > 0)
    if (Experiment::Intervention& done = experiment_.interventions[--count]; is_setting(done)) swap(done);
}

double Settings::longest_reach() const {
  double longest = 0;
  for (const BodyType& type : state_.types)
    for (const BodyType::Device& device : type.devices)
      if (type.runs()) longest = std::max(longest, device.prepared.reach_m);
  // An intervention holds the data that are not in force at present: before it is applied, the new data, and
  // afterwards the old data.
  for (const Experiment::Intervention& each : experiment_.interventions)
    if (is_setting(each)) longest = std::max(longest, each.device.reach_m);
  return longest;
}

/// Returns the number of the last intervention, counted from 1, among the first `count` interventions that
/// has a basis of this type (Experiment::Intervention::basis); 0 if there is none.
std::size_t Settings::find_basis(TypeId type, std::size_t count) const {
  const auto has_basis = [&](const Experiment::Intervention& each) {
    return each.basis && state_.spec.experiment.at[each.spec].setting->type == type;
  };
  while (count > 0 && !has_basis(experiment_.interventions[count - 1])) --count;
  return count;
}

/// Returns the spec of a type with the settings among the first `count` interventions applied.
TypeSpec Settings::type_at(TypeId type, std::size_t count) const {
  const std::size_t known = find_basis(type, count);
  TypeSpec spec =
      known > 0 ? experiment_.interventions[known - 1].basis->spec : state_.spec.types[type.index()];
  for (std::size_t i = known; i < count; ++i) {
    const InterventionSpec& done = state_.spec.experiment.at[experiment_.interventions[i].spec];
    if (done.action != Action::set || done.setting->type != type) continue;
    Record& params = params_of(spec, *done.setting);
    params = changed(params, *done.setting);
  }
  return spec;
}

/// While an object of this class exists, no setting is in force.
class Settings::Undone {
 public:
  explicit Undone(Settings& settings) : settings_(settings) {
    settings.swap_first_back(settings.experiment_.next);
  }
  ~Undone() { settings_.swap_first(settings_.experiment_.next); }
  Undone(const Undone&) = delete;
  Undone& operator=(const Undone&) = delete;

 private:
  Settings& settings_;
};

Result<> Settings::insert(const SettingSpec& setting, const Registry& registry) {
  Experiment& e = experiment_;
  // The setting is inserted after all interventions of this tick, as in a world that is resumed from a
  // checkpoint of this tick.
  const auto after =
      std::ranges::upper_bound(e.interventions, state_.now.tick, {}, &Experiment::Intervention::tick);
  const auto place = static_cast<std::size_t>(after - e.interventions.begin());
  // Settings are compiled with the type of tick 0, because a world that is resumed from a checkpoint compiles
  // all of them when it is built.
  std::shared_ptr<const BodyType> type;
  const std::size_t known = find_basis(setting.type, place);
  if (known > 0) {
    type = e.interventions[known - 1].basis->type;
  } else {
    const Undone undone(*this);
    type = std::make_shared<const BodyType>(state_.types[setting.type.index()]);
  }
  Types types;
  TypeSpec& spec = types.emplace(setting.type.value, type_at(setting.type, place)).first->second;
  Experiment::Intervention own;
  own.tick = state_.now.tick;
  own.spec = state_.spec.experiment.at.size();
  if (const Result<> built = build(setting, registry, *type, types, own); !built) return built.error();
  own.basis = std::make_shared<const Experiment::Basis>(Experiment::Basis{spec, type});
  auto later = build_from(place, setting.type, registry, *type, types);
  if (!later) return later.error();
  if (e.made++ == 0) {
    const Undone undone(*this);
    e.declared = e.interventions;
  }
  for (auto& [i, again] : *later) e.interventions[i] = std::move(again);
  if (known > 0) e.interventions[known - 1].basis.reset();
  e.interventions.insert(after, std::move(own));
  InterventionSpec& added = state_.spec.experiment.at.emplace_back();
  added.time_s = static_cast<double>(state_.now.tick) * state_.spec.tick_s;
  added.action = Action::set;
  added.setting = setting;
  // If interventions of this tick are still due, the next step applies them and, after them, the setting.
  // Otherwise the setting is applied now.
  if (place == e.next) swap(e.interventions[e.next++]);
  if (e.present.tick != state_.now.tick) e.present = {state_.now.tick, 0};
  ++e.present.settings;
  return {};
}

/// Compiles again the settings of a type from the intervention with the index `first` on, because each
/// contains the values of those before it. Returns them with their indices; changes no intervention. The last
/// two arguments are as for build().
Result<std::vector<std::pair<std::size_t, Experiment::Intervention>>> Settings::build_from(
    std::size_t first, TypeId changed_type, const Registry& registry, const BodyType& type, Types& types) {
  std::vector<std::pair<std::size_t, Experiment::Intervention>> built;
  for (std::size_t i = first; i < experiment_.interventions.size(); ++i) {
    const Experiment::Intervention& each = experiment_.interventions[i];
    const InterventionSpec& spec = state_.spec.experiment.at[each.spec];
    if (!spec.setting || spec.setting->type != changed_type) continue;
    Experiment::Intervention& again = built.emplace_back(i, each).second;
    again.basis.reset();
    if (const Result<> done = build(*spec.setting, registry, type, types, again); !done)
      return Error{
          fmt::format("with these values, the world's intervention \"set\" at {:.10g} s would fail: {}",
                      spec.time_s, done.error().text)};
  }
  return built;
}

void Settings::forget() {
  Experiment& e = experiment_;
  swap_first_back(std::exchange(e.next, 0));
  e.present = {};
  if (e.made == 0) return;
  e.interventions = std::exchange(e.declared, {});
  std::vector<InterventionSpec>& at = state_.spec.experiment.at;
  at.erase(at.end() - static_cast<std::ptrdiff_t>(std::exchange(e.made, 0)), at.end());
}

}  // namespace troupe::engine
