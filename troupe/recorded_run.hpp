#pragma once

#include "troupe/picture_source.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace troupe {

/// A recording as a source of pictures. It needs neither the world's file nor its plug-ins, and simulates
/// nothing. If the fields were recorded (--record-fields), pictures show stalls (`stall`), scans of rangers
/// (`ranges`), charges of power packs (`power_pack`), and any number as colour. Parts on joints are drawn as
/// recorded with `joint`, else at rest.
class RecordedRun : public PictureSource {
 public:
  /// Throws InputError for a file that is not a recording, has no poses or no frame, or comes from a version
  /// that did not store scenes.
  explicit RecordedRun(const std::filesystem::path& recording);
  ~RecordedRun() override;
  RecordedRun(RecordedRun&&) noexcept;             ///< the source may only be destroyed or assigned
  RecordedRun& operator=(RecordedRun&&) noexcept;  ///< the source may only be destroyed or assigned

  /// Goes to the last frame at or before this time, s. Throws InputError for a time before the first frame or
  /// after the last one.
  void go_to(double time_s);
  /// Times of all frames, rising, s.
  std::span<const double> times_s() const;
  /// Index of the current frame; at first the last one.
  std::size_t frame_index() const;
  void go_to_frame(std::size_t frame);  ///< goes to this frame, or to the last one if there are fewer
  /// The first frame at or after the current time less `history_s`, s.
  std::size_t first_within(double history_s) const;

  // PictureSource, for the current frame.
  std::string file() const override;
  std::string world() const override;
  std::uint64_t seed() const override;
  double tick_s() const override;
  const engine::Record* window() const override;
  engine::FrameScene scene() const override;
  std::optional<std::uint32_t> find_body(std::string_view name) const override;
  /// Resolves a name among the recorded fields.
  Result<ChosenValue> find_value(const std::string& name) const override;
  Result<> check(const FrameWishes& wishes) const override;
  double time_s() const override;
  std::uint64_t state_hash() const override;
  engine::Frame frame(const FrameWishes& wishes) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
