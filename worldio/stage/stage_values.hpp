#pragma once

#include "base/color.hpp"
#include "base/pose.hpp"
#include "worldio/stage/stage_parser.hpp"

#include <Eigen/Core>

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace troupe::worldio {

/// The values of properties, in SI units. Every finding is reported once for its place in a file, however
/// many instances of a macro come by it. Where a value is unusable the answer is empty, or the fallback.
class StageValues {
 public:
  StageValues(const StageDocument& document, Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {}

  /// Factors to metres and radians, from then on.
  void set_units(double length, double angle) { length_ = length, angle_ = angle; }
  void set_wraps_headings(bool wraps) { wraps_headings_ = wraps; }
  double length_unit() const { return length_; }
  double angle_unit() const { return angle_; }

  bool thorough() const { return diagnostics_.thorough(); }
  void error(Where where, std::string message);
  void warning(Where where, std::string message);
  /// Counted, and listed once.
  void warning_once(Where where, std::string message);

  /// Of another file than that of `from` with its name: "line 4", or "robots.inc:4".
  std::string place(Where where, Where from) const;
  Where where(const StageProperty& property) const { return document_.token(property.key).where(); }
  std::string_view key(const StageProperty& property) const { return document_.key(property); }

  /// The one value as text, quoted or not.
  std::optional<std::string_view> text(const StageProperty& property);
  /// The same for names: a warning where there is nothing but perhaps a "/".
  std::optional<std::string_view> name(const StageProperty& property);
  /// The one value, or each of a tuple.
  std::vector<std::string_view> texts(const StageProperty& property);
  std::optional<double> number(const StageProperty& property);
  /// A whole number that fits 53 bits.
  std::optional<std::int64_t> integer(const StageProperty& property);
  std::optional<bool> flag(const StageProperty& property);
  /// At least `least` numbers; `layout` names them in messages: "[x y z]". More than `most` is a warning.
  std::optional<std::vector<double>> tuple(const StageProperty& property, std::size_t least, std::size_t most,
                                           std::string_view layout);

  /// One number of a tuple of two.
  std::optional<double> column(const StageProperty& property, std::size_t column);

  /// [x y z heading], or the older [x y heading]; the heading is wrapped into [-pi, pi]. At most 100 km away.
  std::optional<Pose> pose(const StageProperty& property);
  /// The same of a transducer or a bumper in its device's frame: wrapped unless set_wraps_headings(false).
  std::optional<Pose> pose_in_device(const StageProperty& property);
  /// [x y z], each 0 or above and at most 200 km, or the older [x y]. Whether 0 will do is the caller's
  /// matter.
  std::optional<Eigen::Vector3d> size(const StageProperty& property, double default_height);
  /// An X11 name; empty for "random" too. An unknown name is red, with a warning.
  std::optional<Color> color(const StageProperty& property);
  std::optional<Color> color_rgba(const StageProperty& property);

 private:
  std::optional<double> number(const StageProperty& property, const StageToken& token);
  std::optional<Pose> pose(const StageProperty& property, bool is_wrapped);
  bool first_time(Where where, const std::string& message);

  const StageDocument& document_;
  Diagnostics& diagnostics_;
  double length_ = 1;
  double angle_ = radians(1);
  bool wraps_headings_ = true;
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::string>> reported_;
};

}  // namespace troupe::worldio
