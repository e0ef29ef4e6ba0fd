#pragma once

#include "engine/interventions/experiment.hpp"
#include "engine/ranks/halo.hpp"
#include "engine/ranks/orders.hpp"
#include "engine/ranks/rank_rows.hpp"
#include "engine/ranks/rank_work.hpp"
#include "engine/ranks/sharing.hpp"
#include "engine/state/world_state.hpp"
#include "engine/world/phase.hpp"
#include "partition/message.hpp"
#include "partition/transport.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

struct BodySpec;
struct Effect;
struct Hashes;
struct Registry;
struct SettingSpec;
class World;

/// Options of a Replica. No option changes the results of a run.
struct ReplicaOptions {
  /// For tests. If set, rows get random owners (ranks that compute them) during the run. The random numbers
  /// follow from this seed.
  std::optional<std::uint64_t> cut_seed;
  /// True: hashes() also compares the table rows that must be equal on several ranks (RankRows::sums()), and
  /// throws std::logic_error if they differ.
  bool verify = false;
  /// True: the program may keep references to rows of rank 0 across steps. After the first time that the
  /// program reads the state, rank 0 gathers all rows after each tick. After the first time that the program
  /// changes the state, rank 0 sends the whole state to the other ranks before each tick.
  bool keeps_references = false;
  /// True: the rows are distributed among the ranks (class Halo): each rank has only its own rows and copies
  /// of rows near them. why_replicated() must then return an empty text. False: the world is replicated, that
  /// is, every rank has all rows.
  bool is_distributed = false;
  /// The skin of a distributed world, m: a margin with which copies of rows remain sufficient for several
  /// ticks (class Halo). Not set: Halo chooses it.
  std::optional<double> skin_m = std::nullopt;
  /// On ranks other than 0: returns how often a user has requested a checkpoint from this process, by the
  /// signal SIGUSR1. Null: never.
  std::function<std::uint32_t()> requests;
};

/// One of several replicas of a world, each of which belongs to one *rank*: a thread or process
/// (docs/architecture.md). A row is the data of one body in the state tables. Each rank senses, actuates and
/// decides for the rows that it owns. In each tick (time step), the ranks exchange the data that other ranks
/// need for the phases move and index, in which bodies move and the spatial index is rebuilt. In a
/// *replicated* world, every rank has all rows; in a *distributed* world, a rank has only its own rows and
/// copies of rows near them. How the rows are divided among the ranks, and therefore which data they
/// exchange, depends on the form of the world: see ReplicatedRows and DistributedRows. Results do not depend
/// on the form, the number of ranks, or which rows a rank owns.
///
/// An intervention is a change of the world at a given time, a fault a random failure of a robot, and an
/// effect an action of a device on another body. A StepError is the exception with which a step fails.
///
/// Rank 0 leads: the program calls the World of rank 0. The Replica of rank 0 orders the other ranks to do
/// the same, and returns hashes and tables as if there were one world. The other ranks call follow() for each
/// order.
class Replica {
 public:
  /// Makes `world` a replica. All ranks construct their replicas at the same point of the program, with equal
  /// worlds at tick 0. `transport` and `registry` must outlive this object.
  ///
  /// number: identifies the world, because the ranks may compute several worlds
  /// registry: the registry that `world` was made with
  Replica(World& world, const Registry& registry, partition::Transport& transport, std::uint32_t number,
          ReplicaOptions options);
  ~Replica() = default;
  Replica(const Replica&) = delete;
  Replica& operator=(const Replica&) = delete;

  std::uint32_t number() const { return number_; }       ///< number of the world
  unsigned ranks() const { return transport_.ranks(); }  ///< number of ranks that compute the world
  const partition::Transport& transport() const { return transport_; }  ///< connects the ranks
  /// Sizes and times of the work in the last tick, one entry per rank.
  std::span<const RankWork> work() const { return work_; }
  /// How often rows were given to other ranks because the ranks took unequal times.
  std::uint64_t rebalanced() const { return rebalanced_; }
  /// What each rank has counted, one entry per rank. `messages` and `bytes` are those of
  /// Transport::traffic(), and so may include messages for other worlds. Asks the other ranks: call this on
  /// rank 0, between two ticks.
  std::vector<RankCounts> all_counts();
  /// How often users have requested a checkpoint from the other ranks (ReplicaOptions::requests).
  std::uint64_t requests() const;

  /// Carries out an order of rank 0, on another rank. `order` is one from Order::step to Order::counts, or
  /// Order::failed, which is ignored. Throws std::logic_error for any other order. If the tick fails with a
  /// StepError, this function does not throw it, because rank 0 reports it. message: the rest of the message,
  /// after its head (begin_message())
  void follow(Order order, partition::MessageReader message);

  // ---- Called by World
  /// Computes a tick: work() must compute its phases, and call agree() and exchange(). If work() throws on
  /// any rank, this function throws on all ranks: a StepError, or on the failing rank its own exception if
  /// that is not a StepError. has_callback: whether agree() will get a callback; used on rank 0 only
  void tick(bool has_callback, const std::function<void()>& work);
  /// Called after the interventions and faults of a tick were applied. On rank 0, calls `callback`, the
  /// callback of World::before_tick(), unless it is empty. The other ranks then adopt the changes that the
  /// callback has made. Throws StepError on the other ranks if the callback throws on rank 0.
  void agree(const std::function<void()>& callback);
  /// Called at the end of the phase decide on all ranks: rank 0 receives the present rows of all ranks and
  /// then calls work(), which the other ranks do not call. Afterwards, each rank receives the values that
  /// work() has written to the rows that the rank owns.
  void on_rank_0(const std::function<void()>& work);
  /// Called after the phase decide: sends the other ranks those data of the own rows that they need in the
  /// phases move and index, and receives theirs.
  void exchange();
  /// In a distributed world: adds the candidates of the other ranks (bodies among which an intervention
  /// chooses at random) to those of this rank. Every rank must call this for the same interventions, in the
  /// phase intervene. In a replicated world, does nothing.
  void add_candidates(std::vector<Experiment::Candidate>& candidates);
  /// In a distributed world: gives the rows to their owners after interventions have moved, added or removed
  /// bodies. Every rank must call this in the same ticks, in the phase intervene. In a replicated world, does
  /// nothing.
  void follow_jumps();
  /// Called in the phase move with the effects of all ranks, in their order: applies them. In a distributed
  /// world, the rank that owns the source of an effect applies it (class SharedEffects); in a replicated
  /// world, every rank applies all effects. `apply` applies one effect.
  void apply_effects(std::span<const Effect> effects, const std::function<void(const Effect&)>& apply);
  /// For births, which every rank computes for the same requests in the same order. A birth tries several
  /// places (its trials) until one is free. Returns whether this rank tests places at a point (m, world
  /// frame). In a tick of a distributed world, only the rank that owns the ground at the point tests them. In
  /// a replicated world and between two ticks, every rank that computes the birth tests them.
  bool tests_places_at(const Vec2& point) const;
  /// For a birth: returns the lowest value of `own` on any rank. Every rank must call this for the same
  /// birth.
  ///
  /// own: the first trial whose place this rank has found free; `trials` if there is none
  /// trials: number of trials
  std::uint32_t lowest_trial(std::uint32_t own, std::uint32_t trials);
  /// Calls work(). Called in the phase move, for a part of a birth. Only ranks that have the row of the
  /// newborn body, or of the body whose device requested the birth, carry out this part. In a distributed
  /// world, an exception of `work` is thrown by end_attempts() instead, on all ranks. Every rank must call
  /// both for the same births.
  ///@{
  void attempt(const std::function<void()>& work);
  void end_attempts();
  ///@}
  void begin(Phase phase);  ///< called when a phase begins: stores the phase and the time at which it began

  /// The rows that this rank owns.
  RowRange own() const { return rows_->own(); }
  /// The connection to the other ranks with which this rank resolves the motions of a distributed world; null
  /// if the world is replicated.
  RankBorder* border() { return rows_->halo() == nullptr ? nullptr : &rows_->halo()->border(); }
  /// The rows of a distributed world on this rank; null if the world is replicated.
  const Halo* halo() const { return rows_->halo(); }
  /// Returns those rows of `order` that this rank owns, in that order. Valid until the next call.
  std::span<const std::uint32_t> own_of(std::span<const std::uint32_t> order);

  void gather();              ///< implements World::gather(): fetches missing rows to rank 0
  void gather_distributed();  ///< implements World::gather_distributed()
  void touch();               ///< called before the program changes the state, so that other ranks get it
  void replace();             ///< called before the program replaces the whole state, as restore() does
  void reset();  ///< called by World::reset(): on rank 0, orders the other ranks to reset their worlds
  /// Called by World::restart(): on rank 0, orders the other ranks to restart their worlds.
  void restart(std::uint64_t seed, std::span<const BodySpec> bodies);
  /// Called by World::set() after the change: on rank 0, orders the other ranks to make the same change.
  void set(const SettingSpec& setting);
  /// Returns the hashes of the state: each rank computes the hashes of its own rows, and rank 0 adds them up.
  /// Returns std::nullopt on ranks other than 0. Also returns std::nullopt if the tables of rank 0 are
  /// complete, because the world of rank 0 can then compute the hashes alone. Exception: in a replicated
  /// world with ReplicaOptions::verify, all ranks compute hashes.
  std::optional<Hashes> hashes();

 private:
  /// An error of a rank. If there are several errors, the one with the lowest (phase, robot) is reported.
  struct Failure {
    std::uint32_t phase = 0;  ///< the Phase in which the error occurred
    std::uint32_t robot = 0;  ///< 1 plus StepError::robot(); 0: the error has no robot
    std::string text;         ///< the error message; empty: the rank failed because another rank had failed
  };
  /// Thrown if another rank fails while this rank waits for its message in a tick.
  struct OtherFailed {};

  /// Disconnects a world from its Replica, so that the world computes all rows itself again.
  struct Leave {
    void operator()(World* world) const;
  };

  bool leads() const { return transport_.rank() == 0; }
  /// Whether the program may hold references through which it changes the state.
  bool may_write() const { return leads() && options_.keeps_references && is_written_; }
  partition::MessageWriter message_of(Order order) const;
  /// Waits for a message with this order, or with Order::failed, from the rank `from`, and returns it. While
  /// it waits for Order::agree, it obeys other orders that rank 0 gives.
  ReceivedOrder expect(Order order, unsigned from);

  std::unique_ptr<RankRows> make_rows();
  void put_changes(partition::MessageWriter& message);
  void get_changes(partition::MessageReader& message, bool is_in_tick);
  void take_all();
  RankCounts own_counts() const;
  Hashes own_hashes();
  void fail();
  static Failure failure_of(partition::MessageReader message);
  [[noreturn]] void throw_first(std::vector<Failure>& failures, const std::exception_ptr& own);
  std::vector<std::uint64_t> unequal_times();

  World& world_;
  const Registry& registry_;
  partition::Transport& transport_;
  std::uint32_t number_;
  ReplicaOptions options_;
  std::vector<Sharing> sharing_;  // one per table; rows_ refers to it
  ReplicaParts parts_;
  std::unique_ptr<World, Leave> joined_;  // the world leaves also if the constructor throws
  std::vector<RankWork> work_;            // one per rank, of this tick
  std::vector<std::uint64_t> times_;      // one per rank: its time for its own rows, ns: see unequal_times()
  std::vector<std::uint32_t> requests_;   // one per rank: the last result of ReplicaOptions::requests
  std::uint64_t rebalanced_ = 0;
  std::vector<std::uint32_t> order_;  // result of own_of()

  // The program has changed the state of rank 0 since the other ranks received it.
  std::atomic<bool> is_touched_ = false;
  bool is_read_ = false;                  // the program has read the state
  std::atomic<bool> is_written_ = false;  // the program has changed the state
  bool is_in_tick_ = false;               // the program cannot read or change the state
  bool has_callback_ = false;
  bool is_exchanged_ = false;  // in this tick, the messages of all ranks were received
  bool is_agreed_ = false;     // in this tick, agree() has returned
  Phase phase_ = Phase::intervene;
  std::uint64_t beams_before_ = 0;  // at the beginning of the tick
  // Times at which the phases of this tick began on this rank, s. The time of on_rank_0() is added to that of
  // `decide`, so that it does not count as work.
  std::array<double, k_phases> began_s_{};
  std::vector<std::optional<ReceivedOrder>> failed_;  // one per rank: how it failed in this tick
  std::unique_ptr<RankRows> rows_;                    // the last member: it uses the others
};

}  // namespace troupe::engine
