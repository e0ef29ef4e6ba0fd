#pragma once

#include "engine/measures.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// The conditions on measures with which a world ends its run. They look on, as measures do.
/// Not thread-safe; it runs on the world's workers.
class StopConditions {
 public:
  /// Reports at the conditions' places what MeasureSet does. Begins with the state that the world is in, of
  /// which nothing is asked. World and registry must outlive it.
  StopConditions(World& world, const Registry& registry, std::span<const StopSpec> conditions,
                 Diagnostics& diagnostics);

  /// To be called after every step.
  void see();
  /// Asks of the state that was seen last, whether a step has led there or not.
  void ask();
  /// To be called after a reset: begins with the state that the world is in.
  void begin();
  /// The first of the conditions that held when it was last asked.
  std::optional<std::size_t> holding() const { return holding_; }

  /// Under which a checkpoint keeps what the measures remember: other conditions have another name.
  std::string memory_name() const;
  /// What the measures remember, for a checkpoint; and back: MeasureSet::remember().
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
  std::vector<double> values_;  // of its columns
  std::string text_;            // of all conditions
  std::optional<std::size_t> holding_;
};

}  // namespace troupe::engine
