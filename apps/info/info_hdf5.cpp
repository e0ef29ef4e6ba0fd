// Summaries of recordings, of tables of results in HDF5, and of checkpoints.

#include "apps/info/info_kinds.hpp"
#include "apps/sweep/table.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "base/split.hpp"
#include "worldio/results/checkpoint.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/hdf5_superblock.hpp"
#include "worldio/results/recording_reader.hpp"
#include "worldio/results/recording_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

/// Adds the entries of the header of a run to a summary: first the version, then all others except those
/// whose keys are in `left_out`.
void add_header(const std::map<std::string, std::string>& header, const std::set<std::string>& left_out,
                Summary& summary) {
  if (const auto version = header.find("version"); version != header.end())
    summary.emplace_back("written by", version->second);
  for (const auto& [key, value] : header)
    if (key != "version" && !left_out.contains(key)) summary.emplace_back(key, value);
}

Summary summary_of(const worldio::RecordingReader& recording) {
  Summary summary{{"kind", fmt::format("recording, layout {}", worldio::k_recording_layout)}};
  add_header(recording.meta(), {"kind", "layout"}, summary);
  summary.emplace_back("bodies", fmt::format("{}", recording.ids().size()));
  summary.emplace_back("frames", fmt::format("{}", recording.frames()));
  if (recording.frames() > 0) {
    summary.emplace_back("ticks", ticks_text(recording.ticks().front(), recording.ticks().back(),
                                             recording.times_s().front(), recording.times_s().back()));
    summary.emplace_back("last state", hex(recording.hashes().back()));
  } else {
    summary.emplace_back("ticks", "none");
  }
  std::string component;  // arrays of a component are adjacent
  for (const worldio::RecordingReader::Array& array : recording.arrays()) {
    const std::string columns = array.field.columns > 1
                                    ? fmt::format("{}[{}]", array.field.name, array.field.columns)
                                    : array.field.name;
    if (array.component != component) {
      component = array.component;
      summary.emplace_back("  " + worldio::shown_name(component), columns);
    } else {
      summary.back().second += ", " + columns;
    }
  }
  summary.emplace_back("complete",
                       recording.unfinished()
                           ? "no: being written, or cut off; troupe repair makes a cut-off recording "
                             "readable for standard HDF5 tools"
                           : "yes");
  return summary;
}

/// The summary of a table that write_hdf5() of a sweep wrote.
Summary summary_of_table(const worldio::Hdf5File& file) {
  const std::vector<std::string> columns = file.read_texts("columns");
  const worldio::Hdf5Group table = file.group("table");
  const std::vector<std::string> errors = table.read_texts("error");
  Summary summary{{"kind", "table of the results of a sweep, in HDF5"}};
  std::map<std::string, std::string> header;
  for (const std::string& name : table.attributes()) header[name] = table.text(name);
  add_header(header, {}, summary);
  summary.emplace_back("columns", joined(columns, ", "));
  add_runs(errors.size(), errors.size() - static_cast<std::size_t>(std::ranges::count(errors, "")), summary);
  summary.emplace_back("complete", "yes");
  return summary;
}

}  // namespace

Summary summary_of_hdf5(const fs::path& file) {
  try {
    const auto head = worldio::read_superblock(file);
    if (!head || !head->writing()) {  // a table is never seen while it is written
      const worldio::Hdf5File hdf5 = worldio::Hdf5File::open(file);
      if (is_hdf5_table(hdf5)) return summary_of_table(hdf5);
    }
    return summary_of(worldio::RecordingReader(file));
  } catch (const worldio::Hdf5Error& error) {
    throw InputError(error.what());
  }
}

Summary summary_of_checkpoint(const fs::path& file) {
  const worldio::Checkpoint checkpoint(file);  // throws if it is not complete
  Summary summary{{"kind", fmt::format("checkpoint, layout {}", worldio::k_checkpoint_layout)}};
  add_header(checkpoint.header(), {"kind", "layout", "tick", "time_s", "state_hash"}, summary);
  summary.emplace_back("tick", fmt::format("{}, {:.10g} s", checkpoint.tick(), checkpoint.time_s()));
  summary.emplace_back("state", hex(checkpoint.state_hash()));
  summary.emplace_back("complete", "yes");
  return summary;
}

}  // namespace troupe::apps
