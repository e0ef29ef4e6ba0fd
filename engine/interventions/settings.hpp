#pragma once

#include "base/ids.hpp"
#include "base/result.hpp"
#include "engine/interventions/experiment.hpp"
#include "engine/spec/world_spec.hpp"
#include "engine/state/world_state.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace troupe::engine {

/// The changes of parameters of a world: the interventions `set`, and those that a program makes during a
/// run. A *setting* is *in force* if its parameters are those with which the types now run.
class Settings {
 public:
  /// By type id: the specs of the types that settings change, with all settings so far applied.
  using Types = std::map<std::uint32_t, TypeSpec>;

  /// The arguments must outlive the object.
  Settings(WorldState& state, Experiment& experiment) : state_(state), experiment_(experiment) {}
  Settings(const Settings&) = delete;
  Settings& operator=(const Settings&) = delete;

  /// Compiles a change of parameters, `setting`, into `intervention`. `type` is the type whose parameters
  /// change, with those of tick 0. Adds the change to `types`. The error says what is wrong with the change.
  Result<> build(const SettingSpec& setting, const Registry& registry, const BodyType& type, Types& types,
                 Experiment::Intervention& intervention) const;
  /// Calls the hook `bind_world` of devices and controllers again, after poses or colours in the spec have
  /// changed: their kinds have stored places, contours or colours of bodies. No setting may be in force.
  /// Throws std::logic_error if a kind rejects the new bodies.
  void bind_kinds_again(const Registry& registry);

  /// Whether an intervention changes parameters.
  bool is_setting(const Experiment::Intervention& intervention) const;
  /// Applies a setting if it is not in force, and otherwise undoes it: swaps the prepared data of the
  /// intervention with the present data of the type. No memory is thus allocated during a run.
  void swap(Experiment::Intervention& intervention);
  void swap_first(std::size_t count);       ///< applies those among the first `count` interventions in order
  void swap_first_back(std::size_t count);  ///< undoes them, the last one first
  /// Inserts a setting after the interventions of the present tick. Applies it, unless interventions of this
  /// tick are still due. Interventions::find_due() must follow.
  Result<> insert(const SettingSpec& setting, const Registry& registry);
  /// Undoes the changes of all calls of insert(). No setting is in force afterwards.
  void forget();
  /// The spec of a type with its present parameters.
  TypeSpec present_type(TypeId type) const { return type_at(type, experiment_.next); }
  /// Longest reach of a device, m, over the whole run (DeviceKind::Prepared::reach_m). All types that are not
  /// static count. For each of their devices, the present parameters count, and all parameters that
  /// interventions set.
  double longest_reach() const;

 private:
  class Undone;
  std::size_t find_basis(TypeId type, std::size_t count) const;
  TypeSpec type_at(TypeId type, std::size_t count) const;
  Result<std::vector<std::pair<std::size_t, Experiment::Intervention>>> build_from(
      std::size_t first, TypeId changed_type, const Registry& registry, const BodyType& type, Types& types);

  WorldState& state_;
  Experiment& experiment_;
};

}  // namespace troupe::engine
