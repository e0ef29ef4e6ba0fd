#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/kinds.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// How a column of the table of results summarises the values of a measure: by the last, the mean, the
/// smallest or the largest value in a run. A measure is a number that is computed from the state of a run,
/// such as the covered area. It has one value for each measurement (Study::measure_every_s).
enum class Statistic : std::uint8_t { last, mean, min, max };
/// Returns the name of a statistic in a study: "last", "mean", "min" or "max".
std::string_view statistic_name(Statistic statistic);

/// A study (docs/sweeps.md), as `troupe sweep` reads it: one world that is run many times with different
/// values. Each run fills one row of the table of results.
struct Study {
  /// A value of the world that the study varies.
  struct Parameter {
    std::string name;     ///< name of its column in the table of results
    std::string pointer;  ///< JSON pointer to the value in the world, as in the option --set of `troupe run`
    Where where;          ///< position in the study, for messages
  };
  /// The values of the parameters and the seed of one run.
  struct Run {
    std::vector<std::string> values;    ///< JSON texts, one per parameter
    std::optional<std::uint64_t> seed;  ///< empty: the seed of the world
  };

  Where where;                  ///< the study file, for messages
  std::filesystem::path world;  ///< path of the world file, already joined with the folder of the study
  /// Simulated time at which each run ends at the latest, s. Empty: the quit time of the world
  /// (WorldSpec::quit_time_s).
  std::optional<double> for_s;
  std::vector<Parameter> parameters;  ///< the varied values, in the order of their columns
  /// Measures, each as text that parse_measure() reads, such as "stalls:leaders" or a JSON object. Empty: the
  /// measures of the world.
  std::vector<std::string> measures;
  std::vector<Statistic> statistics;  ///< the statistics of each measure; load_study() sets at least one
  double measure_every_s = 1;  ///< simulated time between measurements, s; 0: every tick (simulation step)
  bool series = false;         ///< whether all measurements are also stored, in a separate table

  /// The values that a parameter takes, by `kind`: those of a list (`listed`), equally spaced values of an
  /// interval (`steps`), or random values from an interval: uniformly distributed (`uniform`), with a
  /// uniformly distributed logarithm (`log_uniform`), or uniformly distributed whole numbers (`integers`).
  struct Choice {
    std::vector<std::string> values;  ///< for Kind::listed: JSON texts
    double low = 0;   ///< lower end of the interval (for `steps`: the first value); unused for Kind::listed
    double high = 0;  ///< upper end (for `steps`: the last value); unused for Kind::listed
    std::size_t steps = 0;  ///< for Kind::steps: the number of values, both ends included
    enum class Kind : std::uint8_t { listed, steps, uniform, log_uniform, integers } kind = Kind::listed;

    std::size_t count() const {
      return kind == Kind::steps ? steps : values.size();
    }  ///< number of values to combine; 0 if the values are random
  };
  std::vector<Choice> choices;       ///< one per parameter, in the order of `parameters`
  std::vector<std::uint64_t> seeds;  ///< seeds of the runs; empty: only the world's seed
  /// Number of samples. A sample has one random value of each parameter. Empty: no samples, but all
  /// combinations of the values.
  std::optional<std::size_t> samples;
  std::uint64_t random_seed = 1;  ///< seed of the random values of the samples

  /// The number of runs of the study. load_study() reports an error for a study with more than k_most_runs
  /// runs.
  std::size_t run_count() const;
  /// Returns the run with this index, which must be below run_count(). Without samples, the runs are all
  /// combinations of the values: the first parameter varies slowest and the seed fastest. With samples, each
  /// sample is run with every seed, and the seed varies fastest. The values of a sample depend only on
  /// `random_seed`, on the number of the sample, on the choice and the pointer of each parameter, and on the
  /// number of earlier parameters with the same pointer (several parameters can append to one list with
  /// `/models/-`). Runs are computed on demand, because a file of some kilobytes can define a million runs of
  /// hundreds of parameters.
  Run run(std::size_t index) const;
  /// Returns the values of the parameters in a run as arguments of the option --set: for each parameter, a
  /// pair of its JSON pointer and its value. The seed is not included.
  std::vector<std::pair<std::string, std::string>> settings(const Run& run) const;
};

/// Returns the names of the columns that measures have in the table of results: for each measure one column
/// per statistic. For the measure `coverage`, the statistic `last` is in the column `coverage` and `mean` in
/// `coverage_mean`. measures: names of the measures, with their units, as Measures::columns() returns them.
std::vector<std::string> measure_columns(const std::vector<std::string>& measures,
                                         const std::vector<Statistic>& statistics);

/// Adds an error for each column of a measure that has the same name as another column of the study's tables.
/// The other column can be that of a parameter or of another measure, or one that every table has, such as
/// `seed`. measures: names of the measures, with their units, as Measures::columns() returns them.
void check_columns(const Study& study, const std::vector<std::string>& measures, Diagnostics& diagnostics);

inline constexpr std::size_t k_most_runs = 1000000;  ///< greatest number of runs of a study

/// Reads a study from a JSON file. Adds all errors to `diagnostics`; do not use the result if there are
/// errors. Does not load the world, and does not check that the pointers of the parameters exist in it.
/// `registry` lists the kinds (sorts) of measures that the study may use.
Study load_study(const std::filesystem::path& file, const engine::Registry& registry,
                 Diagnostics& diagnostics);
/// Like load_study(), but reads the study from `text`. `file` is the path of the study in messages, and the
/// path of the world is relative to its folder. The file need not exist.
Study load_study_text(const std::filesystem::path& file, std::string_view text,
                      const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
