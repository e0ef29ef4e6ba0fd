#pragma once

#include "engine/conflicts.hpp"
#include "engine/localization.hpp"
#include "engine/world_state.hpp"
#include "partition/parallel.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// The motions of bodies in a tick: from velocities to new poses. This part of World writes the components
/// (state tables) `pose`, `stall` and `odometry`. A row is the index of a body in the state tables.
class Movement {
 public:
  /// The arguments must outlive the object.
  Movement(WorldState& state, partition::Parallel& parallel) : state_(state), parallel_(parallel) {}
  Movement(const Movement&) = delete;
  Movement& operator=(const Movement&) = delete;

  /// Allocates the lists, after the rows of the state were made, and again after bodies have changed their
  /// rows. The caller must then derive everything else with draw_odometry_errors() and rest().
  void build();
  /// Computes the odometry error of each robot, unborn ones too, from the seed (Localization::error_of()).
  void draw_odometry_errors();
  /// Discards the motion and the FreeCircle of a row. Call this when the row's body gets another pose.
  void rest(Row row);
  /// Counts the stalled bodies again. Call this after other code has written the component `stall`.
  void count_stalls();
  /// Overwrites with junk all data that are neither constant nor state: see World::forget(). The caller must
  /// then derive them again with draw_odometry_errors(), rest() and count_stalls().
  void forget();
  /// Overwrites the motions of the last tick with junk, which the next tick must not read.
  void forget_motions();

  /// Computes the pose that each robot proposes from its velocity.
  void propose();
  /// Resolves the conflicts of all proposed motions. composites: rows of bodies whose shape can change.
  void resolve(std::span<const std::uint32_t> composites);
  /// Writes the new poses, including those of pushed bodies, and all data that are derived from poses, except
  /// the spatial index.
  void commit();

  std::uint64_t rounds() const { return conflicts_.rounds(); }  ///< number of rounds of the last resolution
  double longest() const { return conflicts_.longest(); }       ///< longest motion, m: Conflicts::longest()
  std::size_t stalled() const { return stalled_; }              ///< number of rows blocked or out of bounds
  std::size_t out_of_bounds() const { return out_of_bounds_; }  ///< number of rows out of bounds

 private:
  /// Adds the motion of this tick to the odometry estimate of a robot. It is called only if the motion was
  /// not blocked.
  void count_way(Row row, const BodyType::Drive& drive);
  void commit_pushes();

  WorldState& state_;
  partition::Parallel& parallel_;

  // Constants, and odometry_errors_, which are derived: another seed changes them.
  std::vector<std::uint8_t> is_pushable_;  // one per row; empty, like push_limits_, if no body can be pushed
  std::vector<std::uint8_t> push_limits_;
  Pushables pushables_;
  std::vector<Localization::Error> odometry_errors_;  // one per row; empty if no robot has odometry

  // Derived.
  std::vector<FreeCircle> free_circles_;
  std::size_t stalled_ = 0;
  std::size_t out_of_bounds_ = 0;

  // Scratch.
  std::vector<Motion> motions_;  // absent bodies never propose one
  Conflicts conflicts_;
};

}  // namespace troupe::engine
