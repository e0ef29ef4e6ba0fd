#pragma once

#include "engine/ranks/halo.hpp"
#include "engine/ranks/orders.hpp"
#include "engine/ranks/rank_rows.hpp"
#include "engine/ranks/rank_work.hpp"
#include "engine/ranks/sharing.hpp"
#include "engine/rows/ranks.hpp"
#include "engine/state/phase.hpp"
#include "engine/state/world_state.hpp"
#include "partition/message.hpp"
#include "partition/transport.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace troupe::engine {

struct Registry;
class World;

/// What users have requested from a process with signals.
struct UserRequests {
  std::uint32_t saves = 0;  ///< number of requests for a checkpoint: signals SIGUSR1
  bool stop = false;        ///< whether the run shall end after the current tick: SIGINT, SIGTERM or SIGHUP
};

/// Options of a Replica, which is the copy of a world on one rank (a thread or process). A row is the data of
/// one body in the state tables. No option changes the results of a run.
struct ReplicaOptions {
  /// For tests. If set, the owners of rows (the ranks that compute them) change at random during the run. The
  /// random numbers follow from this seed.
  std::optional<std::uint64_t> cut_seed;
  /// True: hashes() also checks that rows which must be equal on several ranks are equal (RankRows::sums()),
  /// and throws std::logic_error if they differ.
  bool verify = false;
  /// True: the program may keep references to the data of rank 0 across ticks, and read and write through
  /// them. For this purpose, rank 0 gathers all rows after each tick, from the first time that the program
  /// reads the state. From the first time that the program changes the state, rank 0 also sends the whole
  /// state to the other ranks before each tick.
  bool keeps_references = false;
  /// True: the world is *distributed*: each rank has only its own rows and copies of the rows of nearby
  /// bodies (class Halo). why_replicated() must then return an empty text. False: the world is *replicated*:
  /// every rank has all rows.
  bool is_distributed = false;
  /// The skin of a distributed world, m. With a larger skin, each rank has more copies of rows, and the ranks
  /// exchange rows less often (class Halo, `ghosts`). Not set: Halo chooses it.
  std::optional<double> skin_m = std::nullopt;
  /// On ranks other than 0: returns what users have requested from this process. Empty: nothing.
  std::function<UserRequests()> requests;
};

/// Makes a World one of several *replicas* of the same world. Each replica belongs to a *rank*, which is a
/// thread or a process. The ranks compute the world together (docs/architecture.md). Results do not depend on
/// the number of ranks.
///
/// A row is the data of one body in the state tables. Each rank *owns* some rows: it senses, actuates and
/// decides for their bodies. In each tick (time step), the ranks then send each other the data that the
/// receivers need for the phases move and index, in which bodies move and the spatial index is rebuilt. In a
/// *replicated* world, every rank has all rows (class ReplicatedRows). In a *distributed* world, a rank has
/// only its own rows and copies of the rows of nearby bodies (class DistributedRows).
///
/// Rank 0 leads. The program calls only the World of rank 0. The Replica of rank 0 sends orders to the other
/// ranks, which call follow() for each order. With their answers, it returns hashes and tables as if there
/// were one world.
///
/// An intervention is a change of the world at a given time, a fault a random failure of a robot, and an
/// effect an action of a device on another body. A StepError is the exception with which a step fails.
class Replica final : public Ranks {
 public:
  /// Makes `world` a replica. All ranks construct their replicas at the same point of the program, with equal
  /// worlds at tick 0. `world`, `transport` and `registry` must outlive this object.
  ///
  /// number: distinguishes this world from other worlds that the same ranks compute; the same on all ranks
  /// registry: the registry that `world` was made with
  Replica(World& world, const Registry& registry, partition::Transport& transport, std::uint32_t number,
          ReplicaOptions options);

  std::uint32_t number() const { return number_; }       ///< number of the world
  unsigned ranks() const { return transport_.ranks(); }  ///< number of ranks that compute the world
  const partition::Transport& transport() const { return transport_; }  ///< connects the ranks
  /// The work that each rank has done in the last tick, one entry per rank.
  std::span<const RankWork> work() const { return work_; }
  /// Number of ticks in which rows were given to other ranks because the ranks took unequal times.
  std::uint64_t rebalanced() const { return rebalanced_; }
  /// Asks the other ranks, and returns what each rank has counted, one entry per rank. Call this on rank 0,
  /// between two ticks. `messages` and `bytes` include messages for other worlds that the same ranks compute.
  std::vector<RankCounts> all_counts();
  /// What users have requested from the other ranks (ReplicaOptions::requests), up to the last tick: the sum
  /// of the checkpoints, and whether any rank shall stop.
  UserRequests requests() const;

  /// On ranks other than 0: carries out an order of rank 0. `order` is one of the orders from Order::step to
  /// Order::counts; for any other order, the function throws std::logic_error. If a tick, World::reset() or
  /// World::restart() fails with a StepError, or if World::restart() rejects the new bodies, this function
  /// does not throw the error, because rank 0 reports it.
  ///
  /// message: the rest of the message, after its head (begin_message())
  void follow(Order order, partition::MessageReader message);

  // ---- Called by World: see Ranks
  void join(RankAccess& access) override { given_ = &access; }
  bool are_several() const override { return true; }
  bool are_distributed() const override { return halo() != nullptr; }
  void tick(bool has_callback, const std::function<void()>& work) override;
  void begin(Phase phase) override;  ///< stores the phase and the time at which it began
  void observe(const std::function<void()>& callback) override;
  void add_candidates(std::vector<Candidate>& candidates) override;
  bool on_any_rank(bool own) override { return rows_->on_any_rank(own); }
  void follow_jumps() override;
  void agree(const std::function<void()>& callback) override;
  RowRange own(std::size_t) const override { return own(); }
  RowRange own() const { return rows_->own(); }  ///< the rows that this rank owns
  std::span<const std::uint32_t> own_of(std::span<const std::uint32_t> order) override;
  void on_rank_0(const std::function<void()>& work) override;
  void exchange() override;
  RankBorder* border() override { return rows_->halo() == nullptr ? nullptr : &rows_->halo()->border(); }
  void report_joints(const std::function<void()>& work) override { rows_->report_joints(work); }
  void apply_effects(std::span<const Effect> effects,
                     const std::function<void(const Effect&)>& apply) override;
  bool tests_places_at(const Vec2& point) const override;
  std::uint32_t lowest_trial(std::uint32_t own, std::uint32_t trials) override;
  void attempt(const std::function<void()>& work) override;
  void end_attempts() override;
  void gather() override;
  void gather_distributed() override;
  void touch() override;
  void replace() override;
  void reset() override;
  void restart(std::uint64_t seed, std::span<const BodySpec> bodies) override;
  void note_rejection() override { ++rejections_; }
  void set(const SettingSpec& setting) override;
  /// In a replicated world with ReplicaOptions::verify, the ranks compute and compare hashes even if rank 0
  /// has all rows. They do not do so from a change of the state by the program until the next tick.
  std::optional<Hashes> hashes() override;

  /// The rows that this rank has of a distributed world; null if the world is replicated.
  const Halo* halo() const { return rows_->halo(); }

 private:
  /// An error of a rank. If there are several errors, the one with the lowest (phase, robot) is reported.
  struct Failure {
    bool is_consequence = false;  ///< the rank failed only because another rank failed
    std::uint32_t phase = 0;      ///< the Phase in which the error occurred
    std::uint32_t robot = 0;      ///< 1 plus StepError::robot(); 0: the error has no robot
    std::string text;             ///< the error message
    std::exception_ptr error;     ///< the StepError itself, on the rank that failed with it; else null
  };
  /// Thrown if another rank fails while this rank waits for a message from it in a tick.
  struct OtherFailed {};

  /// A deleter that disconnects a world from its Replica, so that the world computes all rows itself again.
  struct Leave {
    void operator()(World* world) const;
  };

  bool leads() const { return transport_.rank() == 0; }
  /// Whether the program may hold references through which it changes the state.
  bool may_write() const { return leads() && options_.keeps_references && is_written_; }
  partition::MessageWriter message_of(Order order) const;
  /// Waits for a message with this order from the rank `from`, and returns it. If that rank fails in this
  /// tick, returns its message with Order::failed instead, unless `order` is an answer to an order of rank 0.
  /// While rank 0 runs the callback of World::before_tick(), the other ranks wait for Order::agree or, if
  /// they have failed, for Order::exchange; during this wait, they carry out other orders of rank 0. Throws
  /// partition::RankError if rank 0 ends the world instead, because it cannot go on after an exception.
  ReceivedOrder expect(Order order, unsigned from);

  /// Bits of the first byte of Order::step.
  enum Flags : std::uint8_t { k_has_callback = 1, k_watches_contacts = 2 };
  void follow_step(std::uint8_t flags);
  RankAccess& attach_to(World& world);
  std::unique_ptr<RankRows> make_rows();
  void put_changes(partition::MessageWriter& message);
  void get_changes(partition::MessageReader& message, bool is_in_tick);
  void take_all();
  template <class Work>
  void keep_step_error(Work&& work);
  void follow_restart(partition::MessageReader& message);
  void follow_set(partition::MessageReader& message);
  void require_whole() const;
  void require_equal_rejections(std::uint64_t rejections) const;
  RankCounts own_counts() const;
  Hashes own_hashes();
  [[noreturn]] void fail();
  static Failure failure_of(partition::MessageReader message);
  [[noreturn]] static void throw_first(const std::vector<Failure>& failures);
  std::vector<std::uint64_t> unequal_times();

  World& world_;
  const Registry& registry_;
  partition::Transport& transport_;
  std::uint32_t number_;
  ReplicaOptions options_;
  std::vector<Sharing> sharing_;  // one per table; rows_ refers to it
  RankAccess* given_ = nullptr;   // by join()
  RankAccess& access_;
  std::unique_ptr<World, Leave> joined_;  // the world leaves also if the constructor throws
  std::vector<RankWork> work_;            // one per rank, of this tick
  std::vector<std::uint64_t> times_;      // one per rank: its time for its own rows, ns: see unequal_times()
  std::vector<UserRequests> requests_;    // one per rank: the last result of ReplicaOptions::requests
  std::uint64_t rebalanced_ = 0;
  std::vector<std::uint32_t> order_;  // result of own_of()
  std::string unreported_;            // the last error that follow() has not thrown
  std::uint64_t rejections_ = 0;      // calls of note_rejection()

  // The program has changed the state of rank 0 since the other ranks received it.
  std::atomic<bool> is_touched_ = false;
  bool is_replaced_ = false;              // in this tick, the program has replaced the state: replace()
  bool is_read_ = false;                  // the program has read the state
  std::atomic<bool> is_written_ = false;  // the program has changed the state
  bool is_in_tick_ = false;               // the program cannot read or change the state
  bool has_callback_ = false;
  bool is_exchanged_ = false;          // in this tick, the messages of all ranks were received
  std::exception_ptr observer_error_;  // what the callback of observe() has thrown in this tick
  Phase phase_ = Phase::intervene;
  std::uint64_t beams_before_ = 0;  // before the phase sense of the tick
  // Times at which the phases of this tick began on this rank, s. The time of on_rank_0() is added to that of
  // `decide`, so that it does not count as work.
  std::array<double, k_phases> began_s_{};
  std::vector<std::optional<ReceivedOrder>> failed_;  // one per rank: how it failed in this tick
  std::unique_ptr<RankRows> rows_;                    // the last member: it uses the others
};

}  // namespace troupe::engine
