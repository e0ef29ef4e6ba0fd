#pragma once

#include "troupe/rank_group.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace troupe::engine {
struct Registry;
class World;
struct WorldOptions;
}  // namespace troupe::engine
namespace troupe::partition {
class Transport;
}  // namespace troupe::partition

namespace troupe {

class Plugins;

/// The processes of one program, each of them a rank (docs/cluster.md). Rank 0 runs the program. For each
/// world of the program, rank 0 makes a replica (a copy of the world) on every other rank. The other ranks
/// only execute the orders that rank 0 sends them.
class RankProcesses {
 public:
  /// transport: the connection to the other processes; it must outlive this object
  /// nodes: number of computers on which the processes run
  /// threads: number of worker threads of each replica in this process if the user gives no number
  RankProcesses(partition::Transport& transport, unsigned nodes, unsigned threads)
      : transport_(transport), nodes_(nodes), threads_(threads) {}
  /// On rank 0: tells the other processes that no order follows; their follow() then returns.
  ~RankProcesses();
  RankProcesses(const RankProcesses&) = delete;
  RankProcesses& operator=(const RankProcesses&) = delete;

  /// On rank 0: makes replicas of a world, which must be at tick 0. `world` and `registry` must outlive the
  /// result. Throws InputError, with the rank and the reason, if a process cannot make its replica, for
  /// example because it lacks a plug-in.
  ///
  /// plugins: the plug-ins that the world uses
  /// options: options of all replicas; if their number of threads is 0, each process uses its own threads()
  /// seed: SimulationOptions::rank_seed; here it determines only how robots move between ranks
  /// distribute: whether each rank has only the state of its own robots and of robots near them; only for
  /// worlds that can be distributed (engine/ranks/halo.hpp)
  std::unique_ptr<RankGroup> add(engine::World& world, const engine::Registry& registry,
                                 const Plugins& plugins, const engine::WorldOptions& options,
                                 std::optional<std::uint64_t> seed, bool distribute);
  /// On all other ranks: carries out orders of rank 0 until rank 0 destroys its RankProcesses. Throws
  /// partition::RankError if a rank fails.
  ///
  /// plugin_path: folders to search for the plug-ins that rank 0 uses
  /// requests: returns how often this process was asked for a checkpoint (RankStatistics::requests)
  void follow(const std::vector<std::filesystem::path>& plugin_path,
              const std::function<std::uint32_t()>& requests);
  unsigned threads() const { return threads_; }  ///< the argument `threads` of the constructor

 private:
  partition::Transport& transport_;
  unsigned nodes_;
  unsigned threads_;
  std::uint32_t worlds_ = 0;  // number of worlds that were added
};

}  // namespace troupe
