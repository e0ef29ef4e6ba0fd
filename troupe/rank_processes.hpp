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
struct UserRequests;
class World;
struct WorldOptions;
}  // namespace troupe::engine
namespace troupe::partition {
class Transport;
}  // namespace troupe::partition

namespace troupe {

class Plugins;

/// The processes that execute one program together, for example on a cluster. Each process is a rank and has
/// a number from 0 (docs/cluster.md). Rank 0 runs the program and sends orders to the other ranks, which wait
/// for orders and carry them out. For each world of the program, every rank has a replica (a copy of the
/// world) and computes a part of the robots.
class RankProcesses {
 public:
  /// transport: the connection to the other processes; it must outlive this object
  /// nodes: number of computers on which the processes run
  /// threads: number of worker threads of each replica in this process if the user gives no number
  RankProcesses(partition::Transport& transport, unsigned nodes, unsigned threads)
      : transport_(transport), nodes_(nodes), threads_(threads) {}
  /// On rank 0: tells the other ranks that no order follows. Their calls of follow() then return.
  ~RankProcesses();
  RankProcesses(const RankProcesses&) = delete;
  RankProcesses& operator=(const RankProcesses&) = delete;

  /// On rank 0: makes a replica of a world on every rank. The world must be at tick 0: no step has been made.
  /// `world` and `registry` must outlive the result. Throws InputError, with the rank and the reason, if a
  /// process cannot make its replica, for example because it lacks a plug-in.
  ///
  /// registry: the kinds of sensors, drives, controllers and so on that the world was made with
  /// plugins: the plug-ins (shared libraries with further kinds) that the world uses
  /// options: options of the replicas on the other ranks; if the number of threads is 0, each of these ranks
  /// uses the number that was given to the constructor of its RankProcesses
  /// seed: for tests; if set, robots move to random ranks during the run, and the seed determines the ranks
  /// distribute: true: each rank has only the state of its own robots and of robots near them. Only allowed
  /// for a world for which engine::why_replicated() returns an empty text
  std::unique_ptr<RankGroup> add(engine::World& world, const engine::Registry& registry,
                                 const Plugins& plugins, const engine::WorldOptions& options,
                                 std::optional<std::uint64_t> seed, bool distribute);
  /// On the ranks other than 0: carries out the orders of rank 0 until rank 0 destroys its RankProcesses.
  /// Throws partition::RankError if a rank fails.
  ///
  /// plugin_path: folders to search for the plug-ins that rank 0 uses
  /// requests: a function that returns what users have requested from this process with signals
  void follow(const std::vector<std::filesystem::path>& plugin_path,
              const std::function<engine::UserRequests()>& requests);
  unsigned threads() const { return threads_; }  ///< the argument `threads` of the constructor

 private:
  partition::Transport& transport_;
  unsigned nodes_;
  unsigned threads_;
  std::uint32_t worlds_ = 0;  // number of worlds that were added
};

}  // namespace troupe
