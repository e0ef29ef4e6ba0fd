#pragma once

#include "base/geometry.hpp"
#include "engine/spec/world_spec.hpp"
#include "partition/overlap.hpp"
#include "partition/parallel.hpp"
#include "partition/sparse_grid.hpp"
#include "partition/static_scene.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::engine {

/// Returns the solids of the parts of a body type that are obstacles (Returns::obstacle), as a shape for
/// overlap tests (body frame, joints at rest). The shape is empty if no part is an obstacle. Throws
/// std::length_error if an outline is too complex for convex_pieces(), which divides it into convex polygons.
partition::ObstacleShape obstacle_shape(const TypeSpec& type);
/// Returns the solids of the parts of a body type for which counts(part) is true, as a shape for overlap
/// tests (body frame, joints at rest). The shape is empty if there is no such part. Throws std::length_error
/// if an outline is too complex for convex_pieces(), which divides it into convex polygons.
partition::ObstacleShape shape_of(const TypeSpec& type, bool (*counts)(const PartSpec& part));

/// A spatial index of placed bodies. It has several grids (levels), whose cell widths are powers of two. A
/// body is listed in the cell of its origin, at the level whose cells are about as wide as the body, so that
/// a single large body does not slow down every query. No result depends on the cells.
class Crowd {
 public:
  /// Adds a body. Bodies are numbered from 0 in the order in which they are added. The crowd keeps a
  /// reference to the shape, so the shape must outlive the crowd. A body with an empty shape gets a number,
  /// but overlaps no other.
  void add(const partition::ObstacleShape& shape, const Pose& pose_world_body);
  std::size_t size() const { return bodies_.size(); }  ///< number of bodies

  /// Whether no body of the crowd overlaps a shape at a pose in the world frame. True for an empty shape.
  bool free(const partition::ObstacleShape& shape, const Pose& pose_world_body) const;
  /// Numbers of the bodies that overlap a shape at a pose in the world frame, ascending; none for an empty
  /// shape.
  std::vector<std::size_t> overlapping(const partition::ObstacleShape& shape,
                                       const Pose& pose_world_body) const;
  /// Whether the body with this number overlaps a shape at a pose in the world frame. False for an empty
  /// shape.
  bool overlaps(std::size_t number, const partition::ObstacleShape& shape, const Pose& pose_world_body) const;

 private:
  static constexpr std::uint32_t k_none = ~0u;

  struct Body {
    Pose pose;
    const partition::ObstacleShape* shape;
    std::uint32_t next;  // next body in the same cell; k_none: last
  };
  /// The bodies of similar width.
  struct Level {
    int exponent = 0;  // cells are 2^exponent m wide: at least as wide as the bodies
    partition::GridGeometry grid;
    partition::TileDirectory tiles;
    std::vector<std::uint32_t> first;  // per tile and cell: first body there
  };

  template <class Visit>  // bool visit(body): false ends the search
  bool each_near(double radius, const Pose& pose, Visit visit) const;

  std::vector<Body> bodies_;
  std::vector<Level> levels_;
};

/// Rule by which the bodies of a population (the bodies NAME0, NAME1, ... of one type) are placed. All
/// positions are in the world frame. The static scene is the set of obstacles that never move.
struct PlacementRule {
  /// Kinds of rules.
  enum class Kind : std::uint8_t {
    /// The points of a square grid with the spacing `pitch_m`, column by column from the region's corner of
    /// least x and y, first in `region` and then in `spill`. A point is skipped if the origin of the body
    /// would be outside `polygon` or the bounds of the world, or if the body would overlap the static scene
    /// or another body.
    grid,
    // All other kinds draw random positions, at most `trials` for each body, until one is free.
    uniform,       ///< uniformly distributed in the region
    gaussian,      ///< normally distributed around `mean`
    poisson_disc,  ///< in the region, at least `distance_m` from all other bodies of the population
    free_floor,    ///< on the free floor that a disc as wide as the body can reach from the point `from`
  };
  Kind kind = Kind::grid;  ///< how positions are chosen
  /// Box that must contain the bodies' origins, m. For `grid`, it is the box of the grid points; random
  /// displacements (`jitter_m`) may move bodies out of it.
  Box region;
  Ring polygon;        ///< polygon that must contain the bodies' origins, m; empty: not restricted
  Box spill;           ///< grid: second box, used when all points of `region` were tried, m; empty: none
  double pitch_m = 1;  ///< grid: distance between neighbouring points, m
  /// grid: largest random displacement of x and of y from the grid, in either direction, m
  double jitter_m = 0;
  Vec2 mean{0, 0};        ///< gaussian: mean position, m
  Vec2 deviation{1, 1};   ///< gaussian: standard deviations along x and y, m
  double distance_m = 1;  ///< poisson_disc: smallest distance between the origins of two bodies, m
  /// free_floor: a point of the connected floor on which bodies are placed, m; not set: the largest
  /// connected floor of the region. If the point is outside the region or on no floor, no body can be
  /// placed.
  std::optional<Vec2> from;
  /// free_floor: step of the search for the floor along x and y, m; 0: half the body's radius, but at least
  /// 0.02 m
  double cell_m = 0;
  std::optional<double> heading;  ///< heading of all bodies, rad; not set: random, uniform in [-pi, pi)
  double z = 0;                   ///< height of the bodies' origins, m
  /// Largest number of random positions that are tried for each body; not used by `grid`.
  std::uint32_t trials = 1000;
};

/// Number of grid points of a rule of the kind `grid`, in `region` and `spill` together. The result is a
/// double, because it may exceed the range of every integer type.
double grid_cells(const PlacementRule& rule);

/// Number of positions that a rule of the kind `free_floor` tests to find the floor for bodies of a shape.
/// The result is a double, because it may exceed the range of every integer type.
double floor_cells(const PlacementRule& rule, const partition::ObstacleShape& shape);

/// Returns poses (world frame) for bodies 0, 1, ... of a population, chosen one after another. At each pose
/// the origin of the body is within `bounds` (if given), and the body overlaps neither `scene` (the obstacles
/// that never move) nor the bodies of `crowd`. The body is then added to the crowd, so `shape` must outlive
/// the crowd. The function stops at the first body for which it finds no free pose: the result is then
/// shorter than `count`.
///
/// The pose of body k depends neither on `count` nor on the cells of the spatial index: its random numbers
/// follow from (seed, population, k, trial), where `population` is the name of the population. The time is
/// linear in the number of positions that are tried. For a rule of the kind `free_floor`, the floor is
/// computed within the region of the rule, in steps of PlacementRule::cell_m, with only `scene` as obstacles.
/// grid_cells() and floor_cells() of the rule must be below 2^32.
std::vector<Pose> place(const PlacementRule& rule, const partition::ObstacleShape& shape, std::size_t count,
                        std::uint64_t seed, std::string_view population, const std::optional<Box>& bounds,
                        const partition::StaticScene& scene, Crowd& crowd, partition::Parallel& parallel);

}  // namespace troupe::engine
