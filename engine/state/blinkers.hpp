#pragma once

#include "base/ids.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/state/world_state.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace troupe::engine {

/// Implements the test mode World::hide_beyond_reach(). A kind of device is a table of functions that
/// implements one sort of device. It declares which data of other bodies the device reads, and which bodies
/// it may change. Before a device runs, World calls hide_from(): the object overwrites with junk all data of
/// other bodies that are not declared as read, and removes bodies beyond the reach of the device from the
/// spatial index. The object also detects effects (changes that a device makes to bodies) on bodies that may
/// not be changed. The reach of a device is the distance up to which it may read or change other bodies. A
/// row is the index of a body in the state tables, and a component is one of these tables. Bodies that carry
/// one another form a tree.
class Blinkers {
 public:
  /// Copies `state`, and keeps a reference to it. `state` must outlive the object.
  explicit Blinkers(WorldState& state);

  /// Hides data from a device of the row's body. Two groups of bodies are hidden completely: bodies that are
  /// not in the world, and bodies whose enclosing circles are outside the disc with the radius `reach` (m)
  /// about the origin of the row's body. Bodies in the same tree as the row's body count as inside the disc.
  /// The remaining bodies, except the row's own, keep only these components, and the rest of their state is
  /// hidden: `pose`, `carrier`, `life`, those of joints, and those that the kind of the device declares as
  /// read (DeviceKind::reads). `kind` must outlive the object.
  void hide_from(Row row, const DeviceKind& kind, double reach);
  /// Undoes the last call of hide_from(), which must have had the same row and kind and must not have been
  /// undone yet.
  void show_hidden(Row row, const DeviceKind& kind);
  /// Checks the targets of the effects that the device emitted while data were hidden. The scope of a kind
  /// says which bodies its effects may change. Only devices whose kind has the scope ApplyScope::trees are
  /// checked: throws a StepError if a target is a body that hide_from() has hidden completely, because it is
  /// beyond the reach of the device or not in the world. Effects without a target, and effects on static
  /// bodies, are allowed. Call it after show_hidden(), before the next hide_from().
  void check_targets(const BodyType::Device& device, std::span<const Effect> emitted) const;

  /// Call this before an effect is applied: copies the state, and stores which bodies are in the tree of the
  /// source (the body of the device) or of the target of the effect. end_effect() compares with these data.
  void begin_effect(const Effect& effect);
  /// Throws a StepError if the effect that was applied since begin_effect() has changed the state of a body
  /// outside the trees of the source and the target of the effect. A body that was in one of these trees
  /// before or after the effect may change. If the kind of the device has the scope ApplyScope::anything, its
  /// effects may change any body, and nothing is checked.
  void end_effect(const BodyType::Device& device, const Effect& effect);

 private:
  std::vector<std::uint8_t> tables_read_by(const DeviceKind& kind) const;
  template <class Visit>
  void for_joints_of(Row row, Visit&& visit) const;
  template <class Visit>
  void for_other_tables(Row row, std::span<const std::uint8_t> reads, Visit&& visit);
  std::vector<std::uint8_t> trees_of(const Effect& effect) const;

  WorldState& state_;

  // Copies of columns of the state. Only the elements of hidden rows are used.
  std::vector<Transform> transforms_;
  std::vector<Vec2> outlines_;
  std::vector<double> radii_;
  std::vector<const partition::ObstacleShape*> shapes_;
  std::vector<Mount> joint_mounts_;
  std::vector<std::uint32_t> roots_;
  std::vector<StateTable> tables_;
  partition::BodyIndex index_;  // while rows are hidden: the complete index; otherwise: memory for the index
                                // without hidden rows
  partition::Parallel serial_{1};
  std::vector<Row> hidden_;  // in ascending order
  // Per kind of device: for each state table, whether the kind reads the rows of other bodies in it.
  std::map<const DeviceKind*, std::vector<std::uint8_t>> reads_;

  // The state before the effect that is being applied.
  std::vector<StateTable> before_;
  std::vector<std::uint8_t> inside_;  // one per row: 1 if it was in the tree of the source or of the target
};

}  // namespace troupe::engine
