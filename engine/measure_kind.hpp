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

/// A measure of a run: one number of each state, and what it remembers of earlier ones. It looks on and
/// changes nothing. Its numbers follow the rules for state (docs/determinism.md): the same bits on any number
/// of threads and tiles.
class Measure {
 public:
  virtual ~Measure() = default;
  /// For what it remembers: called for every tick in its order, from the one where measuring begins.
  virtual void see(World& world) { static_cast<void>(world); }
  /// Of the state that the world is in, which has been seen. NaN where it has none.
  virtual double value(World& world) = 0;
  /// What it remembers, to be saved and put back; always of the same size.
  virtual std::span<std::byte> memory() { return {}; }
};

/// A kind of measure. Its name and unit give the column of a table; `of` all, some or one of the robots.
struct MeasureKind {
  std::string_view name;        ///< of the measure, and of its column
  Unit unit = Unit::none;       ///< SI; behind the column's name
  std::string_view text;        ///< a line
  std::string_view definition;  ///< what exactly, and from where
  FieldTable params;            ///< its parameters
  /// robots: those that are measured, in the order of their ids; there may be none. Throws std::length_error
  /// where the parameters ask for too much, std::invalid_argument where they ask for what is not there.
  std::unique_ptr<Measure> (*make)(const World& world, const Record& params, std::vector<Row> robots);
};

/// A kind of a class M that is made from (world, robots), or, where it has a described `struct Params`, from
/// (world, params, robots).
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
