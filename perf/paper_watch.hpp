#pragma once

#include "engine/world.hpp"

#include <cstdint>
#include <memory>
#include <string_view>

namespace troupe::perf {

/// What looks on at every tick of a run: what `troupe run` does for --hash-log, for --record with poses (at
/// 10 Hz, where a tick is 0.1 s), and for --measures with all measures and --measure-every 0.
enum class Watch : std::uint8_t { nothing, hashes, recording, measures };
std::string_view watch_name(Watch watch);

class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual void look() = 0;
  /// After the last tick: what is still to be written.
  virtual void finish() {}
};

/// Null where nothing looks on. World and registry must outlive it.
std::unique_ptr<Watcher> make_watcher(Watch watch, engine::World& world, const engine::Registry& registry);

}  // namespace troupe::perf
