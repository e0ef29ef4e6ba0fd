#pragma once

#include "perf/paper_report.hpp"

namespace troupe::perf {

/// What this simulator is meant to reach, and what the report says of it: one line an aim, none for what was
/// not run.
Sheet aims_sheet(const Report& report);

}  // namespace troupe::perf
