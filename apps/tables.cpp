#include "apps/tables.hpp"

#include "engine/world.hpp"

#include <string>
#include <utility>

namespace troupe::apps {
namespace {

std::string header_of(const Measures& measures) {
  std::string header = "tick,time_s";
  for (const std::string& column : measures.columns()) {
    header += ',';
    header += csv_cell(column);
  }
  return header;
}

}  // namespace

MeasuresTable::MeasuresTable(const std::filesystem::path& file, Measures measures, std::uint64_t every)
    : measures_(std::move(measures)), every_(every), csv_(file, header_of(measures_)) {}

void MeasuresTable::observe(const Simulation& simulation) {
  measures_.see();
  if (simulation.tick() % every_ != 0) return;
  csv_.add(simulation.tick()).add(simulation.time_s());
  for (const double value : measures_.values()) csv_.add(value);
  csv_.end_line();
  csv_.flush(simulation.tick());
}

EventsTable::EventsTable(const std::filesystem::path& file, const Simulation& simulation)
    : watch_(simulation.world()), csv_(file, k_events_header) {}

void EventsTable::observe(const Simulation& simulation) {
  const engine::World& world = simulation.world();
  for (const engine::Event& event : watch_.see(world)) {
    const Pose pose = world.pose(event.body);
    csv_.add(world.tick()).add(world.time_s()).add(engine::event_name(event.type));
    csv_.add(world.spec().name(event.body)).add(std::uint64_t{event.body.value});
    csv_.add(pose.x).add(pose.y).add(pose.heading);
    csv_.end_line();
  }
  csv_.flush(world.tick());
}

}  // namespace troupe::apps
