#include "engine/interventions/experiment.hpp"

#include "base/math.hpp"
#include "base/random.hpp"
#include "base/sort.hpp"
#include "engine/interventions/groups.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/spec/placement.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/kind_errors.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

namespace troupe::engine {

namespace {

using Action = InterventionSpec::Action;
using FaultEvent = Experiment::FaultEvent;

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

std::vector<std::size_t> order_of_interventions(const ExperimentSpec& spec, double tick_s) {
  std::vector<std::uint64_t> ticks;
  for (const InterventionSpec& at : spec.at) ticks.push_back(ticks_until(at.time_s, tick_s));
  return sorted_order(ticks);
}

void World::build_experiment(const Registry& registry, Diagnostics& diagnostics) {
  Experiment& e = experiment_;
  const ExperimentSpec& spec = state_.spec.experiment;
  for (const std::size_t i : order_of_interventions(spec, state_.spec.tick_s)) {
    Experiment::Intervention& intervention = e.interventions.emplace_back();
    intervention.tick = ticks_until(spec.at[i].time_s, state_.spec.tick_s);
    intervention.spec = i;
    intervention.stream = stream_id("at", std::to_string(i));
  }
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
  const auto apply_settings_before = [&](std::size_t end) {
    for (; e.next < end; ++e.next)
      if (Experiment::Intervention& due = e.interventions[e.next]; is_setting(due)) swap_setting(due);
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
    if (replica_ != nullptr) follows = replica_->on_any_rank(follows);
    if (!follows) return;
    carry_placed();
    is_index_old = true;
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
    was_move = action == Action::move;
    has_cargo_to_follow = has_cargo_to_follow || (was_move && has_changed);
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
  require_row(row, disabled ? "disable()" : "enable()");
  if (!state_.condition_table)
    throw std::logic_error(fmt::format(
        "programs cannot disable \"{}\": add \"mortal\": true to the world file, or set this key when you "
        "load the world (in C++: SimulationOptions::mortal; in Python: set={{\"/mortal\": True}}); worlds "
        "with faults, or with an intervention \"disable\" or \"enable\", need neither",
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
/// none of the random poses that are tried for a body is free (PlacementRule::trials, as when a world is
/// loaded). Returns whether any body was added.
bool World::add(const Experiment::Intervention& intervention) {
  const InterventionSpec& spec = state_.spec.experiment.at[intervention.spec];
  const std::uint32_t trials = spec.pose ? 1 : PlacementRule().trials;
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
