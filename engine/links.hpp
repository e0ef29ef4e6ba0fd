#pragma once

#include "base/ids.hpp"
#include "engine/mount.hpp"
#include "engine/shape_buffer.hpp"

#include <atomic>
#include <cstdint>
#include <vector>

namespace troupe::engine {

/// A row of the component `carrier`: all zero where the body is not carried.
struct Carried {
  std::uint32_t carrier = 0;  ///< its id + 1
  std::uint32_t joint = 0;    ///< of the carrier's type, from which the body hangs: its index + 1; 0: none
  Pose pose;                  ///< of the body, in the carrier's frame as that joint moves it
};

/// What hangs together: the joints of bodies, and the *trees* of bodies that carry one another, each under
/// its root, the one that is not carried. All of it is derived from the components `joint/...` and `carrier`;
/// the lists are empty where no type of the world has joints or picks up others.
///
/// A body whose shape changes, because it has joints or may carry, is *composite*. The shape of a root is
/// that of its tree, in its own frame; that of a carried body is empty.
struct Links {
  static constexpr std::uint32_t k_none = ~0u;  ///< no row
  /// What became in this tick of what a joint was asked for.
  enum class Goal : std::uint8_t {
    none,     ///< it was not asked to move
    asked,    ///< it is still to be settled
    moved,    ///< it is there
    refused,  ///< something was in the way: it is where it was
  };

  /// A joint of one body.
  struct Joint {
    Mount now;                ///< takes a point of the body at rest to where it is, in the body's frame
    Mount then;               ///< where it would be: while joints settle
    Pose goal;                ///< relative to rest
    Goal state = Goal::none;  ///< of this tick
    bool moves = false;       ///< with the joints of this round
  };

  std::vector<std::uint32_t> joint_begins;  ///< a row each: its first in `joints`
  std::vector<Joint> joints;                ///< of all rows, by row
  std::atomic<bool> asked = false;          ///< some joint, in this tick
  std::size_t rounds = 0;                   ///< the most devices with joints that one body has

  std::vector<std::uint32_t> composites;    ///< rows
  std::vector<std::uint32_t> composite_of;  ///< a row each: index into the following, or k_none
  std::vector<ShapeBuffer> shapes;          ///< of roots that of their tree, in their own frame
  std::vector<ShapeBuffer> moved;           ///< of this round: what of the tree moves, where it would go
  std::vector<ShapeBuffer> on_the_way;      ///< the same, while the way there is tested
  std::vector<std::uint32_t> samples;  ///< of this round: poses at which that is tested; 0: nothing moves
  std::vector<std::uint8_t> refused;   ///< of this round: 1 where something is in the way

  // A row each; empty where there are no composites.
  std::vector<std::uint32_t> roots;        ///< row of the tree's root; its own where it is not carried
  std::vector<std::uint32_t> first_cargo;  ///< of lowest id that it carries itself; k_none: nothing
  std::vector<std::uint32_t> next_cargo;   ///< of the next higher id on the same carrier; k_none: the last
  std::size_t carried = 0;                 ///< rows that are carried

  std::vector<double> lifts;  ///< m, of each outline that the grid ray engine draws

  /// Whether anything in the world has joints or can carry.
  bool any() const { return !composites.empty(); }
};

}  // namespace troupe::engine
