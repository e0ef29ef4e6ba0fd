#pragma once

#include "base/geometry.hpp"
#include "engine/fields/state_table.hpp"
#include "engine/interventions/experiment.hpp"
#include "engine/ranks/orders.hpp"
#include "engine/ranks/rank_work.hpp"
#include "engine/state/world_state.hpp"
#include "partition/message.hpp"
#include "partition/parallel.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace troupe::engine {

struct Effect;
class Effects;
class Halo;
class Links;
class World;

/// The data of a world that a Replica reads and writes.
struct ReplicaParts {
  std::span<StateTable> tables;  ///< the state tables
  Effects& effects;              ///< the effects (actions on other bodies) of the tick
  Links& links;                  ///< the joints, and the poses to which devices move them
  std::uint64_t& beams;          ///< rays cast by all sensors since tick 0
};

/// Converts a range of rows of the world to rows of one table: returns the rows that the bodies of `rows`
/// have in `table`.
RowRange rows_in(const World& world, const StateTable& table, const RowRange& rows);
/// The sum of the hashes of rows of a table, computed in parallel.
std::uint64_t hash_of(partition::Parallel& parallel, const StateTable& table, const RowRange& rows);

/// How the rows of a world (the data of its bodies in the state tables) are divided among the ranks (threads
/// or processes) that compute it, and therefore which data the ranks exchange. There are two forms. In a
/// replicated world (ReplicatedRows), every rank has all rows and owns some of them. In a distributed world
/// (DistributedRows), a rank has only the rows that it owns and copies of rows near them. Each rank has a
/// Replica, which decides when the ranks exchange data. Some functions below write or read the contents of
/// messages, and the Replica sends and receives these messages. The functions of a tick also exchange
/// messages of their own (RankPost).
///
/// All ranks call the functions of a tick at the same points of the tick. A tick is a time step, and its
/// phases are listed in engine/world/phase.hpp.
class RankRows {
 public:
  RankRows() = default;
  RankRows(const RankRows&) = delete;
  RankRows& operator=(const RankRows&) = delete;
  virtual ~RankRows() = default;

  virtual RowRange own() const = 0;       ///< the rows that this rank owns
  virtual Halo* halo() = 0;               ///< this rank's rows of a distributed world; null if replicated
  virtual RankCounts counts() const = 0;  ///< what this rank has counted; `messages` and `bytes` are 0

  // ---- All rows on rank 0
  /// Whether rank 0, which calls this, has the present values of all rows.
  virtual bool is_complete() const = 0;
  /// Appends those data of the own rows that rank 0 lacks.
  virtual void put_missing(partition::MessageWriter& message) const = 0;
  /// On rank 0: reads what put_missing() of the other ranks has appended, one message each, in the order of
  /// ranks. Afterwards, is_complete() is true.
  virtual void complete(std::span<ReceivedOrder> messages) = 0;
  /// Called before the whole state is replaced, either by all ranks (for example by a reset) or by rank 0
  /// (for example from a file): rank 0 takes all rows. In a distributed world, is_complete() must be true on
  /// rank 0 before the call. Returns whether this rank must send the new state to the other ranks because
  /// they have no rows.
  virtual bool take_all() = 0;
  /// On rank 0: appends the whole state to a message for the other ranks. In a distributed world, the message
  /// does not contain the rows, because redistribute() sends them. redistribute() must follow.
  virtual void put_all(partition::MessageWriter& message) = 0;
  /// On other ranks: replaces the state of the world by the state that put_all() has appended. redistribute()
  /// must follow. is_in_tick: see World::adopt()
  virtual void adopt_all(partition::MessageReader message, bool is_in_tick) = 0;

  // ---- A tick, in the order of calls
  /// Gives the rows to the ranks that need them. Called at three points of a tick: at its beginning, after
  /// the callback of World::before_tick(), and after interventions (changes at given times) have moved, added
  /// or removed bodies.
  ///
  /// have_jumped: true if called after interventions
  virtual void redistribute(bool have_jumped) = 0;
  /// Adds the candidates of the other ranks (bodies among which an intervention chooses at random) to those
  /// of this rank.
  virtual void add_candidates(std::vector<Experiment::Candidate>& candidates) = 0;
  /// For controllers that decide on rank 0 for the robots of all ranks. put_rows_of() appends the present
  /// values of the rows that `rank` owns, and get_rows_of() reads them. A distributed world has no such
  /// controllers (why_replicated()), and these functions then throw std::logic_error.
  ///@{
  virtual void put_rows_of(unsigned rank, partition::MessageWriter& message) const = 0;
  virtual void get_rows_of(unsigned rank, partition::MessageReader& message) = 0;
  ///@}
  using Messages = std::vector<std::shared_ptr<const partition::Message>>;
  /// Returns a list with one message for each rank. The message for a rank contains those data that this rank
  /// has written in the phases sense, actuate and decide, and that the receiving rank reads. The list also
  /// has an element for this rank itself, which is not used. Each message begins with a copy of `head`.
  /// Throws StepError if this rank cannot compute the tick.
  virtual Messages written(const partition::MessageWriter& head) = 0;
  /// Reads the message that rank `from` has written for this rank. `message` begins after the head, which was
  /// read before.
  virtual void get_written(unsigned from, partition::MessageReader& message) = 0;
  /// Called when the messages of all other ranks have been read, before any body moves: changes the owners of
  /// rows if necessary. Returns whether it has done so because of `times`.
  ///
  /// times: if the ranks take unequal times, the time that each rank took for its own rows in the last ticks,
  /// one per rank, in any unit, the same on all ranks; otherwise empty
  virtual bool prepare_motions(std::span<const std::uint64_t> times) = 0;
  /// Called after bodies have moved: applies the effects of all ranks, in their order. `apply` applies one
  /// effect. In a replicated world, every rank applies all effects; in a distributed world, one rank applies
  /// each effect.
  virtual void apply_effects(std::span<const Effect> effects,
                             const std::function<void(const Effect&)>& apply) = 0;

  // ---- Births: see the functions of Replica with these names
  /// Whether this rank tests whether places at a point (m, world frame) are free for a newborn body.
  virtual bool tests_places_at(const Vec2& point) const = 0;
  /// Returns the lowest value of `own` on any rank. A birth tries several places, which are numbered: its
  /// trials. own: the first trial whose place this rank has found free; if there is none, `trials`, which is
  /// the number of trials
  virtual std::uint32_t lowest_trial(std::uint32_t own, std::uint32_t trials) = 0;
  /// Calls work(). If work() throws: in a replicated world, attempt() passes the exception on to its caller;
  /// in a distributed world, attempt() keeps the exception, and end_attempts() throws it.
  virtual void attempt(const std::function<void()>& work) = 0;
  /// If work() of a call of attempt() has failed on any rank, throws the exception of the first such call on
  /// all ranks.
  virtual void end_attempts() = 0;

  // ---- Verification (ReplicaOptions::verify)
  /// Sums of hashes of rows. With them, verify() checks that rows that several ranks have are equal on these
  /// ranks.
  virtual std::vector<std::uint64_t> sums() const = 0;
  /// On rank 0: throws std::logic_error if a row differs between ranks. sums: the result of sums() on each
  /// rank
  virtual void verify(std::span<const std::vector<std::uint64_t>> sums) const = 0;
};

}  // namespace troupe::engine
