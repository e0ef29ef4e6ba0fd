#pragma once

#include "engine/observing/measures.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// Conditions that end the run of a world, such as `coverage >= 0.9`. Each condition compares a measure,
/// which is a number computed from the state of the world, with a constant. The conditions never change the
/// world. Not thread-safe; the measures are computed on the worker threads of the world.
class StopConditions {
 public:
  /// Begins to measure with the present state. Does not evaluate the conditions: see() and ask() do. Reports
  /// errors to `diagnostics`, at the positions and with the paths of the conditions in the file: those that
  /// the constructor of MeasureSet reports, such as unknown kinds of measures. World and registry must
  /// outlive the object.
  StopConditions(World& world, const Registry& registry, std::span<const StopSpec> conditions,
                 Diagnostics& diagnostics);

  /// Updates the measures (MeasureSet::see()) and evaluates the conditions. Call this after every step.
  /// Throws the exceptions of MeasureSet::see(), for example if a measure throws.
  void see();
  /// Evaluates the conditions for the state of the last see(), without updating the measures. The world must
  /// still be in that state. Throws the exceptions of MeasureSet::see().
  void ask();
  /// Forgets which condition was true, and updates the measures with MeasureSet::see(). Call this after the
  /// world was reset. The measures then begin again with the present state if the world is at tick 0, its
  /// seed has changed or its time has jumped (MeasureSet::see()).
  void begin();
  /// Index of the first condition that was true at the last evaluation; std::nullopt if none was true or
  /// there was no evaluation since construction or begin(). A condition is false if its measure or its limit
  /// is NaN, even if it tests for inequality.
  std::optional<std::size_t> holding() const { return holding_; }

  /// Name under which a checkpoint (a file from which a run is resumed) stores the result of memory():
  /// `stop_when` and a hash of the texts of the conditions, so that different lists of conditions have
  /// different names.
  std::string memory_name() const;
  /// memory() returns the memory of the measures (data from earlier ticks that their values depend on), for a
  /// checkpoint. remember() restores it; the world must be in the state that MeasureSet::remember() requires.
  /// remember() returns false and changes nothing if the size is not that of memory().
  ///@{
  std::vector<std::byte> memory() const { return measures_.memory(); }
  bool remember(std::span<const std::byte> memory) { return measures_.remember(memory); }
  ///@}

 private:
  struct Condition {
    std::size_t column;
    Comparison comparison;
    double value;
  };
  /// The measures that the conditions test, each listed once, and for each of them the path of the first
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
  std::string text_;            // the text of all conditions, for memory_name()
  std::optional<std::size_t> holding_;
};

}  // namespace troupe::engine
