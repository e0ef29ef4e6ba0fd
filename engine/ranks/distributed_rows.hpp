#pragma once

#include "engine/ranks/halo.hpp"
#include "engine/ranks/rank_rows.hpp"
#include "engine/ranks/shared_effects.hpp"
#include "engine/ranks/shared_error.hpp"
#include "engine/ranks/sharing.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

/// The *distributed* form of a world that several ranks (threads or processes) compute. A row is the data of
/// one body in the state tables. A rank has only the rows that it owns and *ghosts*: copies of rows of other
/// ranks. The bodies of ghosts are those that may affect the bodies of the own rows (class Halo). In each
/// tick (time step), the ranks exchange the data of the ghosts, and all effects (actions of devices on other
/// bodies).
class DistributedRows final : public RankRows {
 public:
  /// Keeps the own rows and the ghosts of this rank, and removes all other rows from `world`. Before the
  /// call, `world` must have all rows. Throws std::logic_error if the rows cannot be distributed
  /// (why_replicated() returns the reason). The world must outlive this object.
  ///
  /// sharing: one entry per state table, which says how the ranks share its rows (sharing_of())
  /// cut_seed: for tests; if set, the ranks own random parts of the plane (the constructor of Halo)
  /// skin_m: margin with which the ghosts remain sufficient for several ticks, m; not set: Halo chooses it
  DistributedRows(World& world, const ReplicaParts& parts, std::span<const Sharing> sharing, RankPost post,
                  std::optional<std::uint64_t> cut_seed, std::optional<double> skin_m);

  RowRange own() const override { return {0, halo_.own()}; }
  Halo* halo() override { return &halo_; }
  RankCounts counts() const override { return halo_.counts(); }

  bool is_complete() const override { return halo_.is_complete(); }
  void put_missing(partition::MessageWriter& message) const override { halo_.put_own(message); }
  void complete(std::span<ReceivedOrder> messages) override { halo_.complete(messages); }
  bool take_all() override;
  void put_all(partition::MessageWriter& message) override;
  void adopt_all(partition::MessageReader message, bool is_in_tick) override;

  void redistribute(bool have_jumped) override;
  void add_candidates(std::vector<Experiment::Candidate>& candidates) override;
  void put_rows_of(unsigned rank, partition::MessageWriter& message) const override;
  void get_rows_of(unsigned rank, partition::MessageReader& message) override;
  Messages written(const partition::MessageWriter& head) override;
  void get_written(unsigned from, partition::MessageReader& message) override;
  bool prepare_motions(std::span<const std::uint64_t> times) override;
  void apply_effects(std::span<const Effect> effects,
                     const std::function<void(const Effect&)>& apply) override;

  bool tests_places_at(const Vec2& point) const override { return halo_.owner_at(point) == post_.rank; }
  std::uint32_t lowest_trial(std::uint32_t own, std::uint32_t trials) override;
  void attempt(const std::function<void()>& work) override;
  void end_attempts() override;

  std::vector<std::uint64_t> sums() const override;
  void verify(std::span<const std::vector<std::uint64_t>> sums) const override;

 private:
  bool leads() const { return post_.rank == 0; }

  World& world_;
  RankPost post_;
  std::vector<std::uint8_t> is_known_;  // of each table: 1 if the ghosts have its present values, otherwise 0
  Halo halo_;
  SharedEffects effects_;
  SharedError error_;           // of births
  std::uint64_t attempts_ = 0;  // in this tick
  // Until redistribute(): bodies were born, whose rows are on any rank, or bodies with cargo have died.
  bool must_distribute_ = false;
  bool is_on_rank_0_ = false;  // until redistribute(): rank 0 has all rows, and the other ranks have none
  double longest_ = 0;  // longest motion of a body in this tick, of the ranks whose messages are read, m
};

}  // namespace troupe::engine
