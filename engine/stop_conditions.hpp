#pragma once

#include "engine/measures.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// Conditions on measures that end the run of a world. They never change the world. Not thread-safe; computes
/// on the world's workers.
class StopConditions {
 public:
  /// Reports the errors of MeasureSet, at the positions of the conditions. Measuring begins with the present
  /// state, without evaluating the conditions. World and registry must outlive it.
  StopConditions(World& world, const Registry& registry, std::span<const StopSpec> conditions,
                 Diagnostics& diagnostics);

  /// Updates the measures and evaluates the conditions; to be called after every step.
  void see();
  /// Evaluates the conditions for the state that the measures saw last.
  void ask();
  /// Begins again with the present state; to be called after a reset.
  void begin();
  /// Index of the first condition that held at the last evaluation; not set if none did.
  std::optional<std::size_t> holding() const { return holding_; }

  /// Name of memory() in a checkpoint; it differs between different conditions.
  std::string memory_name() const;
  /// Memory of the measures, for a checkpoint, and its restoration: see MeasureSet.
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
  StopConditions(World& world, const Registry& registry, std::span<const StopSpec> conditions,
                 std::vector<MeasureSpec> measures, Diagnostics& diagnostics);

  std::vector<Condition> conditions_;
  MeasureSet measures_;
  std::vector<double> values_;  // one per column of measures_
  std::string text_;            // of all conditions
  std::optional<std::size_t> holding_;
};

}  // namespace troupe::engine
