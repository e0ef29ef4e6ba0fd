#pragma once

#include "base/diagnostics.hpp"
#include "base/exact_sum.hpp"
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

/// The measures of one run, one column each. Not thread-safe; computes on the world's workers.
class MeasureSet {
 public:
  /// Reports, at the positions of the specs, unknown kinds and robots, two columns of one name, and
  /// parameters that ask for too much. Measuring begins with the present state. World and registry must
  /// outlive it.
  MeasureSet(World& world, const Registry& registry, std::span<const MeasureSpec> specs,
             Diagnostics& diagnostics);

  /// Names with SI units as suffixes, as in the keys of JSON worlds: `displacement_m`, `stalls:leaders`.
  std::span<const std::string> columns() const { return columns_; }
  /// To be called after every step. If the tick does not follow the last one, as after a reset, all measures
  /// begin again.
  void see();
  /// One number per column, for the state of the last see(); NaN if a measure has none.
  std::vector<double> values();
  /// One number of values(); the others are not computed.
  double value(std::size_t column);

  /// Memory of all measures, for a checkpoint.
  std::vector<std::byte> memory() const;
  /// Restores memory() of a set of the same specs; the world must be in the saved state. Returns false and
  /// changes nothing if the size is wrong.
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
  std::vector<std::string> columns_;                // parallel to parts_
  std::vector<std::unique_ptr<Measure>> measures_;  // parallel to parts_
  std::uint64_t seen_ = 0;                          // tick of the last see()
};

/// The robots that `of` names, in order of ids: those of a type or a population, or a single robot. All
/// robots if `of` is empty. No robots if nothing has that name.
std::vector<Row> robots_of(const World& world, std::string_view of);
/// Names of all types and populations of robots, sorted.
std::vector<std::string> names_of_robots(const World& world);

/// Number of the rows that are in the world.
std::size_t count_there(const World& world, std::span<const Row> rows);

/// term(0) + ... + term(count - 1), rounded once: the result depends on neither the number of threads nor the
/// order of the terms.
template <class Term>
double exact_sum(World& world, std::size_t count, Term&& term) {
  constexpr std::size_t k_block = 1024;
  thread_local std::vector<ExactSum> kept;  // kept, because stop conditions are evaluated in every step
  kept.assign((count + k_block - 1) / k_block, ExactSum());
  const std::span<ExactSum> sums = kept;  // of this thread: `kept` is another array on each worker
  world.parallel().for_each(sums.size(), [&, sums](std::size_t b) {
    for (std::size_t i = b * k_block; i < std::min(count, (b + 1) * k_block); ++i) sums[b].add(term(i));
  });
  ExactSum sum;
  for (const ExactSum& of_block : sums) sum.add(of_block);
  return sum.value();
}

}  // namespace troupe::engine
