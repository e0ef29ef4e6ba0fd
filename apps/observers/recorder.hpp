#pragma once

#include "apps/observers/observer.hpp"
#include "apps/run/run_output.hpp"
#include "troupe/recording.hpp"

#include <chrono>
#include <filesystem>
#include <memory>
#include <utility>

namespace troupe::apps {

/// Returns the file to which a run is recorded. This is the file that the command line names, or else the
/// file that the entry `record` of the world file names. The result is empty if neither names a file. Throws
/// InputError if the world file names a file outside the working folder.
std::filesystem::path recording_file(const RunOptions& options, const Simulation& simulation);

/// Checks that a run can be recorded (recording_file()). Returns a function that opens the recording and
/// appends its Recorder to the observers; null if the run is not recorded. In a run that was resumed from a
/// checkpoint (saved state of a run), the function continues an existing recording. With the option --force,
/// it replaces it instead. The function throws InputError if the file cannot be written.
///
/// options: used only during the call
/// simulation: must outlive the returned function
///
/// Throws InputError, before anything is written, if the file or the fields of the recording are invalid, or
/// if the recording cannot be continued. Also throws InputError if the command line gives an interval or
/// fields, but the run is not recorded.
OpenOutput prepare_recorder(const RunOptions& options, const Simulation& simulation);

/// Writes the recording of a run: an HDF5 file with one frame per recorded tick (time step). A frame
/// contains the chosen fields of the state. About every 2 s of wall time, the new frames are flushed to the
/// disk. Programs that read the growing file then see recent frames, and a killed run loses few frames.
class Recorder : public Observer {
 public:
  explicit Recorder(Recording recording) : recording_(std::move(recording)) {}

  void observe(const Simulation& simulation) override;
  bool reads_robots() const override { return false; }  // Recording fetches the robots of a frame
  void before_save() override { recording_.flush(); }
  void finish(const Simulation& simulation) override;

 private:
  using Clock = std::chrono::steady_clock;
  Recording recording_;
  Clock::time_point flushed_ = Clock::now();
};

}  // namespace troupe::apps
