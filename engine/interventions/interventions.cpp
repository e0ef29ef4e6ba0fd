#include "engine/interventions/interventions.hpp"

#include "base/random.hpp"
#include "engine/interventions/build_part.hpp"
#include "engine/interventions/groups.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/placement.hpp"
#include "engine/spec/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace troupe::engine {
namespace {

using Action = InterventionSpec::Action;

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

}  // namespace

// ---- Compiling the spec

void Interventions::build(const Registry& registry, Diagnostics& diagnostics) {
  Experiment& e = experiment_;
  const ExperimentSpec& spec = state_.spec.experiment;
  for (const std::size_t i : order_of_interventions(spec, state_.spec.tick_s)) {
    Experiment::Intervention& intervention = e.interventions.emplace_back();
    intervention.tick = ticks_until(spec.at[i].time_s, state_.spec.tick_s);
    intervention.spec = i;
    intervention.stream = stream_id("at", std::to_string(i));
  }
  Settings::Types types;  // by type id, with all settings so far applied
  Groups groups(state_);
  std::size_t most = 0;
  for (Experiment::Intervention& intervention : e.interventions) {
    build_part("at", intervention.spec, diagnostics,
               [&](Diagnostics& own) { build_intervention(intervention, registry, groups, types, own); });
    if (intervention.whom) most = std::max(most, intervention.whom->size());
  }
  warn_of_small_reserves(state_.spec, e.interventions, diagnostics);
  faults_.build(registry, groups, diagnostics);
  e.candidates.reserve(most);
  if (std::ranges::any_of(spec.at, [](const auto& at) { return at.action == Action::move; }))
    places_.reserve_placed();
}

void Interventions::build_intervention(Experiment::Intervention& intervention, const Registry& registry,
                                       Groups& groups, Settings::Types& types, Diagnostics& diagnostics) {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  const auto error = [&](const std::string& what) {
    diagnostics.error(spec.where, fmt::format("at {:g} s: {}", spec.time_s, what));
  };
  if (spec.action == Action::set) {
    const BodyType& type = state_.types[spec.setting->type.index()];
    if (const Result<> built = settings_.build(*spec.setting, registry, type, types, intervention); !built)
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

void Interventions::build_conditions() {
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

void Interventions::rebuild(bool are_new_bodies, const Registry& registry, Diagnostics& diagnostics) {
  settings_.forget();
  if (are_new_bodies) settings_.bind_kinds_again(registry);
  Groups groups(state_);
  faults_.build(registry, groups, diagnostics);  // kinds of faults may read the devices of a type
}

// ---- Derived data

void Interventions::derive() {
  Experiment& e = experiment_;
  settings_.swap_first_back(std::exchange(e.next, 0));
  const auto apply_settings_before = [&](std::size_t end) {
    for (; e.next < end; ++e.next)
      if (Experiment::Intervention& due = e.interventions[e.next]; settings_.is_setting(due))
        settings_.swap(due);
  };
  const auto first_of = [&](std::uint64_t tick) {
    return static_cast<std::size_t>(
        std::ranges::lower_bound(e.interventions, tick, {}, &Experiment::Intervention::tick) -
        e.interventions.begin());
  };
  apply_settings_before(first_of(state_.now.tick));
  // If other interventions of this tick are due, the next step applies them and, after them, the settings.
  const std::size_t end = first_of(state_.now.tick + 1);
  if (e.present.tick == state_.now.tick && e.present.settings == end - e.next) apply_settings_before(end);
  faults_.derive();
  find_due();
}

void Interventions::find_due() {
  Experiment& e = experiment_;
  e.due = e.next < e.interventions.size() ? e.interventions[e.next].tick : Experiment::k_never;
  if (!e.fault_events.empty()) e.due = std::min(e.due, e.fault_events.front().tick);
}

bool Interventions::hold() const {
  if (!state_.condition_table) return true;
  for (std::size_t r = 0; r < state_.row_count(); ++r) {
    const Condition& now = state_.condition(Row(r));
    if (!(now.speed >= 0 && now.speed <= 1) || now.out > (Condition::k_disabled | Condition::k_dropped_out))
      return false;
    if (!now.is_sound() && state_.view.presence(Row(r)) != Presence::there) return false;
  }
  return true;
}

void Interventions::count_impaired() {
  state_.now.impaired = 0;
  for (std::size_t r = 0; state_.condition_table && r < state_.row_count(); ++r)
    state_.now.impaired += !state_.condition(Row(r)).is_sound();
}

void Interventions::forget() {
  constexpr std::uint32_t k_junk = 0x5a5a5a5a;
  state_.now.impaired = k_junk;
  experiment_.fault_events.clear();
  experiment_.due = 0;
}

// ---- Running

void Interventions::apply_due() {
  Experiment& e = experiment_;
  bool is_index_old = false;         // bodies are elsewhere, were born or have died
  bool was_move = false;             // the last intervention was `move`
  bool has_cargo_to_follow = false;  // such interventions have moved a body on this rank
  bool has_moved = false;  // bodies are elsewhere, or no longer part of a tree because another body died
  bool has_added = false;
  // The work that takes time proportional to the number of bodies is done once for many interventions: cargo
  // follows after consecutive interventions `move`, and the index is rebuilt at the end and before `add`.
  // All cargo follows, not only that of the moved bodies: the pose of a body that was gripped in the last
  // tick may change by a rounding error. All ranks therefore learn whether any of them has moved a body.
  const auto let_cargo_follow = [&] {
    if (!std::exchange(was_move, false) || !state_.carrier_table) return;
    bool follows = std::exchange(has_cargo_to_follow, false);
    follows = ranks_->on_any_rank(follows);
    if (!follows) return;
    places_.carry_placed();
    is_index_old = true;
  };
  while (e.next < e.interventions.size() && e.interventions[e.next].tick <= state_.now.tick) {
    Experiment::Intervention& due = e.interventions[e.next++];
    const Action action = state_.spec.experiment.at[due.spec].action;
    if (action != Action::move) let_cargo_follow();
    // A rank tests whether poses on its ground are free, so it needs the rows of the bodies that moved there.
    if (action == Action::add && has_moved) lives_.follow_newborn();
    has_moved = has_moved && action != Action::add;
    const bool has_changed = carry_out(due);
    is_index_old = is_index_old || has_changed;
    was_move = action == Action::move;
    has_cargo_to_follow = has_cargo_to_follow || (was_move && has_changed);
    has_added = has_added || action == Action::add;
    has_moved = has_moved || action == Action::move || (action == Action::remove && state_.carrier_table);
  }
  let_cargo_follow();
  faults_.apply_due();
  find_due();
  if ((has_moved || has_added)) ranks_->follow_jumps();
  if (!is_index_old) return;
  movement_.count_stalls();
  places_.index();
}

/// Applies an intervention. Returns true if bodies were moved, were born or died; the caller must then
/// rebuild the spatial index. After `move`, the caller must also call carry_placed().
bool Interventions::carry_out(Experiment::Intervention& intervention) {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  switch (spec.action) {
    case Action::set: settings_.swap(intervention); return false;
    case Action::add: return add(intervention);
    case Action::move: return move_body(intervention);
    case Action::remove: list_candidates(intervention); return remove_all(experiment_.choose(spec.whom));
    case Action::disable:
    case Action::enable: break;
  }
  list_candidates(intervention);
  for (const Candidate& chosen : experiment_.choose(spec.whom))
    if (state_.view.location(chosen.body) == RowLocation::here) toggle_disabled(state_.view.row(chosen.body));
  return false;
}

/// Applies an intervention `move`. Returns whether the body was moved.
bool Interventions::move_body(const Experiment::Intervention& intervention) {
  if (intervention.whom->empty()) return false;
  const BodyId body = intervention.whom->front();
  if (state_.view.location(body) != RowLocation::here) return false;
  const Row row = state_.view.row(body);
  if (!state_.view.is_there(row) || state_.view.carrier(row)) return false;
  places_.place(row, *state_.spec.experiment.at[intervention.spec].pose);
  return true;
}

/// Lists in Experiment::candidates the bodies that `remove`, `disable` or `enable` can affect, with a random
/// key for each.
void Interventions::list_candidates(const Experiment::Intervention& intervention) {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  const auto is_disabled = [&](Row row) { return (state_.condition(row).out & Condition::k_disabled) != 0; };
  // A selection by count or share depends on all candidates, also on those whose rows only other ranks have.
  // For `remove`, every rank must know of the deaths of newborn_, whose rows may be elsewhere: newborn_ must
  // be the same on all ranks (has_many_newborn()).
  const bool needs_all = spec.whom.count || spec.whom.share || spec.action == Action::remove;
  experiment_.candidates.clear();
  for (const BodyId id : *intervention.whom) {
    if (state_.view.location(id) != RowLocation::here) continue;
    const Row row = state_.view.row(id);
    if (!state_.view.is_there(row)) continue;
    if (needs_all && row.index() >= state_.own_rows) continue;  // the rank that owns the row sends it
    if (spec.action != Action::remove && is_disabled(row) != (spec.action == Action::enable)) continue;
    const Random random(state_.spec.seed, intervention.stream, id.value,
                        static_cast<std::uint32_t>(state_.now.tick));
    experiment_.candidates.push_back({selection_key(random), id});
  }
  if (needs_all) ranks_->add_candidates(experiment_.candidates);
}

/// Removes the bodies from the world. Returns whether there are any. chosen: in order of ids
bool Interventions::remove_all(std::span<const Candidate> chosen) {
  std::erase_if(places_.newborn(), [&](const Places::Newborn& newborn) {
    return std::ranges::binary_search(chosen, newborn.body, {}, &Candidate::body);
  });
  for (const Candidate& each : chosen)
    if (state_.view.location(each.body) == RowLocation::here) lives_.die(state_.view.row(each.body));
  return !chosen.empty();
}

void Interventions::toggle_disabled(Row row) {
  Condition& now = state_.condition(row);
  state_.now.impaired -= !now.is_sound();
  now.out ^= Condition::k_disabled;
  state_.now.impaired += !now.is_sound();
}

/// Adds the bodies of an intervention `add`. Ends early if the pose of the intervention is not free, or if
/// none of the random poses that are tried for a body is free (PlacementRule::trials, as when a world is
/// loaded). Returns whether any body was added.
bool Interventions::add(const Experiment::Intervention& intervention) {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  const std::uint32_t trials = spec.pose ? 1 : PlacementRule().trials;
  const std::int64_t left = static_cast<std::int64_t>(lives_.unborn(intervention.reserve));
  const auto count = static_cast<std::uint32_t>(std::min(spec.whom.count.value_or(left), left));
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto place = [&](std::uint32_t trial) { return place_to_add(intervention, i, trial); };
    const Birth birth = lives_.give_birth(intervention.reserve, trials, std::cref(place));
    if (birth.status != BirthStatus::born) return i > 0;
    if (places_.has_many_newborn()) lives_.follow_newborn();
  }
  return count > 0;
}

Pose Interventions::place_to_add(const Experiment::Intervention& intervention, std::uint32_t number,
                                 std::uint32_t trial) const {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  if (spec.pose) return *spec.pose;
  const Box box = spec.region.value_or(state_.bounds());
  Random random(state_.spec.seed, intervention.stream, number, trial);
  const double x = random.uniform(box.min.x(), box.max.x());
  const double y = random.uniform(box.min.y(), box.max.y());
  const double z = state_.spec.bodies[lives_.next_unborn(intervention.reserve).index()].pose_world_body.z;
  return {x, y, z, random.uniform(-k_pi, k_pi)};
}

// ---- Settings of a program

Result<> Interventions::set(const SettingSpec& setting, const Registry& registry) {
  Result<> done = settings_.insert(setting, registry);
  if (done) find_due();
  return done;
}

std::uint64_t Interventions::settings_now() const {
  const Experiment::Present& present = experiment_.present;
  return present.tick == state_.now.tick ? present.settings : 0;
}

}  // namespace troupe::engine
