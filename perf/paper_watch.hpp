#pragma once

#include "engine/world/world.hpp"

#include <cstdint>
#include <memory>
#include <string_view>

namespace troupe::perf {

/// The observer of a run, which reads the state after every tick (time step):
/// - `nothing`: there is no observer.
/// - `hashes` computes a hash of the whole state, as `troupe run --hash-log` does.
/// - `recording` records the poses of every tick in a file, as `troupe run --record` does.
/// - `measures` computes measures, which are numbers such as the mean speed: those that `troupe run` computes
///   with the options `--measures FILE --measure-every 0`.
enum class Watch : std::uint8_t { nothing, hashes, recording, measures };
/// The name of an observer in tables and messages, such as "hashes".
std::string_view watch_name(Watch watch);

/// The interface of the observers.
class Watcher {
 public:
  virtual ~Watcher() = default;
  /// Reads the state. Must be called after each tick.
  virtual void look() = 0;
  /// Must be called after the last tick; writes data that are still buffered.
  virtual void finish() {}
};

/// Makes an observer; null for Watch::nothing. World and registry must outlive the observer.
std::unique_ptr<Watcher> make_watcher(Watch watch, engine::World& world, const engine::Registry& registry);

}  // namespace troupe::perf
