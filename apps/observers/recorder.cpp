#include "apps/observers/recorder.hpp"

#include "apps/run/run_options.hpp"
#include "base/diagnostics.hpp"
#include "engine/world.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <system_error>

namespace troupe::apps {
namespace {

constexpr std::chrono::seconds k_flush_period{2};

}  // namespace

std::filesystem::path recording_file(const RunOptions& options, const Simulation& simulation) {
  const auto& record = simulation.world().spec().record;
  return options.record.empty() && record ? std::filesystem::path(record->file) : options.record;
}

std::unique_ptr<Recorder> make_recorder(const RunOptions& options, const Simulation& simulation) {
  const std::filesystem::path file = recording_file(options, simulation);
  if (file.empty()) {
    if (options.recording.every_s > 0 || !options.recording.fields.empty())
      throw InputError(
          "troupe run: error: --record-every and --record-fields say how to record: --record FILE.h5 says "
          "where");
    return nullptr;
  }
  if (std::error_code ignored;
      simulation.resumed_at_tick() && !options.force && std::filesystem::exists(file, ignored)) {
    try {
      return std::make_unique<Recorder>(Recording::resume(file, simulation, options.recording));
    } catch (const std::runtime_error& fault) {
      throw InputError(fault.what());
    }
  }
  RecordingOptions recording = options.recording;
  recording.replace = options.force;
  return std::make_unique<Recorder>(Recording(file, simulation, recording));
}

void Recorder::observe(const Simulation& simulation) {
  recording_.observe(simulation);
  if (Clock::now() - flushed_ >= k_flush_period) flush();
}

void Recorder::flush() {
  recording_.flush();
  flushed_ = Clock::now();
}

void Recorder::finish(const Simulation& /*simulation*/) { recording_.close(); }

}  // namespace troupe::apps
