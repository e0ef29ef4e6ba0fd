#pragma once

#include "troupe/rank_group.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace troupe::engine {
class World;
struct Registry;
struct WorldOptions;
}  // namespace troupe::engine

namespace troupe {

/// The options of a RankTeam. SimulationOptions describes them; its members `rank_seed` and `rank_clock` are
/// here called `seed` and `clock`.
struct RankOptions {
  unsigned ranks = 1;
  std::optional<std::uint64_t> seed;
  std::function<double(unsigned rank)> clock;
  bool distribute = false;
};

/// Throws std::invalid_argument, with the reason, if the number of ranks is not from 1 to k_most_ranks, or if
/// it is more than 1 and a launcher such as mpirun started several processes.
void check_ranks(const RankOptions& options);
/// Returns the number of worker threads of each rank: `threads`, the number that the user wants per rank,
/// unless it is 0. If it is 0 and there are several ranks, the result is the number of processors that the
/// process may use, divided by `ranks`, but at least 1. If it is 0 and there is one rank, the result is 0:
/// the world then chooses the number.
unsigned threads_per_rank(unsigned threads, unsigned ranks);

/// Replicas (copies) of a world on threads of this process, one per rank (engine/ranks/replica.hpp). The
/// calling thread is rank 0.
class RankTeam : public RankGroup {
 public:
  /// Makes the replicas of `lead`, which is at tick 0 and becomes the replica of rank 0. world: options of
  /// the worlds of the other ranks. options: must have passed check_ranks(). `lead` and `registry` must
  /// outlive this object. Throws partition::RankError if a replica cannot be made.
  RankTeam(engine::World& lead, const engine::Registry& registry, const engine::WorldOptions& world,
           const RankOptions& options);
  ~RankTeam() override;

  unsigned nodes() const override { return 1; }
  const engine::Replica& replica() const override;
  engine::Replica& replica() override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
