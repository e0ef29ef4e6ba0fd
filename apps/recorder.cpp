#include "apps/recorder.hpp"

#include "apps/run_options.hpp"
#include "engine/world.hpp"

namespace troupe::apps {
namespace {

constexpr std::chrono::seconds k_flush_period{2};

}  // namespace

std::filesystem::path recording_file(const RunOptions& options, const Simulation& simulation) {
  const auto& record = simulation.world().spec().record;
  return options.record.empty() && record ? std::filesystem::path(record->file) : options.record;
}

void Recorder::observe(const Simulation& simulation) {
  recording_.observe(simulation);
  const auto now = Clock::now();
  if (now - flushed_ < k_flush_period) return;
  recording_.flush();
  flushed_ = now;
}

void Recorder::finish(const Simulation& /*simulation*/) { recording_.close(); }

}  // namespace troupe::apps
