#pragma once

namespace troupe::engine {
class Replica;
}  // namespace troupe::engine

namespace troupe {

/// The ranks (threads or processes, docs/cluster.md) that compute one world together with the calling thread.
/// Each of these ranks has a replica, its own copy of the world, which is destroyed together with this
/// object.
class RankGroup {
 public:
  RankGroup() = default;
  RankGroup(const RankGroup&) = delete;
  RankGroup& operator=(const RankGroup&) = delete;
  virtual ~RankGroup() = default;

  virtual unsigned nodes() const = 0;  ///< number of computers on which the ranks run
  /// The replica of rank 0, the rank of the calling thread.
  ///@{
  virtual const engine::Replica& replica() const = 0;
  virtual engine::Replica& replica() = 0;
  ///@}
};

}  // namespace troupe
