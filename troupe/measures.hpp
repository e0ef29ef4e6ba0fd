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
/// Measures do not change the state. The simulation must outlive this object, which uses the worker threads
/// of the simulation. Not thread-safe.
class Measures {
 public:
  /// Makes measures, and updates them with the current state, as see() does. Each text in `wanted` describes
  /// one measure. It is one of:
  /// - the name of a measure that the world file lists: its key `name`, or, without this key, its kind and
  ///   robots as below. The measure has the parameters that the world file gives;
  /// - the name of a measure: "stalls";
  /// - the name of a measure, a colon, and the robots for which it is computed: "stalls:leaders". The word
  ///   after the colon is the name of a type of bodies, of a population (an entry of the world file that
  ///   creates many robots) or of a robot;
  /// - a JSON object as in a world file: `{"kind": "coverage", "cell_m": 0.5}`.
  ///
  /// If `wanted` is empty, the measures of the world file are computed. If the world file has none, all
  /// measures that need no parameters are computed, except aliases (second names of other measures) and
  /// measures that would need too much memory in this world, such as `coverage` of very large ground.
  ///
  /// Throws InputError, whose text lists all errors: unknown measures, parameters and robots, and two
  /// measures with the same column name.
  explicit Measures(Simulation& simulation, const std::vector<std::string>& wanted = {});
  ~Measures();
  Measures(Measures&&) noexcept;             ///< a moved-from object may only be destroyed or assigned to
  Measures& operator=(Measures&&) noexcept;  ///< a moved-from object may only be destroyed or assigned to

  /// Updates the measures with the current state. Call it after every step; the constructor has already
  /// called it for the current tick (time step). A second call in a tick has no effect. Measures such as the
  /// covered area depend on earlier ticks. They start again from the current state after a tick without a
  /// call of see(), and after Simulation::reset(). Throws std::logic_error after a step that threw.
  void see();
  /// Names of the values, in the order of the argument `wanted` of the constructor, with their units
  /// appended: `displacement_m`, `displacement_m:leaders`, `stalls` (no unit).
  std::span<const std::string> columns() const;
  /// Returns the index of a column in columns(); std::nullopt if there is none. The name may omit the unit:
  /// "displacement" finds the column `displacement_m`, and "displacement:leaders" finds
  /// `displacement_m:leaders`.
  std::optional<std::size_t> find(std::string_view name) const;
  /// Returns one number per column for the current state; NaN if a measure has no value, for example a mean
  /// over robots when no robot is in the world. see() must have been called after the last step.
  std::vector<double> values();
  /// Returns the value of one column for the current state, as values() does. The name may omit the unit, as
  /// in find(). Throws std::out_of_range, with the known columns, if there is no such column.
  double value(std::string_view name);

  /// Returns the data about earlier ticks that the measures store, as bytes, for a checkpoint (a file from
  /// which a run can be resumed). Throws a std::runtime_error if a measure of a plug-in now stores another
  /// number of bytes than at first.
  std::vector<std::byte> memory() const;
  /// Restores the data that memory() returned, for each measure of this object that the data contain. They
  /// contain a measure if the object that returned them had one of the same kind, with the same robots and
  /// parameters; names of columns do not matter. The simulation must be in the state that it had when
  /// memory() was called, and this object must have been constructed or updated by see() in this state.
  ///
  /// Returns the indices in columns() of the measures that the data do not contain, or contain in another
  /// size, for example because the bounds of the world have changed. These measures are not changed: those
  /// that need data about earlier ticks (has_memory()) begin with the current state.
  std::vector<std::size_t> remember(std::span<const std::byte> memory);
  /// Whether the measure of a column, an index in columns(), stores data about earlier ticks. Throws
  /// std::out_of_range if there is no such column.
  bool has_memory(std::size_t column) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
