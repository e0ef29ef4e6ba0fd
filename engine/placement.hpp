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

/// The obstacle solids of all parts of a type, for overlap tests; empty where nothing of it blocks.
/// Throws std::length_error where an outline is too intricate (convex_pieces).
partition::ObstacleShape obstacle_shape(const TypeSpec& type);
/// The same of those parts for which counts(part) holds.
partition::ObstacleShape shape_of(const TypeSpec& type, bool (*counts)(const PartSpec& part));

/// Bodies that stand somewhere, found by where they are. A body lies in the cell of its centre, at the level
/// whose cells are as wide as the body, so that one truck does not widen every query; the cells change no
/// answer.
class Crowd {
 public:
  /// Adds body number size(). The shape is referred to and must outlive the crowd. A shape without pieces is
  /// counted and never met.
  void add(const partition::ObstacleShape& shape, const Pose& pose_world_body);
  std::size_t size() const { return bodies_.size(); }  ///< bodies that were added

  /// True when no body of the crowd overlaps a later one of this shape at this pose.
  bool free(const partition::ObstacleShape& shape, const Pose& pose_world_body) const;
  /// The numbers of those that do, ascending.
  std::vector<std::size_t> overlapping(const partition::ObstacleShape& shape,
                                       const Pose& pose_world_body) const;

 private:
  static constexpr std::uint32_t k_none = ~0u;

  struct Body {
    Pose pose;
    const partition::ObstacleShape* shape;
    std::uint32_t next;  // in the same cell
  };
  /// All bodies of about one width.
  struct Level {
    int exponent = 0;  // cells are 2^exponent m wide: at least as wide as the bodies
    partition::GridGeometry grid;
    partition::TileDirectory tiles;
    std::vector<std::uint32_t> first;  // per tile and cell: of the bodies there
  };

  template <class Visit>  // bool visit(body): false ends the search
  bool each_near(double radius, const Pose& pose, Visit visit) const;

  std::vector<Body> bodies_;
  std::vector<Level> levels_;
};

/// How the bodies of a population are placed.
struct PlacementRule {
  /// The rules that there are.
  enum class Kind : std::uint8_t {
    grid,  ///< cells of `pitch_m`, column by column from the region's min corner; taken cells are skipped
    // Of the rest a body has up to `trials` draws:
    uniform,       ///< anywhere in the region
    gaussian,      ///< normally distributed about `mean`
    poisson_disc,  ///< anywhere, no nearer than `distance_m` to any other of the population
    free_floor,    ///< anywhere on the floor that a disc as wide as the body can reach
  };
  Kind kind = Kind::grid;         ///< the one to follow
  Box region;                     ///< of the bodies' origins, m
  Ring polygon;                   ///< in which they lie besides, m; empty: any
  Box spill;                      ///< grid: filled, cell by cell as well, once the region's cells are used up
  double pitch_m = 1;             ///< grid: between neighbouring cells
  double jitter_m = 0;            ///< grid: each coordinate is moved by up to this much
  Vec2 mean{0, 0};                ///< gaussian, m
  Vec2 deviation{1, 1};           ///< gaussian: standard deviations along x and y, m
  double distance_m = 1;          ///< poisson_disc: between origins
  std::optional<Vec2> from;       ///< free_floor: from here; not given: the largest floor of one piece
  double cell_m = 0;              ///< free_floor: steps from one place to the next; 0: half the body's radius
  std::optional<double> heading;  ///< rad; not given: drawn from all directions
  double z = 0;                   ///< m
  std::uint32_t trials = 1000;    ///< draws for each body
};

/// Cells of a grid rule, as a floating number because a region may hold any count.
double grid_cells(const PlacementRule& rule);

/// Places that a free_floor rule looks at for bodies of this shape.
double floor_cells(const PlacementRule& rule, const partition::ObstacleShape& shape);

/// Poses for bodies 0, 1, ... of a population, one after another, each free of the static scene, of the crowd
/// and of those before it; they join the crowd. Stops where one finds no place: the result is then shorter
/// than `count`. The pose of body k does not depend on `count`, nor on any cell size: its draws are those of
/// (seed, population, k, trial).
/// Time is linear in the count plus the grid cells passed over. Poses outside of `bounds` are not free.
/// What is reachable of the free floor is so within the region, in steps along x and y, past the static scene
/// alone.
/// The caller keeps grid_cells() and floor_cells() below 2^32.
std::vector<Pose> place(const PlacementRule& rule, const partition::ObstacleShape& shape, std::size_t count,
                        std::uint64_t seed, std::string_view population, const std::optional<Box>& bounds,
                        const partition::StaticScene& scene, Crowd& crowd, partition::Parallel& parallel);

}  // namespace troupe::engine
