#pragma once

#include "base/geometry.hpp"
#include "base/ids.hpp"
#include "engine/conflicts/conflicts.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/links/links.hpp"
#include "engine/state/hashes.hpp"
#include "engine/state/phase.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

class RankAccess;  // engine/world/rank_access.hpp
struct BodySpec;
struct SettingSpec;

/// A body that a random selection may choose. The selection takes the bodies with the lowest keys.
struct Candidate {
  std::uint64_t key = 0;  ///< random number; of bodies with equal keys, the lowest id is taken first
  BodyId body;            ///< id of the body
};

/// How the ranks that compute a world together take part in the work of a World. The World calls these
/// functions at the same points of the tick on all ranks. The base class is for a world without other ranks:
/// this World computes all rows. Replica (engine/ranks/replica.hpp) implements the class for several ranks.
class Ranks {
 public:
  Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  virtual ~Ranks() = default;

  /// Called by World::attach(). access: what the ranks may do with the World
  virtual void join(RankAccess& access) { static_cast<void>(access); }

  virtual bool are_several() const { return false; }      ///< whether other ranks may compute rows
  virtual bool are_distributed() const { return false; }  ///< whether rows may be on other ranks only

  // ---- A tick, in the order of calls
  /// Computes a tick by calling work(). work() must compute the phases of the tick, and call agree() and
  /// exchange(). If work() throws on any rank, this function throws on all ranks. If the exception on a rank
  /// is not a StepError, this rank throws it unchanged. In all other cases, the ranks throw a StepError.
  ///
  /// has_callback: whether agree() will get a callback; used on rank 0 only
  virtual void tick(bool has_callback, const std::function<void()>& work) {
    static_cast<void>(has_callback);
    work();
  }
  virtual void begin(Phase phase) { static_cast<void>(phase); }  ///< called when a phase begins
  /// Calls a callback that only observes the tick. After exchange(), the other ranks can no longer be told of
  /// an error, and may wait for messages of this rank until the tick ends. If the callback then throws, it is
  /// not called again in this tick, and tick() throws the exception when the tick is complete.
  virtual void observe(const std::function<void()>& callback) { callback(); }
  /// Called in the phase intervene. If rows are distributed: adds the candidates of the other ranks to those
  /// of this rank. The candidates are the bodies that an intervention may choose. Every rank must call this
  /// for the same interventions.
  virtual void add_candidates(std::vector<Candidate>& candidates) { static_cast<void>(candidates); }
  /// Called in the phase intervene: returns whether `own` is true on any rank. Every rank must call this for
  /// the same interventions.
  virtual bool on_any_rank(bool own) { return own; }
  /// Gives the rows to their owners after interventions have moved, added or removed bodies, if the rows are
  /// distributed. Every rank must call this in the same ticks, in the phase intervene.
  virtual void follow_jumps() {}
  /// Called after the interventions and faults of a tick were applied. On rank 0, calls `callback`, the
  /// callback of World::before_tick(), unless it is empty. The other ranks then get the changes that the
  /// callback has made to the state. If the callback throws, tick() throws on all ranks.
  virtual void agree(const std::function<void()>& callback) {
    if (callback) callback();
  }
  /// The rows that this rank senses, actuates and decides for. rows: number of rows of this World
  virtual RowRange own(std::size_t rows) const { return {0, rows}; }
  /// Returns the rows of the list `order` that are own(), in the order of the list. Valid until the next
  /// call.
  virtual std::span<const std::uint32_t> own_of(std::span<const std::uint32_t> order) { return order; }
  /// Called at the end of the phase decide: rank 0 receives the present rows of all ranks and calls work().
  /// The other ranks do not call work(). Afterwards, each rank receives the values that work() has written to
  /// its own rows.
  virtual void on_rank_0(const std::function<void()>& work) { work(); }
  /// Called after the phase decide: sends each other rank those data of the own rows that it needs in the
  /// phases move and index, and receives the corresponding data of the other ranks.
  virtual void exchange() {}
  /// Exchanges the outcomes of motions with the other ranks, if the rows are distributed.
  class Border : public Conflicts::Border, public Links::Border {
   public:
    /// Sends what blocked own rows to the ranks with ghosts of them, and writes that of the ghosts of this
    /// rank. Called in each tick of a world with devices that feel collisions.
    virtual void exchange_blocks(std::span<Conflicts::Block> blocks) = 0;
  };
  virtual Border* border() { return nullptr; }  ///< null unless the rows are distributed
  /// Called in the phase move, after joints have moved: calls work(), which calls the hooks joints_moved of
  /// devices. If the rows are distributed, and work() throws on any rank, this function throws on all ranks.
  virtual void report_joints(const std::function<void()>& work) { work(); }
  /// Called in the phase move: applies `effects`, the effects of all ranks, one after another in the order of
  /// the list, by apply(effect). If the rows are distributed, each effect is applied on one rank only (class
  /// SharedEffects); otherwise every rank applies all effects.
  virtual void apply_effects(std::span<const Effect> effects,
                             const std::function<void(const Effect&)>& apply) {
    for (const Effect& effect : effects) apply(effect);
  }

  // ---- Births
  /// Returns whether this rank tests if a newborn body can be placed at a point (m, world frame). All ranks
  /// compute the same births in the same order. In a tick, if the rows are distributed, only the rank that
  /// owns the ground at the point tests it.
  virtual bool tests_places_at(const Vec2& point) const {
    static_cast<void>(point);
    return true;
  }
  /// Returns the lowest number of a free place that any rank has found. A birth tries several places,
  /// numbered from 0, until one is free. In a tick, every rank must call this for the same birth. Between two
  /// ticks, the result is `own`.
  ///
  /// own: lowest number of a place that this rank has found free; if there is none, `trials`
  /// trials: number of places
  virtual std::uint32_t lowest_trial(std::uint32_t own, std::uint32_t trials) {
    static_cast<void>(trials);
    return own;
  }
  /// attempt() calls work(), a part of a birth that may throw on some ranks only. In the phase move, if the
  /// rows are distributed, attempt() stores an exception of work(), and end_attempts() throws it on all
  /// ranks. In all other cases, the exception propagates from attempt(). In the phase move, every rank must
  /// call attempt() for the same births, and then end_attempts().
  ///@{
  virtual void attempt(const std::function<void()>& work) { work(); }
  virtual void end_attempts() {}
  ///@}

  // ---- Between two steps
  virtual void gather() {}              ///< implements World::gather()
  virtual void gather_distributed() {}  ///< implements World::gather_distributed()
  /// Called before the program changes the state: on rank 0, notes that the other ranks must get the new
  /// state.
  virtual void touch() {}
  virtual void replace() {}  ///< called before the program replaces the whole state, for example by restore()
  virtual void reset() {}    ///< called by World::reset(): on rank 0, orders the other ranks to reset
  /// Called by World::restart(): on rank 0, orders the other ranks to restart their worlds with this seed and
  /// with the poses and colours of `bodies`.
  virtual void restart(std::uint64_t seed, std::span<const BodySpec> bodies) {
    static_cast<void>(seed);
    static_cast<void>(bodies);
  }
  /// Called by World::restart() on all ranks: the new bodies were rejected, and the world returns to the old
  /// ones. If this does not happen on all ranks, the ranks end in the next tick.
  virtual void note_rejection() {}
  /// Called by World::set() after the change: on rank 0, orders the other ranks to make the same change.
  virtual void set(const SettingSpec& setting) { static_cast<void>(setting); }
  /// Returns the hashes of the state: each rank computes the hashes of its own rows, and rank 0 adds them up.
  /// Returns std::nullopt if the World of this rank computes the hashes alone: on ranks other than 0, and if
  /// rank 0 has the present values of all rows.
  virtual std::optional<Hashes> hashes() { return {}; }
};

/// The place of a World to which Ranks are attached. Without other ranks, it has the base class.
class RankPort {
 public:
  RankPort() = default;
  RankPort(const RankPort&) = delete;
  RankPort& operator=(const RankPort&) = delete;

  /// Attaches ranks; null: removes those that are attached. `ranks` must live until the next call.
  void attach(Ranks* ranks) { ranks_ = ranks == nullptr ? &alone_ : ranks; }
  /// The attached ranks.
  Ranks* operator->() const { return ranks_; }

 private:
  Ranks alone_;
  Ranks* ranks_ = &alone_;
};

}  // namespace troupe::engine
