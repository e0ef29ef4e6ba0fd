#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe {

class Simulation;

/// Numbers that are computed from the state of a simulation, such as the covered area or the number of
/// stalled robots (docs/measures.md). `troupe run --measure` writes the same measures.
///
///   troupe::Measures measures(simulation, {"coverage", "stalls", "displacement:leaders"});
///   while (simulation.time_s() < 60) {
///     simulation.step();
///     measures.see();
///   }
///   std::cout << measures.value("coverage") << '\n';
///
/// Measures do not change the state. They are computed on the worker threads of the simulation, which must
/// outlive this object. Not thread-safe.
class Measures {
 public:
  /// wanted: one text per measure. The text is the name of a measure ("stalls"), or the name, a colon and the
  /// robots for which the measure is computed ("stalls:leaders"). These robots are given as the name of a
  /// type of bodies, of a population (an entry of the world file that creates many robots) or of a robot. The
  /// text may also be a JSON object as in a world file (`{"kind": "coverage", "cell_m": 0.5}`). An empty list
  /// means the measures of the world file, or, if it has none, all measures that need no parameters, except
  /// those that are a second name (alias) of another measure. Throws InputError, whose text lists all errors:
  /// unknown measures, parameters and robots, and two measures with the same column name.
  explicit Measures(Simulation& simulation, const std::vector<std::string>& wanted = {});
  ~Measures();
  Measures(Measures&&) noexcept;             ///< a moved-from object may only be destroyed or assigned to
  Measures& operator=(Measures&&) noexcept;  ///< a moved-from object may only be destroyed or assigned to

  /// Updates measures that depend on earlier ticks (time steps), such as the covered area, with the current
  /// state. Call it after every step; the constructor has already called it for the current tick. If a tick
  /// was left out, and after Simulation::reset(), these measures start again from the current state. A second
  /// call in a tick has no effect.
  void see();
  /// Names of the values, in the order of the list `wanted`, with their units appended: `displacement_m`,
  /// `displacement_m:leaders`, `stalls` (no unit).
  std::span<const std::string> columns() const;
  /// Returns the index of a column; std::nullopt if there is none. The name may omit the unit:
  /// `displacement_m` and `displacement`, `displacement_m:leaders` and `displacement:leaders`.
  std::optional<std::size_t> find(std::string_view name) const;
  /// Returns one number per column for the current state; NaN if a measure has no value, for example a mean
  /// over robots when no robot is in the world. see() must have been called after the last step.
  std::vector<double> values();
  /// Returns the value of one column for the current state, as values() does. The name may omit the unit, as
  /// in find(). Throws std::out_of_range, with the known columns, if there is no such column.
  double value(std::string_view name);

  /// Returns the data about earlier ticks that the measures store, as bytes, for a checkpoint (a file from
  /// which a run can be resumed).
  std::vector<std::byte> memory() const;
  /// Restores the data that memory() returned. The measures must be the same as those that returned the
  /// bytes, and the simulation must be in the state that it had when memory() was called. Returns false, and
  /// changes nothing, if the number of bytes does not match these measures.
  bool remember(std::span<const std::byte> memory);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
