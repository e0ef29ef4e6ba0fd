#pragma once

#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace troupe {

/// Content of a recording. Options that are not given are those of the world's `record`, or else poses every
/// 0.1 s.
struct RecordingOptions {
  /// Names of components or of sensor readings: "pose", "velocity", "stall", "ranges", ...; "all".
  std::vector<std::string> fields;
  /// Simulated time between two frames, s; rounded up to whole ticks. 0: not given.
  double every_s = 0;
  /// Whether to replace an existing file.
  bool replace = false;
  /// Whether a thread of the recording writes the file while the simulation goes on. If the process is
  /// killed, up to two batches of frames are then lost instead of one. Troupe serialises its own calls of
  /// HDF5; if the library was built without thread safety (H5is_library_threadsafe), nothing else in the
  /// process, such as h5py, may use it until the recording is closed.
  bool in_background = false;
};

/// A recording of a simulation: an HDF5 file (docs/recordings.md) that can be read while it is written.
///
///     troupe::Recording recording("run.h5", simulation);
///     while (simulation.time_s() < 60) {
///       simulation.step();
///       recording.observe(simulation);
///     }
///     recording.close();
///
/// It does not change the simulation. Write errors throw std::runtime_error that names the file; the file is
/// then readable up to the last flushed frame, and nothing more is written to it. The next call throws an
/// error of the background thread.
class Recording {
 public:
  /// Opens the file. The first frame is the current state, if its tick is due. Throws InputError for fields
  /// that the world does not have, for an existing file without `replace`, and if the file cannot be written.
  Recording(const std::filesystem::path& file, const Simulation& simulation,
            const RecordingOptions& options = {});
  /// Continues a recording of the same world from the simulation's tick on, for a resumed run: with the same
  /// fields and interval, without a gap or a repeated frame. Frames of later ticks are removed. `options` may
  /// repeat fields and interval. Throws std::runtime_error if the file does not fit, or if they differ.
  static Recording resume(const std::filesystem::path& file, const Simulation& simulation,
                          const RecordingOptions& options = {});
  Recording(Recording&&) noexcept;             ///< the source may only be destroyed or assigned
  Recording& operator=(Recording&&) noexcept;  ///< the source may only be destroyed or assigned
  /// Closes the file and ignores errors; close() reports them.
  ~Recording();

  /// Adds a frame if one is due. Call it after each step.
  void observe(const Simulation& simulation);
  /// Writes the frames that are in memory: readers see them, and they survive the process. Frames are flushed
  /// regularly as they come in; call this if frames are rare, or before saving a checkpoint.
  void flush();
  /// Starts a flush(). With `in_background` it returns before the frames are written.
  void start_flush();
  /// Flushes and closes the file: other HDF5 tools can then read it.
  void close();

 private:
  struct Impl;
  explicit Recording(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
