#include "apps/info/info_kinds.hpp"
#include "apps/numbers.hpp"
#include "apps/options.hpp"
#include "base/diagnostics.hpp"
#include "base/split.hpp"
#include "engine/spec/ranging_engine.hpp"
#include "troupe/script.hpp"
#include "worldio/json/study.hpp"
#include "worldio/load.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace troupe::apps {
namespace {

/// Returns the line of the summary for a type of bodies: the number of bodies, then the kinds of the drive,
/// the devices (with their names) and the controllers: "2000: diff, ranger ir, expand".
std::string type_text(const engine::TypeSpec& type, std::size_t bodies) {
  std::vector<std::string> parts;
  if (type.drive) parts.push_back(type.drive->kind);
  for (const engine::DeviceSpec& sensor : type.devices)
    parts.push_back(fmt::format("{} {}", sensor.kind, sensor.name));
  for (const engine::ControllerSpec& controller : type.controllers) parts.push_back(controller.kind);
  std::string text = fmt::format("{}", bodies);
  for (std::size_t i = 0; i < parts.size(); ++i) text += (i == 0 ? ": " : ", ") + parts[i];
  return text;
}

std::string box_text(const Box& box) {
  return fmt::format("x {:g} to {:g}, y {:g} to {:g} m", box.min.x(), box.max.x(), box.min.y(), box.max.y());
}

/// Adds the stop conditions, interventions and faults of a world to the summary; adds nothing if it has none.
void add_experiment(const engine::ExperimentSpec& experiment, Summary& summary) {
  constexpr std::size_t k_most = 8;  // entries listed
  const auto add = [&](const char* what, std::size_t count, auto&& text_of) {
    std::string text;
    for (std::size_t i = 0; i < std::min(count, k_most); ++i)
      text += fmt::format("{}{}", i == 0 ? "" : ", ", text_of(i));
    if (count > k_most) text += fmt::format(", and {} more", count - k_most);
    if (count > 0) summary.emplace_back(what, text);
  };
  add("stops when", experiment.stop_when.size(),
      [&](std::size_t i) { return engine::text_of(experiment.stop_when[i]); });
  add("interventions", experiment.at.size(), [&](std::size_t i) {
    const engine::InterventionSpec& at = experiment.at[i];
    return fmt::format("{} at {:g} s", engine::k_actions[static_cast<std::size_t>(at.action)], at.time_s);
  });
  add("faults", experiment.faults.size(), [&](std::size_t i) {
    std::string kinds;
    for (const engine::FaultSpec::Impairment& impairment : experiment.faults[i].impairments)
      kinds += (kinds.empty() ? "" : " and ") + impairment.kind;
    return fmt::format("{} of {}", kinds, experiment.faults[i].whom.name);
  });
}

/// The number of bodies of each type at the start of a run, by TypeId.
std::vector<std::size_t> bodies_at_start(const engine::WorldSpec& spec) {
  std::vector<std::size_t> counts(spec.types.size());
  for (const engine::BodySpec& body : spec.bodies) ++counts[body.type.index()];
  for (const engine::ReserveSpec& reserve : spec.reserves)
    counts[spec.bodies[reserve.first.index()].type.index()] -= reserve.count;
  return counts;
}

/// Adds the number of robots, and a line for each of their types, to the summary. Returns that number.
std::size_t add_robots(const engine::WorldSpec& spec, Summary& summary) {
  const std::vector<std::size_t> counts = bodies_at_start(spec);
  std::size_t robots = 0;
  for (std::size_t t = 0; t < counts.size(); ++t)
    if (engine::is_mobile(spec.types[t])) robots += counts[t];
  summary.emplace_back("robots", fmt::format("{}", robots));
  constexpr std::size_t k_most_types = 20;
  std::size_t types = 0;
  for (std::size_t t = 0; t < counts.size(); ++t) {
    if (!engine::is_mobile(spec.types[t]) || counts[t] == 0) continue;
    if (types++ < k_most_types)
      summary.emplace_back("  " + spec.types[t].name, type_text(spec.types[t], counts[t]));
  }
  if (types > k_most_types)
    summary.emplace_back("  ...", fmt::format("and {}", counted(types - k_most_types, "more type")));
  return robots;
}

/// Adds the reserves of populations (bodies that can enter the world later) to the summary. Returns the
/// number of these bodies.
std::size_t add_reserves(const engine::WorldSpec& spec, Summary& summary) {
  std::string reserves;
  std::size_t bodies = 0;
  for (const engine::ReserveSpec& reserve : spec.reserves) {
    bodies += reserve.count;
    reserves += fmt::format("{}{} of {}", reserves.empty() ? "" : ", ", reserve.count, reserve.population);
  }
  if (!reserves.empty()) summary.emplace_back("in reserve", reserves);
  return bodies;
}

/// Adds the measures of a world to the summary; adds nothing if it has none.
void add_measures(const engine::WorldSpec& spec, Summary& summary) {
  std::string measures;
  for (const engine::MeasureSpec& measure : spec.measures)
    measures += fmt::format("{}{}{}{}", measures.empty() ? "" : ", ", measure.kind,
                            measure.of.empty() ? "" : ":", measure.of);
  if (!measures.empty()) summary.emplace_back("measures", measures);
}

std::string choice_text(const worldio::Study::Choice& choice) {
  using Kind = worldio::Study::Choice::Kind;
  switch (choice.kind) {
    case Kind::listed: return joined(choice.values, ", ");
    case Kind::steps: return fmt::format("{:g} to {:g} in {} steps", choice.low, choice.high, choice.steps);
    case Kind::uniform: return fmt::format("{:g} to {:g}, uniform", choice.low, choice.high);
    case Kind::log_uniform: return fmt::format("{:g} to {:g}, log-uniform", choice.low, choice.high);
    case Kind::integers: return fmt::format("{:g} to {:g}, whole numbers", choice.low, choice.high);
  }
  return {};
}

}  // namespace

Summary summary_of_study(const std::filesystem::path& file, const std::string& text,
                         const KindSources& sources) {
  Diagnostics diagnostics;
  const worldio::Study study = worldio::load_study_text(file, text, registry_with(sources), diagnostics);
  diagnostics.throw_if_errors();
  Summary summary{{"kind", "study, format 1"},
                  {"world", study.world.string()},
                  {"runs", fmt::format("{}", study.run_count())}};
  if (study.for_s) summary.emplace_back("ends at", fmt::format("{:.10g} s", *study.for_s));
  summary.emplace_back("parameters", fmt::format("{}", study.parameters.size()));
  for (std::size_t p = 0; p < study.parameters.size(); ++p)
    summary.emplace_back("  " + study.parameters[p].name,
                         study.parameters[p].with
                             ? fmt::format("{}, with {}", choice_text(study.choices[p]),
                                           study.parameters[*study.parameters[p].with].name)
                             : choice_text(study.choices[p]));
  if (study.samples) summary.emplace_back("samples", fmt::format("{}", *study.samples));
  summary.emplace_back("seeds",
                       study.seeds.empty() ? "that of the world" : fmt::format("{}", study.seeds.size()));
  if (!study.measures.empty()) summary.emplace_back("measures", joined(study.measures, ", "));
  return summary;
}

Summary summary_of_world(const std::filesystem::path& file, const std::string& text, bool json,
                         const KindSources& sources) {
  const engine::Registry registry = registry_with(sources);
  Diagnostics diagnostics;
  worldio::LoadOptions options;
  options.search_path = with_environment({}).search_path;
  engine::WorldSpec spec = json ? worldio::load_json_world(file, text, registry, options, diagnostics)
                                : worldio::load_stage_world(file, text, registry, options, diagnostics);
  diagnostics.throw_if_errors();
  assign_controllers(sources.scripts, spec, diagnostics);
  diagnostics.throw_if_errors();

  Summary summary{{"kind", json ? "world, in JSON, format 1" : "world, in Stage's syntax"},
                  {"title", spec.title},
                  {"seed", fmt::format("{}", spec.seed)},
                  {"tick", fmt::format("{:.10g} s", spec.tick_s)}};
  if (spec.quit_time_s) summary.emplace_back("ends at", fmt::format("{:.10g} s", *spec.quit_time_s));
  summary.emplace_back("ranging", engine::ranging_engine_name(spec.ranging));
  const std::size_t robots = add_robots(spec, summary);
  const std::size_t in_reserve = add_reserves(spec, summary);
  summary.emplace_back("other models", fmt::format("{}", spec.bodies.size() - 1 - robots - in_reserve));
  summary.emplace_back(
      "bounds", spec.bounds ? box_text(*spec.bounds) : "none: the world reaches 100 km in each direction");
  add_measures(spec, summary);
  add_experiment(spec.experiment, summary);
  if (const std::size_t warnings = diagnostics.warnings().size(); warnings > 0)
    summary.emplace_back("warnings", fmt::format("{}; troupe lint lists them", warnings));
  return summary;
}

}  // namespace troupe::apps
