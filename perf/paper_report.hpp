#pragma once

#include "perf/paper_cases.hpp"
#include "perf/paper_children.hpp"
#include "perf/paper_hashes.hpp"
#include "perf/paper_timing.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace troupe::perf {

/// Describes the machine of a report as pairs of name and value: processor, cores, memory and so on. Unknown
/// values are omitted, and host names are never included.
std::vector<std::pair<std::string, std::string>> describe_machine();

/// Speeds of other simulators: simulated time divided by wall time. The first key is the column in which the
/// tables show the speeds, such as `paper`; the second key is the name of the scene (simulated world).
using Reference = std::map<std::string, std::map<std::string, double>>;
/// Reads a file with the format of perf/paper_reference.json. Throws std::runtime_error if it cannot be read.
Reference read_reference(const std::filesystem::path& file);

/// All measurements of one run of the benchmark program.
struct Report {
  std::vector<std::pair<std::string, std::string>> machine;  ///< as describe_machine() returns it
  std::size_t repeat = 0;                                    ///< repetitions of each row
  bool quick = false;                                        ///< true: only few robots and short times
  std::vector<Table> tables;
  std::vector<CaseTiming> cases;
  std::vector<ChildTiming> children;
  std::vector<std::string> skipped;  ///< reasons why rows were not measured
};

/// A table of a report, with its cells as text.
struct Sheet {
  std::string title;
  std::string note;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// The speed-up of a row (a measured run of a scene) on several threads.
struct Scaling {
  const Timing* timing;  ///< the measurements of the row on several threads
  double speedup;        ///< wall time on one thread divided by wall time on several
  double probe;          ///< `speedup` of the computation of probe_s(): the limit of the machine
};
/// The speed-ups of all rows that were measured on one thread and on several, except those of the tables
/// `clusters`, `watching`, `grid` and `simd`.
std::vector<Scaling> scalings(const Report& report);

/// All tables of a report that have rows. The comparison with the goals is left out if report.quick is true.
std::vector<Sheet> sheets(const Report& report, const Reference& reference);

/// A table as text with aligned columns.
std::string plain_text(const Sheet& sheet);
/// The text of all sheets in Markdown, with the description of the machine and the skipped rows.
std::string markdown(const Report& report, const std::vector<Sheet>& sheets);
/// All measurements of a report as JSON.
std::string json(const Report& report);

/// Replaces the text between the lines `<!-- perf_paper: begin -->` and `<!-- perf_paper: end -->` of a file,
/// or the whole file if it has no such lines. Throws std::runtime_error if the file cannot be written.
void write_between_marks(const std::filesystem::path& file, const std::string& text);

/// Compares the hashes of a report with those in `book`. If `record` is true, stores them in `book` instead;
/// the caller then calls HashBook::save(). Returns one line of text for each wrong or unknown hash, and for
/// each row whose repetitions ended with different hashes. If `record` is true, a hash is wrong if an earlier
/// row of the same scene (simulated world) and tick (simulation step) has a different one.
std::vector<std::string> check_hashes(const Report& report, HashBook& book, bool record);

}  // namespace troupe::perf
