#include "apps/observers/recorder.hpp"

#include "apps/run/run_options.hpp"
#include "base/diagnostics.hpp"
#include "engine/world/world.hpp"
#include "worldio/results/recording_fields.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace troupe::apps {
namespace {

constexpr std::chrono::seconds k_flush_period{2};  // of wall time

}  // namespace

std::filesystem::path recording_file(const RunOptions& options, const Simulation& simulation) {
  const auto& record = simulation.world().spec().record;
  if (!options.record.empty() || !record) return options.record;
  Diagnostics diagnostics(simulation.world().spec().files);
  worldio::check_recording_file(*record, diagnostics);
  diagnostics.throw_if_errors();
  return record->file;
}

std::unique_ptr<Recorder> make_recorder(const RunOptions& options, const Simulation& simulation) {
  const std::filesystem::path file = recording_file(options, simulation);
  if (file.empty()) {
    if (options.recording.every_s > 0 || !options.recording.fields.empty())
      throw InputError(
          "troupe run: error: --record-every and --record-fields need a recording, but the world file has no "
          "\"record\": give --record FILE.h5");
    return nullptr;
  }
  RecordingOptions recording = options.recording;
  recording.replace = options.force;
  recording.in_background = true;  // if a checkpoint is saved meanwhile, HDF5's lock keeps the two apart
  if (std::error_code ignored;
      simulation.resumed_at_tick() && !options.force && std::filesystem::exists(file, ignored)) {
    try {
      return std::make_unique<Recorder>(Recording::resume(file, simulation, recording));
    } catch (const std::runtime_error& error) {
      throw InputError(error.what());
    }
  }
  return std::make_unique<Recorder>(Recording(file, simulation, recording));
}

void Recorder::observe(const Simulation& simulation) {
  recording_.observe(simulation);
  if (Clock::now() - flushed_ < k_flush_period) return;
  recording_.start_flush();
  flushed_ = Clock::now();
}

void Recorder::finish(const Simulation& /*simulation*/) { recording_.close(); }

}  // namespace troupe::apps
