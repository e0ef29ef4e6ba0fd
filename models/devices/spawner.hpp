#pragma once

#include "engine/fields/description.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/kinds/kinds.hpp"

#include <cstdint>

namespace troupe::models {

/// The command of a spawner, a device that brings new bodies (robots or objects) into the world during the
/// run. This is called the birth of the body. A controller requests n births by increasing `request` by n: n
/// more births then become due.
struct SpawnerCommand {
  std::uint32_t request = 0;  ///< number of births requested so far

  static constexpr void describe(engine::Description<SpawnerCommand>& d) {
    d.member<&SpawnerCommand::request>("request", "number of births requested so far");
  }

  void ask() { ++request; }  ///< requests one more birth
};

/// State of a spawner.
struct SpawnerState {
  /// Number of flags (coloured tokens, which bodies exchange) that the spawner's body had received when the
  /// spawner last ran; 0 if the parameter `per_flags` is 0.
  std::uint64_t flags = 0;
  std::uint32_t born = 0;     ///< number of bodies spawned since the birth of the spawner's body
  std::uint32_t owed = 0;     ///< number of births that are due but have not succeeded yet
  std::uint32_t refused = 0;  ///< number of tries that failed: the place was occupied or out of bounds
  std::uint32_t request = 0;  ///< the value of SpawnerCommand::request that was counted last
  std::uint32_t last = 0;     ///< id + 1 of the body that was spawned last; 0: none
  std::uint8_t status = 0;    ///< result of the last try, an engine::BirthStatus

  static constexpr void describe(engine::Description<SpawnerState>& d) {
    d.member<&SpawnerState::flags>("flags",
                                   "number of flags that the spawner's body had received when the spawner "
                                   "last ran; 0 if the parameter `per_flags` is 0");
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

/// Returns the definition of the device `spawner`, which spawns bodies of a population (an entry of the world
/// file that creates many bodies) from its reserve. The reserve holds the bodies of the population that are
/// not in the world at the start. A spawner can model a nest, a door or a factory.
///
/// when    A birth becomes due in three cases: every `every` seconds of the life of the spawner's body; each
///         time other bodies have given `per_flags` more flags (tokens) to this body; and for each request of
///         a controller (SpawnerCommand). `every` and `per_flags` are parameters; with 0, they cause no
///         births. A birth stays due until it succeeds. In each tick (simulation step), the spawner tries at
///         most one birth.
/// where   Bodies are born at the pose of the spawner. With `within` (m) above 0, they are born at a random
///         position in the circle of this radius around the spawner, with a random heading. Each try uses a
///         new random pose. If another body or a wall occupies the place, or if the place is outside the
///         bounds of the world, the try fails, and the spawner tries again in the next tick.
/// which   The next body of the reserve is born (docs/lives.md). Births that become due when the reserve is
///         used up are cancelled.
/// state   SpawnerState; commands: SpawnerCommand
engine::DeviceKind spawner_kind();

}  // namespace troupe::models
