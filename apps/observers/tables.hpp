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
#include <vector>

namespace troupe::apps {

/// Writes the table of the option --measures. A measure is a number that is computed from the state. The
/// columns are `tick`, `time_s` (simulated time) and the measures, as in `tick,time_s,coverage`. There is one
/// line for every tick (time step) that is a multiple of `every`. A resumed run continues the count of
/// ticks, so it writes the same lines as an uninterrupted run.
class MeasuresTable : public Observer {
 public:
  /// Prepares the table, and writes nothing. If the run was resumed from a checkpoint (saved state of a run),
  /// it continues an existing table. Some measures need data from earlier ticks, which are then restored from
  /// the checkpoint. In a new table, a measure without such data in the checkpoint begins at the present
  /// tick; warning() names it. Throws OutputError if the file cannot be continued, for example because its
  /// measures were computed with other parameters.
  ///
  /// simulation: must outlive this object
  /// every: interval of the lines, ticks, at least 1
  MeasuresTable(const std::filesystem::path& file, Simulation& simulation, Measures measures,
                std::uint64_t every);
  ~MeasuresTable() override;
  /// Creates the file, or shortens it to the lines that the run continues. Call it once, before observe().
  /// Throws OutputError if the file cannot be written.
  void open() { csv_.open(); }

  void observe(const Simulation& simulation) override;
  std::string warning() const override;

 private:
  Simulation& simulation_;
  std::filesystem::path file_;
  Measures measures_;
  std::vector<std::string> fresh_;  // columns that begin at the tick of the checkpoint
  std::uint64_t every_;
  CsvFile csv_;
};

/// Writes the table of the option --events, with one line per event. An event is, for example, that a robot
/// stalls, is born or dies. The lines are sorted by tick (time step), and then by the id of the robot.
/// The columns are:
///
/// - `tick`: the tick
/// - `time_s`: simulated time, s
/// - `event`: type of the event, such as `stall_begins`
/// - `robot`, `id`: name and id of the robot
/// - `x_m`, `y_m`, `heading_rad`: pose of the robot at the end of the tick, in the world frame
/// - `other`, `other_id`: name and id of another body that is involved; empty if there is none
class EventsTable : public Observer {
 public:
  /// Prepares the table, and writes nothing. The first events are those of the next tick. If the run was
  /// resumed from a checkpoint (saved state of a run), it continues an existing table. Throws OutputError if
  /// the file cannot be continued.
  ///
  /// simulation: must outlive this object
  EventsTable(const std::filesystem::path& file, Simulation& simulation);
  ~EventsTable() override;
  void open() { csv_.open(); }  ///< as MeasuresTable::open()

  void observe(const Simulation& simulation) override;

 private:
  Simulation& simulation_;
  engine::EventWatch watch_;
  CsvFile csv_;
};

/// The beginnings of a table of measures and of a table of events. `troupe info` detects these two types of
/// files by them. Test for k_events_mark first, because tables of events also begin with k_measures_mark.
inline constexpr std::string_view k_measures_mark = "tick,time_s,";
inline constexpr std::string_view k_events_mark = "tick,time_s,event,robot,";

/// Returns the RunOutput for a table of measures (MeasuresTable). A RunOutput is one output of a run,
/// together with its command-line options. The option --measures names the file, --measure the measures, and
/// --measure-every sets the interval of the lines in simulated seconds. Without --measures, nothing is
/// written.
std::unique_ptr<RunOutput> measures_output();
/// Returns the RunOutput for a table of events (EventsTable). A RunOutput is one output of a run, together
/// with its command-line options. The option --events names the file. Without --events, nothing is written.
std::unique_ptr<RunOutput> events_output();

}  // namespace troupe::apps
