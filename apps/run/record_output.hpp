#pragma once

#include "apps/run/run_output.hpp"

namespace troupe::apps {

/// Returns a new output with the options --record, --record-every and --record-fields. Parsing stores the
/// values of these options in RunOptions::record and RunOptions::recording, with which make_recorder() opens
/// the recording.
std::unique_ptr<RunOutput> record_output();

}  // namespace troupe::apps
