#pragma once

#include "troupe/picture_source.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace troupe {

/// A recording, seen again: its world, loaded from the file that it was recorded from, with the bodies where
/// the recording says. Nothing is simulated.
class RecordedRun : public PictureSource {
 public:
  /// Throws InputError for what is no recording, or has no poses, or where its world is not there any more or
  /// is another one by now.
  explicit RecordedRun(const std::filesystem::path& recording,
                       const std::vector<std::filesystem::path>& plugin_path = {});
  ~RecordedRun() override;
  RecordedRun(RecordedRun&&) noexcept;
  RecordedRun& operator=(RecordedRun&&) noexcept;

  /// Puts every body where it was in the last frame that is not later than this. Throws InputError for a time
  /// before the first frame or after the last one, s.
  void go_to(double time_s);
  /// Of the last frame.
  double last_s() const;

  // What PictureSource says, of the frame it stands at: the last one, at first.
  std::string file() const override;
  std::uint64_t seed() const override;
  double tick_s() const override;
  const engine::Record* window() const override;
  engine::FrameScene scene() const override;
  std::optional<std::uint32_t> find_body(std::string_view name) const override;
  std::optional<ChosenValue> find_value(const std::string& name, std::string& fault) const override;
  std::string missing(const FrameWishes& wishes) const override;
  double time_s() const override;
  std::uint64_t state_hash() const override;
  engine::Frame frame(const FrameWishes& wishes) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
