#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/device_kind.hpp"

#include <cstdint>

namespace troupe::models {

/// The command of a spawner, a device that brings new bodies (robots or objects) into the world during the
/// run. This is called the birth of a body. To request n births, a controller increases `request` by n. If it
/// lowers `request`, for example to 0, it requests nothing; the next births are counted from the lower
/// number.
struct SpawnerCommand {
  std::uint32_t request = 0;  ///< number of births requested so far

  static constexpr void describe(engine::Description<SpawnerCommand>& d) {
    d.member<&SpawnerCommand::request>("request", "number of births requested so far");
  }

  void ask() { ++request; }  ///< requests one more birth
};

/// State of a spawner. A birth is due from the time at which something causes it (see spawner_kind()) until
/// it succeeds.
struct SpawnerState {
  /// Number of flags (coloured tokens) that other bodies had given to the spawner's body when the spawner ran
  /// last, without the flags in `uncounted`.
  std::uint64_t flags = 0;
  /// Number of flags that other bodies had given to the spawner's body while the parameter `per_flags` was 0.
  /// They cause no births, also if an intervention or a user changes the parameter later.
  std::uint64_t uncounted = 0;
  std::uint32_t born = 0;     ///< number of bodies that the spawner has brought into the world
  std::uint32_t owed = 0;     ///< number of births that are due
  std::uint32_t refused = 0;  ///< number of tries that failed: the place was occupied or out of bounds
  std::uint32_t request = 0;  ///< value of SpawnerCommand::request when the spawner ran last
  std::uint32_t last = 0;     ///< id + 1 of the body that was spawned last; 0: none
  std::uint8_t status = 0;    ///< result of the last try, an engine::BirthStatus

  static constexpr void describe(engine::Description<SpawnerState>& d) {
    d.member<&SpawnerState::flags>("flags",
                                   "number of flags that the spawner's body had received when the spawner "
                                   "last ran, without those in `uncounted`");
    d.member<&SpawnerState::uncounted>("uncounted", engine::facts::is_sparse,
                                       "number of flags that the spawner's body had received while the "
                                       "parameter `per_flags` was 0");
    d.member<&SpawnerState::born>("born", "number of bodies spawned since the birth of the spawner's body");
    d.member<&SpawnerState::owed>("owed", "number of births that are due but have not succeeded yet");
    d.member<&SpawnerState::refused>("refused",
                                     "number of failed births: the place was occupied or out of bounds");
    d.member<&SpawnerState::request>("request", "value of `request` in the command that was last read");
    d.member<&SpawnerState::last>("last", "id + 1 of the body that was spawned last; 0: none");
    d.member<&SpawnerState::status>("status",
                                    "result of the last attempted birth: 0: none, 1: born, 2: occupied or "
                                    "out of bounds, 3: the reserve is used up");
  }
};

/// Returns the definition of the device `spawner`: it brings new bodies of a population into the world, which
/// is called a birth. A population is an entry of the world file that creates many bodies; the parameter
/// `population` names it. Its reserve is the set of those of its bodies that are not in the world at the
/// start. A spawner can model a nest, a door or a factory.
///
/// causes  A birth becomes due
///         - every `every` seconds, counted from the time at which the spawner's own body came into the
///           world; 0: never. The birth is due in the first tick that ends at this time or later. Times below
///           the length of a tick count as this length
///         - each time other bodies have given `per_flags` more flags (tokens) to the spawner's body; 0:
///           never. If the parameter is 0 at first and changes during the run, flags count from then on
///         - for each request of a controller (SpawnerCommand)
///         `every` and `per_flags` are parameters.
/// when    In each tick (time step) in which a birth is due, the spawner tries one birth. The birth
///         stays due until it succeeds.
/// where   The new body gets the pose of the spawner. If the parameter `within` (m) is above 0, it gets a
///         random position in the circle with this radius around the spawner, and a random heading; each try
///         uses another pose. The try fails if another body or a wall occupies the place, or if the place is
///         outside the bounds of the world.
/// which   The next body of the reserve is born (docs/lives.md). If the reserve is used up, all births that
///         are due are cancelled.
/// state   SpawnerState; commands: SpawnerCommand
engine::DeviceKind spawner_kind();

}  // namespace troupe::models
