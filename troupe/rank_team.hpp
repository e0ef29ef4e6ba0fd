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

/// How many ranks compute a simulation in this process. The members are SimulationOptions::ranks, rank_seed
/// and rank_clock, where they are described.
struct RankOptions {
  unsigned ranks = 1;
  std::optional<std::uint64_t> seed;
  std::function<double(unsigned rank)> clock;
};

/// Throws std::invalid_argument, with the reason, if the number of ranks is not allowed: because it is not
/// one of 1 to k_most_ranks, or because it is more than 1 and a launcher such as mpirun started several
/// processes.
void check_ranks(const RankOptions& options);
/// Returns the number of worker threads of each rank. threads: the number that the user wants per rank, which
/// is returned; 0: the result is the number of processors that the process may use divided by `ranks`, at
/// least 1, or, with one rank, 0 (the world then chooses the number).
unsigned threads_per_rank(unsigned threads, unsigned ranks);

/// Replicas (copies) of a world on threads of this process, one per rank (engine/replica.hpp). The calling
/// thread is rank 0.
class RankTeam : public RankGroup {
 public:
  /// Makes the replicas of `lead`, which is at tick 0 and becomes the replica of rank 0. world: options of
  /// the worlds of the other ranks. options: number of ranks, test seed and clock, which check_ranks() has
  /// accepted. `lead` and `registry` must outlive this object. Throws partition::RankError if a replica
  /// cannot be made.
  RankTeam(engine::World& lead, const engine::Registry& registry, const engine::WorldOptions& world,
           const RankOptions& options);
  ~RankTeam() override;

  unsigned nodes() const override { return 1; }
  const engine::Replica& replica() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe
