#pragma once

#include "base/ids.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/state/world_state.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace troupe::engine {

/// Implements the test mode World::hide_beyond_reach(), which finds undeclared accesses of devices to other
/// bodies. A *kind* of device is a table of functions that implements one sort of device. It declares which
/// data of other bodies the device reads, and which other bodies the device may change.
///
/// - Reading: Before a device runs, World calls hide_from(). This function overwrites with junk all data of
///   other bodies that the kind has not declared. show_hidden() restores them.
/// - Changing: A device changes other bodies by *effects*, which are applied after all bodies have moved.
///   check_targets(), begin_effect() and end_effect() find effects on bodies that the device may not change.
///
/// The *reach* of a device is the radius of a disc around the origin of its body: the device may read a body
/// only if the enclosing circle of that body meets the disc. A *row* is the index of a body in the state
/// tables, and a *component* is one of these tables. A *tree* consists of bodies that move together because
/// they carry one another; a single body that neither carries others nor is carried is also a tree.
class Blinkers {
 public:
  /// Keeps a reference to `state`, which must outlive the object, and copies its data. If rows are added or
  /// removed, or bodies get other rows, a new object is needed.
  explicit Blinkers(WorldState& state);

  /// Hides the data of other bodies from a device of the row's body. `kind` is the kind of the device, and
  /// must outlive the object. `reach` is the reach of the device, m.
  ///
  /// - Bodies that are not in the world, and bodies beyond the reach, are hidden completely: all their data
  ///   are junk, and the spatial index does not contain them. A body is beyond the reach if its enclosing
  ///   circle is outside the disc with the radius `reach` around the origin of the row's body. Bodies in the
  ///   tree of the row's body are never beyond the reach.
  /// - Bodies that are not hidden completely keep some components: `pose`, `carrier`, `life`, those of
  ///   joints, and those that the kind declares (DeviceKind::reads). Their other components are junk. Only
  ///   the row's own body keeps all components.
  void hide_from(Row row, const DeviceKind& kind, double reach);
  /// Undoes the last call of hide_from(). The arguments must have the same values as in that call. Call this
  /// once after each call of hide_from().
  void show_hidden(Row row, const DeviceKind& kind);
  /// Throws a StepError if an effect has a target that hide_from() has hidden completely: a body that is
  /// beyond the reach of the device or not in the world. `emitted` are the effects that the device has
  /// emitted since hide_from(). Effects without a target, and effects on static bodies (which have no row),
  /// are allowed.
  ///
  /// Checks nothing unless the kind of the device has the scope ApplyScope::trees, because devices with
  /// another scope may act at any distance. Call this after show_hidden(), before the next hide_from().
  void check_targets(const BodyType::Device& device, std::span<const Effect> emitted) const;

  /// Call this before an effect is applied. Stores a copy of the state, with which end_effect() compares the
  /// state. Also stores which bodies are in the tree of the source (the body of the device) or in the tree of
  /// the target.
  void begin_effect(const Effect& effect);
  /// Call this after an effect was applied. Throws a StepError if the effect has changed the state of a body
  /// that it may not change. An effect may change the bodies in the tree of its source (the body of the
  /// device) and in the tree of its target, as these trees were before the effect or are after it. Checks
  /// nothing if the kind of the device has the scope ApplyScope::anything.
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
