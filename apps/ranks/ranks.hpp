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
/// processes are called ranks and numbered from 0. Rank 0 calls run() with options that refer to the other
/// processes (SimulationOptions::processes). The other processes only compute their parts of the worlds that
/// rank 0 loads. Without a launcher, or with a single process, calls run(options.simulation) and passes its
/// exceptions on. Otherwise returns the result of run() on rank 0, and k_finished on the other ranks. If an
/// InputError is thrown, rank 0 prints it and the function returns k_bad_input. If run() throws the
/// InputError, the function returns k_bad_input only on rank 0. After any other exception, this process
/// prints the error and ends without returning, because other processes may wait for it.
ExitCode on_ranks(const WorldOptions& options,
                  const std::function<ExitCode(const SimulationOptions& simulation)>& run);

/// Divides independent runs, such as the runs of a sweep, among the processes (ranks) that a launcher has
/// started. The ranks are numbered from 0 and exchange messages: rank 0 shares the list of runs, and gathers
/// the results. Each rank must first call share() (rank 0) or shared() (other ranks), then
/// tell_that_it_works() while it makes its runs, and then gather().
class RankDeal {
 public:
  /// For a process that is the only one. threads: number of runs that this process makes at the same time
  explicit RankDeal(unsigned threads);
  /// transport: the connection to the other processes
  /// threads: number of runs that this process makes at the same time
  /// limit_s: the longest time that a rank waits for another, s
  RankDeal(partition::Transport& transport, unsigned threads, double limit_s);
  /// On rank 0: if share() was not called, makes shared() return std::nullopt on the other ranks.
  ~RankDeal();
  RankDeal(const RankDeal&) = delete;
  RankDeal& operator=(const RankDeal&) = delete;

  unsigned rank() const;
  unsigned ranks() const;
  unsigned threads() const { return threads_; }  ///< number of runs that this process makes at the same time
  /// A rank that makes its runs must call tell_that_it_works() at intervals of at most this time, so that the
  /// other ranks do not give up waiting for it.
  std::chrono::duration<double> interval() const { return interval_; }
  /// Tells the ranks that wait for this rank that it is still at work. Their wait of at most `limit_s` then
  /// starts again. While rank 0 waits in gather(), it passes such a message of one rank on to all other
  /// ranks, so that none of them gives up waiting for rank 0. Does nothing with one rank.
  void tell_that_it_works() const;
  /// On rank 0: sends a message to all other ranks, whose shared() returns this message. Call it at most
  /// once.
  void share(partition::Message message);
  /// On the other ranks: waits for the message that rank 0 passes to share(), and returns this message.
  /// Returns std::nullopt if rank 0 has ended without share(). Throws partition::RankError if a rank failed
  /// or does not answer. Must not be called on rank 0. Rank 0 must not call tell_that_it_works() before
  /// share(): shared() would return that message.
  std::optional<partition::Message> shared();
  bool has_shared() const { return has_shared_; }  ///< whether share() was called or shared() got a message
  /// Sends `own` to rank 0. On rank 0, waits for the messages of all ranks and returns them, indexed by rank;
  /// on other ranks, returns an empty list. Throws partition::RankError if a rank does not answer.
  std::vector<partition::Message> gather(partition::Message own) const;

 private:
  partition::Transport* transport_ = nullptr;
  unsigned threads_;
  std::chrono::duration<double> interval_;
  bool has_shared_ = false;
};

/// Calls run() on every process that a launcher has started, and returns the result of this process. Errors
/// are handled as in on_ranks().
/// threads: number of runs that each process makes at the same time (RankDeal::threads() then returns it);
///          0: the number of processors that the launcher or the system gives this process
/// limit_s: the longest time that a rank waits for another, s
ExitCode on_each_rank(unsigned threads, double limit_s, const std::function<ExitCode(RankDeal& deal)>& run);

/// For commands that run in one process only: returns true if a launcher started several processes, so that
/// the command must not run; rank 0 then prints an error. command: name of the command, for the error.
bool is_refused_on_ranks(std::string_view command);

/// Prints an error that occurs on all processes of a launcher, such as wrong usage. Only rank 0 prints it.
void print_common_error(std::string_view text);

}  // namespace troupe::apps
