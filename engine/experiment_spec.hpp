#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "base/pose.hpp"
#include "engine/measure_spec.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

// What a world file says of the experiment that is made in its world (docs/experiments.md): when it is over,
// what is done to it while it runs, and how its robots fail.

/// How a measure is held against a number.
enum class Comparison : std::uint8_t {
  below,     ///< `a < b`
  at_most,   ///< `a <= b`
  above,     ///< `a > b`
  at_least,  ///< `a >= b`
  equal,     ///< `a == b`
  unequal,   ///< `a != b`
};
/// As files write them, in the order of Comparison.
inline constexpr std::array<std::string_view, 6> k_comparisons{"<", "<=", ">", ">=", "==", "!="};
/// Whether `a COMPARISON b` holds: never where one of them is no number.
bool holds(double a, Comparison comparison, double b);

/// A condition on a measure.
struct StopSpec {
  MeasureSpec measure;                        ///< what is measured
  Comparison comparison = Comparison::below;  ///< in `measure COMPARISON value`
  double value = 0;                           ///< in the unit of the measure, SI
};
/// `coverage >= 0.9`, `stalls:leaders > 10`.
std::string text_of(const StopSpec& condition);

/// Some of the bodies of a world: all of a population (NAME0, NAME1, ...), of a type, or one model; or so
/// many of them, chosen at random.
struct GroupSpec {
  /// What its name names.
  enum class By : std::uint8_t {
    population,  ///< NAME of NAME0, NAME1, ...
    type,        ///< TypeSpec::name
    model,       ///< the name of one body
  };
  By by = By::population;             ///< see `name`
  std::string name;                   ///< of a population, a type or a model
  std::optional<std::int64_t> count;  ///< more than there are: all
  std::optional<double> share;        ///< of those that there are, 0 to 1, rounded to the nearest number
};

/// New values for some parameters of a type.
struct SettingSpec {
  /// Whose parameters are set.
  enum class Of : std::uint8_t {
    drive,       ///< of the body's own
    device,      ///< TypeSpec::devices[index]
    controller,  ///< TypeSpec::controllers[index]
  };
  TypeId type;              ///< the type of all bodies that it is for: a type shares its parameters
  Of of = Of::drive;        ///< what of the type
  std::uint32_t index = 0;  ///< of the device or controller in the TypeSpec
  Record params;            ///< by the kind's field table; those that are not given stay as they are
};

/// Parameters of a kind with the new values of a setting.
Record changed(const Record& params, const SettingSpec& setting);

/// What is done to a world when a tick has ended, before the next begins, as if a program did it.
struct InterventionSpec {
  /// What is done.
  enum class Action : std::uint8_t {
    remove,   ///< their lives end
    add,      ///< so many are born
    disable,  ///< all of them stops: devices, controllers, drive
    enable,   ///< what `disable` stopped goes on
    move,     ///< one model is put elsewhere
    set,      ///< parameters of a type change
  };
  double time_s = 0;                   ///< a time between two ticks is rounded up
  Action action = Action::remove;      ///< in the order of k_actions
  GroupSpec whom;                      ///< of `add` a population with a reserve, of `move` one model
  std::optional<Pose> pose;            ///< of `move`; of `add` where they are born, else:
  std::optional<Box> region;           ///< anywhere in it, heading anywhere; not given: in the world's bounds
  std::optional<SettingSpec> setting;  ///< of `set`, which has no group
  Where where;                         ///< for messages
};
/// As files write them, in the order of Action.
inline constexpr std::array<std::string_view, 6> k_actions{"remove", "add",  "disable",
                                                           "enable", "move", "set"};

/// How some of the bodies fail that are there at the start.
struct FaultSpec {
  GroupSpec whom;     ///< who may fail; chosen once, at random where not all
  double from_s = 0;  ///< from when on, world time
  /// One way in which they fail.
  struct Ailment {
    std::string kind;  ///< of Registry::faults
    Record params;     ///< by the kind's field table
  };
  std::vector<Ailment> ailments;  ///< each occurs independently of the others
  Where where;                    ///< for messages
};

/// All that a world's experiment consists of.
struct ExperimentSpec {
  std::vector<StopSpec> stop_when;   ///< the run is over when one of them holds
  std::vector<InterventionSpec> at;  ///< in any order of time
  std::vector<FaultSpec> faults;     ///< of robots that are there at the start

  /// Whether nothing is said: the run ends where its caller ends it.
  bool empty() const { return stop_when.empty() && at.empty() && faults.empty(); }
};

}  // namespace troupe::engine
