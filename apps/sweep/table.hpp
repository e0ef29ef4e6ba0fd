#pragma once

#include "apps/sweep/journal.hpp"
#include "worldio/json/study.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace troupe::apps {

/// Names of the columns that the measures of a study have, beside SweepOutcome::values: `coverage`, or with a
/// statistic other than the last value `coverage_mean`.
std::vector<std::string> measure_columns(const std::vector<std::string>& measures,
                                         const std::vector<worldio::Statistic>& statistics);

/// What all runs of a study came to: a row a run, in their order. `failed`: of runs that could not be made,
/// why; they have no outcome.
struct SweepTable {
  const worldio::Study& study;
  std::vector<std::string> measures;  ///< measure_columns()
  std::map<std::size_t, SweepOutcome> outcomes;
  std::map<std::size_t, std::string> failed;
};

/// `run,PARAMETERS...,seed,ticks,time_s,MEASURES...,stopped_by,state_hash,error`, as pandas reads it without
/// options. Written whole or not at all. Throws OutputError.
void write_csv(const SweepTable& table, const std::filesystem::path& file);
/// `run,time_s,MEASURES...`: a row for each look of each run, of the files that runs have left. `measures`:
/// as the world names them. Written whole or not at all. Throws OutputError.
void write_series(const SweepTable& table, const std::vector<std::string>& measures,
                  const std::filesystem::path& folder);
/// The rows of one run, in a file of its own until all are there.
std::filesystem::path series_file(const std::filesystem::path& folder, std::size_t run);
/// Appends the row of a look.
void add_series_row(std::string& rows, std::size_t run, double time_s, const std::vector<double>& values);

/// The same columns as datasets of the group /table, and their order as /columns (docs/sweeps.md).
void write_hdf5(const SweepTable& table, const std::filesystem::path& file);

}  // namespace troupe::apps
