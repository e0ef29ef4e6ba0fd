#pragma once

#include "engine/world/world.hpp"
#include "worldio/results/replay_header.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace troupe::live {

/// The data of a running world after one tick that the server sends to its clients (connected pages and
/// programs). The thread that steps the world fills a picture, and the thread of the server encodes it.
struct Picture {
  std::uint64_t number = 0;  ///< number of the picture, from 1
  std::string state;         ///< JSON members, without braces, that every client receives (docs/live.md)
  /// Further JSON members that only one client receives, by the number of the client: for example, the state
  /// of the robot that the client inspects.
  std::map<std::uint64_t, std::string> own;
  /// The poses of the robots that the page shows, world frame, in the order of the page (the argument `order`
  /// of take()): first x of all robots, then y of all, then the heading of all, then z of all. x, y and z are
  /// in units of worldio::k_replay_step_m (1 mm) and clamped to +-1000 km. Headings are numbers from 0 to
  /// worldio::k_replay_turn - 1, in units of 1 / k_replay_turn of a turn. A robot that is not in the world
  /// has the heading k_gone; its other values are 0.
  std::vector<std::int32_t> poses;
  /// Red, green and blue, each from 0 to 255: first of each robot, and then of each part whose colour is set
  /// by a device. The parts are in the order of worldio::LivePage::shown_parts. An entry of shown_parts
  /// stands for one part of a type of robots; it has one colour per robot of this type, in the order of the
  /// page. Empty if take() was called without `has_colors`.
  std::vector<std::uint8_t> colors;
  /// For each client that colours robots by a value, by the number of the client: one byte per robot, from 1
  /// for the lowest value to 255 for the highest, 0 for no value (take_shades(), live/watched.hpp).
  std::map<std::uint64_t, std::vector<std::uint8_t>> shades;
};
/// Heading of robots that are not in the world.
inline constexpr std::int32_t k_gone = -1;

/// Fills the poses and colours of a picture with the current state of the world. order: the ids of the robots
/// that the page shows, in the order of the page; parts: the parts whose colour is set by a device (both are
/// members of worldio::LivePage). has_colors: whether robots or their parts show colours that change; it must
/// be true if `parts` is not empty.
void take(const engine::World& world, std::span<const std::uint32_t> order, bool has_colors,
          std::span<const worldio::ShownPart> parts, Picture& picture);

/// The content of the last picture that was sent to a client; empty if none was sent.
struct SentPicture {
  std::uint64_t number = 0;  ///< Picture::number; 0 if no picture was sent
  std::vector<std::int32_t> poses;
  std::vector<std::uint8_t> colors;
  std::vector<std::uint8_t> shades;
};

/// Returns the binary WebSocket frame of a picture for a client (docs/live.md), which contains the number of
/// the picture and its differences from `sent`. Sets `sent` to the content of this picture. If the picture
/// has no shades for the client, the frame has none either, and `sent.shades` does not change. robots: number
/// of robots that the page shows. client: number of the client, which selects its Picture::shades.
std::string encode(const Picture& picture, std::size_t robots, std::uint64_t client, SentPicture& sent);

}  // namespace troupe::live
