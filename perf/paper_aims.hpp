#pragma once

#include "perf/paper_report.hpp"

namespace troupe::perf {

/// Makes the table that compares the measurements of a report with Troupe's performance goals. Each goal is
/// one row. A goal is omitted if the scene (simulated world) that it refers to was not measured. The goals
/// are defined in paper_aims.cpp.
Sheet aims_sheet(const Report& report);

}  // namespace troupe::perf
