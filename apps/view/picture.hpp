#pragma once

#include "engine/world.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace troupe::apps {

/// The part of the state of a running world that viewers see. The thread that steps the world fills it, and
/// the thread of the server encodes it.
struct Picture {
  std::uint64_t number = 0;  ///< number of the picture, from 1
  std::string state;         ///< members of the JSON text that is sent with it to every client
  std::map<std::uint64_t, std::string>
      own;  ///< further members per client: the inspected robot and the plotted measure
  /// For each robot of the page, all x, then all y (in steps of k_replay_step_m), all headings (k_replay_turn
  /// steps per turn, from 0; k_gone: not in the world), and all z if heights can change.
  std::vector<std::int32_t> poses;
  std::vector<std::uint8_t> colors;  ///< red, green, blue of each robot; empty if no body shows colours
};
inline constexpr std::int32_t k_gone = -1;

/// Fills the poses and colours of a picture. `order` and `has_z` are those of worldio::LivePage.
void take(const engine::World& world, std::span<const std::uint32_t> order, bool has_z, bool has_colors,
          Picture& picture);

/// The binary frame of a picture (docs/live.md), encoded as the difference from `base`, the last picture that
/// the client received (empty: none). Sets `base` to this picture.
std::string encode(const Picture& picture, std::size_t robots, std::vector<std::int32_t>& base,
                   std::vector<std::uint8_t>& base_colors);

}  // namespace troupe::apps
