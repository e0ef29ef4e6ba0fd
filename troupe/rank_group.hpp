#pragma once

namespace troupe::engine {
class Replica;
}  // namespace troupe::engine

namespace troupe {

/// The ranks that compute one world together: threads or processes with numbers from 0 (docs/cluster.md). The
/// calling thread belongs to rank 0. Each rank has a replica, its own copy of the world. The replicas are
/// destroyed together with this object.
class RankGroup {
 public:
  RankGroup() = default;
  RankGroup(const RankGroup&) = delete;
  RankGroup& operator=(const RankGroup&) = delete;
  virtual ~RankGroup() = default;

  virtual unsigned nodes() const = 0;  ///< number of computers on which the ranks run
  /// The replica of rank 0.
  ///@{
  virtual const engine::Replica& replica() const = 0;
  virtual engine::Replica& replica() = 0;
  ///@}
};

}  // namespace troupe
