#pragma once

#include "apps/csv.hpp"
#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "engine/events.hpp"
#include "troupe/measures.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace troupe::apps {

/// `--measures`: `tick,time_s,coverage,...`, a line for every tick whose number is a multiple of `every`. So
/// a run that was stopped and goes on has the lines of one that was not.
class MeasuresTable : public Observer {
 public:
  /// Where the simulation goes on from a checkpoint, a table that is there goes on with it, and what the
  /// measures remembered is in the checkpoint. Throws OutputError. The simulation must outlive it.
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

/// `--events`: a line an event, `tick,time_s,event,robot,id,x_m,y_m,heading_rad,other,other_id`, in the order
/// of ticks and ids; the pose is the robot's at the end of the tick. The last two are empty where the event
/// has no other.
class EventsTable : public Observer {
 public:
  /// Begins with the state that the simulation is in. Where it goes on from a checkpoint, a table that is
  /// there goes on with it. Throws OutputError.
  EventsTable(const std::filesystem::path& file, const Simulation& simulation);

  void observe(const Simulation& simulation) override;

 private:
  engine::EventWatch watch_;
  CsvFile csv_;
};

/// The first columns of the tables, by which `troupe info` knows them.
inline constexpr std::string_view k_measures_mark = "tick,time_s,";
inline constexpr std::string_view k_events_mark = "tick,time_s,event,robot,";
inline constexpr std::string_view k_events_header =
    "tick,time_s,event,robot,id,x_m,y_m,heading_rad,other,other_id";

/// --measures, --measure and --measure-every.
std::unique_ptr<RunOutput> measures_output();
/// --events.
std::unique_ptr<RunOutput> events_output();

}  // namespace troupe::apps
