#pragma once

#include "apps/run/run_output.hpp"

namespace troupe::apps {

/// Returns the output that records a run into an HDF5 file. An output writes files of a run and has
/// command-line options (class RunOutput); this output has --record, --record-every and --record-fields.
/// Without --record, it records the run only if the world file names a file for the recording.
std::unique_ptr<RunOutput> record_output();

}  // namespace troupe::apps
