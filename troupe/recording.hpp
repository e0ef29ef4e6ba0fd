#pragma once

#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace troupe {

/// What a recording contains, and how it is written. A recording contains fields, which are parts of the
/// state of the bodies, at regular intervals of simulated time. If fields or interval are not given here, the
/// key `record` of the world file determines them. If the world file does not give them either, the only
/// field is `pose`, and the interval is 0.1 s.
struct RecordingOptions {
  /// Names of components (tables of the state), or of fields of sensors: "pose", "velocity", "stall",
  /// "ranges", ...; "all" for all components and fields. Empty: not given.
  std::vector<std::string> fields = {};
  /// Simulated time between two frames (entries of the recording), s; rounded up to whole ticks (time steps).
  /// 0 or less: not given. Making a recording throws std::invalid_argument if it is NaN or more than 1e9.
  double every_s = 0;
  /// True: an existing file is replaced. False: an existing file is an error. Recording::resume() ignores
  /// this option.
  bool replace = false;
  /// Whether the recording writes the file on a thread of its own while the simulation continues. Frames are
  /// collected in memory, and written in batches of several frames. If the process is killed, the frames of
  /// up to two batches are lost. If this option is false, up to one batch is lost.
  ///
  /// Troupe never calls HDF5 from two threads at once. Other code in the process that uses the same HDF5
  /// library, such as h5py, must wait until the recording is closed. It need not wait if the library was
  /// built with thread safety (H5is_library_threadsafe).
  bool in_background = false;
};

/// A recording of a simulation: an HDF5 file with chosen fields of the state over time (docs/recordings.md).
/// A frame is the entry of the recording for one tick (time step). While the file is written, other processes
/// can read it in HDF5's single-writer multiple-reader mode (SWMR; h5py: `swmr=True`).
///
///     troupe::Recording recording("run.h5", simulation);
///     while (simulation.time_s() < 60) {
///       simulation.step();
///       recording.observe(simulation);
///     }
///     recording.close();
///
/// A recording does not change the simulation. If writing fails, observe(), flush(), start_flush() or close()
/// throws std::runtime_error, whose text names the file. An error on the background thread is thrown by a
/// later call of one of these functions. After an error has been thrown, these functions do nothing. The file
/// then contains all frames up to the last one that was flushed.
class Recording {
 public:
  /// Creates the file. The current state is the first frame if its tick is a multiple of the recording
  /// interval. Throws InputError if the world lacks one of the requested fields, if the file exists and
  /// `replace` is false, if another process is creating or writing the file or has locked it (HDF5 locks each
  /// file that a program reads), if the ending of the file name is that of another format than HDF5 (.csv,
  /// .html, .json, .mp4, .pdf, .png or .svg), if the file cannot be written, and in builds without HDF5.
  Recording(const std::filesystem::path& file, const Simulation& simulation,
            const RecordingOptions& options = {});
  /// Continues a recording after its run was resumed from a checkpoint. The recording keeps its fields and
  /// its interval: `options` may leave them empty or repeat them. Frames after the current tick of the
  /// simulation are removed from the file, so that no frame is repeated. Throws std::runtime_error in these
  /// cases:
  /// - The file is not a recording of this run.
  /// - Frames before the current tick are missing in the file; they can no longer be recorded.
  /// - `options` state other fields or another interval than the recording has.
  static Recording resume(const std::filesystem::path& file, const Simulation& simulation,
                          const RecordingOptions& options = {});
  /// Throws the InputError that the constructor throws for these arguments, and creates nothing. Errors that
  /// only occur while the file is written, for example on a full disk, are not found.
  static void check(const std::filesystem::path& file, const Simulation& simulation,
                    const RecordingOptions& options = {});
  /// Throws the std::runtime_error that resume() throws for these arguments, and changes nothing. If the
  /// recording was cut off, because its run was killed, and cannot be read without a repair, only resume()
  /// finds errors in it.
  static void check_resume(const std::filesystem::path& file, const Simulation& simulation,
                           const RecordingOptions& options = {});
  Recording(Recording&&) noexcept;             ///< a moved-from object may only be destroyed or assigned to
  Recording& operator=(Recording&&) noexcept;  ///< a moved-from object may only be destroyed or assigned to
  /// Closes the file and ignores errors; close() reports them.
  ~Recording();

  /// Records the current state if its tick is a multiple of the recording interval and after the last
  /// recorded tick; otherwise does nothing. Call it after each step, with the simulation of the constructor;
  /// for another simulation, it throws std::logic_error. A recording contains one run: throws
  /// std::logic_error if the tick is before that of an earlier call, or if the seed has changed, because the
  /// simulation was reset. Make a new recording after Simulation::reset(). Also throws std::logic_error after
  /// a step that threw, until Simulation::reset().
  void observe(const Simulation& simulation);
  /// Writes the frames that are still in memory to the file. Other processes can then read these frames, and
  /// they are not lost if this process dies. Full batches of frames are written without a call of flush().
  /// Call it if the recording interval is long, or before saving a checkpoint.
  void flush();
  /// Starts to write the frames that are still in memory. With the option `in_background`, start_flush()
  /// returns before the frames are written. Without the option, it is the same as flush().
  void start_flush();
  /// Writes the frames that are still in memory and closes the file. All HDF5 tools can then read it, also
  /// those without SWMR mode. Further calls of the functions of this recording do nothing.
  void close();

 private:
  struct Impl;
  explicit Recording(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
