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

/// A list of circles, metres. Each member of a circle has an array of its own, so that SIMD loops can load
/// several circles at a time. The docstring of each object that has such a list gives the frame of the
/// centres. The arrays never shrink and may have more entries than there are circles.
struct CircleArrays {
  std::vector<float> x;            ///< x of the centres
  std::vector<float> y;            ///< y of the centres
  std::vector<float> radius;       ///< radius; minus infinity: a padding entry, which no beam hits
  std::vector<std::uint32_t> row;  ///< index of a body in the state tables, or number of an outline piece

  /// Ensures that the arrays have room for this many circles; keeps the contents.
  void change_capacity(std::size_t size) {
    if (size <= x.size()) return;
    const std::size_t room = 2 * size;
    x.resize(room);
    y.resize(room);
    radius.resize(room);
    row.resize(room);
  }
  /// Sets circle i. change_capacity() must have made room for it.
  void set(std::size_t i, const BodyCircle& circle) {
    x[i] = circle.x;
    y[i] = circle.y;
    radius[i] = circle.radius;
    row[i] = circle.row;
  }
};

/// Finds the circles that reach into a disc around a sensor. The radius of the disc is the range of the
/// sensor. Each circle encloses a body or a piece (a short chain of edges) of a static outline. The sensor
/// can detect only these bodies and pieces.
///
/// This class is for searches in a few directions: those of fiducial finders, of light sensors and of range
/// sensors with wide beams, and the search for walls between two radios. Range sensors with thin beams use
/// NearbyOutlines instead, which shares one search among all range sensors in a block of cells.
///
/// Not thread-safe. Keep one object per thread and reuse it, because its arrays keep their memory.
class NearCircles {
 public:
  /// Removes all circles and sets the disc. centre: its centre, world frame, m. reach: its radius, m.
  void begin(const Vec2& centre, double reach);
  /// Adds the circles of `index` that reach into the disc, each once, and some circles that are slightly
  /// outside the disc. Leaves out a circle if skip(row) is true; `row` is the member BodyCircle::row of the
  /// circle. Call begin() first.
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
  /// Adds the circles of `outlines` that reach into the disc. A piece that has several circles is added
  /// several times. Call begin() first.
  /// within  radius of the search about the centre of the disc, m. Circles outside this radius may be left
  ///         out
  /// mark    bits that are set in CircleArrays::row of each added circle, so that the caller can tell pieces
  ///         from bodies
  void add_pieces(const FixedOutlines& outlines, double within, std::uint32_t mark);
  /// Removes all circles but the first `size` ones. `size` must be at most size().
  void keep(std::size_t size) { size_ = size; }
  /// Reserves memory for this many circles.
  void change_capacity(std::size_t size) { circles_.change_capacity(size); }

  std::size_t size() const { return size_; }  ///< number of circles
  /// The circles: the first size() entries of the arrays. Their centres are relative to the centre of the
  /// disc, along the axes of the world frame. Their radii are increased by more than the rounding errors of
  /// centres and radii.
  const CircleArrays& circles() const { return circles_; }

 private:
  void add(std::span<const BodyCircle> run, std::uint32_t mark);
  /// Prepares met_ and search_ for a new search for bodies, in which no wide body has been met yet. rows:
  /// number of rows, which are indices of bodies (BodyIndex::rows()).
  void forget_met(std::size_t rows);

  CircleArrays circles_;
  std::size_t size_ = 0;
  Vec2 centre_ = Vec2::Zero();
  double reach_ = 0;
  std::vector<std::uint32_t> met_;  // per row: the latest search that met this wide body
  std::uint32_t search_ = 0;        // number of the present search for bodies
};

}  // namespace troupe::partition
