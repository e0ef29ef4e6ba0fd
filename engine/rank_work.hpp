#pragma once

#include <cstdint>

namespace troupe::engine {

/// What a rank has done for its own rows in a tick. The times are 0 if the ranks have no clock.
struct RankWork {
  std::uint64_t rows = 0;  ///< number of rows that it owned
  double sense_s = 0;      ///< time of the phase sense, s
  double actuate_s = 0;    ///< time of the phase actuate, s
  double decide_s = 0;     ///< time of the phase decide, s
};

}  // namespace troupe::engine
