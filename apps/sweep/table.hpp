#pragma once

#include "apps/sweep/journal.hpp"
#include "worldio/json/study.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace troupe::apps {

/// The results of all runs of a study (a file that describes many runs of a world), from which the tables are
/// written.
struct SweepTable {
  const worldio::Study& study;        ///< study to which the runs belong
  std::vector<std::string> measures;  ///< names of the columns of SweepOutcome::values
  SweepResults results = {};
};

/// Writes a table with one row per run, in the order of runs:
/// `run,PARAMETERS...,seed,ticks,time_s,MEASURES...,stopped_by,state_hash,error`. pandas reads the table
/// without options. A run without an outcome, because it failed, has 0 as its number of ticks (simulation
/// steps), and `nan` or empty cells for its results. Replaces the file only when the new table is complete.
/// Throws OutputError if writing fails.
void write_csv(const SweepTable& table, const std::filesystem::path& file);
/// Writes the table `run,time_s,MEASURES...` to the file series.csv of the folder, with one row for each time
/// at which a run was measured (Study::measure_every_s), by concatenating the files of all finished runs
/// (series_file()). measures: names of the columns of measures (Measures::columns()). Replaces the file only
/// when the new table is complete. Throws OutputError if the file of a finished run is missing or writing
/// fails.
void write_series(const SweepTable& table, const std::vector<std::string>& measures,
                  const std::filesystem::path& folder);
/// Returns the path of the file with the rows of one run for write_series(), which concatenates these files.
/// The file has no line of column names.
std::filesystem::path series_file(const std::filesystem::path& folder, std::size_t run);
/// Appends one row of the table of write_series() to `rows`. time_s: simulated time at which the run was
/// measured, s; values: the values of the measures at this time.
void add_series_row(std::string& rows, std::size_t run, double time_s, const std::vector<double>& values);

/// Writes the table of write_csv() to an HDF5 file (docs/sweeps.md): each column as a dataset of the group
/// /table, and the names of the columns, in their order, as the dataset /columns. Replaces the file only when
/// it is complete. Throws OutputError if writing fails.
void write_hdf5(const SweepTable& table, const std::filesystem::path& file);

}  // namespace troupe::apps
