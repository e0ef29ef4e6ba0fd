#pragma once

#include "apps/exit_code.hpp"
#include "apps/options.hpp"
#include "apps/ranks/rank_deal.hpp"

#include <functional>
#include <string_view>

namespace troupe::apps {

/// How a command of several processes ends when one of them gets SIGINT, SIGTERM or SIGHUP.
enum class RankSignals {
  stop,  ///< rank 0 is told in the next tick, and ends the command as if it had got the signal itself; a
         ///< second SIGINT or SIGTERM ends the process at once, and the launcher ends the others
  kill   ///< the process ends at once, and the launcher ends the others
};

/// Runs a command on all processes that a launcher such as mpirun has started (docs/cluster.md). These
/// processes are called ranks and are numbered from 0. Rank 0 calls run() and returns its result. The
/// argument of run() contains the connection to the other ranks (SimulationOptions::processes). The other
/// ranks do not call run(). They compute their parts of the worlds that rank 0 loads, and then return
/// k_finished.
///
/// With several processes, exceptions are handled as follows:
///
/// - If run() throws InputError, rank 0 prints it and returns k_bad_input. The other ranks return k_finished.
/// - If the connection fails, the ranks run different programs, or --ranks or --controller is given, rank 0
///   prints the error. All ranks return k_bad_input. The connection may fail on some ranks only: these then
///   print that error two seconds later, as in print_usage_error().
/// - After any other exception, the process prints the error and ends without returning, because other
///   processes may wait for it.
///
/// Without a launcher, or with one process, calls run(options.simulation), returns its result, and passes its
/// exceptions on.
ExitCode on_ranks(const WorldCommandOptions& options, RankSignals signals,
                  const std::function<ExitCode(const SimulationOptions& simulation)>& run);

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

/// Whether this process prints texts that are equal on all processes of a launcher, such as the help: it has
/// rank 0, or no launcher that connects the processes started it.
bool prints_for_all_ranks();

/// Prints the text of an error of usage, which usually occurs on all processes of a launcher: rank 0 prints
/// it. The other ranks wait for two seconds first, because a launcher ends all processes as soon as one has
/// failed. Then the first rank of each other computer prints the text too: an error may occur on some
/// computers only, for example because a processor lacks the instruction set of --simd. A rank that is not
/// the first of its computer prints the text if the first one is still running: the two have different
/// arguments. Without a launcher, prints the text.
void print_usage_error(std::string_view text);

}  // namespace troupe::apps
