#pragma once

#include "apps/options.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Functions that return the summary that `troupe info` prints, one function per type of file. All throw
/// InputError if the file cannot be read.
namespace troupe::apps {

/// A summary: names and values, in the order in which they are printed.
using Summary = std::vector<std::pair<std::string, std::string>>;

Summary summary_of_hash_log(const std::filesystem::path& file);
Summary summary_of_measures(const std::filesystem::path& file);
Summary summary_of_events(const std::filesystem::path& file);
Summary summary_of_profile(const std::filesystem::path& file);
/// Of the table of results of a sweep (write_csv()).
Summary summary_of_results(const std::filesystem::path& file);
/// Of the measures over time of the runs of a sweep (write_series()).
Summary summary_of_series(const std::filesystem::path& file);
/// Of a journal of `troupe sweep` (SweepJournal).
Summary summary_of_journal(const std::filesystem::path& file);
/// Of a session: the actions of users during a run.
Summary summary_of_session(const std::filesystem::path& file);
/// Of a recording, or of the table of results of a sweep in HDF5.
Summary summary_of_hdf5(const std::filesystem::path& file);
Summary summary_of_checkpoint(const std::filesystem::path& file);
/// Returns the summary of a world file. Throws InputError if the world has errors.
///
/// file: name of the world file, for errors and for the files to which it refers
/// text: content of the world file
/// json: whether the world is in JSON; otherwise it is in Stage's syntax
/// sources: plug-ins (shared libraries), and scripts, whose controllers replace those of the world
Summary summary_of_world(const std::filesystem::path& file, const std::string& text, bool json,
                         const KindSources& sources);

/// Returns the summary of a study, which is a file that describes many runs of a world. Throws InputError if
/// the study has errors. Does not load the world.
///
/// file: name of the study, for errors
/// text: content of the study
/// sources: plug-ins (shared libraries) and scripts
Summary summary_of_study(const std::filesystem::path& file, const std::string& text,
                         const KindSources& sources);
/// Returns the summary of a JSON file that is a study or a world; std::nullopt if it is neither. The
/// parameters are those of summary_of_study(). Throws InputError if the file has errors.
std::optional<Summary> summary_of_json(const std::filesystem::path& file, const std::string& text,
                                       const KindSources& sources);

/// Adds the number of runs in the table of results of a sweep, and how many of them failed, to a summary.
void add_runs(std::size_t runs, std::size_t failed, Summary& summary);

/// Returns a range of ticks (time steps) and of simulated times as text, such as "0 to 20, 0 to 2 s".
/// first_s, last_s: the simulated times of the ticks `first` and `last`, s.
std::string ticks_text(std::uint64_t first, std::uint64_t last, double first_s, double last_s);

}  // namespace troupe::apps
