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

/// Reads the values of properties, in SI units. A finding is reported once per place in a file, even if many
/// instances of a macro share it. A wrong value is an error and returned as empty.
class StageValues {
 public:
  StageValues(const StageDocument& document, Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {}

  /// Sets the factors to metres and radians for the values read afterwards.
  void set_units(double length, double angle) { length_ = length, angle_ = angle; }
  void set_wraps_headings(bool wraps) { wraps_headings_ = wraps; }
  double length_unit() const { return length_; }
  double angle_unit() const { return angle_; }

  bool thorough() const { return diagnostics_.thorough(); }
  void error(Where where, std::string message);
  void warning(Where where, std::string message);
  /// As Diagnostics::warning_once(): later places are counted, not listed.
  void warning_once(Where where, std::string message);

  /// "line 4", or "robots.inc:4" if the file is not that of `from`.
  std::string place(Where where, Where from) const;
  Where where(const StageProperty& property) const { return document_.token(property.key).where(); }
  std::string_view key(const StageProperty& property) const { return document_.key(property); }

  /// A single value as text, quoted or not.
  std::optional<std::string_view> text(const StageProperty& property);
  /// As text(), for names; "" and "/" are a warning and empty.
  std::optional<std::string_view> name(const StageProperty& property);
  /// The single value, or every value of a tuple.
  std::vector<std::string_view> texts(const StageProperty& property);
  std::optional<double> number(const StageProperty& property);
  /// A whole number that fits 53 bits.
  std::optional<std::int64_t> integer(const StageProperty& property);
  std::optional<bool> flag(const StageProperty& property);
  /// At least `least` numbers. More than `most` is a warning, and the rest is dropped. `layout` describes
  /// them in messages: "[x y z]".
  std::optional<std::vector<double>> tuple(const StageProperty& property, std::size_t least, std::size_t most,
                                           std::string_view layout);

  /// One number of a tuple of two, by its index.
  std::optional<double> column(const StageProperty& property, std::size_t column);

  /// [x y z heading], or the older [x y heading]; the heading is wrapped into [-pi, pi]. Coordinates are at
  /// most 100 km.
  std::optional<Pose> pose(const StageProperty& property);
  /// As pose(), for a transducer or a bumper in its device's frame: set_wraps_headings(false) keeps the
  /// heading as it is.
  std::optional<Pose> pose_in_device(const StageProperty& property);
  /// [x y z], or the older [x y] with the default height, m. Each is at least 0 and at most 200 km; the
  /// caller decides whether 0 is allowed.
  std::optional<Eigen::Vector3d> size(const StageProperty& property, double default_height);
  /// A colour by its X11 name; empty for "random". An unknown name is red, with a warning.
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
