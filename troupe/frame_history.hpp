#pragma once

#include "engine/observing/frame.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace troupe {

/// Past positions of bodies, for the picture layer `trails`, which draws the path of each body as a line. The
/// positions come from frames: a frame is the data that a viewer needs to draw the world at one tick (time
/// step). A position is stored every k_seconds / 50 seconds, rounded up to whole ticks. At most 50 positions
/// per body are kept, and none that is older than k_seconds. Pass frames to see() in the order of their
/// ticks; a frame with an earlier tick than the last stored frame clears the history.
class Trails {
 public:
  /// Largest age of the positions of a trail, s, before rounding up to whole ticks.
  static constexpr double k_seconds = 20;

  /// tick_s: length of a tick, s.
  explicit Trails(double tick_s);
  /// Whether see() would store a frame of this tick. see() ignores the frames of most ticks, to limit the
  /// number of points of a trail.
  bool wants(std::uint64_t tick) const;
  void see(const engine::Frame& frame);  ///< stores the positions of a frame's bodies if wants() is true
  /// Replaces Frame::trails by one trail per body of Frame::mobile (the bodies that are not static): the
  /// stored positions of the body in the last k_seconds before `frame`, oldest first, and then its position
  /// in `frame`; m, world frame.
  void add_to(engine::Frame& frame) const;

 private:
  struct Seen {
    std::uint64_t tick;
    std::vector<std::uint32_t> ids;       // in rising order
    std::vector<Eigen::Vector3d> places;  // one per id
  };
  /// Whether a stored position is too old for a trail that ends at `tick`.
  bool is_too_old(const Seen& seen, std::uint64_t tick) const { return seen.tick + most_ticks_ < tick; }

  std::uint64_t every_ticks_;
  std::uint64_t most_ticks_;  // largest age of a position
  std::deque<Seen> seen_;
};

/// Squares of the floor that robots have visited, for the picture layer `coverage`. A square is visited if
/// the origin of a robot was in it at a tick (time step) whose frame was passed to see(), as in the measure
/// `coverage`. A frame is the data that a viewer needs to draw the world at one tick.
class Covered {
 public:
  static constexpr double k_square_m = 1;  ///< edge length of the squares, m

  /// Stores the squares of all robots of a frame. Pass frames in the order of their ticks; a frame with an
  /// earlier tick than the previous frame clears the history. scene: the constant data of the world, among
  /// them the types of bodies to which `frame` refers.
  void see(const engine::FrameScene& scene, const engine::Frame& frame);
  /// Replaces Frame::covered by the visited squares, sorted by x and then by y, and sets Frame::covered_m to
  /// k_square_m. Each square has the time of its last visit as a number from 0 (first stored tick) to 1 (last
  /// stored tick; also if only one tick was stored).
  void add_to(engine::Frame& frame) const;

 private:
  std::unordered_map<std::uint64_t, std::uint64_t> last_;  // square -> tick of the last visit
  std::uint64_t first_tick_ = 0;
  std::uint64_t last_tick_ = 0;
};

}  // namespace troupe
