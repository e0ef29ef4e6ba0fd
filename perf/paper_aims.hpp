#pragma once

#include "perf/paper_report.hpp"

namespace troupe::perf {

/// Makes the table that compares the measurements of a report with Troupe's performance goals, one row per
/// goal. The goals are the numbers in paper_aims.cpp; those whose scene was not measured are omitted.
Sheet aims_sheet(const Report& report);

}  // namespace troupe::perf
