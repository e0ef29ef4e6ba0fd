#pragma once

#include "engine/frame.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace troupe {

/// Positions of bodies during the last k_seconds seconds, for the picture layer `trails`. Pass frames in the
/// order of their ticks; a frame with an earlier tick than the last one clears the history.
class Trails {
 public:
  static constexpr double k_seconds = 20;

  explicit Trails(double tick_s);
  /// Whether see() keeps a frame of this tick. It ignores frames of other ticks, to limit the number of
  /// points.
  bool wants(std::uint64_t tick) const;
  void see(const engine::Frame& frame);
  /// Fills Frame::trails.
  void add_to(engine::Frame& frame) const;

 private:
  struct Seen {
    std::uint64_t tick;
    std::vector<std::uint32_t> ids;       // in rising order
    std::vector<Eigen::Vector3d> places;  // one per id
  };
  std::uint64_t every_ticks_;
  std::deque<Seen> seen_;
};

/// Squares of the floor that robots have visited, for the picture layer `coverage`. A square is visited if
/// the origin of a robot was in it at the end of a tick that was passed to see(), as in the measure
/// `coverage`.
class Covered {
 public:
  static constexpr double k_square_m = 1;

  void see(const engine::FrameScene& scene, const engine::Frame& frame);
  /// Fills Frame::covered, sorted by column and row.
  void add_to(engine::Frame& frame) const;

 private:
  std::unordered_map<std::uint64_t, std::uint64_t> last_;  // square -> tick of the last visit
  std::uint64_t first_tick_ = 0;
  std::uint64_t last_tick_ = 0;
};

}  // namespace troupe
