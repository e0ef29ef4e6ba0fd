#pragma once

#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace troupe {

/// What a recording holds. What is not given is as the world's `record` says, else poses every 0.1 s.
struct RecordingOptions {
  /// Names of components or of sensors' readings: "pose", "velocity", "stall", "ranges", ...; "all".
  std::vector<std::string> fields;
  /// Simulated time between two frames, s; rounded up to whole ticks. 0: not given.
  double every_s = 0;
  /// Whether a file of the same name may be replaced.
  bool replace = false;
  /// Whether a thread of the recording writes the file while the simulation goes on. Frames that are killed
  /// with the process are then those of up to two batches, not one. Troupe's own calls of HDF5 take turns;
  /// where the library was not built to be safe for threads (H5is_library_threadsafe), nothing else in the
  /// process, such as h5py, may use it until the recording is closed.
  bool in_background = false;
};

/// A recording of a simulation, an HDF5 file (docs/recordings.md) that can be read while it is written:
///
///     troupe::Recording recording("run.h5", simulation);
///     while (simulation.time_s() < 60) {
///       simulation.step();
///       recording.observe(simulation);
///     }
///     recording.close();
///
/// It changes nothing of the simulation. Errors in writing are std::runtime_error that name the file; the
/// file is then readable up to the last frame that was flushed, and nothing more is written to it. An error
/// in the background is thrown by the next call.
class Recording {
 public:
  /// Opens the file; the first frame is the state as it is now, if its tick is due. Throws InputError for
  /// fields that the world does not have, where the file exists and may not be replaced, and where it cannot
  /// be written.
  Recording(const std::filesystem::path& file, const Simulation& simulation,
            const RecordingOptions& options = {});
  /// Goes on with a recording of the same world from the simulation's tick on, for a run that was resumed:
  /// with its fields and its interval, without a gap and without a repeat. Frames of later ticks are cut off.
  /// `options` may repeat fields and interval. Throws std::runtime_error where that cannot be, or where they
  /// are others.
  static Recording resume(const std::filesystem::path& file, const Simulation& simulation,
                          const RecordingOptions& options = {});
  Recording(Recording&&) noexcept;             ///< the one moved from is of no use
  Recording& operator=(Recording&&) noexcept;  ///< as that
  /// Closes it; what fails is lost: call close() to know.
  ~Recording();

  /// To be called after each step: adds a frame where one is due.
  void observe(const Simulation& simulation);
  /// Writes what is still in memory: it then outlives the process, and readers see it. A run flushes by
  /// itself as frames come in; who records slowly, or is about to save a checkpoint, asks for it.
  void flush();
  /// As flush(), but in the background it returns before the file has them.
  void start_flush();
  /// As flush(), and no more to come: plain tools read the file from now on.
  void close();

 private:
  struct Impl;
  explicit Recording(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
