#pragma once

#include "base/color.hpp"
#include "base/diagnostics.hpp"
#include "base/ids.hpp"
#include "engine/spec/placement.hpp"
#include "engine/spec/world_spec.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// A population: bodies NAME0, NAME1, ... of one type, which place() places by a rule. Its reserve consists
/// of further bodies, which are not in the world at tick 0 (the initial state) and can be born later.
struct PopulationSpec {
  std::string name;           ///< NAME of the bodies NAME0, NAME1, ...; also selects their random numbers
  TypeId type;                ///< type of the bodies: index into WorldSpec::types
  std::size_t count = 0;      ///< number of bodies at tick 0
  std::size_t reserve = 0;    ///< number of bodies that may be born later; their names have the next numbers
  Color color{1, 0, 0, 1};    ///< colour of the bodies (BodySpec::color)
  bool random_color = false;  ///< true: each body gets a random opaque colour instead of `color`
  PlacementRule rule;         ///< where the bodies are placed
  std::string path;           ///< path of `rule` in the file, for messages; empty: `populations[INDEX].rule`
  Where where;                ///< position in the file, for messages (BodySpec::where)
  Where where_place;          ///< position of `rule`, for messages
};

/// The obstacles that place() avoids: a static scene and a crowd. The static scene consists of the solids of
/// static bodies, which never move (is_static()). The crowd contains the other bodies that were placed so
/// far. Of each body, only the parts that are obstacles count (Returns::obstacle).
///
/// The object refers to the types of a spec. While the object exists, the spec must exist, and no type of the
/// spec may be added or changed.
class Occupancy {
 public:
  /// Makes the static scene from the first `fixed` bodies of `spec`, even if some of these bodies are not
  /// static. The crowd is empty.
  Occupancy(const WorldSpec& spec, std::size_t fixed);
  /// Makes the static scene from the static bodies of the spec, and the crowd from its other bodies. Omits
  /// bodies that are not in the world at tick 0 (the initial state). Throws std::length_error if an outline
  /// of a body of the crowd is too complex for convex_pieces(), which divides it into convex polygons.
  explicit Occupancy(const WorldSpec& spec);

  const partition::StaticScene& scene() const { return scene_; }  ///< the static solids that are obstacles
  Crowd& crowd() { return crowd_; }                               ///< the bodies outside the static scene
  /// Obstacle shape of a type, computed at the first call for the type. The reference is valid as long as
  /// this object. Throws std::length_error if an outline is too complex for convex_pieces(), which divides it
  /// into convex polygons.
  const partition::ObstacleShape& shape(TypeId type);

 private:
  const std::vector<TypeSpec>& types_;
  partition::StaticScene scene_;
  Crowd crowd_;
  std::vector<std::optional<partition::ObstacleShape>> shapes_;  // in the order of types_, made on demand
};

/// Options of place(). They do not affect the poses.
struct PlaceOptions {
  unsigned threads = 0;           ///< number of threads; 0: one per processor that the process may use
  double most_bodies = 10000000;  ///< largest number of bodies in the world; more are an error
};

/// Appends populations to a world in their order: for each population first its bodies, then its reserve,
/// whose bodies get the height of the rule. A population without both is added to
/// WorldSpec::empty_populations.
/// Each body is placed where it overlaps neither the static scene nor the crowd of `occupancy`, and is then
/// added to the crowd. The poses depend only on the spec, `occupancy` and the populations, not on the number
/// of threads.
///
/// Reports these errors to `diagnostics`:
/// - The world has too many bodies (PlaceOptions::most_bodies).
/// - The type of a population does not exist, or a number of its rule is not finite, too large, or not
///   positive where it must be.
/// - The region of a rule is empty.
/// - A rule has too many grid points (grid_cells()) or tests too many positions (floor_cells()), alone or
///   together with the rules of the same kind before it.
/// - There is not enough room for a population.
/// - An outline of a type is too complex for convex_pieces(), which divides it into convex polygons.
///
/// After an error, some or all of the new bodies are missing in the world.
void place(std::span<const PopulationSpec> populations, WorldSpec& spec, Occupancy& occupancy,
           const PlaceOptions& options, Diagnostics& diagnostics);
/// Calls the function above with Occupancy(spec): the obstacles are all bodies of the spec that are in the
/// world at tick 0. First reports the errors that check_rules() finds in the spec. If Occupancy(spec) throws
/// std::length_error, reports the text of the exception as an error without a file position.
void place(std::span<const PopulationSpec> populations, WorldSpec& spec, Diagnostics& diagnostics,
           const PlaceOptions& options = {});

/// Repeats place() with another seed: gives the bodies that place() has appended new poses and, if
/// PopulationSpec::random_color is true, new random colours. Bodies of a reserve have only a height yet, so
/// only their colours change. If there is not enough room for a population, reports an error at
/// PopulationSpec::where_place. The bodies of this population and of later ones then keep their poses and
/// colours. Several threads may call this function at once with the same `occupancy`.
///
/// populations: the populations that were passed to place()
/// bodies: the bodies and reserves that place() has appended for these populations, in the same order;
/// changed
/// bounds: the bounds of the world (WorldSpec::bounds)
/// occupancy: the object that was passed to place(). Only its static scene and its shapes of types are used,
/// not its crowd.
/// crowd: a copy that was made of the crowd of `occupancy` before place() was called
void place_again(std::span<const PopulationSpec> populations, std::span<BodySpec> bodies, std::uint64_t seed,
                 const std::optional<Box>& bounds, Occupancy& occupancy, Crowd crowd,
                 Diagnostics& diagnostics);

}  // namespace troupe::engine
