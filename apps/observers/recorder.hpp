#pragma once

#include "apps/observers/observer.hpp"
#include "troupe/recording.hpp"

#include <chrono>
#include <filesystem>
#include <memory>
#include <utility>

namespace troupe::apps {

struct RunOptions;

/// The file to which a run is recorded: the one given on the command line, or else in `record` of the world
/// file; empty: the run is not recorded.
std::filesystem::path recording_file(const RunOptions& options, const Simulation& simulation);

class Recorder;
/// Opens the recording of a run; null if the run is not recorded. If the simulation was resumed from a
/// checkpoint, an existing recording is continued. Throws InputError for an invalid file or invalid fields,
/// before anything is written.
std::unique_ptr<Recorder> make_recorder(const RunOptions& options, const Simulation& simulation);

/// Writes a recording on a background thread. Flushes every 2 s of wall time, so that readers of the growing
/// file see recent frames and a killed run loses little.
class Recorder : public Observer {
 public:
  explicit Recorder(Recording recording) : recording_(std::move(recording)) {}

  void observe(const Simulation& simulation) override;
  void before_save() override { recording_.flush(); }
  void finish(const Simulation& simulation) override;

 private:
  using Clock = std::chrono::steady_clock;
  Recording recording_;
  Clock::time_point flushed_ = Clock::now();
};

}  // namespace troupe::apps
