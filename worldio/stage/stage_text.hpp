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

/// A number that `read` turns into just this value: the guess or one of its neighbours; the guess where none
/// of them does.
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

/// pose_b_c where compose(pose_a_b, pose_b_c) is pose_a_c, to the last bit where any number does that.
Pose relative_pose(const Pose& pose_a_b, const Pose& pose_a_c);

/// The text of a world in Stage's syntax, in the making. Numbers have the fewest digits that read back as the
/// same double, without an exponent, which Stage does not know.
class StageText {
 public:
  explicit StageText(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  /// Where what is written next comes from: of texts and numbers that Stage has no way to write.
  void at(Where where) { where_ = where; }
  void comment(std::string_view text);
  /// `word (`, or `define word base (`, until close().
  void open(std::string_view word);
  void define(std::string_view word, std::string_view base);
  void close();

  void number(std::string_view key, double value);
  void flag(std::string_view key, bool value) { number(key, value ? 1 : 0); }
  void numbers(std::string_view key, std::span<const double> values);
  void pose(std::string_view key, const Pose& pose);
  void text(std::string_view key, std::string_view value);
  void texts(std::string_view key, std::span<const std::string> values);

  const std::string& str() const { return out_; }

 private:
  void begin(std::string_view key);
  std::string spelt(double value);
  std::string spelt(std::string_view text);

  Diagnostics& diagnostics_;
  Where where_;
  std::string out_;
  std::size_t indent_ = 0;
};

}  // namespace troupe::worldio
