#pragma once

#include <cstdint>

namespace troupe::engine {

/// The work that a rank (one of the threads or processes that compute a world together) has done in one tick
/// (time step). A rank runs the sensors, drives, devices and controllers of the bodies whose rows in the
/// state tables it owns: sensors in the phase sense, drives and devices in the phase actuate, and controllers
/// in the phase decide. The times are 0 if the transport between the ranks has no clock
/// (partition/transport.hpp).
struct RankWork {
  std::uint64_t rows = 0;  ///< number of bodies whose rows the rank owned
  double sense_s = 0;      ///< time of the phase sense, s
  double actuate_s = 0;    ///< time of the phase actuate, s
  double decide_s = 0;     ///< time of the phase decide, s
};

/// What a rank has counted since its replica (its copy of the world) was made. Only `messages` and `bytes`
/// count since the ranks were connected. For a mean per tick, divide a sum over the ticks by `ticks`.
struct RankCounts {
  std::uint64_t ticks = 0;          ///< number of ticks
  std::uint64_t own = 0;            ///< rows that the rank owned, summed over the ticks
  std::uint64_t ghosts = 0;         ///< ghosts (copies of rows of other ranks), summed over the ticks
  std::uint64_t neighbours = 0;     ///< ranks that own its ghosts or copy its rows, summed over the ticks
  std::uint64_t distributions = 0;  ///< how often the rows were distributed among the ranks again
  std::uint64_t migrated = 0;       ///< number of rows that the rank gave to another owner
  std::uint64_t rounds = 0;         ///< exchanges of outcomes of motions, with one or more ranks at a time
  std::uint64_t messages = 0;       ///< messages sent to other ranks, for all worlds of the program
  std::uint64_t bytes = 0;          ///< total length of these messages, bytes
};

}  // namespace troupe::engine
