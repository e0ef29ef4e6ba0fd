#pragma once

namespace troupe::engine {
class Replica;
}  // namespace troupe::engine

namespace troupe {

/// The other ranks of one world, which compute it together with the calling thread. Destroying this object
/// destroys their replicas.
class RankGroup {
 public:
  RankGroup() = default;
  RankGroup(const RankGroup&) = delete;
  RankGroup& operator=(const RankGroup&) = delete;
  virtual ~RankGroup() = default;

  virtual unsigned nodes() const = 0;                  ///< number of computers of the ranks
  virtual const engine::Replica& replica() const = 0;  ///< that of the calling thread
};

}  // namespace troupe
