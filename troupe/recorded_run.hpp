#pragma once

#include "troupe/picture_source.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace troupe {

/// A recording, seen again. It holds all that it takes: neither the world's file nor its plug-ins are needed,
/// and nothing is simulated. Of what beside poses was recorded (--record-fields) pictures can show who is
/// stalled (`stall`), what rangers read (`ranges`), what power packs hold (`power_pack`), and any number as
/// colour. Parts that move are drawn where they were with `joint`, else at rest.
class RecordedRun : public PictureSource {
 public:
  /// Throws InputError for what is no recording, has no poses or no frame, or was recorded before scenes were
  /// kept.
  explicit RecordedRun(const std::filesystem::path& recording);
  ~RecordedRun() override;
  RecordedRun(RecordedRun&&) noexcept;             ///< the one moved from is of no use
  RecordedRun& operator=(RecordedRun&&) noexcept;  ///< as that

  /// Goes to the last frame that is not later than this. Throws InputError for a time before the first frame
  /// or after the last one, s.
  void go_to(double time_s);
  /// Of all its frames, rising, s.
  std::span<const double> times_s() const;
  /// The frame it stands at.
  std::size_t frame_index() const;
  void go_to_frame(std::size_t frame);  ///< the last one where there are not so many
  /// The first frame that is not earlier than so long before where it stands, s.
  std::size_t first_within(double history_s) const;

  // What PictureSource says, of the frame it stands at: the last one, at first.
  std::string file() const override;
  std::string world() const override;
  std::uint64_t seed() const override;
  double tick_s() const override;
  const engine::Record* window() const override;
  engine::FrameScene scene() const override;
  std::optional<std::uint32_t> find_body(std::string_view name) const override;
  /// Of what was recorded.
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
