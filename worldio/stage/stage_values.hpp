#pragma once

#include "base/color.hpp"
#include "base/pose.hpp"
#include "engine/fields/fields.hpp"
#include "worldio/stage/stage_parser.hpp"

#include <Eigen/Core>

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace troupe::worldio {

/// Reads the values of properties of a `.world` file, the world file of Stage (an older robot simulator). If
/// a value is wrong, the function that reads it reports an error and returns std::nullopt. The same message
/// is reported only once per line of a file, even if many instances of a macro share this line.
///
/// Poses and sizes are returned in m and rad. number(), integer(), tuple() and column() return numbers as in
/// the file, without conversion.
class StageValues {
 public:
  StageValues(const StageDocument& document, Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {}

  /// Sets the units of the file. `length` is the factor that converts lengths of the file to metres, and
  /// `angle` is the factor that converts its angles to radians. Before the call, lengths are in metres and
  /// angles in degrees.
  void set_units(double length, double angle) { length_ = length, angle_ = angle; }
  /// Sets whether pose_in_device() wraps headings into [-pi, pi]. By default it does.
  void set_wraps_headings(bool wraps) { wraps_headings_ = wraps; }
  double length_unit() const { return length_; }
  double angle_unit() const { return angle_; }
  /// The unit of the file for values of this unit, in SI units; 1 for units other than lengths and angles.
  double unit(engine::Unit unit) const;

  bool thorough() const { return diagnostics_.thorough(); }
  void error(Where where, std::string message);
  void warning(Where where, std::string message);
  /// Reports a warning. If the same message occurs at several places, only the first place is listed, and the
  /// others are counted (Diagnostics::warning_once()).
  void warning_once(Where where, std::string message);

  /// Reports a warning that may be the cause of errors, as Diagnostics::explain() does.
  void explain(Where where, std::string message);

  /// Returns the place `where` as text for a message about the place `from`: "line 4" if both are in the same
  /// file, else with the name of the file: "robots.inc:4".
  std::string place(Where where, Where from) const;
  Where where(const StageProperty& property) const { return document_.token(property.key).where(); }
  std::string_view key(const StageProperty& property) const { return document_.key(property); }

  /// Returns a single value as text, without the quotes that it may have in the file. A tuple is an error.
  std::optional<std::string_view> text(const StageProperty& property);
  /// Returns a name as text() does. If the name is "" or "/", warns and returns std::nullopt.
  std::optional<std::string_view> name(const StageProperty& property);
  /// Returns all values of a tuple, or the single value, as texts.
  std::vector<std::string_view> texts(const StageProperty& property);
  /// Returns a single number as in the file, from -2^53 to 2^53.
  std::optional<double> number(const StageProperty& property);
  /// Returns a single whole number from -2^53 to 2^53.
  std::optional<std::int64_t> integer(const StageProperty& property);
  /// Returns a switch, which the file writes as a whole number: false for 0, true for all other numbers.
  std::optional<bool> flag(const StageProperty& property);
  /// Like the other flag(), but returns `otherwise` if `property` is null or has another value than a switch.
  bool flag(const StageProperty* property, bool otherwise);
  /// Returns the numbers of a tuple. Fewer than `least` numbers are an error. Numbers after the first `most`
  /// are dropped with a warning. `layout` describes the tuple in messages: "[x y z]".
  std::optional<std::vector<double>> tuple(const StageProperty& property, std::size_t least, std::size_t most,
                                           std::string_view layout);

  /// Reports a value outside the limits of a property. If `unused` says why the property has no effect
  /// (engine::unused_reason()), this is a warning, and the result is true: the value may be kept.
  bool may_exceed(Where where, std::string message, const std::string& unused);
  /// Whether a number is within the limits of a parameter. If not, reports an error.
  /// field    the description of the parameter, with the limits
  /// si       the number in SI units
  /// written  the number as the file gives it
  /// unused   why the property has no effect, as in may_exceed()
  bool is_within(const StageProperty& property, const engine::Field& field, double si, double written,
                 const std::string& unused = {});
  /// Whether a height, m, that is the sum of several values of the file is within the limits of coordinates.
  /// If not, reports an error. `what` is the subject of the message: "the middle of this sensor".
  bool is_in_reach(Where where, double z_m, std::string_view what);
  /// Reads a tuple of two numbers and returns one of them: the first if `column` is 0, the second if it is 1.
  std::optional<double> column(const StageProperty& property, std::size_t column);

  /// Reads a pose [x y z heading], or the older form [x y heading]. The heading is wrapped into [-pi, pi].
  /// Coordinates must be from -100 km to 100 km.
  std::optional<Pose> pose(const StageProperty& property);
  /// Reads a pose like pose(), but for a transducer (fan of beams of a ranger) or a bumper. The result is the
  /// pose in the frame of the device. After set_wraps_headings(false), the heading is not wrapped.
  std::optional<Pose> pose_in_device(const StageProperty& property);
  /// Reads a size [x y z]. In the older form [x y], z is `default_height` (m). Each extent must be from 0 to
  /// 100 km. The caller must check whether 0 is allowed.
  std::optional<Eigen::Vector3d> size(const StageProperty& property, double default_height);
  /// Reads a colour by its X11 name (color_by_name()). For an unknown name, warns and returns red. For
  /// "random", returns std::nullopt without an error.
  std::optional<Color> color(const StageProperty& property);
  /// Reads a colour [red green blue opacity] with four numbers from 0 to 1.
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
