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

/// The obstacles that place() avoids: a static scene and a crowd. The static scene is made of the solids of
/// static bodies, which never move (is_static()). The crowd is the list of the other bodies that were placed
/// so far.
class Occupancy {
 public:
  /// Makes the static scene from the first `fixed` bodies of `spec`, whether or not these bodies are static
  /// (is_static()). Only parts that are obstacles count. The crowd is empty. Both constructors keep a
  /// reference to the types of the spec: while the object exists, the spec must also exist, and no type may
  /// be added or changed.
  Occupancy(const WorldSpec& spec, std::size_t fixed);
  /// Makes the static scene from the static bodies of the spec (is_static()), and the crowd from the other
  /// bodies. Only parts that are obstacles count. Bodies that are not in the world at tick 0 (the initial
  /// state) are left out. Throws std::length_error if an outline is too complex for convex_pieces(), which
  /// divides it into convex polygons.
  explicit Occupancy(const WorldSpec& spec);

  const partition::StaticScene& scene() const { return scene_; }  ///< the static solids that are obstacles
  Crowd& crowd() { return crowd_; }                               ///< the bodies that are not static
  /// Obstacle shape of a type, computed at the first call for the type; valid as long as this object. Throws
  /// std::length_error if an outline is too complex for convex_pieces(), which divides it into convex
  /// polygons.
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

/// Appends populations to a world in their order: for each population first its bodies, then its reserve.
/// Each body is placed so that it overlaps neither the static scene nor the crowd of `occupancy`, and is then
/// added to the crowd. The poses depend only on the spec, `occupancy` and the populations, not on the number
/// of threads. These errors are reported to `diagnostics`: too many bodies, an empty region, a rule with too
/// many grid points or floor cells, a population without enough room, and a type with an outline that is too
/// complex for convex_pieces(), which divides it into convex polygons. After an error, some or all bodies are
/// missing in the world.
void place(std::span<const PopulationSpec> populations, WorldSpec& spec, Occupancy& occupancy,
           const PlaceOptions& options, Diagnostics& diagnostics);
/// Appends populations to a world, with all bodies of the spec that are in the world at tick 0 as obstacles:
/// calls the function above with Occupancy(spec). If an outline of one of these bodies is too complex for
/// convex_pieces(), the function reports an error without a file position.
void place(std::span<const PopulationSpec> populations, WorldSpec& spec, Diagnostics& diagnostics,
           const PlaceOptions& options = {});

/// Draws new poses and new random colours, from another seed, for the bodies that place() has appended.
/// Bodies of a reserve have no pose yet: only their random colours change. A population without enough room
/// is an error, reported at PopulationSpec::where_place; the bodies of that population and of later ones
/// then keep their poses and colours. Several threads may call this function at once with one `occupancy`.
///
/// bodies      the bodies of these populations and their reserves, in the order of place(); changed
/// bounds      the bounds of the world (WorldSpec::bounds)
/// occupancy   the object that place() used, so that the shapes of the types are already computed; its
///             crowd is not read
/// crowd       a copy of the crowd as it was before place()
void place_again(std::span<const PopulationSpec> populations, std::span<BodySpec> bodies, std::uint64_t seed,
                 const std::optional<Box>& bounds, Occupancy& occupancy, Crowd crowd,
                 Diagnostics& diagnostics);

}  // namespace troupe::engine
