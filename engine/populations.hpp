#pragma once

#include "base/color.hpp"
#include "base/diagnostics.hpp"
#include "base/ids.hpp"
#include "engine/placement.hpp"
#include "engine/world_spec.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

/// Bodies NAME0, NAME1, ... of one type that a rule places.
struct PopulationSpec {
  std::string name;           ///< NAME; names the random draws too
  TypeId type;                ///< index into WorldSpec::types
  std::size_t count = 0;      ///< bodies that are there at tick 0
  std::size_t reserve = 0;    ///< bodies that may be born later, after the others: ReserveSpec
  Color color{1, 0, 0, 1};    ///< BodySpec::color
  bool random_color = false;  ///< each body draws an opaque colour instead
  PlacementRule rule;         ///< where they are placed
  std::string path;           ///< of `rule`, for messages; empty: `populations[INDEX].rule`
  Where where;                ///< BodySpec::where
  Where where_place;          ///< of `rule`, for messages
};

/// The room that the bodies of a world take up while others are placed: solids of static geometry, and a
/// crowd.
class Occupancy {
 public:
  /// The first `fixed` bodies of the spec become the static scene. The types of the spec are referred to:
  /// none may be added or changed while this lives.
  Occupancy(const WorldSpec& spec, std::size_t fixed);
  /// The bodies at tick 0: those that nothing moves become the static scene, the others join the crowd.
  /// Throws std::length_error as shape() does.
  explicit Occupancy(const WorldSpec& spec);

  const partition::StaticScene& scene() const { return scene_; }  ///< obstacle solids alone
  Crowd& crowd() { return crowd_; }                               ///< empty at first
  /// Obstacle shape of a type. Throws std::length_error as obstacle_shape() does.
  const partition::ObstacleShape& shape(TypeId type);

 private:
  const std::vector<TypeSpec>& types_;
  partition::StaticScene scene_;
  Crowd crowd_;
  std::vector<std::optional<partition::ObstacleShape>>
      shapes_;  // in the order of types_, made when asked for
};

/// How populations are placed. Nothing here changes a pose.
struct PlaceOptions {
  unsigned threads = 0;           ///< 0: one for each processor that the process may use
  double most_bodies = 10000000;  ///< that the world may have
};

/// Appends the bodies of populations, in their order, and then their reserves, to a world. A body is placed
/// free of the static scene, of the crowd, and of the bodies before it; it joins the crowd. Same spec and
/// populations, same poses, whatever the threads.
/// errors   reported at PopulationSpec::where and where_place: too many bodies, a rule that tries too many
///          cells, a population that found too little room. The world is of no use then
void place(std::span<const PopulationSpec> populations, WorldSpec& spec, Occupancy& occupancy,
           const PlaceOptions& options, Diagnostics& diagnostics);
/// The same among all bodies that the spec has at tick 0.
void place(std::span<const PopulationSpec> populations, WorldSpec& spec, Diagnostics& diagnostics,
           const PlaceOptions& options = {});

/// Gives bodies that place() has appended the poses and the random colours that they have with another seed.
/// Nothing else of them changes, nor anything of their reserves but colours.
/// bodies      of these populations and their reserves, in the order in which place() appended them
/// occupancy   that place() was given, whose shapes it has made; only its scene and shapes are read
/// crowd       as it was before place()
/// errors      reported at PopulationSpec::where_place: a population that found too little room
/// May be called from several threads at once.
void place_again(std::span<const PopulationSpec> populations, std::span<BodySpec> bodies, std::uint64_t seed,
                 const std::optional<Box>& bounds, Occupancy& occupancy, Crowd crowd,
                 Diagnostics& diagnostics);

}  // namespace troupe::engine
