#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace troupe {
class Simulation;
}  // namespace troupe

namespace troupe::live {

/// The checkpoints and recordings that viewers request. All files together have at most about 10 GB.
class ViewerFiles {
 public:
  /// folder: folder for the files; empty: the current folder
  /// report: called with a line of text if the limit ends a recording; may be null
  ViewerFiles(Simulation& simulation, std::filesystem::path folder,
              std::function<void(const std::string&)> report)
      : simulation_(simulation), folder_(std::move(folder)), report_(std::move(report)) {}

  const std::filesystem::path& folder() const { return folder_; }
  /// File of the recording that a viewer has started; empty: none.
  const std::filesystem::path& recording() const { return recording_; }
  /// Saves a checkpoint, or starts a recording, in a new file, and returns the name of the file. Throws
  /// ActRefused if the files have reached their limit or the run is being recorded already, and the
  /// exceptions of Simulation::save() and Simulation::record().
  std::string save_checkpoint();
  std::string start_recording();
  /// Ends the recording that a viewer has started. Does nothing without one.
  void stop_recording();
  /// Ends the recording if the files have reached their limit.
  void limit_recording();
  /// Call after a reset of the simulation, which has ended the recording.
  void forget_recording() { recording_.clear(); }

 private:
  std::filesystem::path new_file(std::string_view what) const;

  Simulation& simulation_;
  std::filesystem::path folder_;
  std::function<void(const std::string&)> report_;
  std::filesystem::path recording_;
  std::uintmax_t bytes_ = 0;  // size of all finished files
};

}  // namespace troupe::live
