#pragma once

#include "base/geometry.hpp"
#include "engine/world_spec.hpp"
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

/// Obstacle solids of all parts of a type, for overlap tests; empty if no part is an obstacle.
/// Throws std::length_error if an outline is too complex (convex_pieces).
partition::ObstacleShape obstacle_shape(const TypeSpec& type);
/// Solids of the parts for which counts(part) is true; throws as obstacle_shape() does.
partition::ObstacleShape shape_of(const TypeSpec& type, bool (*counts)(const PartSpec& part));

/// A spatial index of bodies. A body is in the cell of its centre, at the level whose cells are about as wide
/// as the body, so that a single large body does not slow every query. The cells change no answer.
class Crowd {
 public:
  /// Adds body number size(). Keeps a reference to the shape, which must outlive the crowd. A body whose
  /// shape is empty is counted, but overlaps nothing.
  void add(const partition::ObstacleShape& shape, const Pose& pose_world_body);
  std::size_t size() const { return bodies_.size(); }  ///< number of bodies

  /// Whether no body of the crowd overlaps a shape at a pose.
  bool free(const partition::ObstacleShape& shape, const Pose& pose_world_body) const;
  /// Numbers of the bodies that overlap a shape at a pose, ascending.
  std::vector<std::size_t> overlapping(const partition::ObstacleShape& shape,
                                       const Pose& pose_world_body) const;

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

/// Rule by which the bodies of a population are placed.
struct PlacementRule {
  /// Kinds of rules.
  enum class Kind : std::uint8_t {
    grid,  ///< cells of `pitch_m`, column by column from the region's min corner; taken cells are skipped
    // All others draw up to `trials` positions for each body.
    uniform,       ///< anywhere in the region
    gaussian,      ///< normally distributed around `mean`
    poisson_disc,  ///< anywhere, at least `distance_m` from all others of the population
    free_floor,    ///< anywhere that a disc as wide as the body can reach
  };
  Kind kind = Kind::grid;         ///< kind of this rule
  Box region;                     ///< contains the bodies' origins, m
  Ring polygon;                   ///< also contains the bodies' origins, m; empty: no restriction
  Box spill;                      ///< grid: filled cell by cell after the region's cells are used up
  double pitch_m = 1;             ///< grid: distance between neighbouring cells
  double jitter_m = 0;            ///< grid: greatest random displacement of each coordinate
  Vec2 mean{0, 0};                ///< gaussian: mean position, m
  Vec2 deviation{1, 1};           ///< gaussian: standard deviations along x and y, m
  double distance_m = 1;          ///< poisson_disc: least distance between origins
  std::optional<Vec2> from;       ///< free_floor: start of reach; not set: the largest connected floor
  double cell_m = 0;              ///< free_floor: step of the search; 0: half the body's radius
  std::optional<double> heading;  ///< rad; not set: uniformly random
  double z = 0;                   ///< m
  std::uint32_t trials = 1000;    ///< most draws for each body
};

/// Number of cells of a grid rule; a double, because it may exceed every integer.
double grid_cells(const PlacementRule& rule);

/// Number of positions that a free_floor rule tests for bodies of a shape.
double floor_cells(const PlacementRule& rule, const partition::ObstacleShape& shape);

/// Poses for bodies 0, 1, ... of a population, one after another, each within `bounds` and free of the static
/// scene, the crowd and the bodies before it. Adds the bodies to the crowd. Stops at the first body without a
/// free pose: the result is then shorter than `count`. The pose of body k does not depend on `count` nor on
/// any cell size: its draws are those of (seed, population, k, trial).
/// Time is linear in the count plus the skipped grid cells. Reachability of the free floor is computed within
/// the region, in steps along x and y, with only the static scene as obstacles.
/// grid_cells() and floor_cells() must be below 2^32.
std::vector<Pose> place(const PlacementRule& rule, const partition::ObstacleShape& shape, std::size_t count,
                        std::uint64_t seed, std::string_view population, const std::optional<Box>& bounds,
                        const partition::StaticScene& scene, Crowd& crowd, partition::Parallel& parallel);

}  // namespace troupe::engine
