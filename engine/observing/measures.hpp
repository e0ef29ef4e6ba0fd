#pragma once

#include "base/diagnostics.hpp"
#include "base/exact_sum.hpp"
#include "base/result.hpp"
#include "engine/kinds/measure_kind.hpp"
#include "engine/rows/measured_world.hpp"
#include "engine/world/world.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// Returns the name of a measure in results: the name that its spec gives it, or the name of its kind and,
/// after a colon, of its robots. `unit`, such as "_m", follows the name of the spec or of the kind. With the
/// unit, this is the name of the measure's column (MeasureSet::columns()).
std::string measure_name(const MeasureSpec& spec, std::string_view unit = {});

struct KnownNames;  // engine/observing/measures.cpp

/// The measures of one run. A measure is a number that is computed from the state of the world after a tick
/// (time step), such as the mean displacement of robots. Each measure has one column in the tables of
/// results. A measure may have a memory: data from earlier ticks on which its value depends. Not thread-safe.
/// The measures use the worker threads of the world.
class MeasureSet {
 public:
  /// Makes the measures of `specs`, and updates them with the present state. World and registry (the list of
  /// all kinds) must outlive the set.
  ///
  /// Reports errors of a spec to `diagnostics`, at the position of the spec in the file, and omits the
  /// measure. The errors are:
  /// - an unknown kind of measure, or an unknown name of robots;
  /// - a column name that another measure has, or that is reserved for the time;
  /// - an exception of MeasureKind::make, the function that makes the measure. Code in another language can
  ///   implement a measure (MeasureKind::is_foreign). For such a measure, only a std::logic_error is
  ///   reported, and other exceptions propagate unchanged.
  ///
  /// Also throws the exceptions of see().
  ///
  /// paths: one per spec: the path of the measure in its file, such as "/measures/0", with which the text of
  /// an error begins. Empty if the specs come from no file
  /// too_large: if not null, a measure that needs too much memory (std::length_error of MeasureKind::make) is
  /// no error; the set omits the measure and adds the index of its spec to this list
  MeasureSet(World& world, const Registry& registry, std::span<const MeasureSpec> specs,
             Diagnostics& diagnostics, std::span<const std::string> paths = {},
             std::vector<std::size_t>* too_large = nullptr);

  /// Names of the columns, in the order of the specs. By default, a name consists of the name of the kind of
  /// measure, the SI unit and, after a colon, the robots: `displacement_m:leaders` is the displacement, in
  /// metres, of the robots `leaders`. A measure of all robots has no colon. If a spec gives its measure a
  /// name, the column has this name and the unit.
  std::span<const std::string> columns() const { return columns_; }
  /// Updates the measures with the present state. Call this after every step. The constructor counts as the
  /// first call. There are three cases:
  /// - The world has advanced by one tick since the last call, with the same seed: the measures add the
  ///   present state to their memories.
  /// - The tick and the seed have not changed since the last call, and the tick is not 0: nothing happens.
  /// - Otherwise, for example after a reset or after the restore of a checkpoint: the measures discard their
  ///   memories and begin again with the present state.
  ///
  /// Throws a std::runtime_error that names the tick and the measure if a measure throws. Exceptions of
  /// foreign measures (see the constructor) propagate unchanged. Throws std::logic_error if the last step
  /// threw (World::require_whole()), and during a step (World::require_between_steps()).
  void see();
  /// Returns the values of the measures, one per column, in the SI units of the columns. A value is NaN if
  /// the measure has no value. The world must still be in the state of the last call of see(). Throws the
  /// exceptions of see().
  std::vector<double> values();
  /// Returns only the value of one column, as values() computes it. `column` is an index into columns(),
  /// which must exist.
  double value(std::size_t column);

  /// Whether the value of a column depends on earlier ticks: its measure has a memory that is not empty.
  bool has_memory(std::size_t column) const { return parts_[column].memory_bytes > 0; }
  /// Returns the memories of all measures (Measure::memory()), for a checkpoint (a file from which a run is
  /// resumed). Each memory is stored with a hash of the kind of the measure, its robots and its parameters.
  /// Throws a std::runtime_error that names the measure if Measure::memory() throws, or if the size of a
  /// memory has changed since the set was made: such a checkpoint could not be resumed.
  std::vector<std::byte> memory() const;
  /// Restores the memories of the measures from a result of memory(), which may come from a set with other
  /// specs. A memory is restored if its measure had the same kind, robots and parameters; the name of the
  /// column does not matter. First restore the state of the world in which the memories were saved, and call
  /// see() or construct the set in that state: otherwise, the next call of see() discards the restored
  /// memories.
  ///
  /// Returns the indices of the columns for which `memory` contains no such measure, also if they have no
  /// memory, or for which it contains a memory of another size or one that does not fit the world
  /// (Measure::memory()). These measures keep the memories that they have.
  std::vector<std::size_t> remember(std::span<const std::byte> memory);

 private:
  struct Part {
    const MeasureKind* kind;
    Record params;
    std::vector<BodyId> robots;
    std::size_t memory_bytes;  // of a new measure
    std::uint64_t identity;    // identity_of()
  };
  /// Adds a measure. The error says why it cannot be added. Throws std::length_error as MeasureKind::make.
  /// names: null until a measure has had an unknown name of robots
  Result<> add(const MeasureSpec& spec, const Registry& registry, std::unique_ptr<const KnownNames>& names);
  void begin();
  void note_present();  // stores the tick and the seed of the world

  World& world_;
  std::vector<Part> parts_;
  std::vector<std::string> columns_;                // parallel to parts_
  std::vector<std::unique_ptr<Measure>> measures_;  // parallel to parts_
  std::uint64_t seen_ = 0;                          // tick of the last see()
  std::uint64_t seen_seed_ = 0;                     // seed of the world then
};

/// Returns the robots to which a name refers, in order of ids. A robot is a body with a drive. Robots that
/// are not yet in the world (unborn) and dead robots are included.
///
/// of: the name of a type (all robots of the type), the name or alias of a robot, or the name of a
/// population. A population here means all robots whose names are `of` followed by digits, such as "ant7" for
/// "ant". The population is ignored if a single robot has the name or alias `of`: "r1" does not refer to
/// "r10". If `of` is empty, all robots are returned. If nothing has this name, the list is empty
std::vector<BodyId> robots_of(const World& world, std::string_view of);
/// Whether a name that robots_of() does not find is nevertheless known: it is the name of a type of robots,
/// or of a population of robots, without a robot. For example, the option --robots may have removed all of
/// them.
bool is_name_of_no_robots(const World& world, std::string_view name);
/// Returns the names of all types of robots and of all populations, sorted, each once. The population of a
/// robot has the name of the robot without the digits at its end: "ant" for "ant7".
std::vector<std::string> names_of_robots(const World& world);
/// Returns the text of an error for a name that robots_of() does not find, and for which
/// is_name_of_no_robots() is false.
std::string unknown_robots(const World& world, std::string_view name);

}  // namespace troupe::engine
