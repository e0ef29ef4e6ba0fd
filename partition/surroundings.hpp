#pragma once

#include "partition/body_index.hpp"
#include "partition/fixed_outlines.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace troupe::partition {

/// Circles, each number an array, in metres and the world's frame. The arrays only ever grow.
struct CircleArrays {
  std::vector<float> x;            ///< of the centres
  std::vector<float> y;            ///< of the centres
  std::vector<float> radius;       ///< negative infinite: nothing meets it
  std::vector<std::uint32_t> row;  ///< of a body, or a piece of the static scene

  /// Makes room for so many circles, what lies in it kept.
  void make_room(std::size_t size) {
    if (size <= x.size()) return;
    const std::size_t room = 2 * size;
    x.resize(room);
    y.resize(room);
    radius.resize(room);
    row.resize(room);
  }
  /// Sets the i-th; there must be room.
  void set(std::size_t i, const BodyCircle& circle) {
    x[i] = circle.x;
    y[i] = circle.y;
    radius[i] = circle.radius;
    row[i] = circle.row;
  }
};

/// Circles that lie side by side; behind them three more can be read.
using CircleRun = std::span<const BodyCircle>;
/// Sets out[size], out[size + 1] ... to the circles of the runs, their rows with the bits of `mark`. There is
/// room for them and three more.
void unpack(std::span<const CircleRun> runs, std::uint32_t mark, std::size_t size, CircleArrays& out);

/// What sensors in one block of cells may meet: the circles of bodies and of pieces of fixed outlines, in
/// bands from near to far. A band is looked up when the first sensor asks for it and serves all that follow
/// from the same block: in a crowd most see no farther than the first.
class Surroundings {
 public:
  /// Circles of bodies carry their row, those of fixed pieces the piece with this bit.
  static constexpr std::uint32_t k_fixed = 1u << 31;

  /// reach: how far to look at all, m.
  void begin(const BodyIndex& bodies, const FixedOutlines& fixed, const GridGeometry& geometry, double reach);
  /// Looks from the block of this point from now on.
  void look_from(const Vec2& point);

  /// Bands 0 .. bands()-1 hold every circle that comes within the reach of any point of the block, and more.
  std::size_t bands() const { return radii_.size(); }
  /// Every circle that comes nearer than this to any point of the block lies in this band or one before, m.
  double radius(std::size_t band) const { return radii_[band]; }
  /// A band's place in circles(). Padded to a multiple of k_circle_padding with circles that nothing meets.
  struct Band {
    std::size_t begin;  ///< of its first circle
    std::size_t end;    ///< behind its last
  };
  /// Where a band below bands() lies: looked up, if need be.
  Band band(std::size_t band) {
    while (ends_.size() <= band) gather(ends_.size());
    return {band == 0 ? 0 : ends_[band - 1], ends_[band]};
  }
  /// Those of all bands looked up so far; grows when the next is.
  const CircleArrays& circles() const { return circles_; }
  /// What to look at first in the first band, m: a distance within which some k_at_hand circles lie on
  /// average, but no more than radius(0). Infinite where there are so few that one look is best.
  double at_hand() const { return at_hand_; }
  static constexpr double k_at_hand = 20;  ///< see at_hand()
  /// Where no more circles than these are near, one look is best: at_hand() is infinite.
  static constexpr double k_few = 48;

 private:
  void gather(std::size_t band);

  const BodyIndex* bodies_ = nullptr;
  const FixedOutlines* fixed_ = nullptr;
  GridGeometry geometry_;
  double reach_ = 0;
  double at_hand_ = 0;
  std::vector<double> radii_;
  std::optional<Cell> home_;        // in blocks
  std::array<CircleRun, 64> runs_;  // found, not yet unpacked
  CircleArrays circles_;
  std::vector<std::size_t> ends_;  // of the bands looked up so far
};

}  // namespace troupe::partition
