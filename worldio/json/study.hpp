#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// How a column of the table of results summarises the values that a measure has during a run.
enum class Statistic : std::uint8_t { last, mean, min, max };
/// Returns the name of a statistic in a study: "last", "mean", "min" or "max".
std::string_view statistic_name(Statistic statistic);

/// A study (docs/sweeps.md), as `troupe sweep` reads it: one world that is run many times with different
/// values.
struct Study {
  /// A value of the world that differs from run to run.
  struct Parameter {
    std::string name;     ///< name of its column in the table of results
    std::string pointer;  ///< JSON pointer into the world, as in --set
  };
  /// The values of the parameters and the seed of one run.
  struct Run {
    std::vector<std::string> values;    ///< JSON texts, one per parameter
    std::optional<std::uint64_t> seed;  ///< empty: the seed of the world
  };

  std::filesystem::path world;  ///< path of the world file, already joined with the folder of the study
  std::optional<double>
      for_s;  ///< world time at which each run ends at the latest, s; empty: the world's quit time
  std::vector<Parameter> parameters;
  std::vector<std::string>
      measures;  ///< measures, as troupe::Measures accepts them; empty: the measures of the world
  std::vector<Statistic> statistics;
  double measure_every_s = 1;  ///< world time between measurements, s; 0: every tick
  bool series = false;         ///< whether all measurements are also stored, in a separate table

  /// The values that a parameter takes: a list (`listed`), equally spaced values of an interval (`steps`), or
  /// random samples from an interval: uniform, uniform in the logarithm, or whole numbers.
  struct Choice {
    std::vector<std::string> values;  ///< listed: JSON texts
    double low = 0;                   ///< ends of the interval, for every kind but `listed`
    double high = 0;
    std::size_t steps = 0;  ///< for Kind::steps: the number of values, both ends included
    enum class Kind : std::uint8_t { listed, steps, uniform, log_uniform, integers } kind = Kind::listed;

    std::size_t count() const {
      return kind == Kind::steps ? steps : values.size();
    }  ///< 0 if values are random
  };
  std::vector<Choice> choices;         ///< one per parameter
  std::vector<std::uint64_t> seeds;    ///< empty: the world's seed
  std::optional<std::size_t> samples;  ///< number of random samples; empty: all combinations
  std::uint64_t random_seed = 1;       ///< seed of the samples

  /// The number of runs of the study. load_study() reports an error for a study with more than k_most_runs.
  std::size_t run_count() const;
  /// Returns the run with this index, which must be below run_count(). Without samples, the runs are all
  /// combinations of the values: the first parameter varies slowest and the seed fastest. With samples, each
  /// sample is run with every seed. Runs are computed on demand, because a file of some kilobytes can define
  /// a million runs of hundreds of parameters.
  Run run(std::size_t index) const;
  /// Returns the pairs of JSON pointer and value that --set applies to the world for a run.
  std::vector<std::pair<std::string, std::string>> settings(const Run& run) const;
};

inline constexpr std::size_t k_most_runs = 1000000;

/// Reads a study from a file. Reports all errors in `diagnostics`; do not use the result if there are errors.
/// Does not load the world.
Study load_study(const std::filesystem::path& file, const engine::Registry& registry,
                 Diagnostics& diagnostics);
/// Like load_study(), for a file whose content is `text`.
Study load_study_text(const std::filesystem::path& file, std::string_view text,
                      const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
