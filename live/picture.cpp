#include "live/picture.hpp"

#include "base/math.hpp"
#include "engine/sensing/shown_color.hpp"
#include "worldio/results/replay_codec.hpp"
#include "worldio/results/replay_header.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace troupe::live {
namespace {

using worldio::append_number;

constexpr std::size_t k_axes = 4;         // x, y, heading and z
constexpr double k_farthest_steps = 1e9;  // 1,000 km; positions are clamped to it

std::int32_t steps_of(double metres) {
  return static_cast<std::int32_t>(
      std::lround(std::clamp(metres / worldio::k_replay_step_m, -k_farthest_steps, k_farthest_steps)));
}

std::int32_t heading_steps(double heading) {
  const long steps = std::lround(heading / (2 * k_pi) * worldio::k_replay_turn);
  return static_cast<std::int32_t>((steps % worldio::k_replay_turn + worldio::k_replay_turn) %
                                   worldio::k_replay_turn);
}

void append_signed(std::int64_t value, std::string& out) {
  append_number((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63), out);
}

/// Appends the poses of the robots whose poses differ from those in `sent`, and sets `sent` to `poses`.
void append_poses(std::string& out, const std::vector<std::int32_t>& poses, std::size_t robots,
                  std::vector<std::int32_t>& sent) {
  sent.resize(poses.size(), 0);
  std::size_t skipped = 0;
  for (std::size_t r = 0; r < robots; ++r) {
    const auto differs = [&](std::size_t axis) {
      return poses[axis * robots + r] != sent[axis * robots + r];
    };
    if (!differs(0) && !differs(1) && !differs(2) && !differs(3)) {
      ++skipped;
      continue;
    }
    append_number(skipped + 1, out);
    skipped = 0;
    for (std::size_t axis = 0; axis < k_axes; ++axis)
      append_signed(std::int64_t{poses[axis * robots + r]} - sent[axis * robots + r], out);
  }
  append_number(0, out);
  sent = poses;
}

/// Appends the bytes of the robots (or parts) whose bytes differ from those in `sent`, and sets `sent` to
/// `bytes`. each: bytes per robot or part.
void append_bytes(std::string& out, const std::vector<std::uint8_t>& bytes, std::size_t each,
                  std::vector<std::uint8_t>& sent) {
  sent.resize(bytes.size(), 0);
  std::size_t skipped = 0;
  for (std::size_t at = 0; at < bytes.size(); at += each) {
    const auto robot = std::span(bytes).subspan(at, each);
    if (std::ranges::equal(robot, std::span(sent).subspan(at, each))) {
      ++skipped;
      continue;
    }
    append_number(skipped + 1, out);
    skipped = 0;
    for (const std::uint8_t byte : robot) out += static_cast<char>(byte);
  }
  append_number(0, out);
  sent = bytes;
}

/// Writes red, green and blue of a part of a body, each from 0 to 255, to `into`: the colour that a device
/// gives the part, else the colour of the body. part: index of the part; 0: the body itself.
void put_color(const engine::World& world, std::uint32_t body, std::uint32_t part,
               std::span<std::uint8_t> into) {
  const Color color = engine::shown_color(world.view(), world.view().row(BodyId(body)), part)
                          .value_or(world.spec().bodies[body].color);
  into[0] = to_byte(color.r);
  into[1] = to_byte(color.g);
  into[2] = to_byte(color.b);
}

}  // namespace

void take(const engine::World& world, std::span<const std::uint32_t> order, bool has_colors,
          std::span<const worldio::ShownPart> parts, Picture& picture) {
  const std::size_t robots = order.size();
  picture.poses.resize(k_axes * robots);
  std::size_t colors = robots;
  for (const worldio::ShownPart& part : parts) colors += part.count;
  picture.colors.resize(has_colors ? 3 * colors : 0);
  for (std::size_t r = 0; r < robots; ++r) {
    const Row row = world.view().row(BodyId(order[r]));
    const Pose& pose = world.view().poses()[row.index()];
    const bool there = world.view().is_there(row);
    picture.poses[r] = there ? steps_of(pose.x) : 0;
    picture.poses[robots + r] = there ? steps_of(pose.y) : 0;
    picture.poses[2 * robots + r] = there ? heading_steps(pose.heading) : k_gone;
    picture.poses[3 * robots + r] = there ? steps_of(pose.z) : 0;
    if (!has_colors) continue;
    put_color(world, order[r], 0, std::span(picture.colors).subspan(3 * r, 3));
  }
  std::size_t at = 3 * robots;
  for (const worldio::ShownPart& part : parts)
    for (std::size_t r = part.first; r < part.first + part.count; ++r, at += 3)
      put_color(world, order[r], part.part, std::span(picture.colors).subspan(at, 3));
}

std::string encode(const Picture& picture, std::size_t robots, std::uint64_t client, SentPicture& sent) {
  std::string out;
  append_number(picture.number, out);
  append_poses(out, picture.poses, robots, sent.poses);
  append_bytes(out, picture.colors, 3, sent.colors);
  if (const auto shades = picture.shades.find(client); shades != picture.shades.end())
    append_bytes(out, shades->second, 1, sent.shades);
  sent.number = picture.number;
  return out;
}

}  // namespace troupe::live
