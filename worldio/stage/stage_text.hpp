#pragma once

#include "base/diagnostics.hpp"
#include "base/pose.hpp"
#include "worldio/json/fields_json.hpp"

#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace troupe::worldio {

/// Searches for a number x for which read(x) equals `value` in every bit, and returns x. `read` is a function
/// from double to double, such as a conversion of units. The function tries `guess`, the seven nearest
/// doubles above it and the seven nearest below it. If none of them fits, the function returns `guess`.
template <class Read>
double solved(double value, double guess, Read read) {
  constexpr int k_neighbours = 8;
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  double above = guess;
  double below = guess;
  for (int i = 0; i < k_neighbours; ++i) {
    if (same_bits(read(above), value)) return above;
    if (same_bits(read(below), value)) return below;
    above = std::nextafter(above, k_infinity);
    below = std::nextafter(below, -k_infinity);
  }
  return guess;
}

/// Returns the pose of a frame c in a frame b. The arguments are the poses of b and c in a frame a.
/// compose(pose_a_b, result) equals pose_a_c in every bit if the function finds such a result; otherwise the
/// two poses differ by rounding.
Pose relative_pose(const Pose& pose_a_b, const Pose& pose_a_c);

/// Builds the text of a world in the syntax of Stage, an older robot simulator. Numbers have the fewest
/// digits that read back as the same double. They have no exponent, because Stage's syntax has none.
class StageText {
 public:
  explicit StageText(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// Sets the place that the errors of later calls refer to. A text with a double quote or a line end is an
  /// error. A number that is not finite, or that exceeds 2^53 in absolute value, is also an error.
  void at(Where where) { where_ = where; }
  /// Writes a line `# text`. The text must not have a line end.
  void comment(std::string_view text);
  /// Writes the beginning or end of an entity: open() writes `word (`, define() writes `define word base (`,
  /// and close() writes the `)` of either.
  void open(std::string_view word);
  void define(std::string_view word, std::string_view base);
  void close();

  /// Each of these functions writes one property on a line of its own. A flag is written as 1 or 0;
  /// numbers(), pose() and texts() write tuples. Lengths and angles are written as given, in m and rad.
  ///@{
  void number(std::string_view key, double value);
  void flag(std::string_view key, bool value) { number(key, value ? 1 : 0); }
  void numbers(std::string_view key, std::span<const double> values);
  void pose(std::string_view key, const Pose& pose);
  void text(std::string_view key, std::string_view value);
  void texts(std::string_view key, std::span<const std::string> values);
  ///@}

  /// Returns the text written so far.
  const std::string& str() const { return out_; }

 private:
  void begin(std::string_view key);
  template <class Value>
  void tuple(std::string_view key, std::span<const Value> values);
  std::string spelt(double value);
  std::string spelt(std::string_view text);

  Diagnostics& diagnostics_;
  Where where_;
  std::string out_;
  std::size_t indent_ = 0;
};

}  // namespace troupe::worldio
