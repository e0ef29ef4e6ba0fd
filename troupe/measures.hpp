#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

class Simulation;

/// Measures of a simulation (docs/measures.md), as `troupe run --measure` writes them:
///
///   troupe::Measures measures(simulation, {"coverage", "stalls", "displacement:leaders"});
///   while (simulation.time_s() < 60) {
///     simulation.step();
///     measures.see();
///   }
///   std::cout << measures.value("coverage") << '\n';
///
/// They change no state. Not thread-safe. They run on the simulation's workers; the simulation must outlive
/// them.
class Measures {
 public:
  /// wanted: names, for a type, population or robot `name:of`, or objects as in a JSON world
  /// (`{"kind": "coverage", "cell_m": 0.5}`). If empty: the measures of the world, or, if it has none, all
  /// that need no parameters. Throws InputError that lists all errors.
  explicit Measures(Simulation& simulation, const std::vector<std::string>& wanted = {});
  ~Measures();
  Measures(Measures&&) noexcept;             ///< the source may only be destroyed or assigned
  Measures& operator=(Measures&&) noexcept;  ///< the source may only be destroyed or assigned

  /// Updates measures that remember where robots have been. Call it after every step. After a reset they
  /// start again.
  void see();
  /// Names with their units appended: `displacement_m`, `stalls:leaders`.
  std::span<const std::string> columns() const;
  /// One number per column, for the current state, after see(); NaN if a column has no value.
  std::vector<double> values();
  /// The value of one column, named with or without its unit. Throws std::out_of_range, with the known
  /// columns, if there is none.
  double value(std::string_view name);

  /// The remembered history, to be stored in a checkpoint.
  std::vector<std::byte> memory() const;
  /// Restores memory() into equal measures of a simulation in the saved state. False, without a change, if
  /// the size is not that of these measures.
  bool remember(std::span<const std::byte> memory);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
