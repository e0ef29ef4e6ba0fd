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

/// The ray engine of the robot simulator Stage (Vaughan: Massively multi-robot simulation in Stage, Swarm
/// Intelligence, 2008): outlines are drawn into the cells of a nested grid, and rays walk from cell to cell.
///
/// Cells are squares with edges of length `resolution`. The cell of a point (x, y) in the world frame is
/// (floor(x / resolution), floor(y / resolution)). For rays this differs, as in Stage: the cell of a ray's
/// position is found by rounding towards zero. At negative coordinates, a ray therefore meets an edge one
/// cell away from the cell in which the edge is drawn. A block of 8 x 8 cells is stored in one 64-bit word. A
/// region of 8 x 8 blocks is found through a hash table; another word tells which of its blocks are not
/// empty. Empty regions are not stored.
///
/// An edge is drawn as a staircase of cells, by Cohen's integer line (Graphics Gems IV, 1994): each cell
/// shares a side with the previous one. The staircase begins in the cell of the edge's start and stops before
/// the cell of its end, which the next edge draws. An outline that lies within one cell is drawn as that
/// cell. The inside of an outline is not drawn.
///
/// A ray moves as in Stage. In squares of 32 x 32 cells in which anything is drawn, the ray follows the same
/// kind of staircase as an edge; it jumps over empty squares. The ray ends in the first cell that has a
/// surface that it can hit, which may be the cell of its origin. Empty blocks are skipped as a whole. This
/// does not change the cells through which the ray passes, because the staircase is computed in integers.
/// docs/sensing.md gives all rules.

/// An outline of a mobile body, which RayGrid::redraw() draws.
struct MovingOutline {
  std::uint32_t body = 0;   ///< index into `poses` of redraw(); rays of this body ignore the outline
  std::uint32_t first = 0;  ///< the outline is vertices [first, first + count) of RayGrid::redraw()
  std::uint32_t count = 0;  ///< number of vertices; 0: the outline is not drawn
  ZInterval z;              ///< heights, body frame, m
  float ranger_return = 1;  ///< intensity that a ray reads; negative: the outline is not drawn
};

/// A ray to cast.
struct GridRay {
  Vec2 origin;          ///< start of the ray, world frame, m
  Vec2 direction;       ///< direction of the ray: unit vector, world frame
  double z = 0;         ///< height, m, world frame
  float range_max = 0;  ///< length of the ray, m; greater than 0
  /// The body that casts the ray: index into `poses` of RayGrid::redraw(), or ~0 for none. The ray ignores
  /// the outlines of this body.
  std::uint32_t body = ~0u;
};

/// The result of a ray.
struct GridHit {
  float range;              ///< distance, m; exactly range_max if nothing was hit
  float ranger_return = 0;  ///< largest intensity of the surfaces hit in the cell; 0 if none
};

/// The cells of one world. The comment at the top of this file says how outlines are drawn and how rays move.
class RayGrid {
 public:
  /// Draws the static scene. The mobile bodies are drawn only by redraw(). outlines: those of the mobile
  /// bodies, grouped by body; outlines without vertices or with a negative ranger_return are dropped.
  /// vertices: the vertices of all outlines, including dropped ones, world frame, metres. resolution_m: edge
  /// of a cell, metres, above 0. Throws std::length_error if the cells would take more than k_most_bytes (the
  /// message suggests a resolution that fits), or if a solid that range sensors see is more than 2^29 cells
  /// from the origin.
  RayGrid(std::span<const FixedSolid> solids, std::vector<MovingOutline> outlines,
          std::span<const Vec2> vertices, double resolution_m);
  static constexpr std::size_t k_most_bytes = std::size_t{2} << 30;  ///< limit on the memory of the cells

  /// Optional data for redraw(): bodies with moving parts, bodies that move together, and bodies not to draw.
  struct Linked {
    /// Per outline that the constructor did not drop: the height by which it is raised above its
    /// MovingOutline::z, m. Empty: no outline is raised.
    std::span<const double> lifts;
    /// Per body: the number of its group; rays of the body ignore the outlines of the whole group. Empty:
    /// each body is its own group. Must stay valid until the next redraw().
    std::span<const std::uint32_t> groups;
    std::span<const std::uint8_t> absent;  ///< per body: not 0 if it is not drawn; empty: all are drawn
  };
  /// Removes the drawings of the mobile bodies and draws the bodies at their present poses. vertices: the
  /// present vertices of all outlines, including dropped ones, world frame, metres, in the same order as in
  /// the constructor. poses: one per body; only their z is used. The result depends neither on the number of
  /// threads nor on the order in which they draw.
  void redraw(std::span<const Vec2> vertices, std::span<const Pose> poses, Parallel& parallel,
              const Linked& linked = {});

  /// Follows a ray through the cells and returns the first surface that it hits. If it hits none, or starts
  /// 2^29 cells or more from the origin, the range is exactly GridRay::range_max. Several threads may call
  /// cast() at once, but not during redraw().
  GridHit cast(const GridRay& ray) const;

  double resolution_m() const { return cells_.cell_m; }  ///< edge of a cell, metres
  /// True if a static or a mobile outline is drawn in the cell of this point (world frame, metres).
  bool is_drawn(const Vec2& point) const;
  /// Number of known regions (squares of 64 x 64 cells): those with static geometry, those in which bodies
  /// are drawn, and some that bodies have left.
  std::size_t regions() const { return slots_.size(); }
  /// Memory of the cells of the static scene, bytes.
  std::size_t fixed_bytes() const;

 private:
  static constexpr std::uint32_t k_none = ~0u;
  static constexpr std::uint32_t k_shared = ~0u - 1;

  /// A surface of the static scene: its heights, m, world frame, and the intensity that a ray reads from it.
  struct Surface {
    double z_min;
    double z_max;
    float ranger_return;
    friend auto operator<=>(const Surface&, const Surface&) = default;
  };
  struct Region {
    Region() { owners.fill(k_shared); }
    std::uint64_t blocks = 0;               // blocks that are not empty
    std::array<std::uint64_t, 64> cells{};  // per block: the cells that are drawn
    std::array<std::uint32_t, 64> owners;   // per block: the only body that draws in it, or k_shared
    std::array<std::uint32_t, 64> marks{};  // per block: index in marks_ of the mark of its first drawn cell
  };
  /// A region that is or was in use. `fixed` shows only the static scene, `live` also the mobile bodies.
  struct Slot {
    const Region* seen = nullptr;  // the one that rays see: live while bodies are in it, else fixed or null
    std::unique_ptr<Region> fixed;
    std::unique_ptr<Region> live;
    std::uint64_t redrawn = 0;    // blocks of the live region that differ from the fixed one
    std::uint32_t runs = k_none;  // head of the list of runs that are drawn in it in this tick
  };
  /// Consecutive cells of one outline in one region.
  struct Run {
    std::uint32_t next;     // next run in the same region
    std::uint32_t first;    // first cell: index into Drawing::cells
    std::uint32_t count;    // number of cells
    std::uint32_t surface;  // number of the surface that the cells show
  };
  /// The cells that were drawn, each as 6 bits for its block and 6 bits for its place in the block, and the
  /// runs that they form.
  struct Drawing {
    std::unique_ptr<std::uint16_t[]> cells;
    std::unique_ptr<Run[]> runs;
  };
  /// An entry of a linked list of surfaces: those of a cell that shows several surfaces.
  struct Link {
    std::uint32_t surface;
    std::uint32_t next;  // the next entry, or the last surface: a mark
  };
  /// The outlines are divided into shares, one per task. A share is stored as the indices of its first
  /// outline, of its first entry in Drawing::cells, and of its first entry in Drawing::runs.
  struct Share {
    std::uint32_t outline;
    std::uint32_t cell;
    std::uint32_t run;
  };
  /// The surfaces of one body, which have consecutive numbers.
  struct Own {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  /// A run in a region for which there is no Slot::live yet.
  struct NewRegionRun {
    Cell region;
    std::uint32_t run;
  };
  class Rasterizer;
  class Line;
  struct CellPosition;

  void draw_fixed(std::span<const FixedSolid> solids);
  void share_out(std::span<const Vec2> vertices);
  Slot& slot_in(Cell region);
  void assemble(Region& region, const Region& base, const Drawing& drawing, Slot& slot);
  void mark(std::uint32_t& mark, std::uint32_t surface);
  void forget_empty_regions(std::size_t used);
  /// A mark stands for one or more surfaces. Returns the largest ranger_return of those surfaces that the ray
  /// hits; negative if the ray hits none of them.
  float met(std::uint32_t mark, const GridRay& ray) const;
  bool met_in_block(const Region& region, std::uint32_t block, const GridRay& ray, const Line& line, Cell at,
                    std::int64_t i, std::int64_t j, GridHit& hit) const;

  GridGeometry cells_;
  TileDirectory directory_;          // gives each region in use a number, its slot
  std::vector<Slot> slots_;          // indexed by the slots of directory_
  std::vector<std::uint32_t> live_;  // slots that have a live region
  std::size_t fixed_regions_ = 0;
  Cell low_{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()};
  Cell high_{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()};

  // The mark of a cell is the number of a surface, or of a Link if several surfaces are in the cell. Surfaces
  // are numbered: first the static ones, then the outlines of the mobile bodies.
  std::vector<Surface> surfaces_;
  std::vector<MovingOutline> outlines_;
  std::vector<Own> own_;         // per body
  std::vector<double> heights_;  // per outline, m: z of its body plus its lift
  std::span<const std::uint32_t> groups_;
  std::vector<Share> shares_;
  Drawing drawing_;
  // Allocated for the worst case; unused pages are never touched. The entries of the static scene come first.
  std::unique_ptr<std::uint32_t[]> marks_;
  std::unique_ptr<Link[]> links_;
  std::uint32_t fixed_marks_ = 0;
  std::uint32_t fixed_links_ = 0;
  std::uint32_t used_marks_ = 0;
  std::uint32_t used_links_ = 0;
};

}  // namespace troupe::partition
