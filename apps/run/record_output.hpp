#pragma once

#include "apps/run/run_output.hpp"

namespace troupe::apps {

/// Returns the output of a run (an object with command-line options, see RunOutput) that records the run into
/// an HDF5 file (Recorder). It adds the options --record, --record-every and --record-fields to the command
/// line. Parsing stores their values in RunOptions::record and RunOptions::recording, with which
/// make_recorder() opens the recording. Without --record, the run is recorded only if the world file names a
/// recording.
std::unique_ptr<RunOutput> record_output();

}  // namespace troupe::apps
