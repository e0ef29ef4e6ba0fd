#include "apps/observers/recorder.hpp"

#include "apps/run/run_options.hpp"
#include "base/diagnostics.hpp"
#include "engine/world/world.hpp"
#include "worldio/results/recording_fields.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace troupe::apps {
namespace {

constexpr std::chrono::seconds k_flush_period{2};  // of wall time

/// Calls `work`. Throws its std::runtime_error, which names the file, as InputError.
template <class Work>
void with_input_errors(Work&& work) {
  try {
    work();
  } catch (const std::runtime_error& error) {
    throw InputError(error.what());
  }
}

}  // namespace

std::filesystem::path recording_file(const RunOptions& options, const Simulation& simulation) {
  const auto& record = simulation.world().spec().record;
  if (!options.record.empty() || !record) return options.record;
  Diagnostics diagnostics(simulation.world().spec().files);
  worldio::check_recording_file(*record, diagnostics);
  diagnostics.throw_if_errors();
  return record->file;
}

OpenOutput prepare_recorder(const RunOptions& options, const Simulation& simulation) {
  const std::filesystem::path file = recording_file(options, simulation);
  if (file.empty()) {
    if (options.recording.every_s > 0 || !options.recording.fields.empty())
      throw InputError(
          fmt::format("troupe {}: error: --record-every and --record-fields need a recording, but the world "
                      "has no \"record\": give --record FILE.h5",
                      options.is_checkpoint ? "resume" : "run"));
    return nullptr;
  }
  RecordingOptions recording = options.recording;
  recording.replace = options.force;
  recording.in_background = true;  // if a checkpoint is saved meanwhile, HDF5's lock keeps the two apart
  std::error_code ignored;
  const bool goes_on =
      simulation.resumed_at_tick() && !options.force && std::filesystem::exists(file, ignored);
  with_input_errors([&] {
    if (goes_on)
      Recording::check_resume(file, simulation, recording);
    else
      Recording::check(file, simulation, recording);
  });
  return [file, &simulation, recording, goes_on](Observers& observers) {
    with_input_errors([&] {
      observers.push_back(std::make_unique<Recorder>(goes_on ? Recording::resume(file, simulation, recording)
                                                             : Recording(file, simulation, recording)));
    });
  };
}

void Recorder::observe(const Simulation& simulation) {
  recording_.observe(simulation);
  if (Clock::now() - flushed_ < k_flush_period) return;
  recording_.start_flush();
  flushed_ = Clock::now();
}

void Recorder::finish(const Simulation& /*simulation*/) { recording_.close(); }

}  // namespace troupe::apps
