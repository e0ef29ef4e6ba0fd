#pragma once

#include "engine/world.hpp"

#include <cstdint>
#include <memory>
#include <string_view>

namespace troupe::perf {

/// An observer that reads the state after every tick of a run, as `troupe run` does with --hash-log (hashes),
/// with --record of poses at 10 Hz, which is one frame per tick of 0.1 s (recording), or with --measures of
/// all measures and --measure-every 0 (measures).
enum class Watch : std::uint8_t { nothing, hashes, recording, measures };
/// The name of an observer in tables and messages, such as "hashes".
std::string_view watch_name(Watch watch);

/// The interface of the observers.
class Watcher {
 public:
  virtual ~Watcher() = default;
  /// Must be called after each tick.
  virtual void look() = 0;
  /// Must be called after the last tick; writes data that are still buffered.
  virtual void finish() {}
};

/// Makes an observer; null for Watch::nothing. World and registry must outlive the observer.
std::unique_ptr<Watcher> make_watcher(Watch watch, engine::World& world, const engine::Registry& registry);

}  // namespace troupe::perf
