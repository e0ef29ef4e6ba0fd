#pragma once

#include "base/ids.hpp"
#include "engine/fields/description.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {

class MeasuredWorld;

/// A measure of a run, such as the area that robots have covered. It computes one number from the present
/// state of the world and from its own memory of earlier states. It never changes the world. The number must
/// have the same bits for any number of threads and for any layout of the world's spatial index
/// (docs/determinism.md).
class Measure {
 public:
  virtual ~Measure() = default;
  /// Updates the memory of the measure with the present state. MeasureSet, the class that computes all
  /// measures of a run, calls this function once after every tick (time step), in order. The first call is
  /// for the state with which measuring begins. By default the function does nothing.
  virtual void see(const MeasuredWorld& world) { static_cast<void>(world); }
  /// Returns the value for the present state, in the unit MeasureKind::unit; NaN if the measure has no value
  /// in this state. The caller calls see() for a state before value(), and may call value() any number of
  /// times for one state.
  virtual double value(const MeasuredWorld& world) = 0;
  /// The memory of the measure as bytes; by default there is none. A checkpoint (a file with the whole state
  /// of a run) contains these bytes. When a run is resumed from the checkpoint, the saved bytes are written
  /// back to the memory. The number of bytes must be the same in every call.
  ///
  /// The saved bytes may not fit the resumed world, for example because its bounds were changed. A measure
  /// that can recognise this changes the bytes in the call after they were written. MeasureSet then writes
  /// back the bytes from before, and the measure begins again at the tick of the checkpoint.
  virtual std::span<std::byte> memory() { return {}; }
};

/// A kind of measure: its name, parameters and description, and a function that makes such a measure. A
/// measure can be computed for all robots, for some of them, or for one. The values of a measure are a column
/// of the results of a run.
struct MeasureKind {
  std::string_view name = {};        ///< name of the measure and of its column in the results
  Unit unit = Unit::none;            ///< SI unit of the values; MeasureSet adds it to the name of the column
  std::string_view text = {};        ///< description in one line
  std::string_view definition = {};  ///< exact definition, and the publication that it is from
  /// The definition as a formula, in which n is the number of robots and x_i the position of robot i; may be
  /// empty.
  std::string_view formula = {};
  /// Name of the original measure, if this measure is an alias; otherwise empty. An alias is computed only if
  /// the user chooses it (is_usual()).
  std::string_view same_as = {};
  /// Whether code in another language, such as Python, computes the measure. The values of such a measure
  /// need not have the same bits in every run. An exception of such code reaches the caller of MeasureSet,
  /// the class that computes all measures of a run, unchanged. Only a std::logic_error from `make` does not:
  /// the constructor of MeasureSet reports it in its diagnostics.
  bool is_foreign = false;
  FieldTable params = {};  ///< table of the parameters of a measure of this kind
  /// Whether the measure is computed if the user chooses no measures. True if it is not an alias and all its
  /// parameters have default values.
  bool is_usual() const { return same_as.empty() && std::ranges::all_of(params.defaults(), &Value::given); }
  /// Makes a measure of the given robots, which are in the order of their ids; there may be none. The caller
  /// has checked `params` against the table MeasureKind::params. Throws std::length_error if the parameters
  /// need too much memory, and std::invalid_argument if they contain the name of a thing that the world does
  /// not have.
  ///
  /// The measure must keep the ids, not the rows (indices in the state tables), because the row of a robot
  /// can change during a run. MeasuredWorld::row() returns the present row of a robot.
  std::unique_ptr<Measure> (*make)(const MeasuredWorld& world, const Record& params,
                                   std::vector<BodyId> robots) = nullptr;
};

/// Makes a measure kind from a class M, which is derived from Measure. The constructor of M takes (world,
/// robots), as MeasureKind::make does. If M has a `struct Params`, the constructor takes (world, params,
/// robots). Params must have a function `describe` that lists its members (engine/fields/description.hpp).
/// The arguments of make_measure_kind() become the members of MeasureKind with the same names.
template <class M>
MeasureKind make_measure_kind(std::string_view name, Unit unit, std::string_view text,
                              std::string_view definition, std::string_view formula = {}) {
  MeasureKind kind{.name = name, .unit = unit, .text = text, .definition = definition, .formula = formula};
  if constexpr (requires { typename M::Params; }) {
    kind.params = described<typename M::Params>();
    kind.make = [](const MeasuredWorld& world, const Record& record,
                   std::vector<BodyId> robots) -> std::unique_ptr<Measure> {
      return std::make_unique<M>(world, from_record<typename M::Params>(record), std::move(robots));
    };
  } else {
    kind.make = [](const MeasuredWorld& world, const Record&,
                   std::vector<BodyId> robots) -> std::unique_ptr<Measure> {
      return std::make_unique<M>(world, std::move(robots));
    };
  }
  return kind;
}

}  // namespace troupe::engine
