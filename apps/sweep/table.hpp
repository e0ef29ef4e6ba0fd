#pragma once

#include "apps/sweep/journal.hpp"
#include "worldio/json/study.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace troupe::apps {

/// Names of the columns of SweepOutcome::values: `coverage` for the last value, `coverage_mean` for another
/// statistic.
std::vector<std::string> measure_columns(const std::vector<std::string>& measures,
                                         const std::vector<worldio::Statistic>& statistics);

/// The results of all runs of a study, one row per run, in the order of runs. `failed` holds the errors of
/// failed runs, which have no outcome.
struct SweepTable {
  const worldio::Study& study;
  std::vector<std::string> measures;  ///< measure_columns()
  std::map<std::size_t, SweepOutcome> outcomes;
  std::map<std::size_t, std::string> failed;
};

/// Writes `run,PARAMETERS...,seed,ticks,time_s,MEASURES...,stopped_by,state_hash,error`, which pandas reads
/// without options. Replaces the file only when it is complete. Throws OutputError.
void write_csv(const SweepTable& table, const std::filesystem::path& file);
/// Writes `run,time_s,MEASURES...`, one row per sample of each run, from the files of series_file().
/// `measures` are the columns of Measures. Replaces the file only when it is complete. Throws OutputError.
void write_series(const SweepTable& table, const std::vector<std::string>& measures,
                  const std::filesystem::path& folder);
/// The file with the rows of one run, until write_series() concatenates the rows of all runs.
std::filesystem::path series_file(const std::filesystem::path& folder, std::size_t run);
/// Appends the row of one sample.
void add_series_row(std::string& rows, std::size_t run, double time_s, const std::vector<double>& values);

/// Writes the columns of write_csv() as datasets of the group /table, and their order as /columns
/// (docs/sweeps.md). Throws OutputError.
void write_hdf5(const SweepTable& table, const std::filesystem::path& file);

}  // namespace troupe::apps
