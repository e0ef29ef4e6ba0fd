#pragma once

#include "base/geometry.hpp"
#include "engine/spec/world_spec.hpp"
#include "partition/overlap.hpp"
#include "partition/parallel.hpp"
#include "partition/sparse_grid.hpp"
#include "partition/static_scene.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
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

/// The bodies that were placed so far, in a spatial index that finds those that overlap a shape. The index
/// consists of several grids (levels) with cells of different widths, which are powers of two. A body is
/// listed in the cell of its origin, at the level whose cells are about as wide as the body. A single large
/// body therefore does not slow down every query. No result depends on the cells.
class Crowd {
 public:
  /// Adds a body. Bodies are numbered from 0 in the order in which they are added. The crowd keeps a
  /// reference to the shape, so the shape must outlive the crowd. A body with an empty shape gets a number,
  /// but overlaps no shape.
  void add(const partition::ObstacleShape& shape, const Pose& pose_world_body);
  std::size_t size() const { return bodies_.size(); }  ///< number of bodies

  /// Whether no body of the crowd overlaps a shape at a pose in the world frame. True for an empty shape.
  bool free(const partition::ObstacleShape& shape, const Pose& pose_world_body) const;
  /// Numbers of the bodies that overlap a shape at a pose in the world frame, ascending; none for an empty
  /// shape. Only bodies for whose number `matters` returns true are tested, which is slower than `matters`.
  std::vector<std::size_t> overlapping(const partition::ObstacleShape& shape, const Pose& pose_world_body,
                                       const std::function<bool(std::size_t)>& matters) const;
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
  /// A grid, with the bodies of similar width.
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

/// Least PlacementRule::distance_m of a poisson_disc rule, and least PlacementRule::cell_m of a free_floor
/// rule in a world file, m.
inline constexpr double k_least_placement_step_m = 1e-3;

/// Rule by which the bodies of a population (the bodies NAME0, NAME1, ... of one type) are placed. All
/// positions are in the world frame. The *static scene* is the set of obstacles that never move. The bounds
/// of the world are a box that bodies cannot leave (WorldSpec::bounds).
struct PlacementRule {
  /// Kinds of rules.
  enum class Kind : std::uint8_t {
    /// The points of a square grid with the spacing `pitch_m`. The points of `region` come first, then those
    /// of `spill`. In each box, the first point is the corner of least x and y. The points follow column by
    /// column: y grows within a column, and x grows from column to column. Each body takes the next point at
    /// which two conditions hold: the origin of the body is within `polygon` and the bounds of the world, and
    /// the body overlaps neither the static scene nor another body.
    grid,
    // All other kinds draw random positions, at most `trials` for each body, until one is free.
    uniform,       ///< uniformly distributed in the region
    gaussian,      ///< normally distributed around `mean`
    poisson_disc,  ///< in the region, at least `distance_m` from all other bodies of the population
    /// Uniformly distributed on a *floor*: a connected part of the region in which a disc can move around
    /// without overlapping the static scene. The disc is centred on the body's origin and encloses the body.
    free_floor,
  };
  Kind kind = Kind::grid;  ///< how positions are chosen
  /// Box that must contain the bodies' origins, m. For `grid`, it is the box of the grid points, and random
  /// displacements (`jitter_m`) may move origins out of it.
  Box region;
  Ring polygon;        ///< polygon that must contain the bodies' origins, m; empty: not restricted
  Box spill;           ///< grid: second box, used when all points of `region` were tried, m; empty: none
  double pitch_m = 1;  ///< grid: distance between neighbouring points, m
  /// grid: largest random displacement of x and of y from the grid, in either direction, m
  double jitter_m = 0;
  Vec2 mean{0, 0};        ///< gaussian: mean position, m
  Vec2 deviation{1, 1};   ///< gaussian: standard deviations along x and y, m
  double distance_m = 1;  ///< poisson_disc: smallest distance between the origins of two bodies, m
  /// free_floor: a point of the floor on which bodies are placed, m; not set: the largest floor of the
  /// region. If the point is outside the region or on no floor, no body can be placed.
  std::optional<Vec2> from;
  /// free_floor: distance along x and y between the positions that are tested to find the floor, m; 0: half
  /// the radius of the disc (see Kind::free_floor), but at least 0.02 m
  double cell_m = 0;
  std::optional<double> heading;  ///< heading of all bodies, rad; not set: random, uniform in [-pi, pi)
  double z = 0;                   ///< height of the bodies' origins, m
  /// Largest number of random positions that are tried for each body; not used by `grid`.
  std::uint32_t trials = 1000;
};

/// Number of points of a rule of the kind `grid`, in `region` and `spill` together. The result is a double,
/// because it may exceed the range of every integer type.
double grid_cells(const PlacementRule& rule);

/// Number of positions that a rule of the kind `free_floor` tests to find the floor for bodies of this shape.
/// The result is a double, because it may exceed the range of every integer type.
double floor_cells(const PlacementRule& rule, const partition::ObstacleShape& shape);

/// Whether PlacementRule::from, which must be set, is a point of a floor for bodies of this shape.
bool is_on_floor(const PlacementRule& rule, const partition::ObstacleShape& shape,
                 const partition::StaticScene& scene, partition::Parallel& parallel);

/// The bodies of a population for which place() chooses poses, and what restricts the poses apart from other
/// bodies.
struct Placement {
  const PlacementRule& rule;              ///< grid_cells() and floor_cells() of the rule must be below 2^32
  const partition::ObstacleShape& shape;  ///< obstacle shape of each body
  std::size_t count = 0;                  ///< number of bodies
  std::uint64_t seed = 0;                 ///< seed of the world (WorldSpec::seed)
  std::string_view population;            ///< name of the population
  std::optional<Box> bounds;              ///< must contain the bodies' origins; not set: not restricted
  const partition::StaticScene& scene;    ///< the static scene
};

/// Chooses poses (world frame) for the bodies 0, 1, ... of a population, one after another, by a rule. At its
/// pose, a body overlaps neither the static scene nor a body of `crowd`, and its origin is within the bounds.
/// Each body is added to `crowd` before the next pose is chosen. The crowd keeps a reference to the shape, so
/// the shape must outlive the crowd. If no free pose is found for a body, the function stops, and the result
/// has fewer than Placement::count poses.
///
/// The random numbers for body k depend only on the seed, on the name of the population, on k, and on the
/// number of the trial. The poses of the first bodies therefore do not depend on Placement::count. The time
/// is proportional to the number of tested positions.
std::vector<Pose> place(const Placement& placement, Crowd& crowd, partition::Parallel& parallel);

}  // namespace troupe::engine
