#pragma once

#include "apps/observers/observer.hpp"
#include "troupe/recording.hpp"

#include <chrono>
#include <filesystem>
#include <memory>
#include <utility>

namespace troupe::apps {

struct RunOptions;

/// Where the run records: what the command line says, else the world's `record`; empty: nowhere.
std::filesystem::path recording_file(const RunOptions& options, const Simulation& simulation);

class Recorder;
/// Opens it; null where nothing is to be recorded. Where the simulation goes on from a checkpoint, a
/// recording that is there goes on, too. Throws InputError for what is wrong with the file or with what it is
/// to hold, before anything is written.
std::unique_ptr<Recorder> make_recorder(const RunOptions& options, const Simulation& simulation);

/// A recording that a thread writes while the run goes on. It is flushed every few seconds, so that readers
/// of the growing file see what happens now, and a run that is killed loses no more than that.
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
