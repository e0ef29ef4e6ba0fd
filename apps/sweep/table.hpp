#pragma once

#include "apps/sweep/journal.hpp"
#include "worldio/json/study.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace troupe::apps {

/// Returns the names of the columns of SweepOutcome::values: for each measure one column per statistic. For
/// the measure `coverage`, the statistic `last` is in the column `coverage` and `mean` in `coverage_mean`.
std::vector<std::string> measure_columns(const std::vector<std::string>& measures,
                                         const std::vector<worldio::Statistic>& statistics);

/// The results of all runs of a study, from which the tables are written.
struct SweepTable {
  const worldio::Study& study;                   ///< study to which the runs belong
  std::vector<std::string> measures;             ///< names of the columns of SweepOutcome::values
  std::map<std::size_t, SweepOutcome> outcomes;  ///< results of finished runs, by index of the run
  std::map<std::size_t, std::string> failed;     ///< errors of failed runs, which have no outcome
};

/// Writes a table with one row per run, in the order of runs:
/// `run,PARAMETERS...,seed,ticks,time_s,MEASURES...,stopped_by,state_hash,error`. pandas reads it without
/// options. Replaces the file only when it is complete. Throws OutputError.
void write_csv(const SweepTable& table, const std::filesystem::path& file);
/// Writes the table `run,time_s,MEASURES...` into the folder, with one row per sample of each run, by
/// concatenating the files of series_file(). measures: names of the columns of measures
/// (Measures::columns()). Replaces the file only when it is complete. Throws OutputError.
void write_series(const SweepTable& table, const std::vector<std::string>& measures,
                  const std::filesystem::path& folder);
/// Returns the path of the file with the samples of one run, without a line of column names. write_series()
/// concatenates these files.
std::filesystem::path series_file(const std::filesystem::path& folder, std::size_t run);
/// Appends the row of one sample of a run, as in write_series(), to `rows`.
void add_series_row(std::string& rows, std::size_t run, double time_s, const std::vector<double>& values);

/// Writes the table of write_csv() to an HDF5 file (docs/sweeps.md): each column as a dataset of the group
/// /table, and the names of the columns, in their order, as the dataset /columns. Throws OutputError.
void write_hdf5(const SweepTable& table, const std::filesystem::path& file);

}  // namespace troupe::apps
