#pragma once

#include "base/ids.hpp"
#include "engine/mount.hpp"
#include "engine/shape_buffer.hpp"

#include <atomic>
#include <cstdint>
#include <vector>

namespace troupe::engine {

/// A row of the component `carrier`: all zero if the body is not carried.
struct Carried {
  std::uint32_t carrier = 0;  ///< id of the carrier plus 1; 0: the body is not carried
  std::uint32_t joint = 0;    ///< index of the carrier's joint that holds the body, plus 1; 0: none
  /// Pose of the carried body, m and rad, in the frame of the carrier. If `joint` is not 0, that frame is
  /// displaced by the present motion of the joint from rest.
  Pose pose;
};

/// The joints of bodies, and the *trees* of bodies that carry one another. The root of a tree is its body
/// that is not carried. All members are derived from the state components `joint/...` and `carrier`. The
/// lists are empty if no type of the world has joints or can pick up bodies.
///
/// A body whose shape can change, because it has joints or can carry, is *composite*. For conflict
/// resolution, the shape of a root is that of its whole tree, in the root's frame, and the shape of a carried
/// body is empty.
struct Links {
  static constexpr std::uint32_t k_none = ~0u;  ///< no row
  /// The state of a joint's motion in this tick.
  enum class Goal : std::uint8_t {
    none,     ///< the joint has no command to move
    asked,    ///< the joint has a command that is not yet resolved
    moved,    ///< the joint is at its goal
    refused,  ///< the motion was blocked: the joint is at its old pose
  };

  /// A joint of one body.
  struct Joint {
    Mount now;                ///< maps a point of the body, with the joint at rest, to its present position
    Mount then;               ///< maps such a point to its position at the goal, or at a tested pose
    Pose goal;                ///< goal in this tick, relative to rest
    Goal state = Goal::none;  ///< state of the motion in this tick
    bool moves = false;       ///< whether the joint moves in this round of resolution
  };

  std::vector<std::uint32_t> joint_begins;  ///< one per row: its first joint in `joints`
  std::vector<Joint> joints;                ///< joints of all rows, in order of rows
  std::atomic<bool> asked = false;          ///< whether any joint has a command to move in this tick
  /// Number of rounds of joint resolution per tick: the largest number of devices that move joints of one
  /// body. In each round, the joints of at most one device per body move.
  std::size_t rounds = 0;

  std::vector<std::uint32_t> composites;    ///< rows of composite bodies
  std::vector<std::uint32_t> composite_of;  ///< one per row: its index in the lists below; k_none: none
  // One entry per composite body.
  std::vector<ShapeBuffer> shapes;      ///< shape of the tree of which the body is the root, in its frame
  std::vector<ShapeBuffer> moved;       ///< pieces of the tree that move in this round, at their goals
  std::vector<ShapeBuffer> on_the_way;  ///< the same pieces, at the pose that is tested now
  std::vector<std::uint32_t> samples;   ///< number of poses to test in this round; 0: no motion
  std::vector<std::uint8_t> refused;    ///< 1 if the motion of this round is blocked

  // One per row; empty if there are no composites.
  std::vector<std::uint32_t> roots;        ///< row of the tree's root; its own row if it is not carried
  std::vector<std::uint32_t> first_cargo;  ///< row of lowest id among those it carries directly; k_none: none
  std::vector<std::uint32_t> next_cargo;   ///< row of the next higher id on the same carrier; k_none: none
  std::size_t carried = 0;                 ///< number of carried rows

  std::vector<double> lifts;  ///< height offset of each outline that the grid ray engine draws, m

  /// Whether any body type in the world has joints or can pick up bodies.
  bool any() const { return !composites.empty(); }
};

}  // namespace troupe::engine
