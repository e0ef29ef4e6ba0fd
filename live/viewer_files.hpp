#pragma once

#include "troupe/recording.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace troupe {
class Simulation;
}  // namespace troupe

namespace troupe::live {

/// The files that viewers request: checkpoints, recordings, and the session files of restarted runs. All
/// files together have at most about 10 GB, and there are at most 1,000.
class ViewerFiles {
 public:
  /// Called with the reason if a recording ends because of an error or the limit.
  using Tell = std::function<void(const std::string&)>;

  /// folder: folder for the files; empty: the current folder
  ViewerFiles(Simulation& simulation, std::filesystem::path folder)
      : simulation_(simulation), folder_(std::move(folder)) {}

  const std::filesystem::path& folder() const { return folder_; }
  /// File of the recording that a viewer has started; empty: none.
  const std::filesystem::path& recording() const { return recording_; }
  /// Counts a new session file, because a viewer restarts the run. Throws ActRefused if the files have
  /// reached their limit.
  void add_session();
  /// Saves a checkpoint in a new file, and returns the name of the file. Throws ActRefused if the files have
  /// reached their limit or the file cannot be created, and the exceptions of Simulation::save().
  std::string save_checkpoint();
  /// Starts a recording in a new file, and returns the name of the file. `tell` is called once if
  /// the recording ends by itself: an error of a recording that a viewer has started must not end the run.
  /// Throws as save_checkpoint() does, ActRefused if a viewer has started a recording already, and the
  /// exceptions of the constructor of Recording.
  std::string start_recording(Tell tell);
  /// Records the present tick. Call it after each tick. If the file cannot be written, ends the recording.
  void observe();
  /// Ends the recording that a viewer has started. Does nothing without one. Throws std::runtime_error if the
  /// rest of the file cannot be written; the recording has then ended nevertheless.
  void stop_recording();
  /// Ends the recording after a reset of the simulation, because a recording contains one run. Tells the
  /// viewer if the rest of the file cannot be written.
  void end_with_the_run();
  /// Ends the recording if the files have reached their limit.
  void limit_recording();

 private:
  std::filesystem::path new_file(std::string_view what);
  void check_limit() const;
  void end_recording();
  /// Calls `use`. If it throws, ends the recording, and tells the viewer the error.
  void use_recording(const std::function<void(Recording&)>& use);

  Simulation& simulation_;
  std::filesystem::path folder_;
  std::filesystem::path recording_;
  std::optional<Recording> recorder_;  // writes recording_
  Tell tell_;                          // of the recording
  std::uintmax_t bytes_ = 0;           // size of all finished files, without sessions, which are small
  unsigned files_ = 0;                 // number of all files
};

}  // namespace troupe::live
