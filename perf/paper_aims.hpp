#pragma once

#include "perf/paper_report.hpp"

namespace troupe::perf {

/// The performance goals and the values in the report, one row per goal. Goals without a measurement are
/// omitted.
Sheet aims_sheet(const Report& report);

}  // namespace troupe::perf
