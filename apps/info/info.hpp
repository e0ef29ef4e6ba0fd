#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"

#include <filesystem>

namespace troupe::apps {

struct InfoOptions {
  std::filesystem::path file;  ///< file to summarise
  KindSources sources;         ///< plug-ins and scripts with which a world or a study will run
};

/// Adds the options of `info`; parsing fills `options`, which must outlive `command`.
void add_info_options(CLI::App& command, InfoOptions& options);

/// `troupe info FILE`: detects the type of a file from its content, and prints the type and a summary on
/// standard output. Throws InputError if the file cannot be read, or if it is not one of these:
///
/// - a world, in Stage's syntax or in JSON
/// - a hash log: hashes of the state after each tick (time step)
/// - a recording: fields of the state over time
/// - a checkpoint: saved state of a run
/// - a table of measures (numbers computed from the state) or of events
/// - a profile: timing of a run
/// - a study (many runs of a world), a table of the results of its runs, or the journal of `troupe sweep`
/// - a session: actions of users during a run
ExitCode info(const InfoOptions& options);

}  // namespace troupe::apps
