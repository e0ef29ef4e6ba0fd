#pragma once

#include "base/geometry.hpp"
#include "partition/parallel.hpp"
#include "partition/sparse_grid.hpp"
#include "partition/static_scene.hpp"

#include <array>
#include <compare>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace troupe::partition {

/// The paper's ray engine: outlines are drawn into the cells of a nested grid, and rays walk its cells.
///
/// Cells are squares of `resolution`, counted from the origin: a point lies in the cell floor(x /
/// resolution), floor(y / resolution). 8 x 8 cells are a block, one 64-bit word; 8 x 8 blocks are a region,
/// found through a hash, which another word tells which of its blocks hold anything. What is empty is not
/// there.
///
/// An edge is the staircase from the cell of its start to that of its end, which the next edge draws: Cohen's
/// integer line (Graphics Gems IV, 1994), in which each cell shares a side with the one before. An outline
/// that lies in one cell draws that cell. Outlines are hollow.
///
/// A ray walks the same staircase, from the middle of the cell in which it starts, and reads what it meets
/// in the cells that it passes, the first one included. Empty regions and blocks are stepped over whole; the
/// line is kept in integers, so this changes no cell. docs/sensing.md tells how far readings are off.

/// An outline of a body that may move.
struct MovingOutline {
  std::uint32_t body = 0;   ///< its own rays pass it
  std::uint32_t first = 0;  ///< vertices [first, first + count) of those that RayGrid::redraw() is given
  std::uint32_t count = 0;  ///< vertices, at least one
  ZInterval z;              ///< body frame
  float ranger_return = 1;  ///< intensity that a ray reads; below 0: it is not drawn
};

/// A ray to be cast.
struct GridRay {
  Vec2 origin;               ///< world frame, m
  Vec2 direction;            ///< a unit vector
  double z = 0;              ///< height, m
  float range_max = 0;       ///< m; above 0
  std::uint32_t body = ~0u;  ///< whose ray it is: its own outlines are passed
};

/// What a ray met.
struct GridHit {
  float range;              ///< m; exactly range_max where nothing is met
  float ranger_return = 0;  ///< of what was met, the largest of those in one cell
};

/// The cells of one world; the text above tells how they are drawn and walked.
class RayGrid {
 public:
  /// Draws the static scene. `outlines` are those of bodies that may move, body after body, `vertices` as
  /// redraw() is given them. Outlines whose ranger_return is negative are left out. Throws std::length_error,
  /// with a text that names a resolution that would do, where the cells would take more than k_most_bytes or
  /// could not be counted.
  RayGrid(std::span<const FixedSolid> solids, std::vector<MovingOutline> outlines,
          std::span<const Vec2> vertices, double resolution_m);
  static constexpr std::size_t k_most_bytes = std::size_t{2} << 30;  ///< of the cells of the static scene

  /// What else there is to know of bodies with moving parts, and of those that move as one.
  struct Linked {
    std::span<const double> lifts;          ///< by how much each outline is raised, m; empty: none is
    std::span<const std::uint32_t> groups;  ///< of each body: a body's rays pass all of its group; empty:
                                            ///< each is one of its own. Kept until the next redraw
    std::span<const std::uint8_t> absent;   ///< of each body: it is not drawn where this is not 0; empty:
                                            ///< all are there
  };
  /// Draws the moving bodies again: `vertices` in the world's frame, and the pose of each body, of which only
  /// z counts. Sizes are those the grid was made for. What is drawn depends on neither threads nor order.
  void redraw(std::span<const Vec2> vertices, std::span<const Pose> poses, Parallel& parallel,
              const Linked& linked = {});

  /// The first surface along a ray. From any number of threads between redraws.
  GridHit cast(const GridRay& ray) const;

  double resolution_m() const { return cells_.cell_m; }  ///< edge of a cell
  /// True when something is drawn in the cell of this point.
  bool is_drawn(const Vec2& point) const;
  /// Regions that are known: those with something fixed in them, and some that bodies are in or were in
  /// lately.
  std::size_t regions() const { return slots_.size(); }
  /// Bytes that cells of the static scene take.
  std::size_t fixed_bytes() const;

 private:
  static constexpr std::uint32_t k_none = ~0u;
  static constexpr std::uint32_t k_shared = ~0u - 1;

  /// What one cell or more is marked with.
  struct Surface {
    double z_min;
    double z_max;
    float ranger_return;
    friend auto operator<=>(const Surface&, const Surface&) = default;
  };
  struct Region {
    Region() { owners.fill(k_shared); }
    std::uint64_t blocks = 0;               // those that hold anything
    std::array<std::uint64_t, 64> cells{};  // of each block: those that are drawn
    std::array<std::uint32_t, 64> owners;   // of each block: the one body that draws in it, or k_shared
    std::array<std::uint32_t, 64> marks{};  // of each block: where the marks of its drawn cells begin
  };
  /// A region that is or was in use.
  struct Slot {
    const Region* seen = nullptr;  // by rays: the live one while bodies are in it, else the fixed one
    std::unique_ptr<Region> fixed;
    std::unique_ptr<Region> live;
    std::uint64_t redrawn = 0;    // blocks of the live region that differ from the fixed one
    std::uint32_t runs = k_none;  // the last of those drawn in it this tick
  };
  /// Cells of one outline that follow one another in one region.
  struct Run {
    std::uint32_t next;  // of the same region
    std::uint32_t first;
    std::uint32_t count;
    std::uint32_t surface;
  };
  /// Cells as 6 bits of block and 6 bits of place in it, and the runs they make.
  struct Drawing {
    std::unique_ptr<std::uint16_t[]> cells;
    std::unique_ptr<Run[]> runs;
  };
  /// A further surface in a cell.
  struct Link {
    std::uint32_t surface;
    std::uint32_t next;  // a mark
  };
  /// The bodies that one task draws, and where in the drawing.
  struct Share {
    std::uint32_t outline;
    std::uint32_t cell;
    std::uint32_t run;
  };
  /// The surfaces of one body.
  struct Own {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  struct Homeless {
    Cell region;
    std::uint32_t run;
  };
  class Pen;
  class Line;
  struct Spot;

  void draw_fixed(std::span<const FixedSolid> solids);
  void share_out(std::span<const Vec2> vertices);
  Slot& settle(Cell region);
  void assemble(Region& region, const Region& base, const Drawing& drawing, Slot& slot);
  void mark(std::uint32_t& mark, std::uint32_t surface);
  void forget_empty_regions(std::size_t used);
  /// The largest return of what a mark stands for and the ray meets; below 0: nothing.
  float met(std::uint32_t mark, const GridRay& ray) const;
  bool met_in_block(const Region& region, std::uint32_t block, const GridRay& ray, const Line& line, Cell at,
                    std::int64_t i, std::int64_t j, GridHit& hit) const;

  GridGeometry cells_;
  TileDirectory directory_;
  std::vector<Slot> slots_;          // beside the directory's
  std::vector<std::uint32_t> live_;  // slots that have a live region
  std::size_t fixed_regions_ = 0;
  Cell low_{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()};
  Cell high_{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()};

  // A mark is a surface, or a link to several. Surfaces: first those that never move, then the outlines.
  std::vector<Surface> surfaces_;
  std::vector<MovingOutline> outlines_;
  std::vector<Own> own_;         // of each body
  std::vector<double> heights_;  // of each outline's body, m, and by how much the outline is raised
  std::span<const std::uint32_t> groups_;
  std::vector<Share> shares_;
  Drawing drawing_;
  // Memory for the worst case; what is not used is never touched. The static scene comes first.
  std::unique_ptr<std::uint32_t[]> marks_;
  std::unique_ptr<Link[]> links_;
  std::uint32_t fixed_marks_ = 0;
  std::uint32_t fixed_links_ = 0;
  std::uint32_t used_marks_ = 0;
  std::uint32_t used_links_ = 0;
};

}  // namespace troupe::partition
