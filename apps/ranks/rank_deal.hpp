#pragma once

#include "partition/transport.hpp"

#include <chrono>
#include <optional>
#include <vector>

namespace troupe::apps {

/// Lets the processes that a launcher such as mpirun has started share the work of many independent runs,
/// such as the runs of a sweep. These processes are called ranks and are numbered from 0. Each rank performs
/// these steps in order:
///
/// - Rank 0 sends the list of all runs with share(). The other ranks receive it with shared().
/// - Each rank makes its part of the runs, and calls tell_that_it_works() at regular intervals.
/// - Each rank calls gather(), which sends its results to rank 0.
class RankDeal {
 public:
  /// Makes the object of a process that works alone. threads: number of runs that this process makes at the
  /// same time.
  explicit RankDeal(unsigned threads);
  /// transport: the connection to the other processes
  /// threads: number of runs that this process makes at the same time
  /// limit_s: the time limit that `transport` already has, s. A rank that waits longer for another rank
  /// throws partition::RankError.
  RankDeal(partition::Transport& transport, unsigned threads, double limit_s);
  /// If rank 0 has not called share(), its destructor makes shared() return std::nullopt on the other ranks.
  ~RankDeal();
  RankDeal(const RankDeal&) = delete;
  RankDeal& operator=(const RankDeal&) = delete;

  unsigned rank() const;
  unsigned ranks() const;
  unsigned threads() const { return threads_; }  ///< number of runs that this process makes at the same time
  /// Returns the longest time between two calls of tell_that_it_works() on a rank that makes its runs. At
  /// longer intervals, the other ranks may give up waiting for this rank.
  std::chrono::duration<double> interval() const { return interval_; }
  /// Tells the ranks that wait for this rank that it is still working. Their time limit then starts again.
  /// Rank 0 tells all other ranks. Any other rank tells only rank 0. If rank 0 receives this message while it
  /// waits in gather(), it also tells all other ranks that it is still working. With one rank, does nothing.
  ///
  /// On rank 0, call share() first. Otherwise shared() on the other ranks would return the message of this
  /// function.
  void tell_that_it_works() const;
  /// On rank 0: sends a message to all other ranks, where shared() returns it. Call it at most once.
  void share(partition::Message message);
  /// On the other ranks: waits for the message that rank 0 passes to share(), and returns it. Returns
  /// std::nullopt if rank 0 has ended without a call of share(). Throws partition::RankError if a rank failed
  /// or does not answer. Must not be called on rank 0.
  std::optional<partition::Message> shared();
  bool has_shared() const { return has_shared_; }  ///< whether share() was called or shared() got a message
  /// Sends `own` to rank 0. On rank 0, waits for the messages of all ranks and returns them, indexed by rank.
  /// On other ranks, returns an empty list. Throws partition::RankError if a rank does not answer.
  std::vector<partition::Message> gather(partition::Message own) const;

 private:
  partition::Transport* transport_ = nullptr;
  unsigned threads_;
  std::chrono::duration<double> interval_;
  bool has_shared_ = false;
};

}  // namespace troupe::apps
