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

/// What a column of a study's table says of a measure over the ticks at which it was looked at.
enum class Statistic : std::uint8_t { last, mean, min, max };
std::string_view statistic_name(Statistic statistic);

/// One world, run many times with other values: what `troupe sweep` reads (docs/sweeps.md), expanded.
struct Study {
  /// A value of the world that differs from run to run.
  struct Parameter {
    std::string name;     ///< of its column
    std::string pointer;  ///< JSON pointer into the world, as --set takes it
  };
  struct Run {
    std::vector<std::string> values;  ///< JSON texts, one a parameter
    std::optional<std::uint64_t> seed;
  };

  std::filesystem::path world;  ///< as found from the study's file
  std::optional<double>
      for_s;  ///< world time at which each run ends, if not before; not given: where the world says
  std::vector<Parameter> parameters;
  std::vector<std::string> measures;  ///< as troupe::Measures takes them; none given: the world's
  std::vector<Statistic> statistics;
  double measure_every_s = 1;  ///< world time between two looks; 0: every tick
  bool series = false;         ///< every look is kept, in a table of its own

  /// The values that a parameter takes: a list, an interval cut into steps, or one from which samples are
  /// drawn.
  struct Choice {
    std::vector<std::string> values;  ///< listed: JSON texts
    double low = 0;                   ///< of an interval
    double high = 0;
    std::size_t steps = 0;  ///< how many values there are in steps
    enum class Kind : std::uint8_t { listed, steps, uniform, log_uniform, integers } kind = Kind::listed;

    std::size_t count() const { return kind == Kind::steps ? steps : values.size(); }  ///< 0: it is drawn
  };
  std::vector<Choice> choices;         ///< one a parameter
  std::vector<std::uint64_t> seeds;    ///< empty: the world's
  std::optional<std::size_t> samples;  ///< not given: all combinations
  std::uint64_t random_seed = 1;       ///< of the samples

  /// At most k_most_runs. Runs are not kept but made on demand: a file of some kilobytes can ask for a
  /// million runs of hundreds of parameters.
  std::size_t run_count() const;
  /// Of a grid the combinations, the first parameter slowest and the seeds fastest; else the samples, each
  /// with every seed. `index` is below run_count().
  Run run(std::size_t index) const;
  /// What --set takes in a run.
  std::vector<std::pair<std::string, std::string>> settings(const Run& run) const;
};

inline constexpr std::size_t k_most_runs = 1000000;

/// Reads a study. Everything that is wrong is collected in `diagnostics`; the result is meaningless when it
/// has errors. Whether the world can be loaded is not looked at.
Study load_study(const std::filesystem::path& file, const engine::Registry& registry,
                 Diagnostics& diagnostics);
/// The same of a text, as if it stood in `file`.
Study load_study_text(const std::filesystem::path& file, std::string_view text,
                      const engine::Registry& registry, Diagnostics& diagnostics);

}  // namespace troupe::worldio
