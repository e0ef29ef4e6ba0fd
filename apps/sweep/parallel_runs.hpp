#pragma once

#include "apps/ranks/rank_deal.hpp"
#include "apps/sweep/journal.hpp"
#include "apps/sweep/sweep.hpp"
#include "worldio/json/study.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace troupe::apps {

/// Makes the runs with these indices in parallel. columns: names of the measures in the tables. When a run
/// finishes or fails, writes its result or its error to the journal. Returns the errors of failed runs, by
/// index. Throws the error if the result of a run cannot be written, and then writes no further result.
/// During the runs, tells the other ranks that this rank is at work.
std::map<std::size_t, std::string> make_runs(const worldio::Study& study,
                                             const std::vector<std::size_t>& runs,
                                             const std::vector<std::string>& columns,
                                             const SweepOptions& options, SweepJournal& journal,
                                             RankDeal& deal);

}  // namespace troupe::apps
