#pragma once

#include "apps/diff/diff.hpp"
#include "apps/exit_code.hpp"

#include <filesystem>

namespace troupe::apps {

/// Whether a file is a table of results that `troupe sweep` wrote (write_csv()). False if it cannot be read.
bool is_results_table(const std::filesystem::path& file);

/// Compares two tables of results of `troupe sweep`, row by row, and prints the rows that differ. Rows with
/// the same number of the run are compared, in the columns that both tables have. Throws InputError if one of
/// the files is no such table.
ExitCode diff_tables(const DiffOptions& options);

}  // namespace troupe::apps
