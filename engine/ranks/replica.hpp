#pragma once

#include "engine/fields/state_table.hpp"
#include "engine/interventions/experiment.hpp"
#include "engine/ranks/halo.hpp"
#include "engine/ranks/orders.hpp"
#include "engine/ranks/rank_work.hpp"
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
struct BodyType;
struct Effect;
class Effects;
struct Hashes;
class Links;
struct Registry;
struct SettingSpec;
class SharedEffects;
class World;

/// How the ranks that compute one world share the rows of a state table. Each row has an *owner*: the rank
/// that senses, actuates and decides for the row's body.
enum class Sharing : std::uint8_t {
  alike,  ///< every rank computes every row, in the phases intervene and move; nothing is sent
  sent,   ///< the owner computes a row and sends it to all ranks in each tick, before the phase move
  kept,   ///< the owner computes a row; other ranks have old values, except rank 0 after gather()
};
/// Returns how each state table of a world is shared, in the order of World::tables(). This follows from the
/// tables and from what the kinds of devices declare.
///
/// kept    The readings of sensors, because only the controllers of the sensor's own body read them. Also the
///         memories of controllers, and most commands.
/// sent    The velocities of drives, from which every rank computes the motions. The states of devices that
///         act or set a colour, because other bodies may read them. Also the readings and commands that a
///         kind of device in the world declares to read (DeviceKind::reads), and the commands to devices with
///         hooks in the phase move.
/// alike   All other tables.
std::vector<Sharing> sharing_of(const World& world);

/// A division of the rows into one range per rank: rank r owns the rows from cut[r] up to, but not including,
/// cut[r + 1].
using Cut = std::vector<std::uint32_t>;
/// Returns a cut with which all ranks would take about the same time, on the assumption that all rows of a
/// rank took equally long. Returns `cut` if all times are 0. times: the time that each rank took with `cut`,
/// one per rank, in any unit
Cut balanced_cut(const Cut& cut, std::span<const std::uint64_t> times);

/// The data of a world that a Replica reads and writes.
struct ReplicaParts {
  std::span<StateTable> tables;  ///< the state tables
  Effects& effects;              ///< the effects of the tick
  Links& links;                  ///< for the goals of joints
  std::uint64_t& beams;          ///< rays cast by all sensors since tick 0
};

/// Options of a Replica. No option changes the results of a run.
struct ReplicaOptions {
  /// For tests. If set, each tick ends with a new random cut, whose random numbers follow from this seed.
  std::optional<std::uint64_t> cut_seed;
  /// True: hashes() also compares the tables that must be equal on all ranks (Sharing::alike and
  /// Sharing::sent), and throws std::logic_error if a table differs.
  bool verify = false;
  /// True: the program may keep references to rows across steps. After the first time that the program reads
  /// the state, rank 0 gathers all rows after each tick. After the first time that the program changes the
  /// state, rank 0 sends the whole state to the other ranks before each tick.
  bool keeps_references = false;
  /// True: the rows are distributed among the ranks (class Halo). The world must allow that
  /// (why_replicated()). False: every rank has all rows.
  bool is_distributed = false;
  /// The skin of a distributed world, m (class Halo); not set: it is chosen.
  std::optional<double> skin_m = std::nullopt;
  /// On ranks other than 0: returns how often a user has requested a checkpoint from this process, by the
  /// signal SIGUSR1. Null: never.
  std::function<std::uint32_t()> requests;
};

/// One of several replicas of a world, each of which belongs to one *rank*: a thread or process
/// (docs/architecture.md). Every rank holds all rows and computes the phases `move` and `index` for all of
/// them. Each rank senses, actuates and decides for its own rows. Once a tick, all ranks exchange the rows
/// that other ranks may read (Sharing::sent), the effects (actions of devices on other bodies) and the goals
/// of joints. Results do not depend on the number of ranks, nor on which rows a rank owns.
///
/// If the rows are distributed (ReplicaOptions::is_distributed), a rank holds only its own rows and copies of
/// some others: see Halo. The ranks then exchange the data of these copies only.
///
/// Rank 0 leads: the program calls its World. The Replica of rank 0 orders the others to do the same, and
/// returns hashes and tables as if there were one world. The other ranks call follow() for each order.
class Replica {
 public:
  /// Makes `world` a replica. All ranks construct their replicas at the same point of the program, with equal
  /// worlds at tick 0. `transport` and `registry` must outlive this object.
  ///
  /// number: identifies the world, because the ranks may compute several worlds
  /// registry: the registry that `world` was made with
  Replica(World& world, const Registry& registry, partition::Transport& transport, std::uint32_t number,
          ReplicaOptions options);
  ~Replica();
  Replica(const Replica&) = delete;
  Replica& operator=(const Replica&) = delete;

  std::uint32_t number() const { return number_; }       ///< number of the world
  unsigned ranks() const { return transport_.ranks(); }  ///< number of ranks that compute the world
  const partition::Transport& transport() const { return transport_; }  ///< connects the ranks
  /// Sizes and times of the work in the last tick, one entry per rank.
  std::span<const RankWork> work() const { return work_; }
  /// How often the cut was changed because the ranks took unequal times.
  std::uint64_t rebalanced() const { return rebalanced_; }
  /// What each rank has counted, one entry per rank; Transport::traffic() may also include other worlds. Rank
  /// 0 asks the other ranks. Call it on rank 0, between two ticks.
  std::vector<RankCounts> all_counts();
  /// How often users have requested a checkpoint from the other ranks (ReplicaOptions::requests).
  std::uint64_t requests() const;

  /// Obeys an order of rank 0: one from Order::step to Order::gather, or Order::failed, which is ignored.
  /// Throws std::logic_error for any other order. A StepError of Order::step is not thrown here, because
  /// rank 0 reports it. message: the rest of the message, after its head (begin_message())
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
  /// Called after the phase decide: sends the rows that other ranks may read, the effects and the goals of
  /// joints to all ranks, and receives theirs.
  void exchange();
  /// In a distributed world: adds the candidates of the other ranks to those of this rank. Every rank must
  /// call this for the same interventions, each in the phase intervene. Otherwise does nothing.
  void add_candidates(std::vector<Experiment::Candidate>& candidates);
  /// In a distributed world: gives the rows to their owners after interventions have moved bodies. Every rank
  /// must call this in the same ticks, in the phase intervene. Otherwise does nothing.
  void follow_jumps();
  /// Called in the phase move with the effects of all ranks, in their order: applies them, each on the rank
  /// that owns its source, if the world is distributed (class SharedEffects); else on every rank. `apply`
  /// applies one.
  void apply_effects(std::span<const Effect> effects, const std::function<void(const Effect&)>& apply);
  void begin(Phase phase);  ///< called when a phase begins: stores the phase for errors, and the time

  /// The rows that this rank owns.
  RowRange own() const { return halo_ ? RowRange{0, halo_->own()} : rows_of(transport_.rank()); }
  /// The ranks with which this rank resolves the motions of a distributed world; otherwise null.
  Conflicts::Border* border() { return halo_.get(); }
  /// The rows of a distributed world on this rank; otherwise null.
  const Halo* halo() const { return halo_.get(); }
  /// Returns those rows of `order` that this rank owns, in that order. Valid until the next call.
  std::span<const std::uint32_t> own_of(std::span<const std::uint32_t> order);

  void gather();   ///< implements World::gather()
  void touch();    ///< called before the program changes the state: World::touch()
  void replace();  ///< called before the program replaces the whole state
  void reset();    ///< called by World::reset(): on rank 0, orders the other ranks to reset their worlds
  /// Called by World::restart(): on rank 0, orders the other ranks to restart their worlds.
  void restart(std::uint64_t seed, std::span<const BodySpec> bodies);
  /// Called by World::set() after the change: on rank 0, orders the other ranks to make the same change.
  void set(const SettingSpec& setting);
  /// The hashes of the state: each rank computes the hashes of its own rows, and rank 0 adds them up.
  /// std::nullopt on ranks other than 0, and if the tables of rank 0 are complete, so that its world can
  /// compute the hashes alone.
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

  bool leads() const { return transport_.rank() == 0; }
  /// Whether the program may hold references through which it changes the state.
  bool may_write() const { return leads() && options_.keeps_references && is_written_; }
  RowRange rows_of(unsigned rank) const { return {cut_[rank], cut_[rank + 1]}; }
  /// The rows of a table whose bodies have the rows `rows` of the world.
  RowRange rows_in(const StateTable& table, const RowRange& rows) const;
  partition::MessageWriter message_of(Order order) const;
  /// Waits for the message with this order from a rank and returns it. If that rank fails in this tick,
  /// returns its message with Order::failed instead. Obeys other orders that rank 0 gives before.
  ReceivedOrder expect(Order order, unsigned from);

  void make_halo();
  void own_all();
  void settle_rows();
  std::vector<std::uint8_t> known_tables() const;
  void check_ghosts(std::span<const std::vector<std::uint64_t>> sums) const;
  std::vector<std::uint64_t> ghost_sums() const;
  void put_state(partition::MessageWriter& message);
  void adopt_state(partition::MessageReader message, bool is_in_tick);
  void put_written(partition::MessageWriter& message);
  void get_written(partition::MessageReader& message, unsigned from);
  template <class Visit>
  void for_rows(Sharing sharing, const RowRange& rows, Visit&& visit) const;
  void put_kept(partition::MessageWriter& message, const RowRange& rows) const;
  void get_kept(partition::MessageReader& message, const RowRange& rows);
  void put_own(partition::MessageWriter& message, const RowRange& rows) const;
  void get_own(partition::MessageReader& message, const RowRange& rows);
  Hashes own_hashes();
  RankCounts own_counts() const;
  void fail();
  static Failure failure_of(partition::MessageReader message);
  [[noreturn]] void throw_first(std::vector<Failure>& failures, const std::exception_ptr& own);
  Cut equal_cut() const;
  void note_times();
  bool have_unequal_times();
  void adopt_cut(Cut cut);

  World& world_;
  const Registry& registry_;
  partition::Transport& transport_;
  std::uint32_t number_;
  ReplicaOptions options_;
  std::vector<Sharing> sharing_;  // one per table
  ReplicaParts parts_;
  std::unique_ptr<Halo> halo_;                     // null: every rank has all rows
  std::unique_ptr<SharedEffects> shared_effects_;  // null: every rank has all rows
  // In the next tick, rank 0 gives its rows, which are all rows of the world, to their owners.
  bool distributes_ = false;
  Cut cut_;                              // which rows the ranks own
  std::vector<RankWork> work_;           // one per rank, of this tick
  std::vector<std::uint64_t> times_;     // one per rank: its time for its own rows since the last cut, ns
  std::vector<std::uint32_t> requests_;  // one per rank: the last result of ReplicaOptions::requests
  std::uint64_t rebalanced_ = 0;
  RankCounts counts_;                 // only if every rank has all rows
  std::vector<std::uint32_t> order_;  // result of own_of()

  // The program has changed the state of rank 0 since the other ranks received it.
  std::atomic<bool> is_touched_ = false;
  bool is_read_ = false;                  // the program has read the state
  std::atomic<bool> is_written_ = false;  // the program has changed the state
  bool is_stale_ = false;                 // rank 0 has old rows of other ranks in tables with Sharing::kept
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
  std::size_t exchanged_bytes_ = 0;                   // length of the last message of exchange()
};

}  // namespace troupe::engine
