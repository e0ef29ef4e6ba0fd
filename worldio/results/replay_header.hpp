#pragma once

#include "engine/world.hpp"
#include "worldio/results/replay_plan.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace troupe::worldio {

inline constexpr int k_replay_format = 1;
inline constexpr double k_replay_step_m = 0.001;    ///< step of positions
inline constexpr int k_replay_turn = 2048;          ///< steps in a whole turn: 0.18 degrees each
inline constexpr double k_replay_shape_m = 0.0001;  ///< step of outlines

/// The frames of a page are compressed in blocks, each with one stream for the poses and one per field.
struct ReplayBlocks {
  std::size_t frames = 0;                       ///< per block; the last may have fewer
  std::vector<std::vector<std::size_t>> bytes;  ///< per block: of each stream
};

/// Returns what does not change, as JSON: shapes, names, colours, times, fields (docs/replay.md).
std::string replay_header(const RecordingReader& recording, const ReplayPlan& plan,
                          std::span<const std::size_t> frames, const ReplayBlocks& blocks);

/// What a page that shows a running world needs at its start.
struct LivePage {
  std::string header;                ///< as replay_header(), without the keys that only recordings have
  std::vector<std::uint32_t> order;  ///< BodyId of each robot of the page: by type, then by id
  bool has_z = false;                ///< heights may change; else the header has them
};
LivePage live_page(const engine::World& world, const engine::Registry& registry);

}  // namespace troupe::worldio
