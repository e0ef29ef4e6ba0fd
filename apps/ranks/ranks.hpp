#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"
#include "partition/transport.hpp"

#include <chrono>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// Runs a command on all processes that a launcher such as mpirun has started (docs/cluster.md). These
/// processes are called ranks and are numbered from 0. Rank 0 calls run() and returns its result. The
/// argument of run() contains the connection to the other ranks (SimulationOptions::processes). The other
/// ranks do not call run(). They compute their parts of the worlds that rank 0 loads, and then return
/// k_finished.
///
/// With several processes, exceptions are handled as follows:
///
/// - If run() throws InputError, rank 0 prints it and returns k_bad_input. The other ranks return k_finished.
/// - If the connection fails, the ranks run different programs, or --ranks is given, rank 0 prints the error.
///   All ranks return k_bad_input.
/// - After any other exception, the process prints the error and ends without returning, because other
///   processes may wait for it.
///
/// Without a launcher, or with one process, calls run(options.simulation), returns its result, and passes its
/// exceptions on.
ExitCode on_ranks(const WorldOptions& options,
                  const std::function<ExitCode(const SimulationOptions& simulation)>& run);

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

/// Calls run() on every process that a launcher has started, and returns the result of this process. Without
/// a launcher, or with one process, calls run() once and passes its exceptions on.
///
/// With several processes (ranks), run() may throw InputError only on all ranks, or on rank 0 before
/// RankDeal::share(). The ranks that throw return k_bad_input, and rank 0 prints the error. After any other
/// exception, the process prints the error and ends without returning, because other processes may wait for
/// it.
///
/// threads: number of runs that each process makes at the same time (RankDeal::threads()); 0: the number of
/// processors that the launcher or the system gives this process
/// limit_s: the longest time that a rank waits for another rank, s
ExitCode on_each_rank(unsigned threads, double limit_s, const std::function<ExitCode(RankDeal& deal)>& run);

/// Checks whether a launcher such as mpirun started several processes. Commands that run in one process call
/// this function first. If it returns true, the command must not run, and rank 0 has printed an error.
/// command: name of the command, for the error.
bool is_refused_on_ranks(std::string_view command);

/// Prints an error that occurs on all processes of a launcher, such as wrong usage. Only rank 0 prints it.
/// The other ranks wait for two seconds instead, because a launcher ends all processes as soon as one has
/// failed.
void print_common_error(std::string_view text);

}  // namespace troupe::apps
