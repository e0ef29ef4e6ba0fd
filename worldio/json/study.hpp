#pragma once

#include "base/diagnostics.hpp"
#include "engine/kinds/registry.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::worldio {

/// How the table of results summarises the values that a measure has during a run: by the last, the mean, the
/// smallest or the largest value. A measure is a number that is computed from the state of a run, such as the
/// covered area. It is computed at regular intervals of simulated time (Study::measure_every_s).
enum class Statistic : std::uint8_t { last, mean, min, max };
/// Returns the name of a statistic in files: "last", "mean", "min" or "max".
std::string_view statistic_name(Statistic statistic);

/// A study (docs/sweeps.md), as `troupe sweep` reads it: one world that is run many times, with different
/// values of some parameters and with different seeds. The results of each run are one row of the table of
/// results.
struct Study {
  /// A value of the world that the study varies.
  struct Parameter {
    std::string name;     ///< name of its column in the table of results
    std::string pointer;  ///< JSON pointer to the value in the world, as in the option --set of `troupe run`
    Where where;          ///< position in the study, for messages
    /// Index of the earlier parameter with which this one varies together: in each run, both have the value
    /// at the same position in their lists. That parameter has no `with` itself. Empty: this parameter varies
    /// independently.
    std::optional<std::size_t> with = {};
  };
  /// The values of the parameters and the seed of one run.
  struct Run {
    std::vector<std::string> values;    ///< JSON texts, one per parameter
    std::optional<std::uint64_t> seed;  ///< empty: the seed of the world
  };

  Where where;                  ///< the study file, for messages
  std::filesystem::path world;  ///< path of the world file, already joined with the folder of the study
  Where where_world;            ///< position of the key `world`, for messages
  /// Simulated time at which each run ends, s, unless a stop condition of the world ends it earlier. Empty:
  /// the quit time of the world (WorldSpec::quit_time_s).
  std::optional<double> for_s;
  std::vector<Parameter> parameters;  ///< the varied values, in the order of their columns
  /// Measures, each as text that parse_measure() reads, such as "stalls:leaders" or a JSON object, or as the
  /// name of a measure that the world lists. Empty: the measures of the world or, if it has none, all
  /// measures that need no parameters.
  std::vector<std::string> measures;
  std::vector<Where> where_measures;  ///< positions of `measures` in the study, for messages
  std::vector<Statistic> statistics;  ///< the statistics of each measure; load_study() sets at least one
  double measure_every_s = 1;         ///< simulated time between measurements, s; 0: every tick (time step)
  bool series = false;                ///< whether all measurements are also stored, in a separate table

  /// The values that a parameter takes. `kind` says how they are given:
  /// - listed: by the list `values`
  /// - steps: as `steps` equally spaced numbers from `low` to `high`
  /// - uniform: as random numbers, uniformly distributed from `low` to `high`
  /// - log_uniform: as random numbers from `low` to `high` whose logarithm is uniformly distributed
  /// - integers: as random whole numbers from `low` to `high`, both included, uniformly distributed
  struct Choice {
    std::vector<std::string> values;  ///< for Kind::listed: JSON texts
    double low = 0;   ///< lower end of the interval (for `steps`: the first value); unused for Kind::listed
    double high = 0;  ///< upper end (for `steps`: the last value); unused for Kind::listed
    std::size_t steps = 0;  ///< for Kind::steps: the number of values, both ends included
    enum class Kind : std::uint8_t { listed, steps, uniform, log_uniform, integers } kind = Kind::listed;

    std::size_t count() const {
      return kind == Kind::steps ? steps : values.size();
    }  ///< number of values to combine; 0 if the values are random
    /// Returns the i-th value, as JSON text. `i` must be below count().
    std::string value(std::size_t i) const;
  };
  std::vector<Choice> choices;       ///< one per parameter, in the order of `parameters`
  std::vector<std::uint64_t> seeds;  ///< seeds of the runs; empty: only the world's seed
  /// Number of samples. A sample consists of one random value for each parameter. Empty: there are no
  /// samples; the runs have all combinations of the values of the parameters.
  std::optional<std::size_t> samples;
  std::uint64_t random_seed = 1;  ///< seed of the random values of the samples

  /// The number of runs of the study: the number of samples or combinations, times the number of seeds. It is
  /// at most k_most_runs if load_study() has reported no error.
  std::size_t run_count() const;
  /// Returns the index of the parameter that determines which of its values the parameter `p` has: that of
  /// Parameter::with, or else `p`.
  std::size_t leader_of(std::size_t p) const { return parameters[p].with.value_or(p); }
  /// Returns the run with this index, which must be below run_count(). The seed varies fastest: each
  /// combination of values, or each sample, is run with all seeds before the next one. Without samples, the
  /// runs have all combinations of the values, and the first parameter varies slowest; parameters that vary
  /// together (Parameter::with) count as one. With samples, the random value of a parameter follows from
  /// `random_seed`, the number of the sample, and the choice and the pointer of the parameter (for one that
  /// varies together with another: the pointer of its leader_of()). It does not depend on the other
  /// parameters. There is one exception: several parameters may have the same pointer if it appends to a
  /// list, as `/models/-` does. Their values also depend on the order of these parameters.
  Run run(std::size_t index) const;
  /// Returns the seed with which a run is made: Run::seed or, if the study gives no seeds, the value of the
  /// parameter with the pointer `/seed`, or else `world_seed`, the seed of the world. Empty if the value of
  /// the parameter is no seed; the run then fails.
  std::optional<std::uint64_t> seed_of(const Run& run, std::uint64_t world_seed) const;
  /// Returns the values of a run as arguments of the option --set: for each parameter, a pair of its JSON
  /// pointer and its value. The seed is not included.
  std::vector<std::pair<std::string, std::string>> settings(const Run& run) const;
};

/// Returns the names of the columns that measures have in the table of results. Each measure has one column
/// for each statistic: for the measure `coverage`, the column of the statistic `last` is `coverage`, and that
/// of `mean` is `coverage_mean`. `measures` are the names from Measures::columns() (troupe/measures.hpp),
/// which include units, as in `displacement_m`.
std::vector<std::string> measure_columns(const std::vector<std::string>& measures,
                                         const std::vector<Statistic>& statistics);

/// Reports an error for each column of a measure that has the same name as another column of the study's
/// tables. The other column can be that of a parameter or of another measure, or one that every table has,
/// such as `seed`. `measures` are the same names as in measure_columns().
void check_columns(const Study& study, const std::vector<std::string>& measures, Diagnostics& diagnostics);

/// Returns indices of runs, in ascending order, as text for messages, such as "2 to 4, 7".
std::string runs_text(std::span<const std::size_t> runs);

inline constexpr std::size_t k_most_runs = 1000000;  ///< greatest number of runs of a study

/// Reads a study from a JSON file. Adds all errors to `diagnostics`; do not use the result if there are
/// errors. Does not load the world, so it does not check that the world has the values at the pointers of the
/// parameters. `registry` lists the measures that the study may use.
Study load_study(const std::filesystem::path& file, const engine::Registry& registry,
                 Diagnostics& diagnostics);
/// Like load_study(), but `text` is the content of the study file. `file` is the path of the study, which
/// need not exist. Messages name this path, and the path of the world (Study::world) is relative to its
/// folder. If the world need not exist as a file either, `world` is its text; null: the world is a file.
Study load_study_text(const std::filesystem::path& file, std::string_view text,
                      const engine::Registry& registry, Diagnostics& diagnostics,
                      const std::string* world = nullptr);

}  // namespace troupe::worldio
