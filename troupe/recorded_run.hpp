#pragma once

#include "troupe/picture_source.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace troupe {

/// A recording (docs/recordings.md) as a source of pictures. A frame is what the recording contains for one
/// tick. A tick is a time step of the simulation. Drawing a frame needs neither the world file nor its
/// plug-ins, and simulates nothing. What pictures can show depends on the fields of the state that were
/// recorded (the option --record-fields of `troupe run`): robots whose motion was blocked need `stall`, scans
/// of rangers (range sensors) need `ranges`, charges of power packs (energy stores) need `power_pack`, and
/// colours by a value need the field of that value. Parts on joints are drawn at their recorded positions if
/// `joint` was recorded, else in their rest position. The layers `sights`, `blobs`, `grips` and `links` of
/// pictures (detections of sensors, gripped and carried bodies) cannot be drawn.
class RecordedRun : public PictureSource {
 public:
  /// Throws InputError if the file is not a recording, has no poses or no frames, or was written by an old
  /// version of Troupe that did not store the static scene (the bodies that never move).
  explicit RecordedRun(const std::filesystem::path& recording);
  ~RecordedRun() override;
  /// The moved-from object may only be destroyed or assigned to.
  ///@{
  RecordedRun(RecordedRun&&) noexcept;
  RecordedRun& operator=(RecordedRun&&) noexcept;
  ///@}

  /// Makes the last frame at or before this world time, s, the current frame. Throws InputError if the time
  /// is before the first frame or after the last frame.
  void go_to(double time_s);
  /// World times of all frames, s, in ascending order; never empty.
  std::span<const double> times_s() const;
  /// Index of the current frame in times_s(). After construction, the last frame is the current one.
  std::size_t frame_index() const;
  /// Makes the frame with this index the current frame. Indices after the last frame select the last frame.
  void go_to_frame(std::size_t frame);
  /// Index in times_s() of the earliest frame that is at most `history_s` seconds before the current frame.
  std::size_t first_within(double history_s) const;

  // The functions of PictureSource (troupe/picture_source.hpp), for the current frame.
  std::string file() const override;
  std::string world() const override;
  std::uint64_t seed() const override;
  double tick_s() const override;
  const engine::Record* window() const override;
  engine::FrameScene scene() const override;
  std::optional<std::uint32_t> find_body(std::string_view name) const override;
  /// Finds a value by name among the recorded fields. Names in the form of earlier versions of Troupe are
  /// also found if they have a dot before the field, as in `sensors/minibot/eye.ranges`. If such a name has a
  /// slash before the field, as in `sensors/minibot/eye/ranges`, it is not found, and the error states the
  /// present name.
  Result<ChosenValue> find_value(const std::string& name) const override;
  /// Returns the present name of a value if `name` is its name in earlier versions of Troupe, such as
  /// `eye.ranges.3` for `sensors/minibot/eye.ranges.3`. Empty for all other names.
  std::optional<std::string> present_name(std::string_view name) const;
  Result<> check(const FrameWishes& wishes) const override;
  double time_s() const override;
  std::uint64_t state_hash() const override;
  engine::Frame frame(const FrameWishes& wishes) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
