#pragma once

#include "troupe/picture_source.hpp"

#include <filesystem>
#include <memory>

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
  RecordedRun(RecordedRun&&) noexcept;
  RecordedRun& operator=(RecordedRun&&) noexcept;

  /// Goes to the last frame that is not later than this. Throws InputError for a time before the first frame
  /// or after the last one, s.
  void go_to(double time_s);
  /// Goes through all frames from so long before where it stands to there, `history_s`, for
  /// Pictures::see().
  template <class See>
  void replay(double history_s, See&& see) {
    const std::size_t last = index();
    for (std::size_t frame = first_within(history_s); frame < last; ++frame) {
      set_index(frame);
      see(*this);
    }
    set_index(last);
    see(*this);
  }
  /// Of the last frame.
  double last_s() const;

  // What PictureSource says, of the frame it stands at: the last one, at first.
  std::string file() const override;
  std::uint64_t seed() const override;
  double tick_s() const override;
  const engine::Record* window() const override;
  engine::FrameScene scene() const override;
  std::optional<std::uint32_t> find_body(std::string_view name) const override;
  /// Of what was recorded.
  std::optional<ChosenValue> find_value(const std::string& name, std::string& fault) const override;
  std::string missing(const FrameWishes& wishes) const override;
  double time_s() const override;
  std::uint64_t state_hash() const override;
  engine::Frame frame(const FrameWishes& wishes) const override;

 private:
  std::size_t index() const;
  void set_index(std::size_t frame);
  std::size_t first_within(double history_s) const;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
