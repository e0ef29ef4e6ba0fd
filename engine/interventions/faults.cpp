#include "engine/interventions/faults.hpp"

#include "base/random.hpp"
#include "engine/interventions/build_part.hpp"
#include "engine/interventions/groups.hpp"
#include "engine/kinds/thrown_text.hpp"
#include "engine/spec/names.hpp"
#include "engine/spec/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

namespace troupe::engine {
namespace {

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

void Faults::build(const Registry& registry, Groups& groups, Diagnostics& diagnostics) {
  Experiment& e = experiment_;
  e.faults.clear();
  e.first_fault_events.clear();
  for (std::size_t i = 0; i < state_.spec.experiment.faults.size(); ++i)
    build_part("faults", i, diagnostics, [&](Diagnostics& own) { build_fault(i, registry, groups, own); });
  diagnostics.throw_if_errors();
  std::ranges::make_heap(e.first_fault_events, is_later);
  e.fault_events.reserve(e.first_fault_events.size());
}

void Faults::build_fault(std::size_t at, const Registry& registry, Groups& groups, Diagnostics& diagnostics) {
  const FaultSpec& spec = state_.spec.experiment.faults[at];
  const std::uint32_t chooses = stream_id("fault", fmt::format("{}", at));
  experiment_.candidates.clear();
  for (const BodyId body : *groups.find(spec.whom, spec.where, diagnostics))
    if (state_.spec.starts(body))
      experiment_.candidates.push_back({selection_key({state_.spec.seed, chooses, body.value, 0}), body});
  const std::span<const Candidate> chosen = experiment_.choose(spec.whom);
  const std::uint64_t from = ticks_until(spec.from_s, state_.spec.tick_s);
  for (const FaultSpec::Impairment& impairment : spec.impairments) {
    const FaultKind* kind = registry.fault(impairment.kind);
    if (kind == nullptr) {
      diagnostics.error(spec.where, unknown_name("fault", impairment.kind, name_list(registry.faults)));
      continue;
    }
    const std::uint32_t stream = stream_id(kind->name, fmt::format("{}", at));
    std::map<std::uint32_t, std::uint32_t> faults;  // by type: device indices differ between types
    for (const Candidate& candidate : chosen) {
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
      const std::uint64_t tick = next_tick(known->second, candidate.body, from);
      experiment_.first_fault_events.push_back({tick, known->second, candidate.body, true});
    }
  }
}

void Faults::derive() {
  Experiment& e = experiment_;
  e.fault_events = e.first_fault_events;
  while (!e.fault_events.empty() && e.fault_events.front().tick < state_.now.tick) take_event();
}

void Faults::apply_due() {
  const std::vector<FaultEvent>& events = experiment_.fault_events;
  while (!events.empty() && events.front().tick <= state_.now.tick) apply(take_event());
}

/// The tick at whose end a fault occurs next in a body. A fault without a rate (Impairment::per_s) occurs at
/// `from`. A fault with a rate occurs at least one tick later, after a random, exponentially distributed
/// time.
std::uint64_t Faults::next_tick(std::uint32_t fault, BodyId body, std::uint64_t from) const {
  const Experiment::Fault& f = experiment_.faults[fault];
  if (!(f.impairment.per_s > 0)) return from;
  Random random(state_.spec.seed, f.stream, body.value, static_cast<std::uint32_t>(from));
  return from + std::max<std::uint64_t>(
                    1, ticks_until(random.exponential() / f.impairment.per_s, state_.spec.tick_s));
}

/// Removes the earliest fault event from the heap and returns it. If another event of the fault follows in
/// the same body, inserts this event: the end of a drop-out, or the next time that the fault occurs. Dead
/// bodies keep their events, which then have no effect, so that the schedule does not depend on the state.
Experiment::FaultEvent Faults::take_event() {
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
    next.tick = next_tick(now.fault, now.body, now.tick);
    push(heap, next);
  }
  return now;
}

void Faults::apply(const Experiment::FaultEvent& event) {
  if (state_.view.location(event.body) != RowLocation::here) return;
  const Row row = state_.view.row(event.body);
  if (!state_.view.is_there(row)) return;
  const Impairment& impairment = experiment_.faults[event.fault].impairment;
  Condition& now = state_.condition(row);
  state_.now.impaired -= !now.is_sound();
  if (event.begins) {
    now.dead |= impairment.dead;
    if (impairment.speed != 1) {
      // A product that underflows to 0 would act as 1, and the reciprocal of a denormal number can be
      // infinite.
      now.speed = std::max(now.scale() * impairment.speed, std::numeric_limits<double>::min());
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
