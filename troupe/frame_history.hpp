#pragma once

#include "engine/observing/frame.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace troupe {

/// The positions of bodies in the last k_seconds, from which the picture layer `trails` draws the path of
/// each body as a line. see() takes the positions from frames. A frame has the data that a viewer needs to
/// draw the world at one tick (time step).
///
/// see() stores at most 50 positions per body: the first of each interval of 0.4 s (k_seconds / 50), rounded
/// up to whole ticks. The intervals are counted from tick 0, so that a trail does not depend on the frame at
/// which the history begins. Pass frames to see() in the order of their ticks. A frame with an earlier tick
/// than the last stored frame clears the history.
class Trails {
 public:
  /// How far a trail goes back in time, s; rounded up to whole ticks.
  static constexpr double k_seconds = 20;

  /// tick_s: length of a tick, s.
  explicit Trails(double tick_s);
  /// How far back see() must have received frames for a complete trail, s: the length of a trail and of one
  /// interval.
  double history_s() const { return history_s_; }
  /// Whether see() would store a frame of this tick. see() ignores the frames of most ticks, to limit the
  /// number of points of a trail.
  bool wants(std::uint64_t tick) const;
  void see(const engine::Frame& frame);  ///< stores the positions of a frame's bodies if wants() is true
  /// Replaces Frame::trails by one trail per body of Frame::mobile (the bodies that are in the world and not
  /// static). A trail consists of the stored positions of the body in the last k_seconds before `frame`,
  /// oldest first, and of its position in `frame`; m, world frame.
  void add_to(engine::Frame& frame) const;

 private:
  struct Seen {
    std::uint64_t tick;
    std::vector<std::uint32_t> ids;       // in rising order
    std::vector<Eigen::Vector3d> places;  // one per id
  };
  /// Whether stored positions are too old to be part of a trail that ends at `tick`.
  bool is_too_old(const Seen& seen, std::uint64_t tick) const { return seen.tick + most_ticks_ < tick; }

  std::uint64_t every_ticks_;
  std::uint64_t most_ticks_;  // largest age of a position
  double history_s_;
  std::deque<Seen> seen_;
};

/// The squares of the floor that robots have visited, for the picture layer `coverage`. see() takes the
/// positions of the robots from frames. A frame has the data that a viewer needs to draw the world at one
/// tick (time step). A square is visited if it contains the origin of a robot in a frame that see() has
/// received.
class Covered {
 public:
  static constexpr double k_square_m = 1;  ///< edge length of the squares, m

  /// Stores which squares the robots of a frame visit. Pass frames in the order of their ticks. A frame with
  /// an earlier tick than the previous frame clears the history. scene: the constant data of the world, which
  /// contain the body types that `frame` uses.
  void see(const engine::FrameScene& scene, const engine::Frame& frame);
  /// Replaces Frame::covered by the visited squares, sorted by x and then by y, and sets Frame::covered_m to
  /// k_square_m. FrameSquare::freshness is the time of the last visit as a number from 0 (tick of the first
  /// stored frame) to 1 (tick of the last stored frame). It is 1 if all stored frames have the same tick.
  void add_to(engine::Frame& frame) const;

 private:
  std::unordered_map<std::uint64_t, std::uint64_t> last_;  // square -> tick of the last visit
  std::uint64_t first_tick_ = 0;
  std::uint64_t last_tick_ = 0;
};

}  // namespace troupe
