#pragma once

#include <cstdint>

namespace troupe::engine {

/// The work that a rank (one of the threads or processes that compute a world together, engine/replica.hpp)
/// has done in a tick for the rows that it owns. The times are 0 if the transport between the ranks has no
/// clock (partition/transport.hpp).
struct RankWork {
  std::uint64_t rows = 0;  ///< number of rows that it owned
  double sense_s = 0;      ///< time of the phase sense, s
  double actuate_s = 0;    ///< time of the phase actuate, s
  double decide_s = 0;     ///< time of the phase decide, s
};

}  // namespace troupe::engine
