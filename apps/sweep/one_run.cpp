#include "apps/sweep/one_run.hpp"

#include "apps/interrupt.hpp"
#include "apps/options.hpp"
#include "apps/sweep/table.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "troupe/measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace troupe::apps {
namespace {

using worldio::Statistic;

/// Computes statistics of each column of measures over the samples of a run. Missing values (NaN) are
/// ignored, except by the statistic `last`.
class Statistics {
 public:
  explicit Statistics(std::size_t columns) : columns_(columns) {}

  void add(const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      Column& column = columns_[i];
      column.last = values[i];
      if (std::isnan(values[i])) continue;
      ++column.count;
      column.sum += values[i];
      column.min = std::min(column.min, values[i]);
      column.max = std::max(column.max, values[i]);
    }
  }

  std::vector<double> values(const std::vector<Statistic>& wanted) const {
    constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> values;
    for (const Column& column : columns_)
      for (const Statistic statistic : wanted) switch (statistic) {
          case Statistic::last: values.push_back(column.last); break;
          case Statistic::mean:
            values.push_back(column.count > 0 ? column.sum / static_cast<double>(column.count) : k_none);
            break;
          case Statistic::min: values.push_back(column.count > 0 ? column.min : k_none); break;
          case Statistic::max: values.push_back(column.count > 0 ? column.max : k_none); break;
        }
    return values;
  }

 private:
  struct Column {
    double last = std::numeric_limits<double>::quiet_NaN();
    double sum = 0;
    double min = std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();
    std::size_t count = 0;
  };
  std::vector<Column> columns_;
};

/// The values of the measures with the names `columns`; NaN for a column that these measures do not have. If
/// the study names no measures, the world of a run may have others than the world that gave the columns.
std::vector<double> values_of(Measures& measures, const std::vector<std::string>& columns) {
  const std::vector<double> own = measures.values();
  std::vector<double> values;
  for (const std::string& column : columns) {
    const auto found = std::ranges::find(measures.columns(), column);
    const bool is_there = found != measures.columns().end();
    values.push_back(is_there ? own[static_cast<std::size_t>(found - measures.columns().begin())]
                              : std::numeric_limits<double>::quiet_NaN());
  }
  return values;
}

}  // namespace

SimulationOptions simulation_options(const worldio::Study& study, const worldio::Study::Run& run,
                                     const SweepOptions& options) {
  SimulationOptions simulation = with_environment({});
  simulation.plugin_path = plugin_path(options.sources.plugin_path);
  simulation.scripts = options.sources.scripts;
  simulation.threads = 1;
  simulation.seed = run.seed;
  simulation.set = study.settings(run);
  return simulation;
}

double end_time_s(const worldio::Study& study, const Simulation& simulation) {
  if (study.for_s) return *study.for_s;
  if (const auto quit = simulation.quit_time_s()) return *quit;
  throw InputError(
      fmt::format("{}: error: no end time: give \"for_s\" in the study, or set quit_time_s in the world "
                  "(quit_time in a .world)",
                  study.world.string()));
}

std::optional<MadeRun> make_run(const worldio::Study& study, std::size_t index,
                                const std::vector<std::string>& columns, const SweepOptions& options) {
  Simulation simulation(study.world, simulation_options(study, study.run(index), options));
  Measures measures(simulation, study.measures);
  Statistics statistics(columns.size());
  const std::uint64_t end = engine::ticks_until(end_time_s(study, simulation), simulation.tick_s());
  const std::uint64_t every = engine::period_ticks(study.measure_every_s, simulation.tick_s());
  std::string series;
  const auto add_sample = [&] {
    const std::vector<double> values = values_of(measures, columns);
    statistics.add(values);
    if (study.series) add_series_row(series, index, simulation.time_s(), values);
  };
  add_sample();
  while (simulation.tick() < end && !simulation.stopped()) {
    if (stop_requested()) return std::nullopt;
    simulation.step();
    measures.see();
    const bool is_last = simulation.tick() == end || simulation.stopped();
    if (simulation.tick() % every == 0 || is_last) add_sample();
  }
  return MadeRun{.outcome = {.run = index,
                             .seed = simulation.world().spec().seed,
                             .ticks = simulation.tick(),
                             .time_s = simulation.time_s(),
                             .stopped_by = simulation.stopped().value_or(""),
                             .values = statistics.values(study.statistics),
                             .state_hash = hex(simulation.state_hash())},
                 .series = std::move(series)};
}

}  // namespace troupe::apps
