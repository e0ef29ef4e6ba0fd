#pragma once

#include "engine/observing/measures.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// Conditions that end the run of a world, such as `coverage >= 0.9`. Each condition compares a measure with
/// a constant. A measure is a number that is computed from the state of the world. The conditions never
/// change the world. Not thread-safe. The measures use the worker threads of the world.
class StopConditions {
 public:
  /// Makes the measures of the conditions, and updates them with the present state. Does not evaluate the
  /// conditions. Reports errors of their measures, such as an unknown kind of measure, to `diagnostics`, with
  /// the position and the path of the condition in the file. The errors and the exceptions are those of the
  /// constructor of MeasureSet. World and registry (the list of all kinds) must outlive the object.
  StopConditions(World& world, const Registry& registry, std::span<const StopSpec> conditions,
                 Diagnostics& diagnostics);

  /// Updates the measures with MeasureSet::see(), and evaluates the conditions. Call this after every step.
  /// Throws the exceptions of MeasureSet::see(), for example if a measure throws.
  void see();
  /// Evaluates the conditions without updating the measures. The world must still be in the state of the last
  /// update, by see(), begin() or the constructor. Throws the exceptions of MeasureSet::see().
  void ask();
  /// Call this after the world was reset. Forgets which condition was true, and updates the measures, which
  /// begin again with the present state. Throws the exceptions of MeasureSet::see().
  void begin();
  /// Index of the first condition that was true at the last evaluation. std::nullopt if none was true, or if
  /// there was no evaluation since construction or begin(). A condition is false if its measure or its
  /// constant is NaN, even if the operator is `!=`.
  std::optional<std::size_t> holding() const { return holding_; }

  /// Returns the memories of the measures (data from earlier ticks), for a checkpoint (a file from which a
  /// run is resumed).
  std::vector<std::byte> memory() const { return measures_.memory(); }
  /// Restores the memories of the measures from a result of memory(), which may come from other conditions.
  /// The world must be in the state that MeasureSet::remember() requires. Returns the columns of the measures
  /// that have a memory (MeasureSet::has_memory()), but for which the argument contains none: they begin with
  /// the present state.
  std::vector<std::string> remember(std::span<const std::byte> memory);

 private:
  struct Condition {
    std::size_t column;
    Comparison comparison;
    double value;
  };
  /// The measures that the conditions test, each once. `paths` has, for each measure, the path of the first
  /// condition that tests it.
  struct Tested {
    std::vector<MeasureSpec> measures;
    std::vector<std::string> paths;
  };
  static Tested measures_of(std::span<const StopSpec> conditions);
  StopConditions(World& world, const Registry& registry, std::span<const StopSpec> conditions,
                 const Tested& tested, Diagnostics& diagnostics);

  std::vector<Condition> conditions_;
  MeasureSet measures_;
  std::vector<double> values_;  // one per column of measures_
  std::optional<std::size_t> holding_;
};

}  // namespace troupe::engine
