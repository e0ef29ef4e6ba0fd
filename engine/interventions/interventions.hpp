#pragma once

#include "base/diagnostics.hpp"
#include "base/ids.hpp"
#include "base/pose.hpp"
#include "base/result.hpp"
#include "engine/conflicts/movement.hpp"
#include "engine/interventions/experiment.hpp"
#include "engine/interventions/faults.hpp"
#include "engine/interventions/settings.hpp"
#include "engine/rows/lives.hpp"
#include "engine/rows/places.hpp"
#include "engine/rows/ranks.hpp"
#include "engine/state/world_state.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace troupe::engine {

class Groups;  // engine/interventions/groups.hpp

/// The changes of a world that happen at given times: interventions, settings and faults, and which of them
/// are due.
class Interventions {
 public:
  /// The arguments must outlive the object.
  Interventions(WorldState& state, Movement& movement, Places& places, Lives& lives, const RankPort& ranks)
      : state_(state), movement_(movement), places_(places), lives_(lives), ranks_(ranks) {}
  Interventions(const Interventions&) = delete;
  Interventions& operator=(const Interventions&) = delete;

  // ---- Compiling the spec
  /// Compiles the interventions and faults of the spec. Throws InputError if one of them has errors.
  void build(const Registry& registry, Diagnostics& diagnostics);
  /// Adds the component `condition` to the tables, if bodies can be disabled or have faults.
  void build_conditions();
  /// Compiles again what depends on the seed and on the bodies of the spec, after they have changed, and
  /// undoes all settings of set(). are_new_bodies: whether poses or colours have changed
  void rebuild(bool are_new_bodies, const Registry& registry, Diagnostics& diagnostics);

  // ---- Derived data
  /// Computes from the tick which interventions have been applied: those whose tick is before the present
  /// one. The next step applies the interventions of the present tick.
  void derive();
  void count_impaired();  ///< counts the rows whose bodies are disabled or have a fault
  bool hold() const;      ///< whether the component `condition` is consistent
  void forget();          ///< for tests: overwrites the derived data with junk

  // ---- Running
  /// Whether interventions or fault events are due at the end of the last completed tick.
  bool are_due() const { return state_.now.tick >= experiment_.due; }
  /// Applies the interventions and fault events that are due. Interventions come first, in the order of the
  /// file; fault events follow. If the rows are distributed among ranks, each rank applies them to its own
  /// rows and to its ghosts.
  void apply_due();
  /// Disables a body, or enables it if it is disabled. The world must have the component `condition`.
  void toggle_disabled(Row row);

  // ---- Settings of a program
  /// Changes parameters of a type at the present tick: see World::set().
  Result<> set(const SettingSpec& setting, const Registry& registry);
  void forget_settings() { settings_.forget(); }  ///< undoes the changes of all calls of set()
  /// Number of calls of set() that have changed parameters since forget_settings().
  std::size_t settings_made() const { return experiment_.made; }
  /// Number of changes by set() in the present tick.
  std::uint64_t settings_now() const;
  /// The state was restored: `settings` changes by set() belong to the present tick.
  void restore_settings(std::uint64_t settings) { experiment_.present = {state_.now.tick, settings}; }
  const Settings& settings() const { return settings_; }  ///< the present parameters of types

 private:
  void build_intervention(Experiment::Intervention& intervention, const Registry& registry, Groups& groups,
                          Settings::Types& types, Diagnostics& diagnostics);
  void find_due();
  bool carry_out(Experiment::Intervention& intervention);
  bool move_body(const Experiment::Intervention& intervention);
  void list_candidates(const Experiment::Intervention& intervention);
  bool remove_all(std::span<const Candidate> chosen);
  bool add(const Experiment::Intervention& intervention);
  Pose place_to_add(const Experiment::Intervention& intervention, std::uint32_t number,
                    std::uint32_t trial) const;

  WorldState& state_;
  Movement& movement_;
  Places& places_;
  Lives& lives_;
  const RankPort& ranks_;
  // Derived, except its lists of interventions, which only set() extends, and faults, which are constant.
  Experiment experiment_;
  Settings settings_{state_, experiment_};
  Faults faults_{state_, experiment_};
};

}  // namespace troupe::engine
