#pragma once

#include "engine/ranks/rank_rows.hpp"
#include "engine/ranks/sharing.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace troupe::engine {

/// A division of the rows (indices of bodies in the state tables) into one range per rank: rank r owns the
/// rows in [cut[r], cut[r + 1]). Ranks are threads or processes that compute a world together.
using Cut = std::vector<std::uint32_t>;
/// Returns a cut with which all ranks would take about the same time. Assumes that all rows of a rank took
/// equally long. Returns `cut` if all times are 0.
///
/// times: the time that each rank took for its rows with `cut`, one per rank, in any unit
Cut balanced_cut(const Cut& cut, std::span<const std::uint64_t> times);

/// The *replicated* form of a world that several ranks compute: every rank has all rows, and owns one range
/// of them (Cut). A rank runs the sensors, devices and controllers of its own rows. It computes the motions
/// of all rows, and the spatial index (in the phases move and index of a tick, which is a time step).
///
/// Before the phase move, each rank sends three things to all other ranks: the data of its own rows that
/// other ranks may read (Sharing::sent), the effects (actions on other bodies) of its devices, and the poses
/// to which its devices move joints.
class ReplicatedRows final : public RankRows {
 public:
  /// The world and `sharing` must outlive this object.
  ///
  /// sharing: one entry per state table, which says how the ranks share its rows (sharing_of())
  /// cut_seed: for tests; if set, a new random cut is made in each tick, before bodies move
  ReplicatedRows(World& world, RankAccess& access, std::span<const Sharing> sharing, RankPost post,
                 std::optional<std::uint64_t> cut_seed);

  RowRange own() const override { return rows_of(post_.rank); }
  Halo* halo() override { return nullptr; }
  RankCounts counts() const override { return counts_; }

  bool is_complete() const override { return is_complete_; }
  void put_missing(partition::MessageWriter& message) const override;
  void complete(std::span<ReceivedOrder> messages) override;
  bool take_all() override;
  void put_all(partition::MessageWriter& message) override;
  void adopt_all(partition::MessageReader message, bool is_in_tick) override;

  void redistribute(bool) override {}                       // every rank has all rows
  void add_candidates(std::vector<Candidate>&) override {}  // every rank finds all candidates
  bool on_any_rank(bool own) override { return own; }
  void put_rows_of(unsigned rank, partition::MessageWriter& message) const override;
  void get_rows_of(unsigned rank, partition::MessageReader& message) override;
  Messages written(const partition::MessageWriter& head) override;
  void get_written(unsigned from, partition::MessageReader& message) override;
  bool prepare_motions(std::span<const std::uint64_t> times) override;
  void report_joints(const std::function<void()>& work) override { work(); }
  void apply_effects(std::span<const Effect> effects,
                     const std::function<void(const Effect&)>& apply) override;

  bool tests_places_at(const Vec2&) const override { return true; }
  std::uint32_t lowest_trial(std::uint32_t own, std::uint32_t) override { return own; }
  void attempt(const std::function<void()>& work) override { work(); }
  void end_attempts() override {}

  std::vector<std::uint64_t> sums() const override;
  void verify(std::span<const std::vector<std::uint64_t>> sums) const override;

 private:
  RowRange rows_of(unsigned rank) const { return {cut_[rank], cut_[rank + 1]}; }
  template <class Visit>
  void for_rows(Sharing sharing, const RowRange& rows, Visit&& visit) const;
  void put_rows(Sharing sharing, const RowRange& rows, partition::MessageWriter& message) const;
  void get_rows(Sharing sharing, const RowRange& rows, partition::MessageReader& message);
  Cut random_cut() const;
  void adopt_cut(Cut cut);

  World& world_;
  RankAccess& access_;
  std::span<const Sharing> sharing_;  // one per table
  RankPost post_;
  std::optional<std::uint64_t> cut_seed_;
  Cut cut_;                  // which rows the ranks own
  bool is_complete_ = true;  // on rank 0: the rows of other ranks in tables with Sharing::kept are present
  std::size_t written_ = 0;  // length of the last message of written()
  RankCounts counts_;
};

}  // namespace troupe::engine
