#pragma once

#include "base/ids.hpp"
#include "engine/description.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::engine {

class World;

/// A measure of a run: computes one number from the present state and its memory of earlier ones. It never
/// changes the world. Its numbers follow the rules for state (docs/determinism.md): the same bits on any
/// number of threads and tiles.
class Measure {
 public:
  virtual ~Measure() = default;
  /// Updates the memory. Called for every tick in order, from the first measured one.
  virtual void see(World& world) { static_cast<void>(world); }
  /// Value for the present state, after see() was called for it; NaN if there is none.
  virtual double value(World& world) = 0;
  /// The memory as bytes, to be saved and restored; always of the same size.
  virtual std::span<std::byte> memory() { return {}; }
};

/// A kind of measure, taken of all, some or one of the robots. Its name and unit give the column of a table.
struct MeasureKind {
  std::string_view name;        ///< name of the measure and of its column
  Unit unit = Unit::none;       ///< SI; suffix of the column's name
  std::string_view text;        ///< description in one line
  std::string_view definition;  ///< exact definition, and its source
  FieldTable params;            ///< fields of its parameters
  /// Makes a measure. robots: the measured ones, in order of ids; may be empty. Throws std::length_error if
  /// the parameters ask for too much, std::invalid_argument if they name something that does not exist.
  std::unique_ptr<Measure> (*make)(const World& world, const Record& params, std::vector<Row> robots);
};

/// The kind of a class M that is constructed from (world, robots), or from (world, params, robots) if it has
/// a described `struct Params`.
template <class M>
MeasureKind make_measure_kind(std::string_view name, Unit unit, std::string_view text,
                              std::string_view definition) {
  MeasureKind kind{.name = name, .unit = unit, .text = text, .definition = definition};
  if constexpr (requires { typename M::Params; }) {
    kind.params = described<typename M::Params>();
    kind.make = [](const World& world, const Record& record,
                   std::vector<Row> robots) -> std::unique_ptr<Measure> {
      return std::make_unique<M>(world, from_record<typename M::Params>(record), std::move(robots));
    };
  } else {
    kind.make = [](const World& world, const Record&, std::vector<Row> robots) -> std::unique_ptr<Measure> {
      return std::make_unique<M>(world, std::move(robots));
    };
  }
  return kind;
}

}  // namespace troupe::engine
