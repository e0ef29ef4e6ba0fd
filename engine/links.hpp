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
  std::uint32_t carrier = 0;  ///< id of the carrier + 1
  std::uint32_t joint = 0;    ///< joint of the carrier that holds the body: its index + 1; 0: none
  Pose pose;                  ///< pose of the body in the carrier's frame, as moved by that joint
};

/// The joints of bodies, and the *trees* of bodies that carry one another. The root of a tree is not carried.
/// All members are derived from the components `joint/...` and `carrier`. The lists are empty if no type of
/// the world has joints or can pick up bodies.
///
/// A body whose shape changes, because it has joints or can carry, is *composite*. The shape of a root is
/// that of its tree, in the root's frame; the shape of a carried body is empty.
struct Links {
  static constexpr std::uint32_t k_none = ~0u;  ///< no row
  /// The outcome of a joint's motion in this tick.
  enum class Goal : std::uint8_t {
    none,     ///< it has no command to move
    asked,    ///< it is not yet resolved
    moved,    ///< it is at its goal
    refused,  ///< blocked: it is at its old place
  };

  /// A joint of one body.
  struct Joint {
    Mount now;                ///< maps a point of the joint part at rest to its present place, body frame
    Mount then;               ///< the same for the goal, while joint motions are resolved
    Pose goal;                ///< relative to rest
    Goal state = Goal::none;  ///< outcome in this tick
    bool moves = false;       ///< it moves in this round
  };

  std::vector<std::uint32_t> joint_begins;  ///< one per row: its first joint in `joints`
  std::vector<Joint> joints;                ///< of all rows, by row
  std::atomic<bool> asked = false;          ///< a joint has a command to move in this tick
  std::size_t rounds = 0;                   ///< largest number of devices with joints on one body

  std::vector<std::uint32_t> composites;    ///< rows of composite bodies
  std::vector<std::uint32_t> composite_of;  ///< one per row: index into the lists below, or k_none
  std::vector<ShapeBuffer> shapes;          ///< shapes of trees, in the frame of their root
  std::vector<ShapeBuffer> moved;           ///< this round: the moving pieces of the tree, at their goals
  std::vector<ShapeBuffer> on_the_way;      ///< this round: the moving pieces, at the sample under test
  std::vector<std::uint32_t> samples;       ///< this round: number of samples of the motion; 0: no motion
  std::vector<std::uint8_t> refused;        ///< this round: 1 if the motion is blocked

  // One per row; empty if there are no composites.
  std::vector<std::uint32_t> roots;        ///< row of the tree's root; its own row if it is not carried
  std::vector<std::uint32_t> first_cargo;  ///< row of lowest id that it carries itself; k_none: none
  std::vector<std::uint32_t> next_cargo;   ///< row of the next higher id on the same carrier; k_none: none
  std::size_t carried = 0;                 ///< number of carried rows

  std::vector<double> lifts;  ///< m, height offset of each outline that the grid ray engine draws

  /// Whether bodies in the world have joints or can carry.
  bool any() const { return !composites.empty(); }
};

}  // namespace troupe::engine
