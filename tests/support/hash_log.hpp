#pragma once

#include "troupe/simulation.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace troupe::test {

/// Simulates some ticks. Returns the lines of the hash log of the present tick and of these ticks.
inline std::vector<std::string> hash_log(Simulation& simulation, std::uint64_t ticks) {
  std::vector<std::string> lines{simulation.hash_log_line()};
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    simulation.step();
    lines.push_back(simulation.hash_log_line());
  }
  return lines;
}

}  // namespace troupe::test
