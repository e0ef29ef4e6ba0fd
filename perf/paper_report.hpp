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

/// The machine of a report: processor, cores, memory; unknown values are omitted. Does not contain host
/// names.
std::vector<std::pair<std::string, std::string>> describe_machine();

/// Figures of other simulators from perf/paper_reference.json: column -> scene -> times real time.
using Reference = std::map<std::string, std::map<std::string, double>>;
Reference read_reference(const std::filesystem::path& file);

/// All measurements.
struct Report {
  std::vector<std::pair<std::string, std::string>> machine;
  std::size_t repeat = 0;
  bool quick = false;
  std::vector<Table> tables;
  std::vector<CaseTiming> cases;
  std::vector<ChildTiming> children;
  std::vector<std::string> skipped;
};

/// A table as text.
struct Sheet {
  std::string title;
  std::string note;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// The speed-up of several threads in one row.
struct Scaling {
  const Timing* timing;
  double speedup;  ///< relative to the same row on one thread
  double probe;    ///< speed-up of the same number of threads that share nothing, in the same run
};
std::vector<Scaling> scalings(const Report& report);

std::vector<Sheet> sheets(const Report& report, const Reference& reference);

std::string plain_text(const Sheet& sheet);
/// All sheets, with the description of the machine and the skipped rows.
std::string markdown(const Report& report, const std::vector<Sheet>& sheets);
std::string json(const Report& report);

/// Replaces the text between the lines `<!-- perf_paper: begin -->` and `<!-- perf_paper: end -->` of a file,
/// or the whole file if it has no such lines. Throws std::runtime_error.
void write_between_marks(const std::filesystem::path& file, const std::string& text);

/// Compares hashes with the book, or records them there. Returns a line for each wrong or unknown hash.
std::vector<std::string> check_hashes(const Report& report, HashBook& book, bool record);

}  // namespace troupe::perf
