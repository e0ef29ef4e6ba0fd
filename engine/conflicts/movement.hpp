#pragma once

#include "engine/conflicts/collision.hpp"
#include "engine/conflicts/conflicts.hpp"
#include "engine/kinds/localization.hpp"
#include "engine/state/world_state.hpp"
#include "partition/parallel.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

/// The motions of all bodies in a tick (time step), from velocities to new poses. In each tick, World calls
/// propose(), resolve() and commit(), in this order. commit() writes the results to the components (state
/// tables) `pose`, `stall` and `odometry`.
///
/// A *row* is the index of a body in the state tables. A *robot* is a body with a drive. A body is *stalled*
/// if its motion in the last tick was blocked by another body, or would have ended outside the bounds of the
/// world (*out of bounds*).
class Movement {
 public:
  /// The arguments must outlive the object.
  Movement(WorldState& state, partition::Parallel& parallel) : state_(state), parallel_(parallel) {}
  Movement(const Movement&) = delete;
  Movement& operator=(const Movement&) = delete;

  /// Allocates the lists that have one entry per row. Call this after the rows of the state were made, and
  /// again after bodies have changed their rows. Afterwards call draw_odometry_errors(), rest() for each row,
  /// and count_stalls(), which compute the contents.
  void build();
  /// Computes the odometry error of each robot, including robots that are not yet born. It is the error that
  /// the world file gives, or else a random error that depends on the seed of the world and the id of the
  /// robot (Localization::error_of()).
  void draw_odometry_errors();
  /// Discards the proposed motion of a row and its cached FreeCircle (engine/conflicts/conflicts.hpp). Call
  /// this after code other than commit() has set the pose of the row's body.
  void rest(Row row);
  /// Computes TickCounts::stalled and out_of_bounds from the component `stall`. Call this after other code
  /// has written that component.
  void count_stalls();
  /// Overwrites with junk all data of this object that are neither constant nor part of the state.
  /// World::forget() calls this to test that these data can be computed again from the state. The caller must
  /// then compute them with draw_odometry_errors(), rest() for each row, and count_stalls().
  void forget();
  /// Overwrites the proposed motions of the last tick with junk. World::forget() calls this to test that the
  /// next tick does not read them.
  void forget_motions();

  /// Computes the motion that each robot proposes from its velocity. A robot proposes no motion if its
  /// velocity is 0 or another body carries it.
  void propose();
  /// Decides which of the proposed motions happen: see Conflicts.
  ///
  /// composites: rows of the bodies whose shape can change (Links::composites())
  /// border: the connection to the other ranks (threads or processes that compute the same world), if the
  /// rows include ghosts (copies of rows that other ranks compute); otherwise null
  void resolve(std::span<const std::uint32_t> composites, Conflicts::Border* border);
  /// Lets resolve() find out what blocks each body, from the next resolution on. This never ends.
  void find_blocks() {
    finds_blocks_ = true;
    blocks_.resize(state_.row_count());
  }
  /// What blocked the motion of each row in the last resolution; empty without find_blocks(). A Border may
  /// write the elements of ghosts.
  std::span<Conflicts::Block> blocks() { return blocks_; }
  /// A blocked motion of the last resolution: the arguments are the members of Collision::Sides. Call this
  /// between resolve() and commit(), with find_blocks().
  Collision::Sides collision(std::uint32_t mover, std::uint32_t blocker, bool feels_as_mover) const {
    return {crowd_, state_.scene, mover, blocker, feels_as_mover};
  }
  /// Writes the poses of the bodies that moved or were pushed, their transforms and outlines, the component
  /// `stall`, what blocked each body (WorldState::contact()), and the odometry estimates. The spatial index
  /// still has the old poses afterwards. Carried bodies keep their old poses until Links::carry() moves them
  /// with their carriers.
  void commit();

  /// Number of rounds in which the last resolve() resolved the motions: 1 if no body had to wait for the
  /// outcome of another, 0 before the first resolve(). See Conflicts::rounds().
  std::uint64_t rounds() const { return conflicts_.rounds(); }
  /// Upper bound on the distance that the origin of any body moved in the last resolution, m; 0 before the
  /// first resolution. See Conflicts::longest().
  double longest() const { return conflicts_.longest(); }

 private:
  /// Adds the motion of this tick, with the error of the robot's odometry, to the robot's odometry estimate.
  /// Called only if the robot has moved or turned. share: 1 if it has moved, 0 if it has only turned
  void count_way(Row row, const BodyType::Drive& drive, double share);
  void commit_pushes();

  WorldState& state_;
  partition::Parallel& parallel_;

  // Constants, and odometry_errors_, which are derived: another seed changes them.
  std::vector<std::uint8_t> is_pushable_;  // one per row; empty, like push_limits_, if no body can be pushed
  std::vector<std::uint8_t> push_limits_;
  Pushables pushables_;
  bool finds_blocks_ = false;
  std::vector<std::uint8_t> turns_;  // one per row: 1 if it turns when it is blocked; empty if no body does
  std::vector<Localization::Error> odometry_errors_;  // one per row; empty if no robot has odometry

  // Scratch.
  std::vector<Motion> motions_;           // absent bodies never propose one
  std::vector<Conflicts::Block> blocks_;  // one per row; empty unless finds_blocks_
  Conflicts::Crowd crowd_;                // of the last resolution
  Conflicts conflicts_;
};

}  // namespace troupe::engine
