#pragma once

#include "perf/paper_report.hpp"

namespace troupe::perf {

/// Makes the table that compares the measurements of a report with Troupe's performance goals, one row per
/// goal. The goals are the numbers in paper_aims.cpp. A goal is omitted if its scene (simulated world) was
/// not measured.
Sheet aims_sheet(const Report& report);

}  // namespace troupe::perf
