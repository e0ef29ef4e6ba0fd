#pragma once

#include "apps/csv.hpp"
#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "engine/observing/events.hpp"
#include "troupe/measures.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace troupe::apps {

/// Writes the table of --measures: the tick (number of the simulation step), the time and the values of the
/// measures (numbers computed from the state), with the columns `tick,time_s,coverage,...`. The table has one
/// line for every tick that is a multiple of `every`, counted from the start of the simulation. So a resumed
/// run writes the same lines as an uninterrupted run.
class MeasuresTable : public Observer {
 public:
  /// Creates the table. If the simulation was resumed from a checkpoint (saved state of a run), an existing
  /// table is continued and the data that the measures keep from earlier ticks are restored from the
  /// checkpoint. every: interval of the lines, ticks, at least 1. Throws OutputError if the file cannot be
  /// written or continued, or if the checkpoint lacks these data. The simulation must outlive this object.
  MeasuresTable(const std::filesystem::path& file, Simulation& simulation, Measures measures,
                std::uint64_t every);
  ~MeasuresTable() override;

  void observe(const Simulation& simulation) override;

 private:
  Simulation& simulation_;
  Measures measures_;
  std::uint64_t every_;
  std::string memory_name_;
  CsvFile csv_;
};

/// Writes the table of --events: one line per event (a robot stalls, is born, dies, ...),
/// `tick,time_s,event,robot,id,x_m,y_m,heading_rad,other,other_id`, in the order of ticks and ids. The pose
/// is that of the robot at the end of the tick. `other` and `other_id` are empty if no other body is
/// involved.
class EventsTable : public Observer {
 public:
  /// Creates the table, which will contain the events after the current tick. If the simulation was resumed
  /// from a checkpoint, an existing table is continued. Throws OutputError if the file cannot be written or
  /// continued. The simulation must outlive this object.
  EventsTable(const std::filesystem::path& file, Simulation& simulation);
  ~EventsTable() override;

  void observe(const Simulation& simulation) override;

 private:
  Simulation& simulation_;
  engine::EventWatch watch_;
  CsvFile csv_;
};

/// The beginnings of the first lines of a table of measures and of a table of events, by which `troupe info`
/// detects the type of a file. A table of events begins with both, so k_events_mark must be tested first.
inline constexpr std::string_view k_measures_mark = "tick,time_s,";
inline constexpr std::string_view k_events_mark = "tick,time_s,event,robot,";
/// The first line of a table of events: the names of its columns.
inline constexpr std::string_view k_events_header =
    "tick,time_s,event,robot,id,x_m,y_m,heading_rad,other,other_id";

/// Returns the output of a run (an object with command-line options, see RunOutput) that writes a
/// MeasuresTable. It adds the options --measures, --measure and --measure-every to the command line, and
/// writes the table to the file that --measures names. Without --measures, nothing is written.
std::unique_ptr<RunOutput> measures_output();
/// Returns the output of a run (an object with command-line options, see RunOutput) that writes an
/// EventsTable. It adds the option --events to the command line, and writes the table to the file that
/// --events names. Without --events, nothing is written.
std::unique_ptr<RunOutput> events_output();

}  // namespace troupe::apps
