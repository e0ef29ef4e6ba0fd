#pragma once

#include "base/geometry.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/ranks/orders.hpp"
#include "engine/ranks/rank_work.hpp"
#include "engine/rows/ranks.hpp"
#include "engine/state/hashes.hpp"
#include "engine/state/world_state.hpp"
#include "partition/message.hpp"
#include "partition/parallel.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace troupe::engine {

class Effects;
class Halo;
class Links;
class World;

/// Returns the range of rows that some bodies have in `table`. `rows` is the range of rows of these bodies in
/// the world (SensingView::row()). The ranges differ if `table` has rows for only some of the bodies with
/// rows.
RowRange rows_in(const World& world, const StateTable& table, const RowRange& rows);
/// Reads an effect from a message. Throws std::logic_error if it refers to a body, device or reserve that
/// does not exist.
Effect get_effect(partition::MessageReader& message, const World& world);

/// The part of a Replica that depends on how the rows of a world are divided among ranks. A row is the data
/// of one body in the state tables. A rank is a thread or process that computes the world together with
/// others, and has a Replica, a copy of the world. A rank *owns* the rows of the bodies whose sensors,
/// devices, drives and controllers it runs. There are two forms. In a *replicated* world (ReplicatedRows),
/// every rank has all rows. In a *distributed* world (DistributedRows), a rank has only the rows that it owns
/// and copies of the rows of nearby bodies.
///
/// Functions with an argument `message` or `messages`, and written(), only write or read the contents of
/// messages; the Replica sends and receives these messages. Other functions send and receive messages
/// themselves. A tick is a time step, and its phases are listed in engine/state/phase.hpp. All ranks call the
/// functions of a tick at the same points of the tick. An effect is an action of a device on another body.
class RankRows {
 public:
  RankRows() = default;
  RankRows(const RankRows&) = delete;
  RankRows& operator=(const RankRows&) = delete;
  virtual ~RankRows() = default;

  virtual RowRange own() const = 0;       ///< the rows that this rank owns
  virtual Halo* halo() = 0;               ///< the rows of a distributed world on this rank; else null
  virtual RankCounts counts() const = 0;  ///< what this rank has counted; `messages` and `bytes` are 0

  // ---- All rows on rank 0
  /// Whether rank 0 has the present values of all rows. Called on rank 0 only.
  virtual bool is_complete() const = 0;
  /// Appends those data of the rows of this rank that rank 0 lacks.
  virtual void put_missing(partition::MessageWriter& message) const = 0;
  /// On rank 0: reads one message from each other rank, in the order of ranks, to which put_missing() has
  /// appended data. Afterwards, is_complete() is true.
  virtual void complete(std::span<ReceivedOrder> messages) = 0;
  /// Called before a new state replaces the whole state, for example by a reset: on all ranks if all ranks
  /// make the new state, otherwise on rank 0 only. Returns whether this rank must send the new state to the
  /// other ranks.
  ///
  /// In a replicated world, the owners of rows do not change, and the result is false. In a distributed
  /// world, is_complete() must be true on rank 0 before the call. Afterwards, rank 0 owns all rows, and the
  /// other ranks that made the call have no rows. The result is then true on rank 0.
  virtual bool take_all() = 0;
  /// On rank 0: appends the state to a message for the other ranks, without the rows if the world is
  /// distributed. redistribute(), which must follow, sends those rows.
  virtual void put_all(partition::MessageWriter& message) = 0;
  /// On other ranks: reads the state that put_all() has appended, and replaces the state of the world by it.
  /// redistribute() must follow. is_in_tick: whether the interventions of the present tick have already been
  /// applied
  virtual void adopt_all(partition::MessageReader message, bool is_in_tick) = 0;

  // ---- A tick, in the order of calls
  /// In a distributed world: gives each row to its owner and makes the copies of rows again, if the present
  /// copies may not suffice. Called at three points of a tick: at its beginning, after the callback of
  /// World::before_tick(), and after interventions (changes at given times) have moved, added or removed
  /// bodies. In a replicated world, does nothing.
  ///
  /// have_jumped: true if called after interventions
  virtual void redistribute(bool have_jumped) = 0;
  /// Adds the candidates of the other ranks to those of this rank. The candidates are the bodies that an
  /// intervention may choose. In a replicated world, does nothing, because every rank has all candidates.
  virtual void add_candidates(std::vector<Candidate>& candidates) = 0;
  /// Returns whether `own` is true on any rank. In a replicated world, `own` must be the same on all ranks.
  virtual bool on_any_rank(bool own) = 0;
  /// For controllers that decide on rank 0 for the robots of all ranks (Replica::on_rank_0()). put_rows_of()
  /// appends the present values of the rows that `rank` owns, and get_rows_of() reads them. In a distributed
  /// world, which has no such controllers (why_replicated()), both throw std::logic_error.
  ///@{
  virtual void put_rows_of(unsigned rank, partition::MessageWriter& message) const = 0;
  virtual void get_rows_of(unsigned rank, partition::MessageReader& message) = 0;
  ///@}
  using Messages = std::vector<std::shared_ptr<const partition::Message>>;
  /// Returns one message for each rank. The message has those data that this rank has written in the phases
  /// sense, actuate and decide, and that the receiver needs. The element for this rank itself is not used.
  /// Each message begins with a copy of `head`. In a distributed world, throws StepError if a device acts on
  /// a body that is farther away than the device declares.
  virtual Messages written(const partition::MessageWriter& head) = 0;
  /// Reads `message`, which rank `from` has sent to this rank. On rank `from`, written() made it. The head of
  /// the message has already been read.
  virtual void get_written(unsigned from, partition::MessageReader& message) = 0;
  /// Called when get_written() has read the messages of all other ranks, before any body moves. Gives rows to
  /// other owners if necessary. Returns whether it has done so because of `times`.
  ///
  /// times: the time that each rank took for its own rows in the last ticks, one per rank, in any unit; the
  /// same on all ranks. Empty: the times are no reason to change owners
  virtual bool prepare_motions(std::span<const std::uint64_t> times) = 0;
  /// Called after bodies and joints have moved: calls work(), which tells the devices on this rank the
  /// outcomes of their joint motions (DeviceKind::joints_moved). In a replicated world, every rank has all
  /// rows, so a hook that throws does so on all ranks, and the exception propagates. In a distributed world,
  /// if work() throws on any rank, all ranks throw the error of the lowest of these ranks.
  virtual void report_joints(const std::function<void()>& work) = 0;
  /// Called after bodies have moved: applies `effects`, the effects of all ranks, one after another in the
  /// order of the list. apply(effect) applies one effect. In a replicated world, every rank applies all
  /// effects. In a distributed world, each effect is applied on one rank only.
  virtual void apply_effects(std::span<const Effect> effects,
                             const std::function<void(const Effect&)>& apply) = 0;

  // ---- Births: see the functions of Replica with these names
  /// Whether this rank tests if a newborn body can be placed at a point (m, world frame).
  virtual bool tests_places_at(const Vec2& point) const = 0;
  /// Returns the lowest number of a free place that any rank has found. A birth tries several places,
  /// numbered from 0, until one is free.
  ///
  /// own: lowest number of a place that this rank has found free; if there is none, `trials`
  /// trials: number of places
  virtual std::uint32_t lowest_trial(std::uint32_t own, std::uint32_t trials) = 0;
  /// Calls work(), a part of a birth. In a replicated world, an exception of work() propagates. In a
  /// distributed world, attempt() stores the exception, and further calls of attempt() do nothing until
  /// end_attempts() is called.
  virtual void attempt(const std::function<void()>& work) = 0;
  /// In a distributed world, on all ranks: ends a sequence of calls of attempt(). If work() threw in any of
  /// these calls on any rank, throws the error of the first call that failed, on all ranks. In a replicated
  /// world, does nothing.
  virtual void end_attempts() = 0;

  // ---- Verification (ReplicaOptions::verify)
  /// Returns sums of hashes of the rows that must be equal on several ranks. verify() compares the sums of
  /// all ranks.
  virtual std::vector<std::uint64_t> sums() const = 0;
  /// On rank 0: throws std::logic_error if rows that must be equal on several ranks differ.
  ///
  /// sums: the results of sums() on all ranks, in the order of ranks
  virtual void verify(std::span<const std::vector<std::uint64_t>> sums) const = 0;
};

}  // namespace troupe::engine
