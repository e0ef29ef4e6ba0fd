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

/// A recording (docs/recordings.md) as a source of pictures. A frame is the recorded state at one tick (time
/// step). Drawing a frame simulates nothing, and needs neither the world file nor its plug-ins.
///
/// What pictures can show depends on the recorded fields of the state (the option --record-fields of
/// `troupe run`):
/// - `stall`: marks on robots whose motion was blocked
/// - `ranges`: scans of rangers (range sensors)
/// - `power_pack`: charges of power packs (energy stores)
/// - `joint`: present positions of parts on joints; without this field, parts are drawn in their rest
///   position
/// - the field of a value: robots coloured by this value
///
/// The layers `sights`, `blobs`, `grips` and `links` of pictures (detections of sensors, gripped and carried
/// bodies) cannot be drawn.
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

  /// Makes the last frame at or before this simulated time the current frame; time in s. Throws InputError if
  /// the time is before the first frame, after the last frame or NaN.
  void go_to(double time_s);
  /// Simulated times of all frames, s, in ascending order; never empty.
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
  /// Finds a value by name among the recorded fields: COMPONENT.FIELD or COMPONENT.FIELD.COLUMN
  /// (troupe/picture_source.hpp). Earlier versions of Troupe spelled these names differently. Old names with
  /// a dot before the field, such as `sensors/minibot/eye.ranges`, are also found. Old names with a slash
  /// before the field, such as `sensors/minibot/eye/ranges`, are not found; the error then states the present
  /// name.
  Result<ChosenValue> find_value(const std::string& name) const override;
  /// Returns the present name of a value if `name` is its name in earlier versions of Troupe. For example,
  /// the present name of `sensors/minibot/eye.ranges.3` is `eye.ranges.3`. Empty for all other names.
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
