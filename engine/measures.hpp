#pragma once

#include "base/diagnostics.hpp"
#include "engine/measure_kind.hpp"
#include "engine/world.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// The measures that are taken of one run: a column each. Not thread-safe; it runs on the world's workers.
class MeasureSet {
 public:
  /// Reports at the specs' places: kinds and robots that are not there, two columns of one name, parameters
  /// that ask for too much. Begins with the state that the world is in. World and registry must outlive it.
  MeasureSet(World& world, const Registry& registry, std::span<const MeasureSpec> specs,
             Diagnostics& diagnostics);

  /// `displacement_m`, `stalls:leaders`: names with the units of SI behind them, like the keys of JSON
  /// worlds.
  std::span<const std::string> columns() const { return columns_; }
  /// To be called after every step. After a tick that does not follow the last one (after a reset) measures
  /// begin again.
  void see();
  /// A number a column, of the state that was seen last; NaN where there is none.
  std::vector<double> values();
  /// One number of values(), without the others.
  double value(std::size_t column);

  /// What is remembered of earlier ticks, for a checkpoint; and back, into a set of the same specs and a
  /// world in the saved state. False, and nothing changed, for what no such set has saved.
  std::vector<std::byte> memory() const;
  /// Sets what memory() gave, see there.
  bool remember(std::span<const std::byte> memory);

 private:
  struct Part {
    const MeasureKind* kind;
    Record params;
    std::vector<Row> robots;
  };
  void begin();

  World& world_;
  std::vector<Part> parts_;
  std::vector<std::string> columns_;                // beside parts_, as are
  std::vector<std::unique_ptr<Measure>> measures_;  // made of them
  std::uint64_t seen_ = 0;                          // the last tick
};

/// The robots that `of` names, in the order of their ids: those of the type or the population of this name,
/// or the one robot; of an empty text all. Empty where no robot is called so.
std::vector<Row> robots_of(const World& world, std::string_view of);
/// What `of` may name, but for single robots: the types and populations of robots, sorted.
std::vector<std::string> names_of_robots(const World& world);

/// How many of the rows are in the world.
std::size_t count_there(const World& world, std::span<const Row> rows);

/// term(0) + term(1) + ...: of blocks of a fixed size, each summed up by one task, so that threads do not
/// show.
template <class Term>
double ordered_sum(World& world, std::size_t count, Term&& term) {
  constexpr std::size_t k_block = 1024;
  thread_local std::vector<double> kept;  // grows once: conditions are asked in every step
  kept.resize((count + k_block - 1) / k_block);
  const std::span<double> sums = kept;  // the workers' own is another
  world.parallel().for_each(sums.size(), [&, sums](std::size_t b) {
    double sum = 0;
    for (std::size_t i = b * k_block; i < std::min(count, (b + 1) * k_block); ++i) sum += term(i);
    sums[b] = sum;
  });
  double sum = 0;
  for (const double s : sums) sum += s;
  return sum;
}

}  // namespace troupe::engine
