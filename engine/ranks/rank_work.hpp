#pragma once

#include <cstdint>

namespace troupe::engine {

/// The work that a rank (one of the threads or processes that compute a world together) has done in one tick,
/// for the bodies whose rows in the state tables it owns (engine/ranks/replica.hpp). The times are 0 if the
/// transport between the ranks has no clock (partition/transport.hpp).
struct RankWork {
  std::uint64_t rows = 0;  ///< number of bodies whose rows the rank owned
  double sense_s = 0;      ///< time of the phase sense, s
  double actuate_s = 0;    ///< time of the phase actuate, s
  double decide_s = 0;     ///< time of the phase decide, s
};

/// What a rank has counted since its replica of the world was made. For a mean per tick, divide a sum over
/// the ticks by `ticks`.
struct RankCounts {
  std::uint64_t ticks = 0;          ///< ticks
  std::uint64_t own = 0;            ///< own rows, summed over the ticks
  std::uint64_t ghosts = 0;         ///< ghosts (class Halo), summed over the ticks
  std::uint64_t neighbours = 0;     ///< ranks with which it has ghosts in common, summed over the ticks
  std::uint64_t distributions = 0;  ///< how often the rows were distributed
  std::uint64_t migrated = 0;       ///< rows that went to another rank
  std::uint64_t rounds = 0;         ///< exchanges of outcomes of motions, with one or more ranks at a time
  std::uint64_t messages = 0;       ///< messages sent to other ranks
  std::uint64_t bytes = 0;          ///< total length of these messages, bytes
};

}  // namespace troupe::engine
