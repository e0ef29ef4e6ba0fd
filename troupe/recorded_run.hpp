#pragma once

#include "troupe/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace troupe {

/// A recording, seen again: its world, loaded from the file that it was recorded from, with the bodies where
/// the recording says. Nothing is simulated.
class RecordedRun {
 public:
  /// Throws InputError for what is no recording, or has no poses, or where its world is not there any more or
  /// is another one by now.
  explicit RecordedRun(const std::filesystem::path& recording,
                       const std::vector<std::filesystem::path>& plugin_path = {});
  ~RecordedRun();
  RecordedRun(RecordedRun&&) noexcept;
  RecordedRun& operator=(RecordedRun&&) noexcept;

  /// Puts every body where it was in the last frame that is not later than this. Throws InputError for a time
  /// before the first frame or after the last one, s.
  void go_to(double time_s);
  /// Of the frame it stands at: the last one, at first.
  double time_s() const;
  std::uint64_t state_hash() const;
  /// Of the last frame.
  double last_s() const;
  /// With poses of the frame, and everything else as the world begins.
  const Simulation& simulation() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
