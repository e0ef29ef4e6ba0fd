#pragma once

#include "apps/observers/observer.hpp"
#include "troupe/recording.hpp"

#include <chrono>
#include <filesystem>
#include <memory>
#include <utility>

namespace troupe::apps {

struct RunOptions;

/// Returns the file to which a run is recorded: the file that the command line names, or else the file that
/// `record` in the world file names; empty if neither names a file. Throws InputError if the world names a
/// file outside the working folder.
std::filesystem::path recording_file(const RunOptions& options, const Simulation& simulation);

class Recorder;
/// Opens the recording of a run (recording_file()). Returns null if the run is not recorded. If the
/// simulation was resumed from a checkpoint (saved state of a run), an existing recording is continued,
/// unless --force was given. Throws InputError, before anything is written, if the file or the fields are
/// invalid, or if an interval or fields are given for a run that is not recorded.
std::unique_ptr<Recorder> make_recorder(const RunOptions& options, const Simulation& simulation);

/// Writes the recording of a run: an HDF5 file with one frame per recorded tick (simulation step). A frame
/// contains the chosen fields of the state. The recorder starts to flush the frames to the disk every 2 s of
/// wall time, so that readers of the growing file see recent frames and a killed run loses few frames.
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
