#pragma once

#include "base/diagnostics.hpp"
#include "base/exact_sum.hpp"
#include "engine/kinds/measure_kind.hpp"
#include "engine/world/world.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// The measures of one run. A measure is a number that is computed from the state of the world after a tick
/// (time step), such as the mean displacement of robots. Each measure is a column of the results. A measure
/// may have a memory: data from earlier ticks that its value depends on. Not thread-safe; the measures
/// compute on the worker threads of the world.
class MeasureSet {
 public:
  /// Begins to measure with the present state. Reports errors of the specs to `diagnostics`, at the positions
  /// of the specs in the file, and leaves out the measures that have errors. The errors are: unknown kinds or
  /// robots; equal or reserved column names; and exceptions of MeasureKind::make, the function that makes a
  /// measure, which throws for example if parameters name something unknown or need too much memory. A
  /// foreign measure is computed by code in another language, such as Python (MeasureKind::is_foreign). If
  /// `make` of a foreign measure throws, only std::logic_error is reported; all other exceptions propagate
  /// unchanged.
  ///
  /// Then calls Measure::see() of the remaining measures, which updates them. If one of these calls throws,
  /// or if the last step of the world threw, the constructor throws the same exceptions as MeasureSet::see().
  /// World and registry (the list of all kinds of measures) must outlive the set.
  /// paths: for each spec, the path of the measure in its file, such as "/measures/0", with which its errors
  /// begin; empty if the specs come from no file
  MeasureSet(World& world, const Registry& registry, std::span<const MeasureSpec> specs,
             Diagnostics& diagnostics, std::span<const std::string> paths = {});

  /// Names of the columns, in the order of the specs, with the SI unit after the name of the measure:
  /// `displacement_m`, `displacement_m:leaders`, `stalls:leaders`.
  std::span<const std::string> columns() const { return columns_; }
  /// Updates the measures. Call this after every step. Does nothing if the tick and the seed of the world are
  /// those of the last call (or of the constructor), except at tick 0. The measures discard their memory and
  /// begin again with the present state in these cases: at tick 0; after a change of the seed; after a jump
  /// in time, such as a reset or the restore of a checkpoint (the tick is neither that of the last call nor
  /// the next one). If a measure throws, throws a std::runtime_error that names the tick and the measure;
  /// exceptions of foreign measures propagate unchanged. Throws std::logic_error if the last step threw
  /// (World::require_whole()).
  void see();
  /// Values for the state of the last see(), one per column, in the SI units of the columns; NaN if a
  /// measure has no value. The world must still be in that state. Exceptions are those of see().
  std::vector<double> values();
  /// Returns the value that values() has for the column with this index, which must exist. Does not compute
  /// the other columns.
  double value(std::size_t column);

  /// Memory of all measures (Measure::memory()), one after another, for a checkpoint (a file from which a run
  /// is resumed).
  std::vector<std::byte> memory() const;
  /// Restores the result of memory(), which must come from a set with the same specs. The world must be in
  /// the state in which the memory was saved, and the constructor or see() must have been called for that
  /// state: otherwise the next see() discards the memory. Returns false and changes nothing if the size is
  /// wrong.
  bool remember(std::span<const std::byte> memory);

 private:
  struct Part {
    const MeasureKind* kind;
    Record params;
    std::vector<BodyId> robots;
  };
  void begin();
  void note_present();  // stores the tick and the seed of the world

  World& world_;
  std::vector<Part> parts_;
  std::vector<std::string> columns_;                // parallel to parts_
  std::vector<std::unique_ptr<Measure>> measures_;  // parallel to parts_
  std::uint64_t seen_ = 0;                          // tick of the last see()
  std::uint64_t seen_seed_ = 0;                     // seed of the world then
};

/// Returns the robots (bodies with a drive) that the name `of` stands for, in order of ids, including unborn
/// robots (not yet in the world) and dead robots (no longer in the world): all robots of the type with this
/// name, and the robot with this name or alias. If no single robot has this name or alias, the robots of the
/// population with this name are added, which are those whose name is `of` followed by digits. Returns all
/// robots if `of` is empty, and no robots if there is no type, population or robot with this name.
std::vector<BodyId> robots_of(const World& world, std::string_view of);
/// Names of all types of robots and of all populations, sorted, each once. The name of a robot's population
/// is the name of the robot without the digits at its end: "ant" for "ant7".
std::vector<std::string> names_of_robots(const World& world);

/// Returns how many of the bodies are in the world, that is, neither unborn nor dead. Every body must have a
/// row in the state tables.
std::size_t count_there(const World& world, std::span<const BodyId> bodies);

/// Returns the exact sum term(0) + ... + term(count - 1), rounded once to double, and 0 if `count` is 0. The
/// result depends on neither the number of threads nor the order of the terms. The worker threads of the
/// world call term(i), so it must be thread-safe. Call this between two steps, or in Measure::see() or
/// value().
template <class Term>
double exact_sum(World& world, std::size_t count, Term&& term) {
  constexpr std::size_t k_block = 1024;
  thread_local std::vector<ExactSum> kept;  // reused, because stop conditions call this in every step
  kept.assign((count + k_block - 1) / k_block, ExactSum());
  const std::span<ExactSum> sums = kept;  // of this thread: `kept` is another array on each worker
  world.parallel().for_batches(count, k_block, [&, sums](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) sums[first / k_block].add(term(i));
  });
  ExactSum sum;
  for (const ExactSum& of_block : sums) sum.add(of_block);
  return sum.value();
}

}  // namespace troupe::engine
