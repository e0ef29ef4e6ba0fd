#pragma once

#include "engine/fields/description.hpp"

#include <cstdint>

namespace troupe::engine {

inline constexpr double k_most_rate = 1e9;                      ///< largest allowed WatchSpec::rate
inline constexpr std::int64_t k_most_clock_ticks = 1000000000;  ///< largest allowed WatchSpec::clock_ticks

/// Settings of a world file for watching a run: a limit of the speed of the run, and whether and how often
/// the program prints the simulated time. No setting affects a result. A tick is a time step.
struct WatchSpec {
  bool clock = false;               ///< whether the program prints the simulated time during the run
  std::uint64_t clock_ticks = 100;  ///< ticks from one printed time to the next, if `clock` is true
  /// Highest speed of a run with the command-line option `--rate world`, as a multiple of real time; 0: no
  /// limit.
  double rate = 1;
  bool paused = false;  ///< whether the window of the simulator Stage starts paused; no effect in Troupe
  friend bool operator==(const WatchSpec&, const WatchSpec&) = default;

  static constexpr void describe(Description<WatchSpec>& d) {
    using namespace facts;
    d.member<&WatchSpec::clock>("clock", "true: the run prints the simulated time");
    d.member<&WatchSpec::clock_ticks>("clock_ticks", within(1, k_most_clock_ticks),
                                      "number of ticks from one printed time to the next");
    d.member<&WatchSpec::rate>(
        "rate", within(0, k_most_rate),
        "speed of a run with the option `--rate world`, as a multiple of real time; 0: as fast as possible");
    d.member<&WatchSpec::paused>("paused", "true: Stage's window starts paused; without effect in Troupe");
  }
};

/// Returns the table that describes the settings in files: the name, type, limits and meaning of each. Their
/// order in the table is `clock`, `clock_ticks`, `rate`, `paused`.
const FieldTable& watch_fields();
/// Returns the settings as a record: a list with one value per setting, in the order of watch_fields().
Record watch_record(const WatchSpec& watch);
/// Returns the settings from a record that watch_record() or a reader of files has made.
WatchSpec watch_spec(const Record& record);

}  // namespace troupe::engine
