#pragma once

#include "apps/sweep/journal.hpp"
#include "worldio/json/study.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::worldio {
class Hdf5File;
}

namespace troupe::apps {

/// The results of all runs of a study, from which the tables are written. A study is a file that describes
/// many runs of a world. A measure is a number that is computed from the state at intervals.
struct SweepTable {
  const worldio::Study& study;        ///< study to which the runs belong
  std::vector<std::string> measures;  ///< names of the columns of SweepOutcome::values
  std::uint64_t world_seed = 0;       ///< the seed of the world
  SweepResults results = {};
  StudyFacts facts = {};  ///< what the results depend on
};

/// Returns the value of a parameter, JSON text, as it appears in the tables: a JSON string has no quotes
/// there, unless it contains escapes.
std::string shown_value(const std::string& json);

/// Writes a table with one row per run, in the order of the runs in the study. The columns are
/// `run,PARAMETERS...,seed,ticks,time_s,MEASURES...,stopped_by,state_hash,error`. pandas.read_csv() reads the
/// table without options. For a failed run, `ticks` is 0, and `seed` is `nan` if a parameter of the study
/// sets it to a value that is no seed; the other results are `nan` or empty. A whole number that has no equal
/// double is written as in the study. Replaces the file only when the new table is complete. Throws
/// OutputError if writing fails.
void write_csv(const SweepTable& table, const std::filesystem::path& file);
/// The text with which a table of write_csv() begins.
inline constexpr std::string_view k_results_mark = "run,";
/// Whether a file that begins with the text `start` is a table of write_csv(). The text must contain the
/// line of column names.
bool is_start_of_results(std::string_view start);
/// The text with which a table of write_series() begins.
inline constexpr std::string_view k_series_mark = "run,time_s";
/// Writes the file series.csv in `folder`: the table `run,time_s,MEASURES...`. It has one row for each time
/// at which the measures of a run were computed (Study::measure_every_s). The rows come from the files of the
/// finished runs (series_rows()). Replaces series.csv only when the new table is complete. Throws OutputError
/// if the rows of a finished run are missing or writing fails.
///
/// measures: names of the columns of measures, as Measures::columns() returns them
void write_series(const SweepTable& table, const std::vector<std::string>& measures,
                  const std::filesystem::path& folder);
/// Returns the path of the file that has the rows of one run for write_series(). This file has no line of
/// column names. run: index of the run in the study
std::filesystem::path series_file(const std::filesystem::path& folder, std::size_t run);
/// Returns the rows of a finished run for write_series(), from the file that series_file() names.
/// std::nullopt if the file cannot be read, has lines that are no rows of this run, or does not end with the
/// row of the last tick, because the file was damaged, for example by a power loss. Times that an earlier
/// version wrote without rounding are rounded as by time_cell().
std::optional<std::string> series_rows(const std::filesystem::path& folder, const SweepOutcome& outcome);
/// Appends one row of the table of write_series() to the text `rows`.
///
/// run: index of the run in the study
/// time_s: simulated time at which the measures were computed, s
/// values: values of the measures at this time
void add_series_row(std::string& rows, std::size_t run, double time_s, const std::vector<double>& values);

/// Writes the table of write_csv() to an HDF5 file (docs/sweeps.md). Each column is a dataset in the group
/// /table. A column of numbers has doubles, but `run`, `seed` (if all are known), `ticks` and a parameter
/// with whole numbers that have no equal double have unsigned 64-bit integers. If such a parameter also has
/// negative numbers or fractions, the column has texts. The dataset /columns has the names of the columns, in
/// their order. Replaces the file only when the new file is complete. HDF5 stores all texts of a column with
/// the length of the longest; therefore an error of more than 200 bytes is cut there, and ends in "...". Each
/// of SweepTable::facts is an attribute of /table.
/// Throws OutputError if writing fails.
void write_hdf5(const SweepTable& table, const std::filesystem::path& file);
/// Whether an HDF5 file is a table of write_hdf5().
bool is_hdf5_table(const worldio::Hdf5File& file);

}  // namespace troupe::apps
