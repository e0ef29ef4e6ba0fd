#pragma once

#include "engine/world/world.hpp"
#include "worldio/results/replay_plan.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace troupe::worldio {

inline constexpr int k_replay_format = 1;         ///< version of the format of docs/replay.md
inline constexpr double k_replay_step_m = 0.001;  ///< resolution of positions, m
inline constexpr int k_replay_turn =
    2048;  ///< number of steps in a whole turn: a heading has a resolution of 0.18 degrees
inline constexpr double k_replay_shape_m = 0.0001;  ///< resolution of outlines, m

/// The sizes of the compressed blocks of a page. A page is an HTML file that shows a recording. A block holds
/// consecutive frames (recorded states of the world). It consists of one stream of bytes for the poses and
/// one stream for each field.
struct ReplayBlocks {
  std::size_t frames = 0;                       ///< number of frames per block; the last block may have fewer
  std::vector<std::vector<std::size_t>> bytes;  ///< for each block, the sizes of its streams, bytes
};

/// Returns the header of a page as JSON text (docs/replay.md): shapes, names, colours, the times of the
/// frames, descriptions of the fields, and the sizes of the blocks. `plan` is the result of plan_replay() for
/// this recording. `frames` are the indices, in ascending order, of the recorded frames that the page shows.
std::string replay_header(const RecordingReader& recording, const ReplayPlan& plan,
                          std::span<const std::size_t> frames, const ReplayBlocks& blocks);

/// A part (rigid piece of a body) whose colour devices such as lights can change. The struct describes this
/// part for all bodies of one type (bodies of the same construction). These bodies are consecutive in
/// LivePage::order.
struct ShownPart {
  std::size_t first = 0;   ///< index in LivePage::order of the first of these bodies
  std::size_t count = 0;   ///< number of these bodies
  std::uint32_t part = 0;  ///< index of the part in the type, from 1 (0 is the body itself)
};

/// The data that a page needs before it can show a running world.
struct LivePage {
  /// Header as from replay_header(), without the keys that only recordings have. Its key `pose.has_z` is
  /// true: users, interventions and controllers can change the height of any body, so the page expects the
  /// height of each body in every state that it receives.
  std::string header;
  /// BodyIds (numbers in the world) of the bodies of the page, sorted by type, then by BodyId. These are all
  /// bodies of the world except static ones.
  std::vector<std::uint32_t> order;
  /// All parts in the lists `shown_parts` of `header`, sorted by ShownPart::first, then by ShownPart::part.
  std::vector<ShownPart> shown_parts;
};
/// Returns the data for a page that shows this world while it runs. `registry` must have the kinds (sorts) of
/// drives, devices and controllers of the world. Throws std::runtime_error if JSON cannot represent the
/// world, for example because a number is not finite.
LivePage live_page(const engine::World& world, const engine::Registry& registry);

}  // namespace troupe::worldio
