#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"
#include "partition/transport.hpp"

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

namespace troupe::apps {

/// Runs a command on all processes that a launcher such as mpirun has started (docs/cluster.md). Rank 0 calls
/// run() with options that contain the other processes; these only compute their ranks of its worlds.
/// Without a launcher, or with a single process, calls run(options). If an error concerns all processes, only
/// rank 0 prints it. If this process fails, it prints the error and ends at once, because other processes may
/// wait for it.
ExitCode on_ranks(const WorldOptions& options,
                  const std::function<ExitCode(const SimulationOptions& simulation)>& run);

/// The processes of a command that makes independent runs, each process some of them. All processes must call
/// the functions in the same order.
class RankDeal {
 public:
  /// transport: to the other processes; null: this process is the only one
  explicit RankDeal(partition::Transport* transport = nullptr) : transport_(transport) {}
  /// On rank 0: tells the others if share() was not called.
  ~RankDeal();
  RankDeal(const RankDeal&) = delete;
  RankDeal& operator=(const RankDeal&) = delete;

  unsigned rank() const;
  unsigned ranks() const;
  /// On rank 0: sends a message to all other ranks; they may now begin. Called once.
  void share(partition::Message message);
  /// On the other ranks: waits for the message of rank 0 and returns it. std::nullopt if rank 0 has ended
  /// without one.
  std::optional<partition::Message> shared();
  bool has_shared() const { return has_shared_; }  ///< whether all ranks have begun
  /// Returns the messages of all ranks on rank 0, and nothing on the others.
  std::vector<partition::Message> gather(partition::Message own) const;

 private:
  partition::Transport* transport_;
  bool has_shared_ = false;
};

/// Calls run() on every process that a launcher has started. Returns the result of rank 0. Errors are handled
/// as in on_ranks().
ExitCode on_each_rank(const std::function<ExitCode(RankDeal& deal)>& run);

/// Whether a launcher started several processes; for commands that run in one process. Rank 0 then prints an
/// error. command: its name, for the error.
bool is_refused_on_ranks(std::string_view command);

/// Prints an error that all processes of a launcher have, such as one of usage, once.
void print_common_error(std::string_view text);

}  // namespace troupe::apps
