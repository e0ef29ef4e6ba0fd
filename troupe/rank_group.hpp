#pragma once

namespace troupe::engine {
class Replica;
}  // namespace troupe::engine

namespace troupe {

/// The ranks (threads or processes, docs/cluster.md) that compute one world together with the calling thread.
/// Each has a replica, its own copy of the world. Destroying this object destroys the replicas of these
/// ranks.
class RankGroup {
 public:
  RankGroup() = default;
  RankGroup(const RankGroup&) = delete;
  RankGroup& operator=(const RankGroup&) = delete;
  virtual ~RankGroup() = default;

  virtual unsigned nodes() const = 0;                  ///< number of computers on which the ranks run
  virtual const engine::Replica& replica() const = 0;  ///< the replica of the calling thread, which is rank 0
};

}  // namespace troupe
