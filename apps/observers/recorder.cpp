#include "apps/observers/recorder.hpp"

#include "apps/run/run_options.hpp"
#include "base/diagnostics.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace troupe::apps {
namespace {

constexpr std::chrono::seconds k_flush_period{2};  // of wall time

/// Throws InputError if the world file names a recording outside the working folder, because a world file
/// from an unknown source must not create or (with --force) replace files elsewhere.
void refuse_outside(const engine::RecordSpec& record, const Simulation& simulation) {
  const std::filesystem::path file = record.file;
  if (file.is_relative() && std::ranges::find(file, "..") == file.end()) return;
  Diagnostics diagnostics(simulation.world().spec().files);
  diagnostics.error(record.where,
                    fmt::format("/record/file: must be a file in or below the working folder (no leading "
                                "\"/\", no \"..\"), found \"{}\"; --record may name any file",
                                record.file));
  diagnostics.throw_if_errors();
}

}  // namespace

std::filesystem::path recording_file(const RunOptions& options, const Simulation& simulation) {
  const auto& record = simulation.world().spec().record;
  if (!options.record.empty() || !record) return options.record;
  refuse_outside(*record, simulation);
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
  recording.in_background = true;  // allowed because nothing else in this process uses HDF5
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
