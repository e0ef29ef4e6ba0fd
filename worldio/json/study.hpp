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

/// How a column of a study's table summarises the values of a measure in a run.
enum class Statistic : std::uint8_t { last, mean, min, max };
std::string_view statistic_name(Statistic statistic);

/// A study, as `troupe sweep` reads it (docs/sweeps.md), expanded: one world that is run many times with
/// different values.
struct Study {
  /// A value of the world that differs from run to run.
  struct Parameter {
    std::string name;     ///< name of its column
    std::string pointer;  ///< JSON pointer into the world, as in --set
  };
  struct Run {
    std::vector<std::string> values;  ///< JSON texts, one per parameter
    std::optional<std::uint64_t> seed;
  };

  std::filesystem::path world;  ///< resolved relative to the study's file
  std::optional<double> for_s;  ///< world time at which each run ends at the latest; empty: the world's own
  std::vector<Parameter> parameters;
  std::vector<std::string> measures;  ///< as troupe::Measures takes them; empty: the world's
  std::vector<Statistic> statistics;
  double measure_every_s = 1;  ///< world time between measurements; 0: every tick
  bool series = false;         ///< all measurements are stored, in a separate table

  /// The values that a parameter takes: a list, equal steps of an interval, or random samples from one.
  struct Choice {
    std::vector<std::string> values;  ///< listed: JSON texts
    double low = 0;                   ///< ends of the interval
    double high = 0;
    std::size_t steps = 0;  ///< steps: how many values
    enum class Kind : std::uint8_t { listed, steps, uniform, log_uniform, integers } kind = Kind::listed;

    std::size_t count() const { return kind == Kind::steps ? steps : values.size(); }  ///< 0: random
  };
  std::vector<Choice> choices;         ///< one per parameter
  std::vector<std::uint64_t> seeds;    ///< empty: the world's seed
  std::optional<std::size_t> samples;  ///< empty: all combinations of the values
  std::uint64_t random_seed = 1;       ///< seed of the samples

  /// At most k_most_runs.
  std::size_t run_count() const;
  /// The run `index`, below run_count(): of all combinations, with the first parameter varying slowest and
  /// the seed fastest, or of the samples, each with every seed. Runs are made on demand because a file of
  /// some kilobytes can define a million runs of hundreds of parameters.
  Run run(std::size_t index) const;
  /// The pointers and values for --set in a run.
  std::vector<std::pair<std::string, std::string>> settings(const Run& run) const;
};

inline constexpr std::size_t k_most_runs = 1000000;

/// Reads a study. Collects all errors in `diagnostics`; do not use the result if there are any. Does not load
/// the world.
Study load_study(const std::filesystem::path& file, const engine::Registry& registry,
                 Diagnostics& diagnostics);
/// Like load_study(), from the content of `file`.
Study load_study_text(const std::filesystem::path& file, std::string_view text,
                      const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
