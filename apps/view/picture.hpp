#pragma once

#include "engine/world.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace troupe::apps {

/// An instant of a running world, as viewers see it: copied by the thread that steps, encoded by the
/// server's.
struct Picture {
  std::uint64_t number = 0;  ///< pictures that were made, this one included
  std::string state;         ///< members of the JSON text that goes with it, for every viewer
  std::map<std::uint64_t, std::string>
      own;  ///< more members, by client: what it asked to inspect and to plot
  /// x, y (k_replay_step_m) and heading (k_replay_turn steps a turn, from 0; k_gone: it is not in the world)
  /// of each robot of the page, and z where heights may change: an axis after the other.
  std::vector<std::int32_t> poses;
  std::vector<std::uint8_t> colors;  ///< red, green, blue of each robot; empty where no body shows colours
};
inline constexpr std::int32_t k_gone = -1;

/// Fills poses and colours; `order` and `has_z` are those of worldio::LivePage.
void take(const engine::World& world, std::span<const std::uint32_t> order, bool has_z, bool has_colors,
          Picture& picture);

/// The binary frame of a picture for a viewer that knows `base`, which becomes what it then knows
/// (docs/live.md). An empty base: the viewer knows nothing.
std::string encode(const Picture& picture, std::size_t robots, std::vector<std::int32_t>& base,
                   std::vector<std::uint8_t>& base_colors);

}  // namespace troupe::apps
