#pragma once

#include "apps/sweep/journal.hpp"
#include "apps/sweep/sweep.hpp"
#include "base/diagnostics.hpp"
#include "worldio/json/study.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace troupe::apps {

/// What a sweep knows of the worlds of its study.
struct SweepIdentity {
  /// Identifies the study in journals: a hash of the study file, the worlds with their images, plug-ins and
  /// scripts (--controller), and the version of the program. It does not depend on the folders of the files.
  std::string text;
  StudyFacts facts;                   ///< `text` in parts, each with its name, for users
  std::vector<std::string> measures;  ///< names of the columns of its measures
  std::uint64_t world_seed = 0;       ///< the seed of the loaded world
};

/// Loads the world of a run, so that errors in the worlds of all runs are reported before any run, and
/// returns the identity of the study. Throws InputError if no world can be loaded, or if columns of measures
/// have the same name. Errors name the positions of parameters in the study.
///
/// shows_warnings: whether to print the warnings about the world
SweepIdentity identify(const worldio::Study& study, const SweepOptions& options, bool shows_warnings,
                       Diagnostics& diagnostics);

}  // namespace troupe::apps
