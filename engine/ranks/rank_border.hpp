#pragma once

#include "base/ids.hpp"
#include "engine/conflicts/conflicts.hpp"
#include "engine/links/links.hpp"
#include "engine/ranks/orders.hpp"
#include "partition/message.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

class World;

/// Exchanges with the other ranks of a distributed world what Conflicts and Links need to resolve the motions
/// of a tick (time step): the outcomes of motions, the pushes, the final positions of pushed bodies, and
/// whether the motions of joints are blocked. Ranks are threads or processes that compute one world together.
/// A row is the data of one body in the state tables. Each rank resolves the motions of the rows that it
/// owns, and has *ghosts*, copies of some rows of other ranks (class Halo).
class RankBorder final : public Conflicts::Border, public Links::Border {
 public:
  /// The rows that this rank has in common with others. The lists have one entry per rank. They must not
  /// change until the motions of the tick are resolved.
  struct Rows {
    std::size_t own = 0;  ///< the own rows are those in [0, own)
    /// Own rows that the rank of the entry has as ghosts, in an order that both ranks know.
    std::span<const std::vector<std::uint32_t>> shown;
    /// Ghosts that the rank of the entry owns, in the same order as in that rank's list `shown`.
    std::span<const std::vector<std::uint32_t>> seen;
  };

  /// The arguments must outlive the object. has_pushable: whether the world has pushable bodies
  RankBorder(World& world, const RankPost& post, bool has_pushable);

  /// Sets the rows, and the limit of pushes, for a tick. Call this before the motions of the tick are
  /// resolved.
  ///
  /// farthest: the largest distance that a body may be pushed in this tick, m
  void begin_tick(const Rows& rows, double farthest);
  /// Returns the largest distance that a body was pushed in the last tick, m, and sets the stored distance to
  /// 0. The result is the same on all ranks.
  double take_pushed();
  std::uint64_t rounds() const { return rounds_; }  ///< number of exchanges of outcomes, in all ticks

  std::span<const std::uint32_t> begin(std::span<const Motion> motions,
                                       std::span<const std::uint32_t> order) override;
  bool exchange(Conflicts& conflicts) override;
  /// Throws StepError on all ranks if a body was pushed farther than begin_tick() allows.
  void exchange_places(Conflicts& conflicts) override;
  void exchange_blocked(Links& links) override;

 private:
  void send_outcomes(unsigned to, const Conflicts& conflicts);
  void receive_outcomes(unsigned from, Conflicts& conflicts);
  void put_pushes(partition::MessageWriter& message, std::span<const Conflicts::Push> pushes) const;
  void get_pushes(partition::MessageReader& message);

  World& world_;
  const RankPost& post_;
  bool has_pushable_;
  Rows rows_;
  double farthest_ = 0;  // largest distance that a body may be pushed in this tick, m
  double pushed_ = 0;    // largest distance that a body was pushed in the last tick, m
  // One entry per rank: of the rows in Rows, the indices of those that move and whose outcome is not yet
  // sent; and the number of those whose outcome is not yet received.
  std::vector<std::vector<std::uint32_t>> to_send_;
  std::vector<std::size_t> to_receive_;
  std::vector<std::uint32_t> order_;     // result of begin()
  std::vector<Conflicts::Push> pushes_;  // scratch: result of get_pushes()
  std::uint64_t rounds_ = 0;
};

}  // namespace troupe::engine
