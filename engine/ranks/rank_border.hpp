#pragma once

#include "base/ids.hpp"
#include "engine/conflicts/conflicts.hpp"
#include "engine/links/links.hpp"
#include "engine/ranks/orders.hpp"
#include "engine/rows/ranks.hpp"
#include "partition/message.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace troupe::engine {

class World;

/// Exchanges data between the ranks of a distributed world while they resolve the motions of a tick (time
/// step), that is, decide which motions are blocked. Ranks are threads or processes that compute one world
/// together. A row is the data of one body in the state tables. Each rank resolves the motions of the rows
/// that it owns. It also has *ghosts*, which are copies of some rows of other ranks (class Halo).
///
/// For the class Conflicts, the ranks exchange the outcomes of motions, the pushes, and the final positions
/// of pushed bodies. For the class Links, they exchange which motions of joints are blocked.
class RankBorder final : public Ranks::Border {
 public:
  /// The rows about which this rank exchanges data with other ranks. `shown` and `seen` have one list of rows
  /// per rank. The lists must not change until the motions of the tick are resolved.
  struct Rows {
    std::size_t own = 0;  ///< the own rows are those in [0, own)
    /// shown[r] has the own rows that are ghosts on rank r.
    std::span<const std::vector<std::uint32_t>> shown;
    /// seen[r] has the ghosts on this rank whose rows rank r owns. The list shown[this rank] on rank r has
    /// the same bodies in the same order.
    std::span<const std::vector<std::uint32_t>> seen;
  };

  /// `world` and `post` must outlive the object. has_pushable: whether the world has pushable bodies
  RankBorder(World& world, const RankPost& post, bool has_pushable);

  /// Begins a tick. Call this before the motions of the tick are resolved.
  ///
  /// rows: the rows that this rank owns, and those about which it exchanges data
  /// farthest: the largest distance that a body may be pushed in this tick, m
  void begin_tick(const Rows& rows, double farthest);
  /// At the first call after a tick, returns the largest distance that a body was pushed in that tick, m.
  /// Further calls return 0. The results are the same on all ranks.
  double take_pushed();
  std::uint64_t rounds() const { return rounds_; }  ///< number of exchanges of outcomes so far, in all ticks

  std::span<const std::uint32_t> begin(std::span<const Motion> motions,
                                       std::span<const std::uint32_t> order) override;
  bool exchange(Conflicts& conflicts) override;
  /// Implements Conflicts::Border: exchanges the final positions of pushed bodies. Throws StepError on all
  /// ranks if a body was pushed farther than begin_tick() allows.
  void exchange_places(Conflicts& conflicts) override;
  void exchange_blocked(Links& links) override;
  void exchange_blocks(std::span<Conflicts::Block> blocks) override;

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
