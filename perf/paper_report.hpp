#pragma once

#include "perf/paper_cases.hpp"
#include "perf/paper_children.hpp"
#include "perf/paper_hashes.hpp"
#include "perf/paper_timing.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace troupe::perf {

/// Describes the machine of a report as pairs of name and value: processor, cores, memory and so on. Unknown
/// values are omitted, and host names are never included.
std::vector<std::pair<std::string, std::string>> describe_machine();

/// Speeds of other simulators: simulated time divided by wall time. The first key is a column title of the
/// report, such as `paper`. The second key is the name of a scene (simulated world), such as "hospital/1000",
/// and whether pictures are drawn during the run.
using Reference = std::map<std::string, std::map<std::pair<std::string, bool>, double>>;
/// Reads a file with the format of perf/paper_reference.json. Throws std::runtime_error if it cannot be read,
/// and nlohmann::json::exception if its content is invalid.
Reference read_reference(const std::filesystem::path& file);

/// All measurements of one run of the benchmark program.
struct Report {
  std::vector<std::pair<std::string, std::string>> machine;  ///< as describe_machine() returns it
  std::size_t repeat = 0;                                    ///< repetitions of each row
  bool quick = false;                                        ///< true: only few robots and short times
  std::vector<Table> tables;
  std::vector<CaseTiming> cases;
  std::vector<ChildTiming> children;
  std::vector<std::string> skipped;  ///< one text per reason why runs were not measured
};

/// A table of a report, with its cells as text.
struct Sheet {
  std::string title;
  std::string note;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// The speed-up of a measured run by the use of several threads instead of one.
struct Scaling {
  const Timing* timing;  ///< the measurements of the run on several threads
  double speedup;        ///< wall time on one thread divided by wall time on these threads
  double probe;          ///< speed-up of the computation of probe_s() on these threads: the machine's limit
};
/// Returns the speed-up of each run on several threads that has a counterpart on one thread in the same case.
/// Runs with pictures are omitted, and so are the tables `clusters`, `watching`, `grid` and `simd`.
std::vector<Scaling> scalings(const Report& report);

/// Returns all tables of a report that have rows. The first one is the comparison with the performance goals
/// (aims_sheet()); it is omitted if report.quick is true.
std::vector<Sheet> sheets(const Report& report, const Reference& reference);

/// Returns a table as text with aligned columns.
std::string plain_text(const Sheet& sheet);
/// Returns the text of all sheets in Markdown, with the description of the machine and the reasons in
/// Report::skipped.
std::string markdown(const Report& report, const std::vector<Sheet>& sheets);
std::string json(const Report& report);

/// Writes `text` to a file. If the file has the two lines `<!-- perf_paper: begin -->` and
/// `<!-- perf_paper: end -->`, `text` replaces only the text between them. Otherwise `text` becomes the whole
/// content of the file. Throws std::runtime_error if the file cannot be written.
void write_between_marks(const std::filesystem::path& file, const std::string& text);

/// Checks the state hashes of a report and returns one line of text for each error. It is an error if the
/// repetitions of a row (a measured run) ended with different hashes.
///
/// If `record` is false, it is also an error if `book` has no hash for the scene and tick (time step)
/// of a row, or a different one.
///
/// If `record` is true, the function stores hashes in `book`: for each scene and tick, that of the first row.
/// It is then an error if a later row has a different hash. The caller must then call HashBook::save().
std::vector<std::string> check_hashes(const Report& report, HashBook& book, bool record);

}  // namespace troupe::perf
