#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

class Simulation;

/// Measures of a simulation, docs/measures.md: what `troupe run --measure` writes, for programs.
///
///   troupe::Measures measures(simulation, {"coverage", "stalls", "displacement:leaders"});
///   while (simulation.time_s() < 60) {
///     simulation.step();
///     measures.see();
///   }
///   std::cout << measures.value("coverage") << '\n';
///
/// They change no state. Not thread-safe; the simulation, on whose workers they run, must outlive them.
class Measures {
 public:
  /// wanted: names, of a type, population or robot `name:of`, or objects as a JSON world has them
  /// (`{"kind": "coverage", "cell_m": 0.5}`). Of an empty list those that the world asks for; where it asks
  /// for none, all that need no parameters.
  /// Throws InputError that lists what is wrong.
  explicit Measures(Simulation& simulation, const std::vector<std::string>& wanted = {});
  ~Measures();
  Measures(Measures&&) noexcept;             ///< the one moved from is of no use
  Measures& operator=(Measures&&) noexcept;  ///< as that

  /// To be called after every step: some measures remember where robots have been. After a reset they begin
  /// again.
  void see();
  /// Names with their units behind them: `displacement_m`, `stalls:leaders`.
  std::span<const std::string> columns() const;
  /// A number a column, of the state that was seen last; NaN where there is none.
  std::vector<double> values();
  /// One of them, with its unit or without. Throws std::out_of_range with the columns there are.
  double value(std::string_view name);

  /// What is remembered of earlier ticks, for a checkpoint, and back, into measures that were made alike of a
  /// simulation in the saved state. False for what no such measures have saved.
  std::vector<std::byte> memory() const;
  bool remember(std::span<const std::byte> memory);  ///< puts it back

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
