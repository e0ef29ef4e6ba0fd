#include "troupe/lint_experiment.hpp"

#include "base/number_text.hpp"
#include "engine/interventions/groups.hpp"
#include "engine/observing/measures.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

namespace troupe {
namespace {

class Experiment {
 public:
  Experiment(const engine::World& world, const engine::LintWorld& linted,
             const std::set<std::string>& base_types, Diagnostics& diagnostics)
      : world_(world),
        linted_(linted),
        spec_(world.spec()),
        base_types_(base_types),
        diagnostics_(diagnostics) {}

  void check_interventions();
  void check_selections();
  void check_base_types();
  void check_conditions(const engine::Registry& registry);

 private:
  const engine::World& world_;
  const engine::LintWorld& linted_;
  const engine::WorldSpec& spec_;
  const std::set<std::string>& base_types_;
  Diagnostics& diagnostics_;
};

/// Warns of interventions that add several bodies at one pose, and of interventions and faults that are later
/// than the end of a run. Those exactly at the end are not reported.
void Experiment::check_interventions() {
  engine::Groups groups(world_.state());
  for (const engine::InterventionSpec& intervention : spec_.experiment.at) {
    if (intervention.action != engine::InterventionSpec::Action::add || !intervention.pose) continue;
    const engine::ReserveSpec& reserve = spec_.reserves.at(*groups.reserve(intervention.whom.name));
    const auto count = std::min<std::int64_t>(intervention.whom.count.value_or(reserve.count), reserve.count);
    if (count > 1 && !world_.view().type(reserve.first).obstacle.empty())
      diagnostics_.warning(
          intervention.where,
          fmt::format("this entry of \"at\" would add {} bodies at the same pose, where only one has room: "
                      "give \"count\": 1, or \"region_m\" in place of \"pose\"",
                      count));
  }
  if (!spec_.quit_time_s) return;
  const auto check_time = [&](std::string_view key, std::string_view what, double time_s, Where where) {
    if (engine::ticks_until(time_s, spec_.tick_s) > engine::ticks_until(*spec_.quit_time_s, spec_.tick_s))
      diagnostics_.warning(
          where,
          fmt::format("this entry of \"{}\" has no effect unless --for makes the run longer: {} {:.10g} "
                      "s, but \"quit_time_s\" ends the run at {:.10g} s",
                      key, what, time_s, *spec_.quit_time_s));
  };
  for (const engine::InterventionSpec& intervention : spec_.experiment.at)
    check_time("at", "its time is", intervention.time_s, intervention.where);
  for (const engine::FaultSpec& fault : spec_.experiment.faults)
    check_time("faults", "it begins at", fault.from_s, fault.where);
}

/// Warns of interventions and faults whose `count` or `share` is so small that they select no body of their
/// group. An intervention selects among at most all bodies of the group, a fault among those that are in the
/// world at the start.
void Experiment::check_selections() {
  engine::Groups groups(world_.state());
  const auto check = [&](std::string_view key, const engine::GroupSpec& whom, std::size_t size, Where where) {
    if (size == 0 || whom.selected_of(size) > 0) return;
    const std::string why = whom.count == 0
                                ? std::string("its \"count\" is 0")
                                : fmt::format(
                                      "its \"share\" of {:.10g} selects none of {} {}: the least share that "
                                      "selects a body is {}",
                                      *whom.share, size, size == 1 ? "body" : "bodies",
                                      plain_number(0.5 / static_cast<double>(size)));
    diagnostics_.warning(where, fmt::format("this entry of \"{}\" has no effect: {}", key, why));
  };
  using Action = engine::InterventionSpec::Action;
  for (const engine::InterventionSpec& at : spec_.experiment.at)
    if (at.action == Action::remove || at.action == Action::disable || at.action == Action::enable)
      check("at", at.whom, groups.find(at.whom, at.where, diagnostics_)->size(), at.where);
  for (const engine::FaultSpec& fault : spec_.experiment.faults) {
    const engine::Groups::Bodies bodies = groups.find(fault.whom, fault.where, diagnostics_);
    const auto starts = [&](BodyId body) { return spec_.starts(body); };
    check("faults", fault.whom, static_cast<std::size_t>(std::ranges::count_if(*bodies, starts)),
          fault.where);
  }
}

/// Warns of interventions, faults, measures and conditions that name a type without bodies that other types
/// extend: they do not refer to the bodies of those types.
void Experiment::check_base_types() {
  const auto warn = [&](const std::string& what, std::string_view name, Where where) {
    if (!base_types_.contains(std::string(name))) return;
    for (std::size_t t = 0; t < spec_.types.size(); ++t)
      if (spec_.types[t].name == name && linted_.bodies[t] > 0) return;
    diagnostics_.warning(where,
                         fmt::format("{}: no body has the type \"{}\"; bodies of a type that extends it "
                                     "do not count",
                                     what, name));
  };
  for (const engine::InterventionSpec& at : spec_.experiment.at)
    if (at.setting)
      warn("this entry of \"at\" has no effect", spec_.types[at.setting->type.index()].name, at.where);
    else if (at.whom.by == engine::GroupSpec::By::type)
      warn("this entry of \"at\" has no effect", at.whom.name, at.where);
  for (const engine::FaultSpec& fault : spec_.experiment.faults)
    if (fault.whom.by == engine::GroupSpec::By::type)
      warn("this entry of \"faults\" has no effect", fault.whom.name, fault.where);
  const auto check = [&](std::string_view what, const engine::MeasureSpec& measure) {
    if (engine::robots_of(world_, measure.of).empty())  // else a population or a robot has this name
      warn(fmt::format("the {} \"{}\" covers no robot", what, engine::measure_name(measure)), measure.of,
           measure.where);
  };
  for (const engine::MeasureSpec& measure : spec_.measures) check("measure", measure);
  for (const engine::StopSpec& condition : spec_.experiment.stop_when)
    check("condition on", condition.measure);
}

/// Warns of conditions with the default parameters of a measure to which the world's list of measures gives
/// others: such a condition and the column of its name differ.
void Experiment::check_conditions(const engine::Registry& registry) {
  for (const engine::StopSpec& condition : spec_.experiment.stop_when) {
    const engine::MeasureSpec& measure = condition.measure;
    const std::string name = engine::measure_name(measure);
    const auto kind = registry.find_measure(measure.kind);
    if (!kind || measure.params != (*kind)->params.defaults()) continue;
    for (std::size_t i = 0; i < spec_.measures.size(); ++i) {
      const engine::MeasureSpec& listed = spec_.measures[i];
      if (engine::measure_name(listed) != name || listed.kind != measure.kind || listed.of != measure.of ||
          listed.params == measure.params)
        continue;
      diagnostics_.warning(
          measure.where,
          fmt::format("the condition on \"{}\" has the default parameters, not those of /measures/{}: to "
                      "give it the same parameters, give that entry a \"name\" of its own, and use the name "
                      "in the condition",
                      name, i));
    }
  }
}

}  // namespace

void lint_experiment(const engine::World& world, const engine::LintWorld& linted,
                     const engine::Registry& registry, const std::set<std::string>& base_types,
                     Diagnostics& diagnostics) {
  Experiment experiment(world, linted, base_types, diagnostics);
  experiment.check_interventions();
  experiment.check_selections();
  experiment.check_base_types();
  experiment.check_conditions(registry);
}

}  // namespace troupe
