#pragma once

#include "engine/description.hpp"

#include <cstdint>

namespace troupe::engine {

inline constexpr double k_most_rate = 1e9;                      ///< of WatchSpec::rate
inline constexpr std::int64_t k_most_clock_ticks = 1000000000;  ///< of WatchSpec::clock_ticks

/// How a world asks to be watched while it runs. Nothing of it changes a result.
struct WatchSpec {
  bool clock = false;               ///< tell the time as the run goes on
  std::uint64_t clock_ticks = 100;  ///< how often
  double rate = 1;      ///< times real time, for who wants the world's own pace; 0: as fast as possible
  bool paused = false;  ///< who shows the world in a window begins at rest
  friend bool operator==(const WatchSpec&, const WatchSpec&) = default;

  static constexpr void describe(Description<WatchSpec>& d) {
    using namespace facts;
    d.member<&WatchSpec::clock>("clock", "print the simulated time during the run");
    d.member<&WatchSpec::clock_ticks>("clock_ticks", within(1, k_most_clock_ticks),
                                      "ticks from one such line to the next");
    d.member<&WatchSpec::rate>("rate", within(0, k_most_rate),
                               "pace for `--rate world`, as a multiple of real time; 0: as fast as possible");
    d.member<&WatchSpec::paused>("paused", "a window starts paused");
  }
};

/// The same as a block of parameters, for files: `clock`, `clock_ticks`, `rate`, `paused`.
const FieldTable& watch_fields();
Record watch_record(const WatchSpec& watch);  ///< by watch_fields()
WatchSpec watch_spec(const Record& record);   ///< of a record by watch_fields()

}  // namespace troupe::engine
