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
/// Intelligence, 2008). Outlines are drawn into the cells of a grid, and rays walk from cell to cell.
/// docs/sensing.md gives all rules.
///
/// Cells are squares. Let r be their edge length. The cell of a point (x, y) in the world frame is
/// (floor(x / r), floor(y / r)). For positions on a ray, however, the quotients are rounded towards zero, as
/// in Stage. At negative coordinates, a ray therefore meets an edge one cell away from the cell in which the
/// edge is drawn.
///
/// A block is a square of 8 x 8 cells; a 64-bit word tells which of the cells are drawn. A region is a square
/// of 8 x 8 blocks; another word tells which of the blocks are not empty. Regions are found through a hash
/// table. A region is stored only if something is or was drawn in it.
///
/// An edge is drawn as a staircase of cells, by Cohen's integer line (Graphics Gems IV, 1994): each cell
/// shares a side with the previous one. The staircase begins in the cell of the edge's start. It stops before
/// the cell of the edge's end, where the next edge of the outline begins. An outline that lies within one
/// cell is drawn as that cell. The inside of an outline is not drawn.
///
/// A ray jumps over squares of 32 x 32 cells in which nothing is drawn. Through any other square, it follows
/// the same kind of staircase as an edge. There it skips empty blocks as a whole, but this does not change
/// the cells through which it passes. The ray ends in the first cell that has a surface that it can hit. This
/// may be the cell of its origin.

/// An outline of a mobile body, which RayGrid::redraw() draws.
struct MovingOutline {
  std::uint32_t body = 0;   ///< index into `poses` of redraw(); rays of this body ignore the outline
  std::uint32_t first = 0;  ///< index of its first vertex in `vertices` of RayGrid::redraw()
  std::uint32_t count = 0;  ///< number of its vertices, which are consecutive; 0: not drawn
  ZInterval z;              ///< heights, body frame, m
  float ranger_return = 1;  ///< intensity that a ray reads; negative: not drawn
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
  float range;              ///< distance, m; exactly GridRay::range_max if nothing was hit
  float ranger_return = 0;  ///< largest intensity of the surfaces that were hit; 0: none
};

/// The grid of one world. The comment at the top of this file says how outlines are drawn and how rays move.
class RayGrid {
 public:
  /// Draws the static scene. The mobile bodies are drawn only by redraw(). Throws std::length_error in two
  /// cases: the cells would take more than k_most_bytes (the message suggests a resolution that fits), or a
  /// solid that range sensors see is more than 2^29 cells from the origin of the world frame, along x or y.
  /// solids        the static scene; solids with a negative ranger_return are not drawn
  /// outlines      the outlines of the mobile bodies, grouped by body; outlines without vertices or with a
  ///               negative ranger_return are dropped
  /// vertices      the vertices of all outlines, including dropped ones, world frame, metres
  /// resolution_m  edge length of a cell, metres, above 0
  RayGrid(std::span<const FixedSolid> solids, std::vector<MovingOutline> outlines,
          std::span<const Vec2> vertices, double resolution_m);
  static constexpr std::size_t k_most_bytes = std::size_t{2} << 30;  ///< limit on the memory of the cells

  /// Optional data for redraw() about bodies with moving parts, bodies that move together, and bodies that
  /// are not drawn.
  struct Linked {
    /// Per outline, without the outlines that the constructor dropped: the height, m, by which the outline is
    /// raised above its MovingOutline::z. Empty: no outline is raised.
    std::span<const double> lifts;
    /// Per body: the number of its group. Rays of a body ignore the outlines of all bodies of its group.
    /// Empty: each body is a group of its own. Must stay valid until the next redraw().
    std::span<const std::uint32_t> groups;
    std::span<const std::uint8_t> absent;  ///< per body: not 0 if it is not drawn; empty: all are drawn
  };
  /// Removes the drawings of the mobile bodies and draws these bodies at their present poses. The result does
  /// not depend on the number of threads.
  /// vertices  the present vertices of all outlines, including dropped ones, world frame, metres, in the same
  ///           order as in the constructor
  /// poses     one per body; only the member z is used
  void redraw(std::span<const Vec2> vertices, std::span<const Pose> poses, Parallel& parallel,
              const Linked& linked = {});

  /// Follows a ray through the cells and returns the first surface that the ray hits. If there is none,
  /// GridHit::range is exactly GridRay::range_max. A ray that starts 2^29 cells or more from the origin of
  /// the world frame, along x or y, hits nothing. Several threads may call cast() at once, but not during
  /// redraw().
  GridHit cast(const GridRay& ray) const;

  double resolution_m() const { return cells_.cell_m; }  ///< edge of a cell, metres
  /// Number of stored regions (squares of 64 x 64 cells): those with static geometry, those in which bodies
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
  /// A stored region. `fixed` shows only the static scene; `live` also shows the mobile bodies.
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
  /// The cells that were drawn, and the runs that they form. A cell is stored as its block in the region
  /// (bits 6 to 11) and its place in the block (bits 0 to 5).
  struct Drawing {
    std::unique_ptr<std::uint16_t[]> cells;
    std::unique_ptr<Run[]> runs;
  };
  /// An entry of the list of surfaces of a cell, for cells that show several surfaces.
  struct Link {
    std::uint32_t surface;
    std::uint32_t next;  // the next entry, or the last surface: a mark
  };
  /// A share is the outlines that one task draws. It is stored as three indices: of its first outline, of its
  /// first entry in Drawing::cells, and of its first entry in Drawing::runs.
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
  /// A run in a region that has no Slot::live yet.
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
  /// Returns the largest ranger_return of those surfaces of a cell that the ray hits; negative if it hits
  /// none of them. mark: the mark of the cell, which stands for all surfaces of the cell (see `surfaces_`).
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
