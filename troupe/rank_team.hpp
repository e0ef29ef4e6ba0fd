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

/// The options of a RankTeam. SimulationOptions has the same options; its members `rank_seed` and
/// `rank_clock` are here called `seed` and `clock`. No option changes a simulated result.
struct RankOptions {
  unsigned ranks = 1;  ///< number of ranks, from 1 to k_most_ranks (1,024)
  /// For tests: if set, messages between ranks arrive late and shuffled, and robots move to random ranks.
  std::optional<std::uint64_t> seed;
  /// A clock with which the ranks measure how long their work takes. The function returns the present time,
  /// s, from any fixed origin. It is called on the threads of all ranks, with the number of the calling rank
  /// as its argument. Null: the ranks measure no times.
  std::function<double(unsigned rank)> clock;
  bool distribute = false;  ///< true: each rank has only the state of its own robots and of robots near them
};

/// Throws std::invalid_argument, with the reason, if the number of ranks is below 1 or above k_most_ranks.
/// Also throws if there is more than one rank and a launcher such as mpirun started several processes.
void check_ranks(const RankOptions& options);
/// Returns the number of worker threads of each rank. threads: the number per rank that the user wants; 0:
/// the user gives none.
/// - If `threads` is not 0, the result is `threads`.
/// - If `threads` is 0 and there are several ranks, the result is the number of processors that the process
///   may use, divided by `ranks`, but at least 1.
/// - If `threads` is 0 and there is one rank, the result is 0: the world then chooses the number.
unsigned threads_per_rank(unsigned threads, unsigned ranks);

/// The ranks of a world, if they are threads of this process. The ranks compute the world together: each has
/// a replica (a copy) of the world and computes a part of its robots (engine/ranks/replica.hpp). The calling
/// thread is rank 0.
class RankTeam : public RankGroup {
 public:
  /// Makes a replica of a world on each rank. Throws partition::RankError if a replica cannot be made, or if
  /// the system does not allow the threads of all ranks.
  ///
  /// lead: the world; it becomes the replica of rank 0. It must be at tick 0 (no step has been made) and
  /// outlive this object
  /// registry: the kinds of sensors, drives, controllers and so on that `lead` was made with; must outlive
  /// this object
  /// world: options of the replicas on the other ranks
  /// options: must have passed check_ranks()
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
