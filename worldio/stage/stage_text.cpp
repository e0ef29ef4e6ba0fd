#include "worldio/stage/stage_text.hpp"

#include "worldio/stage/stage_limits.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>

namespace troupe::worldio {

Pose relative_pose(const Pose& pose_a_b, const Pose& pose_a_c) {
  if (pose_a_b == Pose()) return pose_a_c;
  const Transform transform(pose_a_b);
  const Rotation& turn = transform.rotation;
  const Vec2 offset = pose_a_c.position() - transform.position;
  Pose guess{offset.x() * turn.cos + offset.y() * turn.sin, offset.y() * turn.cos - offset.x() * turn.sin, 0,
             0};
  guess.z = solved(pose_a_c.z, pose_a_c.z - pose_a_b.z, [&](double z) { return pose_a_b.z + z; });
  guess.heading = solved(pose_a_c.heading, wrap_angle(pose_a_c.heading - pose_a_b.heading),
                         [&](double heading) { return wrap_angle(pose_a_b.heading + heading); });
  const auto is_right = [&](const Pose& pose) {
    const Pose found = compose(pose_a_b, transform, pose);
    return same_bits(found.x, pose_a_c.x) && same_bits(found.y, pose_a_c.y);
  };
  constexpr int k_neighbours = 4;
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  const auto moved = [](double x, int steps) {
    for (int i = 0; i < steps; ++i) x = std::nextafter(x, k_infinity);
    for (int i = 0; i > steps; --i) x = std::nextafter(x, -k_infinity);
    return x;
  };
  for (int reach = 0; reach <= k_neighbours; ++reach)  // the nearest doubles first
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j) {
        const Pose near{moved(guess.x, i), moved(guess.y, j), guess.z, guess.heading};
        if (is_right(near)) return near;
      }
  return guess;
}

void StageText::comment(std::string_view text) {
  out_.append(indent_, ' ');
  out_ += fmt::format("# {}\n", text);
}

void StageText::begin(std::string_view key) {
  out_.append(indent_, ' ');
  out_ += key;
  out_ += ' ';
}

void StageText::open(std::string_view word) {
  begin(word);
  out_ += "(\n";
  indent_ += 2;
}

void StageText::define(std::string_view word, std::string_view base) {
  open(fmt::format("define {} {}", word, base));
}

void StageText::close() {
  indent_ -= 2;
  out_.append(indent_, ' ');
  out_ += ")\n";
}

void StageText::number(std::string_view key, double value) {
  begin(key);
  out_ += spelt(value) + '\n';
}

template <class Value>
void StageText::tuple(std::string_view key, std::span<const Value> values) {
  begin(key);
  out_ += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out_ += ' ';
    out_ += spelt(values[i]);
  }
  out_ += "]\n";
}

void StageText::numbers(std::string_view key, std::span<const double> values) { tuple(key, values); }

void StageText::pose(std::string_view key, const Pose& pose) {
  numbers(key, std::array{pose.x, pose.y, pose.z, pose.heading});
}

void StageText::text(std::string_view key, std::string_view value) {
  begin(key);
  out_ += spelt(value) + '\n';
}

void StageText::texts(std::string_view key, std::span<const std::string> values) { tuple(key, values); }

std::string StageText::spelt(double value) {
  if (!(std::abs(value) <= k_largest_number))
    diagnostics_.error(
        where_,
        fmt::format("{:g} is out of range for a .world file; numbers must be from -2^53 to 2^53", value));
  std::array<char, 1200> digits{};  // the smallest double has 1074 digits after the point
  const auto [end, error] =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed);
  return {digits.data(), end};
}

std::string StageText::spelt(std::string_view text) {
  if (text.find_first_of("\"\n\r") != text.npos)
    diagnostics_.error(
        where_,
        fmt::format(
            "a .world file cannot express the string \"{}\": strings in a .world file must not contain "
            "double quotes or line ends",
            text));
  return fmt::format("\"{}\"", text);
}

}  // namespace troupe::worldio
