#pragma once

#include "apps/run/run_output.hpp"

namespace troupe::apps {

/// --record, --record-every, --record-fields: RunOptions::record and ::recording, which the recorder reads.
std::unique_ptr<RunOutput> record_output();

}  // namespace troupe::apps
