#pragma once

#include "partition/body_index.hpp"
#include "partition/fixed_outlines.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace troupe::partition {

/// A list of circles, with one array per component so that kernels load several circles at a time. All values
/// are in metres; the object that owns the list states the frame of the centres. The arrays never shrink and
/// may have more entries than there are circles.
struct CircleArrays {
  std::vector<float> x;            ///< x of the centres
  std::vector<float> y;            ///< y of the centres
  std::vector<float> radius;       ///< radius; minus infinity: a padding entry, which no beam hits
  std::vector<std::uint32_t> row;  ///< row of a body in the state tables, or number of an outline piece

  /// Ensures that the arrays have room for this many circles; keeps the contents.
  void make_room(std::size_t size) {
    if (size <= x.size()) return;
    const std::size_t room = 2 * size;
    x.resize(room);
    y.resize(room);
    radius.resize(room);
    row.resize(room);
  }
  /// Sets circle i. make_room() must have made room for it.
  void set(std::size_t i, const BodyCircle& circle) {
    x[i] = circle.x;
    y[i] = circle.y;
    radius[i] = circle.radius;
    row[i] = circle.row;
  }
};

/// The circles that reach into the disc within which a sensor looks: those that enclose bodies, and those
/// that enclose pieces (short chains of edges) of static outlines. The sensor can detect no other body or
/// piece. This class is for searches in a few directions: those of fiducial finders, light sensors and range
/// sensors with wide beams, and searches for the walls between two radios. Range sensors with thin beams use
/// NearbyOutlines instead, which shares one search among all range sensors in a block of cells. Not
/// thread-safe. Keep one object per thread and reuse it: its arrays keep their memory.
class NearCircles {
 public:
  /// Begins an empty list for a disc. centre: the centre of the disc, world frame, m. reach: its radius, m.
  void begin(const Vec2& centre, double reach);
  /// Adds the circle of each body that reaches into the disc, once, unless skip(row of the body) is true.
  /// Also adds some circles that are slightly outside the disc. begin() must have been called.
  template <class Skip>
  void add_bodies(const BodyIndex& index, Skip&& skip) {
    // A wide body (wider than a cell) is in several cells of the index. Its circle may be met again in
    // another cell.
    const float wide = index.has_wide() ? static_cast<float>(0.5 * index.geometry().cell_m)
                                        : std::numeric_limits<float>::infinity();
    if (index.has_wide()) forget_met(index.rows());
    index.for_each_run(Box::around(centre_, reach_), [&](std::span<const BodyCircle> run) {
      std::size_t kept = size_;
      add(run, 0);
      for (std::size_t i = kept; i < size_; ++i) {
        const std::uint32_t row = circles_.row[i];
        const bool repeated = circles_.radius[i] > wide && std::exchange(met_[row], search_) == search_;
        if (!repeated && !skip(row))
          circles_.set(kept++, {circles_.x[i], circles_.y[i], circles_.radius[i], row});
      }
      size_ = kept;
    });
  }
  /// Adds the circles of outline pieces that reach into the disc. Circles farther than `within` (m) from the
  /// centre of the disc may be omitted, so that the search is shorter. A piece that has several circles is
  /// added several times. The bits of `mark` are set in CircleArrays::row of each added circle, to tell
  /// pieces from bodies. begin() must have been called.
  void add_pieces(const FixedOutlines& outlines, double within, std::uint32_t mark);
  /// Removes all circles but the first `size`, which must be at most size().
  void keep(std::size_t size) { size_ = size; }
  /// Reserves memory for this many circles.
  void make_room(std::size_t size) { circles_.make_room(size); }

  std::size_t size() const { return size_; }  ///< number of circles
  /// The circles. Their centres are relative to the centre of the disc, along the axes of the world frame.
  /// Their radii are increased by more than the rounding errors of centres and radii. Only the first size()
  /// entries of the arrays are circles.
  const CircleArrays& circles() const { return circles_; }

 private:
  void add(std::span<const BodyCircle> run, std::uint32_t mark);
  /// Begins a new search for bodies, in which none of the rows 0 to `rows` - 1 has been met yet.
  void forget_met(std::size_t rows);

  CircleArrays circles_;
  std::size_t size_ = 0;
  Vec2 centre_ = Vec2::Zero();
  double reach_ = 0;
  std::vector<std::uint32_t> met_;  // per row: the latest search that met this wide body
  std::uint32_t search_ = 0;        // number of the present search for bodies
};

}  // namespace troupe::partition
