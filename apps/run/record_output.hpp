#pragma once

#include "apps/run/run_output.hpp"

namespace troupe::apps {

/// The output of --record, --record-every and --record-fields. The options are stored in RunOptions::record
/// and RunOptions::recording, from which make_recorder() opens the recording.
std::unique_ptr<RunOutput> record_output();

}  // namespace troupe::apps
