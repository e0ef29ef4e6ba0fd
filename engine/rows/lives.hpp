#pragma once

#include "base/ids.hpp"
#include "base/pose.hpp"
#include "engine/conflicts/movement.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/links/links.hpp"
#include "engine/rows/places.hpp"
#include "engine/rows/ranks.hpp"
#include "engine/state/world_state.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace troupe::engine {

/// The births and deaths of a world, its reserves, and the number of its robots.
class Lives {
 public:
  /// Returns a pose for a newborn body; the argument is the number of the trial, from 0.
  using Place = std::function<Pose(std::uint32_t)>;
  /// Receives the result of a birth that a device requested.
  using Born = std::function<void(const Effect& effect, const Birth& birth)>;

  /// The arguments must outlive the object.
  Lives(WorldState& state, Links& links, Movement& movement, Places& places, const RankPort& ranks)
      : state_(state), links_(links), movement_(movement), places_(places), ranks_(ranks) {}
  Lives(const Lives&) = delete;
  Lives& operator=(const Lives&) = delete;

  /// Adds the component `life` to the tables, if bodies can be born or die. Call this after the rows were
  /// made.
  void build();
  /// Gives all rows the state at tick 0. All bytes of the tables must be 0 before. Computes no derived data.
  void start();
  /// Whether the component `life` is consistent with itself, with the tick and with the component `carrier`.
  bool hold(std::uint64_t tick) const;
  /// Computes all derived data of this class, and the counts of absent rows.
  void derive();
  /// The part of derive() that depends on which rows are here.
  void count_present();
  void forget();  ///< for tests: overwrites the derived data with junk

  std::size_t robots_at_start() const { return robots_at_start_; }  ///< robots in the world at tick 0
  /// Number of robots that are in the world and have own rows. In a world without births and deaths, all
  /// robots count, whether their rows are here or not.
  std::size_t robots() const { return robots_; }
  /// Number of bodies of each reserve that have been born. All ranks have the same numbers.
  std::span<const std::uint32_t> births() const { return next_born_; }
  /// Sets the numbers of births() to those on rank 0. Called after a new state was adopted, if the rows are
  /// distributed among ranks.
  void set_births(std::span<const std::uint32_t> births);
  /// Number of bodies of a reserve (an index into WorldSpec::reserves) that are not yet born.
  std::size_t unborn(std::size_t reserve) const {
    return state_.spec.reserves[reserve].count - next_born_[reserve];
  }
  /// The body of a reserve that is born next. Not all bodies of the reserve may have been born.
  BodyId next_unborn(std::size_t reserve) const;

  /// Spawns the next body of a reserve, if there is one, at the first free pose of place(0), place(1), ...,
  /// place(trials - 1). Before the call, the spatial index must contain the present poses of all bodies in
  /// the world, except the bodies of Places::newborn().
  ///
  /// If the rows are distributed among ranks, all ranks make the same calls in the same order. The row of the
  /// new body stays on the rank that had the row of the unborn body, until the ranks distribute the rows
  /// again.
  Birth give_birth(std::size_t reserve, std::uint32_t trials, const Place& place);
  /// Brings the rows of bodies that were born or moved since the last tick to the ranks that own the ground
  /// there, if the rows are distributed among ranks, and adds newborn bodies to the index. All ranks make
  /// this call.
  void follow_newborn();
  /// Removes a body from the world; does nothing if the body is not in the world. The carrier of the body
  /// releases it, and the body releases its cargo. The row keeps the pose at death and the component `life`;
  /// the rest of its state becomes 0.
  void die(Row row);
  /// Carries out the deaths and births that devices requested in this tick. Deaths come first, so that a body
  /// can be born where another body died in the same tick. The world must have the component `life`. If the
  /// rows are distributed among ranks, `effects` must have the effects of all ranks.
  ///
  /// born: called for each request of a birth by a device whose row is here
  void resolve(std::span<const Effect> effects, const Born& born);

 private:
  std::uint32_t first_free(BodyId id, const partition::ObstacleShape& shape, std::uint32_t trials,
                           const Place& place) const;
  void enter(Row row, const Pose& pose);
  void leave(Row row);

  WorldState& state_;
  Links& links_;
  Movement& movement_;
  Places& places_;
  const RankPort& ranks_;

  std::size_t robots_at_start_ = 0;  // constant
  // Derived: computed by derive(), kept up to date by each tick.
  std::vector<std::uint32_t> next_born_;  // one per reserve: index of its first unborn body in the reserve
  std::size_t robots_ = 0;                // among the own rows
};

}  // namespace troupe::engine
