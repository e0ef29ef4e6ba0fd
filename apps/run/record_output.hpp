#pragma once

#include "apps/run/run_output.hpp"

namespace troupe::apps {

/// The output of --record, --record-every and --record-fields, which fill RunOptions::record and ::recording
/// for the recorder.
std::unique_ptr<RunOutput> record_output();

}  // namespace troupe::apps
