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

// The experiment of a world file (docs/experiments.md): its stop conditions, interventions and faults.

/// How a measure is compared with a number.
enum class Comparison : std::uint8_t {
  below,     ///< `a < b`
  at_most,   ///< `a <= b`
  above,     ///< `a > b`
  at_least,  ///< `a >= b`
  equal,     ///< `a == b`
  unequal,   ///< `a != b`
};
/// The operators in files, in the order of Comparison.
inline constexpr std::array<std::string_view, 6> k_comparisons{"<", "<=", ">", ">=", "==", "!="};
/// Whether `a COMPARISON b` is true. If a or b is NaN it is false, also for Comparison::unequal.
bool holds(double a, Comparison comparison, double b);

/// A stop condition: a comparison of a measure with a number.
struct StopSpec {
  MeasureSpec measure;                        ///< left operand
  Comparison comparison = Comparison::below;  ///< operator of `measure COMPARISON value`
  double value = 0;                           ///< right operand, in the SI unit of the measure
};
/// The text of a condition: `coverage >= 0.9`, `stalls:leaders > 10`.
std::string text_of(const StopSpec& condition);

/// A group of bodies: a population (NAME0, NAME1, ...), all bodies of a type, or one body. If `count` or
/// `share` is set, the group is a random selection of these bodies.
struct GroupSpec {
  /// What `name` refers to.
  enum class By : std::uint8_t {
    population,  ///< the name of a population: NAME for the bodies NAME0, NAME1, ...
    type,        ///< the name of a body type (TypeSpec::name)
    model,       ///< the name of one body
  };
  By by = By::population;             ///< what `name` refers to
  std::string name;                   ///< name of the population, type or body
  std::optional<std::int64_t> count;  ///< number of bodies to select; all if there are fewer
  std::optional<double> share;  ///< fraction of bodies to select, 0 to 1; their number is rounded to nearest
};

/// New values for some parameters of the drive, of a device or of a controller of a type.
struct SettingSpec {
  /// The owner of the parameters.
  enum class Of : std::uint8_t {
    drive,       ///< the drive of the type (TypeSpec::drive)
    device,      ///< the device TypeSpec::devices[index]
    controller,  ///< the controller TypeSpec::controllers[index]
  };
  TypeId type;              ///< the type; the change affects all its bodies
  Of of = Of::drive;        ///< the owner of the parameters
  std::uint32_t index = 0;  ///< index of the device or controller in the TypeSpec
  Record params;  ///< one per field of the kind's table; without a value: the parameter does not change
};

/// Returns a copy of `params` in which the values that the setting gives replace the old ones.
Record changed(const Record& params, const SettingSpec& setting);

/// An intervention of the world file: a change of the running world, applied between two ticks.
struct InterventionSpec {
  /// The kind of intervention.
  enum class Action : std::uint8_t {
    remove,   ///< removes the bodies of the group from the world
    add,      ///< spawns bodies of the population's reserve
    disable,  ///< stops the devices, controllers and drives of the group's bodies
    enable,   ///< lets disabled bodies run again
    move,     ///< moves one body to `pose`
    set,      ///< changes parameters of a type
  };
  /// World time, s. The intervention is applied after the first tick that ends at this time or later, in the
  /// phase `intervene` of the tick that follows.
  double time_s = 0;
  Action action = Action::remove;  ///< kind of intervention; its name is in k_actions
  GroupSpec whom;                  ///< affected bodies; for `add`, a population with a reserve
  std::optional<Pose> pose;        ///< for `move` the new pose, for `add` the pose of each new body
  /// For `add` without `pose`: box in which the new bodies get random poses; not set: the world's bounds.
  std::optional<Box> region;
  std::optional<SettingSpec> setting;  ///< for `set`: the new parameters; `whom` is then unused
  Where where;                         ///< file position, for messages
};
/// The names of the actions in files, in the order of InterventionSpec::Action.
inline constexpr std::array<std::string_view, 6> k_actions{"remove", "add",  "disable",
                                                           "enable", "move", "set"};

/// Faults that may occur in bodies of a group. Bodies that are born later never have faults.
struct FaultSpec {
  GroupSpec whom;     ///< bodies that may fail; chosen when a world is built or restarted
  double from_s = 0;  ///< earliest world time at which a fault may occur, s
  /// One possible fault of the bodies.
  struct Impairment {
    std::string kind;  ///< name in Registry::faults
    Record params;     ///< one value for each field of the kind's table
  };
  std::vector<Impairment> impairments;  ///< the faults; each occurs independently of the others
  Where where;                          ///< file position, for messages
};

/// The experiment of a world.
struct ExperimentSpec {
  std::vector<StopSpec> stop_when;   ///< the run ends when at least one of these is true
  std::vector<InterventionSpec> at;  ///< interventions, in any order of time
  std::vector<FaultSpec> faults;     ///< faults of bodies that are present at tick 0

  /// Whether the experiment has neither stop conditions nor interventions nor faults. A run of the world then
  /// ends only at its end time, or when the program ends it.
  bool empty() const { return stop_when.empty() && at.empty() && faults.empty(); }
};

}  // namespace troupe::engine
