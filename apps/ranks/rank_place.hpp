#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace troupe::apps {

/// Where a rank runs. Ranks are the processes that a launcher such as mpirun has started.
struct RankPlace {
  std::string host;        ///< name of the computer
  std::string processors;  ///< what partition::affinity_list() returns on the rank
};

/// Returns how many ranks, including the rank `rank`, run on the same computer as this rank and may use the
/// same processors. places: one entry per rank
unsigned count_sharing(const std::vector<RankPlace>& places, std::size_t rank);

}  // namespace troupe::apps
