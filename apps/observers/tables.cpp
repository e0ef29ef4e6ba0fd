#include "apps/observers/tables.hpp"

#include "apps/outputs.hpp"
#include "base/hash.hpp"
#include "engine/world.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

std::string header_of(const Measures& measures) {
  std::string header = "tick,time_s";
  for (const std::string& column : measures.columns()) {
    header += ',';
    header += csv_cell(column);
  }
  return header;
}

/// Tick 66 of 0.1 s is at 6.6 s, not at the 6.6000000000000005 s that the product is.
std::string time_text(double time_s) { return fmt::format("{:.12g}", time_s); }

/// Whether the table of a run that was resumed is there.
bool goes_on(const fs::path& file, const Simulation& simulation) {
  std::error_code ignored;
  return simulation.resumed_at_tick() && fs::is_regular_file(file, ignored);
}

/// Under which a checkpoint keeps what these measures remember: others have another.
std::string memory_name(const Measures& measures) {
  return fmt::format("measures {}", hex(hash_text(header_of(measures))));
}

/// The measures with what they remembered when the run was saved.
Measures remembering(const fs::path& file, const Simulation& simulation, Measures measures) {
  const auto fail = [&file](std::string_view reason) {
    throw OutputError(fmt::format("{}: error: {}", file.string(), reason));
  };
  if (const auto saved = simulation.saved_memory(memory_name(measures))) {
    if (!measures.remember(*saved))
      fail("the checkpoint was saved while measures of these names had other parameters: rename them");
  } else if (goes_on(file, simulation) && !measures.memory().empty()) {
    fail(
        "the table cannot go on: the checkpoint was saved without these measures, and does not say what they "
        "remembered; choose another file");
  }
  return measures;
}

}  // namespace

MeasuresTable::MeasuresTable(const fs::path& file, Simulation& simulation, Measures measures,
                             std::uint64_t every)
    : simulation_(simulation),
      measures_(remembering(file, simulation, std::move(measures))),
      every_(every),
      memory_name_(memory_name(measures_)),
      csv_(goes_on(file, simulation) ? CsvFile(file, header_of(measures_), simulation.tick())
                                     : CsvFile(file, header_of(measures_))) {
  simulation_.on_save(memory_name_, [this] { return measures_.memory(); });
}

MeasuresTable::~MeasuresTable() { simulation_.on_save(memory_name_, nullptr); }

void MeasuresTable::observe(const Simulation& simulation) {
  measures_.see();
  if (simulation.tick() % every_ != 0) return;
  csv_.add(simulation.tick()).add(time_text(simulation.time_s()));
  for (const double value : measures_.values()) csv_.add(value);
  csv_.end_line();
  csv_.flush(simulation.tick());
}

EventsTable::EventsTable(const fs::path& file, const Simulation& simulation)
    : watch_(simulation.world()),
      csv_(goes_on(file, simulation) ? CsvFile(file, k_events_header, simulation.tick() + 1)
                                     : CsvFile(file, k_events_header)) {}

void EventsTable::observe(const Simulation& simulation) {
  const engine::World& world = simulation.world();
  for (const engine::Event& event : watch_.see(world)) {
    const Pose pose = world.pose(event.body);
    csv_.add(world.tick()).add(time_text(world.time_s())).add(engine::event_name(event.type));
    csv_.add(world.spec().name(event.body)).add(std::uint64_t{event.body.value});
    csv_.add(pose.x).add(pose.y).add(pose.heading);
    if (event.other.valid())
      csv_.add(world.spec().name(event.other)).add(std::uint64_t{event.other.value});
    else
      csv_.add(std::string_view()).add(std::string_view());
    csv_.end_line();
  }
  csv_.flush(world.tick());
}

}  // namespace troupe::apps
