#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "base/pose.hpp"
#include "engine/spec/measure_spec.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine {

// The experiment of a world file (docs/experiments.md): its stop conditions, interventions (changes to the
// running world) and faults. Time advances in ticks, steps of equal length; tick 0 is the initial state. A
// measure is a number that is computed from the state of a run. A kind is the implementation of a sort of
// measure, fault, device, drive or controller. A population is the set of bodies NAME0, NAME1, ... . Its
// reserve consists of unborn bodies: they are not in the world at tick 0 and can be born later.

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
/// Returns whether `a COMPARISON b` is true. If a or b is NaN, the result is always false, even for
/// Comparison::unequal.
bool holds(double a, Comparison comparison, double b);

/// A stop condition: a comparison of a measure, such as the covered area, with a number.
struct StopSpec {
  MeasureSpec measure;                        ///< left operand
  Comparison comparison = Comparison::below;  ///< operator of `measure COMPARISON value`
  double value = 0;                           ///< right operand, in the SI unit of the measure
};
/// Returns the text of a condition, such as `coverage >= 0.9`: a name, the operator, and the number in its
/// shortest decimal form. The name is MeasureSpec::name. If that is empty, it is the kind of the measure. If
/// the measure is then limited to a group of robots (MeasureSpec::of), `:` and the name of the group follow,
/// as in `stalls:leaders > 10`.
std::string text_of(const StopSpec& condition);

/// A group of bodies on which an intervention or a fault acts: a population, all bodies of a type, or one
/// body. Static bodies never belong to a group. A body is static if it has no drive, no device and no
/// controller, and cannot be gripped or pushed.
///
/// If `count` or `share` is set, the intervention or fault acts on a random selection from the group. If both
/// are set, the one that gives the smaller number of bodies counts. An intervention selects when it is
/// applied. It selects among the bodies that it can change: `remove` among the bodies in the world, `disable`
/// among those that are not disabled, `enable` among the disabled ones. A fault selects among the bodies that
/// are in the world at tick 0.
///
/// A group without bodies is an error, which is reported when the world is built. Two cases are allowed, in
/// which the intervention or fault has no effect:
/// - The group is given by a body type of the world (By::type), the world has no body of this type, and such
///   bodies would not be static.
/// - The group is given by a population (By::population) that the world file defines, but that has no bodies
///   (WorldSpec::empty_populations).
struct GroupSpec {
  /// What `name` refers to.
  enum class By : std::uint8_t {
    population,  ///< the name of a population: NAME for the bodies NAME0, NAME1, ...
    type,        ///< the name of a body type (TypeSpec::name)
    model,       ///< the name or alias of one body
  };
  By by = By::population;  ///< what `name` refers to
  std::string name;        ///< name of the population, type or body
  /// Number of bodies to select, at least 0. If there are fewer bodies, all are selected. Not set: no limit.
  /// For the intervention `add`, it is the number of bodies to add; not set: all unborn bodies of the
  /// reserve. Not used for `move`.
  std::optional<std::int64_t> count;
  /// Fraction of the bodies to select, 0 to 1. The resulting number of bodies is rounded to the nearest
  /// integer, halves up. Not set: no limit. Not used for the interventions `add` and `move`.
  std::optional<double> share;

  /// Number of bodies that the intervention or fault selects at random from `size` candidates.
  std::size_t selected_of(std::size_t size) const;
};

/// New values for some parameters of the drive, of a device or of a controller of a body type. The type must
/// have that drive, device or controller.
struct SettingSpec {
  /// The owner of the parameters.
  enum class Of : std::uint8_t {
    drive,       ///< the drive of the type (TypeSpec::drive)
    device,      ///< the device TypeSpec::devices[SettingSpec::index]
    controller,  ///< the controller TypeSpec::controllers[SettingSpec::index]
  };
  TypeId type;              ///< the type; the change affects all its bodies
  Of of = Of::drive;        ///< the owner of the parameters
  std::uint32_t index = 0;  ///< index of the device or controller in the TypeSpec; unused for Of::drive
  /// One value per field of the kind's table of parameters, in the order of the table. Where there is no
  /// value (Value::given() is false), the parameter does not change.
  Record params;
};

/// Returns a copy of `params` with the values in setting.params in place of the old ones. Where
/// setting.params has no value, the old value stays. `params` and setting.params must have one value for each
/// field of the same table.
Record changed(const Record& params, const SettingSpec& setting);

/// An intervention: a change of the running world that the world file lists, applied between two ticks. Dead
/// bodies are not affected. Unborn bodies are affected only by `add`, which spawns them, and by `set`, which
/// changes parameters of their type.
struct InterventionSpec {
  /// The kind of intervention.
  enum class Action : std::uint8_t {
    remove,   ///< removes the bodies of the group from the world for good
    add,      ///< spawns bodies of the reserve of a population (unborn bodies: ReserveSpec)
    disable,  ///< stops the devices, controllers and drives of the group's bodies
    enable,   ///< lets disabled bodies of the group run again
    /// moves one body to `pose`, even if another body is there; no effect on a carried body
    move,
    set,  ///< changes parameters of a type, for all its bodies
  };
  /// Simulated time, s. The intervention is applied after the first tick that ends at this time or later,
  /// before the next tick begins. Example: with ticks of 0.1 s and the time 0.25 s, it is applied between
  /// tick 3, which ends at 0.3 s, and tick 4. If the time is 0 or less, the intervention is applied before
  /// tick 1.
  double time_s = 0;
  Action action = Action::remove;  ///< kind of intervention
  GroupSpec whom;  ///< affected bodies; for `move`, one body; for `add`, a population with a reserve
  /// A pose, world frame, m and rad. For `move`, it is the new pose of the body; it must be set, and be
  /// within the bounds of the world. For `add`, it is the pose of each new body. If this pose is not free for
  /// a body, this body and the remaining bodies are not added.
  std::optional<Pose> pose;
  /// For `add` without `pose`: box (world frame, m) in which each new body gets a random free pose. The
  /// height of the pose is that of the unborn body in the spec (BodySpec::pose_world_body). Not set: the box
  /// WorldSpec::bounds, which must then be set. If none of 1000 random poses for a body is free, this body
  /// and the remaining bodies are not added.
  std::optional<Box> region;
  std::optional<SettingSpec> setting;  ///< for `set`: the new parameters; `whom` is then unused
  Where where;                         ///< file position, for messages
};
/// The names of the actions in files, in the order of InterventionSpec::Action.
inline constexpr std::array<std::string_view, 6> k_actions{"remove", "add",  "disable",
                                                           "enable", "move", "set"};

/// Faults that may occur during a run in the bodies of a group. Only bodies that are in the world at tick 0
/// can fail.
struct FaultSpec {
  GroupSpec whom;     ///< bodies that may fail; selected when the world is built or restarted
  double from_s = 0;  ///< simulated time from which on faults may occur, s
  /// One possible fault of the bodies.
  struct Impairment {
    std::string kind;  ///< name of a kind of fault (FaultKind::name)
    Record params;     ///< one value for each field of the kind's table (FaultKind::params)
  };
  std::vector<Impairment> impairments;  ///< the faults; each occurs independently of the others
  Where where;                          ///< file position, for messages
};

/// The experiment of a world: when its runs end, and what changes the world during a run.
struct ExperimentSpec {
  std::vector<StopSpec> stop_when;   ///< the run ends after the first tick at which one of these is true
  std::vector<InterventionSpec> at;  ///< interventions, in any order of time
  std::vector<FaultSpec> faults;     ///< faults that may occur

  /// Whether the experiment has neither stop conditions nor interventions nor faults. A run of the world then
  /// ends only at its end time, or when the program ends it.
  bool empty() const { return stop_when.empty() && at.empty() && faults.empty(); }
};

}  // namespace troupe::engine
