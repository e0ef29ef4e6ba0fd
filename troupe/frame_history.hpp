#pragma once

#include "engine/frame.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace troupe {

/// Where bodies have been in the last seconds. Frames come in the order of their ticks; one of an earlier
/// tick begins a new history.
class Trails {
 public:
  static constexpr double k_seconds = 20;

  explicit Trails(double tick_s);
  /// Whether a frame of this tick would be kept; of all others see() makes nothing.
  bool wants(std::uint64_t tick) const;
  void see(const engine::Frame& frame);
  /// Fills Frame::trails.
  void add_to(engine::Frame& frame) const;

 private:
  struct Seen {
    std::uint64_t tick;
    std::vector<std::uint32_t> ids;       // rising
    std::vector<Eigen::Vector3d> places;  // beside `ids`
  };
  std::uint64_t every_ticks_;
  std::deque<Seen> seen_;
};

/// On which squares of the floor robots have been, as the measure `coverage` counts them: those in which the
/// origin of one has been at the end of a tick that was seen.
class Covered {
 public:
  static constexpr double k_square_m = 1;

  void see(const engine::FrameScene& scene, const engine::Frame& frame);
  /// Fills Frame::covered, by column and row.
  void add_to(engine::Frame& frame) const;

 private:
  std::unordered_map<std::uint64_t, std::uint64_t> last_;  // of each square: the tick
  std::uint64_t first_tick_ = 0;
  std::uint64_t last_tick_ = 0;
};

}  // namespace troupe
