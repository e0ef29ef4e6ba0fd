#pragma once

#include "engine/world.hpp"

#include <cstdint>
#include <memory>
#include <string_view>

namespace troupe::perf {

/// An observer of every tick of a run, as in `troupe run` with --hash-log, with --record of poses (10 Hz, one
/// frame per tick of 0.1 s), or with --measures of all measures and --measure-every 0.
enum class Watch : std::uint8_t { nothing, hashes, recording, measures };
std::string_view watch_name(Watch watch);

class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual void look() = 0;
  /// Call after the last tick; writes the remaining data.
  virtual void finish() {}
};

/// Null for Watch::nothing. World and registry must outlive the result.
std::unique_ptr<Watcher> make_watcher(Watch watch, engine::World& world, const engine::Registry& registry);

}  // namespace troupe::perf
