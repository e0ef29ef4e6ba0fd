#include "engine/interventions/experiment.hpp"

#include "base/math.hpp"
#include "base/random.hpp"
#include "engine/interventions/groups.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/kind_errors.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

namespace troupe::engine {

struct Experiment::Basis {
  TypeSpec spec;                         // the type with all settings up to that of the intervention
  std::shared_ptr<const BodyType> type;  // the compiled type with the parameters of tick 0
};

namespace {

using Action = InterventionSpec::Action;
using By = GroupSpec::By;
using Of = SettingSpec::Of;
using FaultEvent = Experiment::FaultEvent;

constexpr std::uint32_t k_trials = 1000;  // random positions per added body, as when a world is loaded

/// Whether event `a` comes after event `b`: by tick, then by the order of the faults in the file, then by the
/// id of the body. A heap with this order has the earliest event on top.
bool is_later(const FaultEvent& a, const FaultEvent& b) {
  return std::tuple(a.tick, a.fault, a.body) > std::tuple(b.tick, b.fault, b.body);
}

void push(std::vector<FaultEvent>& heap, const FaultEvent& event) {
  heap.push_back(event);
  std::ranges::push_heap(heap, is_later);
}

std::uint64_t key_of(Random random) {
  const std::uint64_t high = random.bits();
  return high << 32 | random.bits();
}

/// Warns once of each population whose interventions `add` together add more bodies than its reserve has.
/// in_order: the interventions of the spec, in the order in which they are applied
void warn_of_small_reserves(const WorldSpec& spec, std::span<const Experiment::Intervention> in_order,
                            Diagnostics& diagnostics) {
  std::map<std::string_view, std::uint64_t> left;  // by population: bodies that are still in the reserve
  for (const ReserveSpec& reserve : spec.reserves) left[reserve.population] += reserve.count;
  for (const Experiment::Intervention& intervention : in_order) {
    const InterventionSpec& at = spec.experiment.at[intervention.spec];
    if (at.action != Action::add) continue;
    const auto reserve = left.find(at.whom.name);
    if (reserve == left.end()) continue;  // an error, or a population that was warned of
    // Without a number, all bodies that are left are added.
    const std::uint64_t wanted = at.whom.count ? static_cast<std::uint64_t>(*at.whom.count) : reserve->second;
    if (wanted <= reserve->second) {
      reserve->second -= wanted;
      continue;
    }
    diagnostics.warning(at.where,
                        fmt::format("at {:g} s: {} bodies are to be added to \"{}\", but at most {} "
                                    "are left in its \"reserve\": enlarge the reserve",
                                    at.time_s, wanted, at.whom.name, reserve->second));
    left.erase(reserve);
  }
}

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

/// Calls build(own), where `own` is a new Diagnostics object. Adds each finding in `own` to `diagnostics` as
/// an error, with the JSON pointer `/KEY/INDEX` of the part of the experiment in front of the message.
template <class Build>
void build_part(std::string_view key, std::size_t index, Diagnostics& diagnostics, Build&& build) {
  Diagnostics own(diagnostics.files());
  build(own);
  for (const Finding& finding : own.findings())
    diagnostics.error(finding.where, fmt::format("/{}/{}: {}", key, index, finding.message));
}

}  // namespace

// ---- Compiling the spec

void World::build_experiment(const Registry& registry, Diagnostics& diagnostics) {
  Experiment& e = experiment_;
  const ExperimentSpec& spec = state_.spec.experiment;
  e.interventions.resize(spec.at.size());
  for (std::size_t i = 0; i < spec.at.size(); ++i) {
    e.interventions[i].tick = ticks_until(spec.at[i].time_s, state_.spec.tick_s);
    e.interventions[i].spec = i;
    e.interventions[i].stream = stream_id("at", std::to_string(i));
  }
  std::ranges::stable_sort(e.interventions, {}, &Experiment::Intervention::tick);
  std::map<std::uint32_t, TypeSpec> types;  // by type id, with all settings so far applied
  Groups groups(*this);
  std::size_t most = 0;
  for (Experiment::Intervention& intervention : e.interventions) {
    build_part("at", intervention.spec, diagnostics,
               [&](Diagnostics& own) { build_intervention(intervention, registry, groups, types, own); });
    if (intervention.whom) most = std::max(most, intervention.whom->size());
  }
  warn_of_small_reserves(state_.spec, e.interventions, diagnostics);
  build_faults(registry, groups, diagnostics);
  e.candidates.reserve(most);
  if (std::ranges::any_of(spec.at, [](const auto& at) { return at.action == Action::move; }))
    for (PlacedRows* list : {&placed_, &placed_before_}) list->reserve(rows());
}

/// Compiles the faults of the spec, selects the bodies that may fail, and computes the first event of each
/// fault in each of these bodies. Throws if the spec of a fault has errors.
void World::build_faults(const Registry& registry, Groups& groups, Diagnostics& diagnostics) {
  Experiment& e = experiment_;
  e.faults.clear();
  e.first_fault_events.clear();
  for (std::size_t i = 0; i < state_.spec.experiment.faults.size(); ++i)
    build_part("faults", i, diagnostics, [&](Diagnostics& own) { build_fault(i, registry, groups, own); });
  diagnostics.throw_if_errors();
  std::ranges::make_heap(e.first_fault_events, is_later);
  e.fault_events.reserve(e.first_fault_events.size());
}

void World::build_intervention(Experiment::Intervention& intervention, const Registry& registry,
                               Groups& groups, std::map<std::uint32_t, TypeSpec>& types,
                               Diagnostics& diagnostics) {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  const auto error = [&](const std::string& what) {
    diagnostics.error(spec.where, fmt::format("at {:g} s: {}", spec.time_s, what));
  };
  if (spec.action == Action::set) {
    const BodyType& type = state_.types[spec.setting->type.index()];
    if (const Result<> built = build_setting(*spec.setting, registry, type, types, intervention); !built)
      error(built.error().text);
    return;
  }
  if (spec.action == Action::add) {
    if (const auto reserve = groups.reserve(spec.whom.name)) {
      intervention.reserve = *reserve;
    } else {
      std::vector<std::string_view> known;
      for (const ReserveSpec& each : state_.spec.reserves) known.push_back(each.population);
      error(known.empty()
                ? fmt::format("no body can be added to \"{}\": no population has a \"reserve\"; give this "
                              "population a \"reserve\"",
                              spec.whom.name)
                : unknown_name("population with a reserve", spec.whom.name, known));
    }
    if (spec.pose && !state_.bounds().contains(spec.pose->position()))
      error(fmt::format("a body of \"{}\" would be added at x {}, y {} (m), {}", spec.whom.name, spec.pose->x,
                        spec.pose->y, outside_text(state_.bounds())));
    if (spec.region && !spec.region->touches(state_.bounds()))
      error(fmt::format("\"region_m\", in which bodies of \"{}\" would be added, is {}", spec.whom.name,
                        outside_text(state_.bounds())));
    if (!spec.pose && !spec.region && !state_.spec.bounds)
      error("\"add\" needs \"region_m\" or \"pose\", because the world has no bounds");
    return;
  }
  intervention.whom = groups.find(spec.whom, spec.where, diagnostics);
  if (spec.action == Action::move && !state_.bounds().contains(spec.pose->position()))
    error(fmt::format("\"{}\" would be moved to x {}, y {} (m), {}", spec.whom.name, spec.pose->x,
                      spec.pose->y, outside_text(state_.bounds())));
}

Result<> World::build_setting(const SettingSpec& setting, const Registry& registry, const BodyType& type,
                              std::map<std::uint32_t, TypeSpec>& types,
                              Experiment::Intervention& intervention) {
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

/// Calls the hook `bind_world` of devices and controllers again, after poses or colours in the spec have
/// changed: their kinds have stored places, contours or colours of bodies. No setting may be in force.
void World::bind_kinds_again(const Registry& registry) {
  const auto require = [](const auto& prepared) {
    if (!prepared) throw std::logic_error(prepared.error().text);  // it was accepted with the old poses
  };
  bool has_bound = false;
  for (std::size_t t = 0; t < state_.types.size(); ++t) {
    BodyType& type = state_.types[t];
    const TypeSpec& spec = state_.spec.types[t];
    for (std::size_t d = 0; d < type.devices.size(); ++d) {
      BodyType::Device& device = type.devices[d];
      if (!device.kind->bind_world) continue;
      Result<DeviceKind::Prepared> prepared =
          prepare_device(*device.kind, spec.devices[d], state_.spec, spec);
      require(prepared);
      device.prepared.data = std::move(prepared->data);
      has_bound = true;
    }
    if (!type.binds_controllers()) continue;
    Result<std::vector<std::any>> data =
        prepare_controllers(type.controllers.size(), state_.spec, spec, type, registry);
    require(data);
    for (std::size_t c = 0; c < data->size(); ++c) type.controllers[c].data = std::move((*data)[c]);
    has_bound = true;
  }
  std::map<std::uint32_t, TypeSpec> types;
  if (!has_bound) return;
  for (Experiment::Intervention& each : experiment_.interventions) {
    if (!is_setting(each)) continue;
    const SettingSpec& setting = *state_.spec.experiment.at[each.spec].setting;
    require(build_setting(setting, registry, state_.types[setting.type.index()], types, each));
  }
}

namespace {

/// Checks the members of the Impairment that a kind of fault returned, because the kind may come from a
/// plug-in.
Result<> check_impairment(const Impairment& made) {
  if (!(made.speed > 0 && made.speed <= 1))
    return Error{
        fmt::format("has the factor {} on the velocity (Impairment::speed): it must be above 0 and at most 1",
                    made.speed)};
  if (!(made.per_s >= 0 && std::isfinite(made.per_s)))
    return Error{fmt::format(
        "occurs at the rate {} 1/s (Impairment::per_s): this must be a finite number of at least 0",
        made.per_s)};
  if (!(made.lasts_s >= 0 && std::isfinite(made.lasts_s)))
    return Error{fmt::format("lasts {} s (Impairment::lasts_s): this must be a finite number of at least 0",
                             made.lasts_s)};
  return {};
}

/// Compiles the parameters of a fault for a type. The text of the error continues the words `fault "NAME"`.
Result<Impairment> prepare_fault(const FaultKind& kind, const Record& params, const BodyType& type) try {
  Result<Impairment> made = kind.prepare(params, type);
  if (!made) return Error{fmt::format(": {}", made.error().text)};
  if (const Result<> checked = check_impairment(*made); !checked)
    return Error{fmt::format(" {}", checked.error().text)};
  return made;
} catch (...) {
  return Error{fmt::format(" {}", thrown_text())};
}

}  // namespace

void World::build_fault(std::size_t at, const Registry& registry, Groups& groups, Diagnostics& diagnostics) {
  const FaultSpec& spec = state_.spec.experiment.faults[at];
  const std::uint32_t chooses = stream_id("fault", fmt::format("{}", at));
  experiment_.candidates.clear();
  for (const BodyId body : *groups.find(spec.whom, spec.where, diagnostics))
    if (state_.spec.starts(body))
      experiment_.candidates.push_back({key_of({state_.spec.seed, chooses, body.value, 0}), body});
  const std::span<const Experiment::Candidate> chosen = choose(spec.whom);
  const std::uint64_t from = ticks_until(spec.from_s, state_.spec.tick_s);
  for (const FaultSpec::Impairment& impairment : spec.impairments) {
    const FaultKind* kind = registry.fault(impairment.kind);
    if (kind == nullptr) {
      diagnostics.error(spec.where, unknown_name("fault", impairment.kind, name_list(registry.faults)));
      continue;
    }
    const std::uint32_t stream = stream_id(kind->name, fmt::format("{}", at));
    std::map<std::uint32_t, std::uint32_t> faults;  // by type: device indices differ between types
    for (const Experiment::Candidate& candidate : chosen) {
      const std::uint32_t t = state_.spec.bodies[candidate.body.index()].type.value;
      const auto [known, is_new] =
          faults.try_emplace(t, static_cast<std::uint32_t>(experiment_.faults.size()));
      if (is_new) {
        Impairment made;
        if (const Result<Impairment> prepared = prepare_fault(*kind, impairment.params, state_.types[t]))
          made = *prepared;
        else
          diagnostics.error(spec.where, fmt::format("fault \"{}\"{}", kind->name, prepared.error().text));
        experiment_.faults.push_back({made, stream});
      }
      const std::uint64_t tick = next_fault_tick(known->second, candidate.body, from);
      experiment_.first_fault_events.push_back({tick, known->second, candidate.body, true});
    }
  }
}

void World::build_conditions() {
  const bool any = std::ranges::any_of(state_.spec.experiment.at, [](const auto& at) {
    return at.action == Action::disable || at.action == Action::enable;
  });
  if (!any && state_.spec.experiment.faults.empty() && !state_.spec.mortal) return;
  state_.condition_table = state_.tables.size();
  state_.tables.emplace_back(
      "condition", HashGroup::memory, StateTable::Layout::rows,
      sparse({{"speed", Element::f64, 1, "",
               "factor by which the velocity of the drive is multiplied; 0 acts as 1",
               offsetof(Condition, speed)},
              {"dead", Element::u32, 1, "",
               "devices that do not work: bit d stands for device d of the type, counted from 0",
               offsetof(Condition, dead)},
              {"out", Element::u8, 1, "",
               "reasons why the devices, controllers and drive of the body are stopped; bit 0: disabled, "
               "bit 1: dropped out; 0: they run",
               offsetof(Condition, out)}}),
      state_.bodies, sizeof(Condition));
}

// ---- Running

void World::derive_experiment() {
  Experiment& e = experiment_;
  swap_settings_back(std::exchange(e.next, 0));
  for (; e.next < e.interventions.size() && e.interventions[e.next].tick < state_.now.tick; ++e.next)
    if (Experiment::Intervention& due = e.interventions[e.next]; is_setting(due)) swap_setting(due);
  e.fault_events = e.first_fault_events;
  while (!e.fault_events.empty() && e.fault_events.front().tick < state_.now.tick) take_fault_event();
  find_due();
}

void World::find_due() {
  Experiment& e = experiment_;
  e.due = e.next < e.interventions.size() ? e.interventions[e.next].tick : Experiment::k_never;
  if (!e.fault_events.empty()) e.due = std::min(e.due, e.fault_events.front().tick);
}

bool World::conditions_hold() const {
  if (!state_.condition_table) return true;
  for (std::size_t r = 0; r < rows(); ++r) {
    const Condition& now = state_.condition(Row(r));
    if (!(now.speed >= 0 && now.speed <= 1) || now.out > (Condition::k_disabled | Condition::k_dropped_out))
      return false;
    if (!now.is_sound() && presence(Row(r)) != Presence::there) return false;
  }
  return true;
}

void World::count_impaired() {
  state_.now.impaired = 0;
  for (std::size_t r = 0; state_.condition_table && r < rows(); ++r)
    state_.now.impaired += !state_.condition(Row(r)).is_sound();
}

double World::speed_scale(Row row) const {
  const double speed = state_.condition(row).speed;
  return speed == 0 ? 1 : speed;
}

/// Applies the interventions and fault events that are due at the end of the last completed tick.
/// Interventions come first, in the order of the file; fault events follow. If the rows are distributed among
/// ranks, each rank applies them to its own rows and to its ghosts (copies of rows of other ranks,
/// engine/ranks/halo.hpp).
void World::intervene() {
  Experiment& e = experiment_;
  bool is_index_old = false;  // bodies are elsewhere, were born or have died
  bool has_cargo_to_follow = false;
  bool has_moved = false;  // bodies are elsewhere, or no longer part of a tree because another body died
  bool has_added = false;
  // The work that takes time proportional to the number of bodies is done once for many interventions: cargo
  // follows after consecutive interventions `move`, and the index is rebuilt at the end and before `add`.
  const auto let_cargo_follow = [&] {
    if (std::exchange(has_cargo_to_follow, false)) carry_placed();
  };
  while (e.next < e.interventions.size() && e.interventions[e.next].tick <= state_.now.tick) {
    Experiment::Intervention& due = e.interventions[e.next++];
    const Action action = state_.spec.experiment.at[due.spec].action;
    if (action != Action::move) let_cargo_follow();
    // A rank tests whether poses on its ground are free, so it needs the rows of the bodies that moved there.
    if (action == Action::add && has_moved) follow_newborn();
    has_moved = has_moved && action != Action::add;
    const bool has_changed = carry_out(due);
    is_index_old = is_index_old || has_changed;
    has_cargo_to_follow = has_cargo_to_follow || (action == Action::move && has_changed);
    has_added = has_added || action == Action::add;
    has_moved = has_moved || action == Action::move || (action == Action::remove && state_.carrier_table);
  }
  let_cargo_follow();
  while (!e.fault_events.empty() && e.fault_events.front().tick <= state_.now.tick)
    apply_fault_event(take_fault_event());
  find_due();
  if ((has_moved || has_added) && replica_ != nullptr) replica_->follow_jumps();
  if (!is_index_old) return;
  movement_.count_stalls();
  index_bodies();
}

/// Applies an intervention. Returns true if bodies were moved, were born or died; the caller must then
/// rebuild the spatial index. After `move`, the caller must also call carry_placed().
bool World::carry_out(Experiment::Intervention& intervention) {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  switch (spec.action) {
    case Action::set: swap_setting(intervention); return false;
    case Action::add: return add(intervention);
    case Action::move: return move_body(intervention);
    case Action::remove: list_candidates(intervention); return remove_all(choose(spec.whom));
    case Action::disable:
    case Action::enable: break;
  }
  list_candidates(intervention);
  for (const Experiment::Candidate& chosen : choose(spec.whom))
    if (location(chosen.body) == RowLocation::here) toggle_disabled(row(chosen.body));
  return false;
}

/// Applies an intervention `move`. Returns whether the body was moved.
bool World::move_body(const Experiment::Intervention& intervention) {
  if (intervention.whom->empty()) return false;
  const BodyId body = intervention.whom->front();
  if (location(body) != RowLocation::here) return false;
  const Row row = this->row(body);
  if (!is_there(row) || carrier(row)) return false;
  place(row, *state_.spec.experiment.at[intervention.spec].pose);
  return true;
}

/// Lists in Experiment::candidates the bodies that `remove`, `disable` or `enable` can affect, with a random
/// key for each.
void World::list_candidates(const Experiment::Intervention& intervention) {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  const auto is_disabled = [&](Row row) { return (state_.condition(row).out & Condition::k_disabled) != 0; };
  // A selection by count or share depends on all candidates, also on those whose rows only other ranks have.
  // For `remove`, every rank must know of the deaths of newborn_, whose rows may be elsewhere: newborn_ must
  // be the same on all ranks (has_many_newborn()).
  const bool needs_all = spec.whom.count || spec.whom.share || spec.action == Action::remove;
  experiment_.candidates.clear();
  for (const BodyId id : *intervention.whom) {
    if (location(id) != RowLocation::here) continue;
    const Row row = this->row(id);
    if (!is_there(row)) continue;
    if (needs_all && row.index() >= state_.own_rows) continue;  // the rank that owns the row sends it
    if (spec.action != Action::remove && is_disabled(row) != (spec.action == Action::enable)) continue;
    const Random random(state_.spec.seed, intervention.stream, id.value,
                        static_cast<std::uint32_t>(state_.now.tick));
    experiment_.candidates.push_back({key_of(random), id});
  }
  if (needs_all && replica_ != nullptr) replica_->add_candidates(experiment_.candidates);
}

/// Removes the bodies from the world. Returns whether there are any. chosen: in order of ids
bool World::remove_all(std::span<const Experiment::Candidate> chosen) {
  std::erase_if(newborn_, [&](const Newborn& newborn) {
    return std::ranges::binary_search(chosen, newborn.body, {}, &Experiment::Candidate::body);
  });
  for (const Experiment::Candidate& each : chosen)
    if (location(each.body) == RowLocation::here) die(row(each.body));
  return !chosen.empty();
}

void World::toggle_disabled(Row row) {
  Condition& now = state_.condition(row);
  state_.now.impaired -= !now.is_sound();
  now.out ^= Condition::k_disabled;
  state_.now.impaired += !now.is_sound();
}

bool World::set_disabled(Row row, bool disabled) {
  require_whole();
  require_between_steps(disabled ? "disable()" : "enable()");
  if (!state_.condition_table)
    throw std::logic_error(fmt::format(
        "programs cannot disable \"{}\": add \"mortal\": true to the world file, or set the option mortal "
        "(worlds with faults, or with an intervention \"disable\" or \"enable\", need neither)",
        state_.spec.name(body(row))));
  if (!is_there(row) || ((state_.condition(row).out & Condition::k_disabled) != 0) == disabled) return false;
  touch();
  toggle_disabled(row);
  return true;
}

std::span<const Experiment::Candidate> World::choose(const GroupSpec& group) {
  std::vector<Experiment::Candidate>& all = experiment_.candidates;
  const std::size_t count = group.selected_of(all.size());
  if (count < all.size()) {
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(count);
    std::ranges::nth_element(all, end, {},
                             [](const Experiment::Candidate& c) { return std::tuple(c.key, c.body); });
  }
  // Candidates of other ranks are not in the order of ids.
  std::sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count),
            [](const auto& a, const auto& b) { return a.body < b.body; });
  return {all.data(), count};
}

/// Adds the bodies of an intervention `add`. Ends early if the pose of the intervention is not free, or if
/// none of k_trials random poses for a body is free. Returns whether any body was added.
bool World::add(const Experiment::Intervention& intervention) {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  const std::uint32_t trials = spec.pose ? 1 : k_trials;
  const std::int64_t left = static_cast<std::int64_t>(unborn(intervention.reserve));
  const auto count = static_cast<std::uint32_t>(std::min(spec.whom.count.value_or(left), left));
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto place = [&](std::uint32_t trial) { return place_to_add(intervention, i, trial); };
    const Birth birth = give_birth(intervention.reserve, trials, std::cref(place));
    if (birth.status != BirthStatus::born) return i > 0;
    if (has_many_newborn()) follow_newborn();
  }
  return count > 0;
}

Pose World::place_to_add(const Experiment::Intervention& intervention, std::uint32_t number,
                         std::uint32_t trial) const {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  if (spec.pose) return *spec.pose;
  const Box box = spec.region.value_or(state_.bounds());
  Random random(state_.spec.seed, intervention.stream, number, trial);
  const double x = random.uniform(box.min.x(), box.max.x());
  const double y = random.uniform(box.min.y(), box.max.y());
  const double z = state_.spec.bodies[next_unborn(intervention.reserve).index()].pose_world_body.z;
  return {x, y, z, random.uniform(-k_pi, k_pi)};
}

bool World::is_setting(const Experiment::Intervention& intervention) const {
  return state_.spec.experiment.at[intervention.spec].action == Action::set;
}

/// Applies a setting if it is not in force, and otherwise undoes it: swaps the prepared data of the
/// intervention with the present data of the type. No memory is thus allocated during a run.
void World::swap_setting(Experiment::Intervention& intervention) {
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

/// Applies the settings among the first `count` interventions, in their order.
void World::swap_settings(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (Experiment::Intervention& next = experiment_.interventions[i]; is_setting(next)) swap_setting(next);
}

/// Undoes the settings among the first `count` interventions, the last one first.
void World::swap_settings_back(std::size_t count) {
  while (count > 0)
    if (Experiment::Intervention& done = experiment_.interventions[--count]; is_setting(done))
      swap_setting(done);
}

double World::longest_reach() const {
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

TypeSpec World::present_type(TypeId type) const { return type_at(type, experiment_.next); }

/// Returns the number of the last intervention, counted from 1, among the first `count` interventions that
/// has a basis of this type (Experiment::Intervention::basis); 0 if there is none.
std::size_t World::find_basis(TypeId type, std::size_t count) const {
  const auto has_basis = [&](const Experiment::Intervention& each) {
    return each.basis && state_.spec.experiment.at[each.spec].setting->type == type;
  };
  while (count > 0 && !has_basis(experiment_.interventions[count - 1])) --count;
  return count;
}

/// Returns the spec of a type with the settings among the first `count` interventions applied.
TypeSpec World::type_at(TypeId type, std::size_t count) const {
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

Result<> World::set(const SettingSpec& setting, const Registry& registry) {
  require_whole();
  require_unfrozen();
  require_between_steps("set()");
  Result<> done = insert_setting(setting, registry);
  if (done && replica_ != nullptr) replica_->set(setting);
  return done;
}

Result<> World::set_at(std::uint64_t tick, const SettingSpec& setting, const Registry& registry) {
  if (tick != state_.now.tick) {
    state_.now.tick = tick;
    derive_experiment();
  }
  return insert_setting(setting, registry);
}

/// Inserts a setting after the interventions of the present tick. Applies it, unless interventions of this
/// tick are still due.
Result<> World::insert_setting(const SettingSpec& setting, const Registry& registry) {
  Experiment& e = experiment_;
  std::vector<InterventionSpec>& at = state_.spec.experiment.at;
  // While an object of this class exists, no setting is in force.
  struct Undone {
    explicit Undone(World& w) : world(w) { world.swap_settings_back(world.experiment_.next); }
    ~Undone() { world.swap_settings(world.experiment_.next); }
    Undone(const Undone&) = delete;
    Undone& operator=(const Undone&) = delete;
    World& world;
  };
  const auto setting_of = [&](const Experiment::Intervention& each) -> const SettingSpec* {
    const auto& of = at[each.spec].setting;
    return of && of->type == setting.type ? &*of : nullptr;  // settings of other types do not matter here
  };
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
  std::map<std::uint32_t, TypeSpec> types;
  TypeSpec& spec = types.emplace(setting.type.value, type_at(setting.type, place)).first->second;
  Experiment::Intervention own{.tick = state_.now.tick,
                               .spec = at.size(),
                               .whom = {},
                               .data = {},
                               .device = {},
                               .controllers = {},
                               .basis = {}};
  if (const Result<> built = build_setting(setting, registry, *type, types, own); !built)
    return built.error();
  own.basis = std::make_shared<const Experiment::Basis>(Experiment::Basis{spec, type});
  // The later settings of the type are compiled again, because each contains the values of those before it.
  std::vector<std::pair<std::size_t, Experiment::Intervention>> later;
  for (std::size_t i = place; i < e.interventions.size(); ++i) {
    const SettingSpec* const next = setting_of(e.interventions[i]);
    if (next == nullptr) continue;
    Experiment::Intervention& again = later.emplace_back(i, e.interventions[i]).second;
    again.basis.reset();
    if (const Result<> built = build_setting(*next, registry, *type, types, again); !built)
      return Error{
          fmt::format("with these values, the world's intervention \"set\" at {:.10g} s would fail: {}",
                      at[again.spec].time_s, built.error().text)};
  }
  if (e.made++ == 0) {
    const Undone undone(*this);
    e.declared = e.interventions;
  }
  for (auto& [i, again] : later) e.interventions[i] = std::move(again);
  if (known > 0) e.interventions[known - 1].basis.reset();
  e.interventions.insert(after, std::move(own));
  InterventionSpec& added = at.emplace_back();
  added.time_s = static_cast<double>(state_.now.tick) * state_.spec.tick_s;
  added.action = Action::set;
  added.setting = setting;
  // If interventions of this tick are still due, the next step applies them and, after them, the setting.
  // Otherwise the setting is applied now.
  if (place == e.next) swap_setting(e.interventions[e.next++]);
  find_due();
  return {};
}

/// Undoes the changes of all calls of set(). No setting is in force afterwards.
void World::forget_settings() {
  Experiment& e = experiment_;
  swap_settings_back(std::exchange(e.next, 0));
  if (e.made == 0) return;
  e.interventions = std::exchange(e.declared, {});
  std::vector<InterventionSpec>& at = state_.spec.experiment.at;
  at.erase(at.end() - static_cast<std::ptrdiff_t>(std::exchange(e.made, 0)), at.end());
}

/// The tick at whose end a fault occurs next in a body. A fault without a rate (Impairment::per_s) occurs at
/// `from`. A fault with a rate occurs at least one tick later, after a random, exponentially distributed
/// time.
std::uint64_t World::next_fault_tick(std::uint32_t fault, BodyId body, std::uint64_t from) const {
  const Experiment::Fault& f = experiment_.faults[fault];
  if (!(f.impairment.per_s > 0)) return from;
  Random random(state_.spec.seed, f.stream, body.value, static_cast<std::uint32_t>(from));
  return from + std::max<std::uint64_t>(
                    1, ticks_until(random.exponential() / f.impairment.per_s, state_.spec.tick_s));
}

/// Removes the earliest fault event from the heap and returns it. If another event of the fault follows in
/// the same body, inserts this event: the end of a drop-out, or the next time that the fault occurs. Dead
/// bodies keep their events, which then have no effect, so that the schedule does not depend on the state.
Experiment::FaultEvent World::take_fault_event() {
  std::vector<FaultEvent>& heap = experiment_.fault_events;
  const FaultEvent now = heap.front();
  std::ranges::pop_heap(heap, is_later);
  heap.pop_back();
  const Impairment& impairment = experiment_.faults[now.fault].impairment;
  FaultEvent next = now;
  next.begins = !now.begins;
  if (now.begins && impairment.drops_out && impairment.lasts_s > 0) {
    next.tick = now.tick + period_ticks(impairment.lasts_s, state_.spec.tick_s);
    push(heap, next);
  } else if (!now.begins && impairment.per_s > 0) {
    next.tick = next_fault_tick(now.fault, now.body, now.tick);
    push(heap, next);
  }
  return now;
}

void World::apply_fault_event(const Experiment::FaultEvent& event) {
  if (location(event.body) != RowLocation::here) return;
  const Row row = this->row(event.body);
  if (!is_there(row)) return;
  const Impairment& impairment = experiment_.faults[event.fault].impairment;
  Condition& now = state_.condition(row);
  state_.now.impaired -= !now.is_sound();
  if (event.begins) {
    now.dead |= impairment.dead;
    if (impairment.speed != 1) {
      // A product that underflows to 0 would act as 1, and the reciprocal of a denormal number can be
      // infinite.
      now.speed = std::max(speed_scale(row) * impairment.speed, std::numeric_limits<double>::min());
      // The velocity is scaled too, because the drive's acceleration limits refer to it.
      Velocity& v = state_.as<Velocity>(WorldState::k_velocity)[row.index()];
      v = {v.x * impairment.speed, v.y * impairment.speed, v.turn * impairment.speed};
    }
    if (impairment.drops_out) now.out |= Condition::k_dropped_out;
  } else {
    now.out &= static_cast<std::uint8_t>(~Condition::k_dropped_out);
  }
  state_.now.impaired += !now.is_sound();
}

}  // namespace troupe::engine
