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

/// The rows of a *distributed* world, which several ranks (threads or processes) compute together. A row is
/// the data of one body in the state tables. Each rank *owns* some rows: it runs the sensors, devices, drives
/// and controllers of their bodies. A rank has the rows that it owns and *ghosts*, but no other rows. Ghosts
/// are copies of rows of other ranks. Their bodies may affect the bodies of the own rows (class Halo). In
/// each tick (time step), the ranks send each other the present data of the ghosts, and all effects (actions
/// of devices on other bodies).
class DistributedRows final : public RankRows {
 public:
  /// Keeps the rows that this rank owns and its ghosts, and removes all other rows from `world`. Before the
  /// call, `world` must have all rows. Throws std::logic_error if the rows cannot be distributed;
  /// why_replicated() returns the reason. The world must outlive this object.
  ///
  /// sharing: one entry per state table, which says how the ranks share its rows (sharing_of())
  /// cut_seed: for tests; if set, each rank owns the rows of bodies in random parts of the plane
  /// skin_m: the skin, m (class Halo, `ghosts`). With a larger skin, each rank has more ghosts, and the ranks
  /// exchange rows less often. Not set: Halo chooses it
  DistributedRows(World& world, RankAccess& access, std::span<const Sharing> sharing, RankPost post,
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
  void add_candidates(std::vector<Candidate>& candidates) override;
  bool on_any_rank(bool own) override;
  void put_rows_of(unsigned rank, partition::MessageWriter& message) const override;
  void get_rows_of(unsigned rank, partition::MessageReader& message) override;
  Messages written(const partition::MessageWriter& head) override;
  void get_written(unsigned from, partition::MessageReader& message) override;
  bool prepare_motions(std::span<const std::uint64_t> times) override;
  void report_joints(const std::function<void()>& work) override;
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
  RankAccess& access_;
  Links& links_;
  RankPost post_;
  bool reports_joints_;                 // devices of any type have the hook joints_moved
  std::vector<std::uint8_t> is_known_;  // of each table: 1 if the ghosts have its present values, otherwise 0
  Halo halo_;
  SharedEffects effects_;
  SharedError error_;           // of the hooks joints_moved, and later of births
  std::uint64_t attempts_ = 0;  // in this tick
  // Until redistribute(): bodies were born, whose rows are on any rank, or bodies with cargo have died.
  bool must_distribute_ = false;
  bool is_on_rank_0_ = false;  // until redistribute(): rank 0 has all rows, and the other ranks have none
  // Of this tick, on the ranks whose messages are read: the longest motion of a body, m, and whether a device
  // has asked a joint to move. Without the hook joints_moved, has_asked_ knows only the devices of this rank.
  double longest_ = 0;
  bool has_asked_ = false;
};

}  // namespace troupe::engine
