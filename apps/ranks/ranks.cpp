#include "apps/ranks/ranks.hpp"

#include "apps/interrupt.hpp"
#include "apps/messages.hpp"
#include "apps/ranks/rank_place.hpp"
#include "apps/scripts.hpp"
#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "base/number_text.hpp"
#include "engine/ranks/replica.hpp"
#include "partition/mpi_transport.hpp"
#include "partition/processors.hpp"
#include "troupe/launcher.hpp"
#include "troupe/rank_processes.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

using partition::Message;
using partition::MessageReader;
using partition::MessageWriter;
using partition::MpiTransport;

/// An error of the connection to the other ranks. It may occur on some computers only, for example if a file
/// is missing there.
class ConnectionError : public InputError {
 public:
  using InputError::InputError;
};

std::string module_file(const std::string& mpi) { return "libtroupe_mpi_" + mpi + ".so"; }

/// Returns the file of the module (a shared library) that connects Troupe with the MPI of the launcher. The
/// environment variable TROUPE_MPI may contain the path of the module, or the name of an MPI (`openmpi`,
/// `mpich`) that replaces Launcher::mpi. Without a path, the module is searched in the folder of the program
/// and in the folder where modules are installed. Throws ConnectionError if the module is not found there.
fs::path find_module(const Launcher& launcher) {
  const char* wanted = std::getenv("TROUPE_MPI");
  if (wanted != nullptr && std::string_view(wanted).find('/') != std::string_view::npos) return wanted;
  const std::string mpi = wanted != nullptr && *wanted != 0 ? wanted : launcher.mpi;
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const std::array<fs::path, 2> folders{program, program.parent_path() / "lib" / "troupe"};
  for (const fs::path& folder : folders)
    if (fs::exists(folder / module_file(mpi), ignored)) return folder / module_file(mpi);
  throw ConnectionError(fmt::format(
      "troupe: error: {} started {} processes, but there is no module {} (Troupe's connection to MPI) in {} "
      "or {}: build the module with the MPI of the launcher and set TROUPE_MPI to its file (docs/cluster.md)",
      launcher.name, launcher.ranks, module_file(mpi), folders[0].string(), folders[1].string()));
}

/// Loads the module of find_module() and connects to MPI. Throws ConnectionError if the connection fails, or
/// if the module was built with another MPI than the MPI of the launcher.
std::unique_ptr<MpiTransport> connect(const Launcher& launcher) {
  const fs::path module = find_module(launcher);
  std::unique_ptr<MpiTransport> transport;
  try {
    transport = std::make_unique<MpiTransport>(module);
  } catch (const std::runtime_error& error) {
    throw ConnectionError(
        fmt::format("troupe: error: {} started this program, but the connection to MPI failed: {}",
                    launcher.name, std::string_view(error.what())));
  }
  if (transport->ranks() != launcher.ranks)
    throw ConnectionError(fmt::format(
        "troupe: error: {} started {} processes, but the module {} ({}) finds {}: this module belongs to "
        "another MPI; set TROUPE_MPI to a module that was built with the MPI of the launcher",
        launcher.name, launcher.ranks, module.string(), transport->library(), transport->ranks()));
  return transport;
}

/// The arguments of this process, without the name of the program.
std::string arguments() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string words{std::istreambuf_iterator<char>(file), {}};
  words.erase(0, words.find('\0'));
  std::ranges::replace(words, '\0', ' ');
  return words;
}

/// Hash of the file of this program, which differs between two builds of one version.
std::uint64_t program_contents() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return hash_text(bytes);
}

std::string host() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// Returns the number of different hosts.
unsigned nodes_of(std::vector<std::string> hosts) {
  std::ranges::sort(hosts);
  return static_cast<unsigned>(std::unique(hosts.begin(), hosts.end()) - hosts.begin());
}

void print_error(unsigned rank, std::string_view error) {
  print_message(fmt::format("troupe: error: rank {} on {}: {}\n", rank, host(), error));
  std::fflush(nullptr);
}

/// Prints an error and ends this process without waiting for threads or other ranks.
[[noreturn]] void end_at_once(unsigned rank, std::string_view error) {
  print_error(rank, error);
  _exit(k_failed);
}

/// How long a rank waits between printing that its time limit has run out and ending. The other ranks began
/// to wait at other times of the tick; in this time their limits run out too, and they print for which rank
/// they wait. limit_s: the time limit, s
std::chrono::duration<double> grace(double limit_s) {
  return std::chrono::duration<double>(std::clamp(limit_s / 10, 5.0, 60.0));
}

/// Ends the process if the object is not destroyed within a time limit after its construction. Time in which
/// the process is suspended does not count. A thread watches the limit; when the limit has run out, the
/// thread prints that `error` took longer than the limit, and ends the process. error: what is limited, as
/// the subject of this sentence. limit_s: the limit, s; above k_longest_s: no limit.
class EndsWithin {
 public:
  EndsWithin(double limit_s, unsigned rank, std::string error) {
    if (limit_s > k_longest_s) return;
    thread_ = std::thread([this, limit_s, rank, error = std::move(error)] {
      std::unique_lock lock(mutex_);
      // In pieces: a process that is suspended during a piece, for example with the whole job, has the rest
      // of the limit when it continues.
      constexpr double k_piece_s = 1;
      for (double left_s = limit_s; left_s > 0; left_s -= k_piece_s) {
        const std::chrono::duration<double> piece(std::min(left_s, k_piece_s));
        if (changed_.wait_for(lock, piece, [this] { return is_over_; })) return;
      }
      end_at_once(rank, fmt::format("{} took longer than {:g} s (--rank-limit)", error, limit_s));
    });
  }
  ~EndsWithin() {
    if (!thread_.joinable()) return;
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }
  EndsWithin(const EndsWithin&) = delete;
  EndsWithin& operator=(const EndsWithin&) = delete;

 private:
  static constexpr double k_longest_s = 1e6;  // the clock of wait_for() counts nanoseconds in 64 bits

  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_over_ = false;
  std::thread thread_;
};

/// Ends the connection to the other ranks; all ranks call it.
/// nodes: number of computers; limit_s: the longest time that MPI_Finalize may take, s.
///
/// In MPI_Finalize, MPICH with UCX over TCP first flushes the connection to each other rank; the other rank
/// must call a function of MPI to answer the flush. Then MPI_Finalize waits in a barrier, where it answers no
/// flush. Therefore a rank hangs if its flush begins after another rank has completed its flushes and waits
/// in the barrier (seen with MPICH 4.0.2 and UCX 1.13.1). A last message cannot prevent this, because the
/// message itself must be flushed. Therefore rank 0 tells the other ranks to end, and calls MPI_Finalize
/// last. The other ranks pause before MPI_Finalize, without calling MPI, while rank 0 completes its sends.
/// Their flushes then wait for the answer of rank 0, which comes when all of them have begun.
void finish(MpiTransport& transport, unsigned nodes, double limit_s) {
  constexpr std::chrono::milliseconds k_quiet(500);
  if (transport.rank() == 0)
    transport.send_to_all(std::make_shared<const Message>());
  else
    while (!transport.receive(0)->empty()) {  // rank 0 is still at work
    }
  const EndsWithin limit(limit_s, transport.rank(),
                         "the work is done and all files are written, but MPI_Finalize");
  transport.complete_sending();
  if (nodes > 1 && transport.library().starts_with("MPICH"))
    std::this_thread::sleep_for(transport.rank() == 0 ? 3 * k_quiet : k_quiet);
  transport.finish();
}

/// What a rank knows of all ranks after meet().
struct Peers {
  std::vector<std::string> hosts;  ///< host names of the ranks, by rank
  unsigned sharing = 1;            ///< count_sharing() of this rank
};

/// What each rank tells rank 0 in meet().
struct Introduction {
  RankPlace place;
  std::string version;
  std::string arguments;
  std::uint64_t contents = 0;  ///< program_contents()
};

Introduction get_introduction(MessageReader& message) {
  Introduction other;
  other.place.host = message.get_text();
  other.version = message.get_text();
  other.arguments = message.get_text();
  // Other versions may send less.
  if (!message.is_done()) other.contents = message.get<std::uint64_t>();
  if (!message.is_done()) other.place.processors = message.get_text();
  return other;
}

/// Returns the error if a rank and rank 0 run different programs or have different arguments, or else "".
std::string difference_of(unsigned rank, const Introduction& other, const Introduction& rank_0) {
  if (other.version != rank_0.version)
    return fmt::format(
        "troupe: error: rank {} on {} runs {}, but rank 0 on {} runs {}: start the same program on all ranks",
        rank, other.place.host, other.version, rank_0.place.host, rank_0.version);
  if (other.contents != rank_0.contents)
    return fmt::format(
        "troupe: error: rank {} on {} runs another build of {} than rank 0 on {}: start the same "
        "program file on all ranks",
        rank, other.place.host, rank_0.version, rank_0.place.host);
  if (other.arguments != rank_0.arguments)
    return fmt::format(
        "troupe: error: rank {} on {} was started with the arguments{}, but rank 0 with{}: give all ranks "
        "the same arguments",
        rank, other.place.host, other.arguments, rank_0.arguments);
  return {};
}

/// Compares the program, its version and its arguments on all ranks. Throws InputError on all ranks if they
/// differ. limit_s: the longest time that ending the connection may take, s
Peers meet(MpiTransport& transport, double limit_s) {
  Peers peers;
  const Introduction own{
      {host(), partition::affinity_list()}, version_line(), arguments(), program_contents()};
  std::string difference;
  if (transport.rank() == 0) {
    std::vector<RankPlace> places{own.place};
    for (unsigned rank = 1; rank < transport.ranks(); ++rank) {
      const auto letter = transport.receive(rank);
      MessageReader message(*letter);
      const Introduction other = get_introduction(message);
      places.push_back(other.place);
      if (difference.empty()) difference = difference_of(rank, other, own);
    }
    MessageWriter verdict;
    verdict.put_text(difference);
    for (const RankPlace& place : places) verdict.put_text(peers.hosts.emplace_back(place.host));
    for (std::size_t rank = 0; rank < places.size(); ++rank) verdict.put(count_sharing(places, rank));
    transport.send_to_all(std::move(verdict));
    peers.sharing = count_sharing(places, 0);
  } else {
    MessageWriter message;
    message.put_text(own.place.host);
    message.put_text(own.version);
    message.put_text(own.arguments);
    message.put(own.contents);
    message.put_text(own.place.processors);
    transport.send(0, std::move(message));
    const auto letter = transport.receive(0);
    MessageReader verdict(*letter);
    difference = verdict.get_text();
    for (unsigned rank = 0; rank < transport.ranks(); ++rank) peers.hosts.push_back(verdict.get_text());
    for (unsigned rank = 0; rank <= transport.rank() && difference.empty(); ++rank)
      peers.sharing = verdict.get<unsigned>();
  }
  if (!difference.empty()) {
    finish(transport, nodes_of(peers.hosts), limit_s);
    throw InputError(difference);
  }
  return peers;
}

/// Returns the default number of worker threads of this rank: SLURM_CPUS_PER_TASK if it is set, but no more
/// than the processors that this process may use; else the number of these processors, divided by the number
/// of ranks that share them.
unsigned threads_of_rank(const Peers& peers, unsigned rank) {
  const std::vector<std::string>& hosts = peers.hosts;
  const unsigned allowed = partition::processors_allowed();
  if (const char* slurm = std::getenv("SLURM_CPUS_PER_TASK"))
    if (const auto cpus = number_of<unsigned>(slurm); cpus && *cpus > 0) {
      // srun ignores the option -c of sbatch but passes on its variable, which may then exceed the processors
      // that srun gives the process.
      if (rank == 0 && *cpus > allowed)
        print_message(fmt::format(
            "troupe: warning: SLURM_CPUS_PER_TASK is {}, but rank 0 on {} may use only {} processor{}: "
            "rank 0 computes with {} thread{}; give srun the option -c {}, or mpirun the option --bind-to "
            "none\n",
            *cpus, hosts[rank], allowed, allowed == 1 ? "" : "s", allowed, allowed == 1 ? "" : "s", *cpus));
      return std::min(*cpus, allowed);
    }
  const unsigned all = std::thread::hardware_concurrency();
  const auto here = static_cast<unsigned>(std::ranges::count(hosts, hosts[rank]));
  if (rank == 0 && allowed == 1 && all > here)
    print_message(fmt::format(
        "troupe: warning: each rank may use 1 of the {} processors of {}: for several threads per rank, "
        "give mpirun the option --bind-to none\n",
        all, hosts[rank]));
  return std::max(1u, allowed / peers.sharing);
}

/// Connects this process with the other processes of the launcher. Then calls work() with the transport and
/// the result of meet(), and returns its result. limit_s: the longest time that this process waits for
/// another, also when the connection begins and ends, s
ExitCode with_others(const Launcher& launcher, double limit_s,
                     const std::function<ExitCode(MpiTransport&, const Peers&)>& work) {
  std::unique_ptr<MpiTransport> transport;
  {
    const EndsWithin limit(limit_s, launcher.rank, "the connection to the other ranks (MPI_Init)");
    transport = connect(launcher);
  }
  transport->set_limit(limit_s);
  const Peers peers = meet(*transport, limit_s);
  transport->set_hosts(peers.hosts);
  ExitCode code = k_finished;
  try {
    code = work(*transport, peers);
  } catch (const InputError&) {  // thrown on rank 0, which has already ended the other ranks
    finish(*transport, nodes_of(peers.hosts), limit_s);
    throw;
  }
  finish(*transport, nodes_of(peers.hosts), limit_s);
  return code;
}

ExitCode on_processes(MpiTransport& transport, const Peers& peers, const WorldCommandOptions& options,
                      RankSignals signals,
                      const std::function<ExitCode(const SimulationOptions& simulation)>& run) {
  SimulationOptions simulation = options.simulation;
  const unsigned threads =
      simulation.threads > 0 ? simulation.threads : threads_of_rank(peers, transport.rank());
  const auto processes = std::make_shared<RankProcesses>(transport, nodes_of(peers.hosts), threads);
  if (transport.rank() > 0) {
    // Rank 0 saves the state and ends the run, whichever rank receives the signal.
    std::signal(SIGUSR2, SIG_IGN);
    if (signals == RankSignals::stop) stop_on_signals();
    count_save_requests();
    processes->follow(plugin_path(simulation.plugin_path), [] {
      return engine::UserRequests{.saves = save_requests(), .stop = stop_requested()};
    });
    return k_finished;
  }
  simulation.processes = processes;
  return run(simulation);
}

/// Prints an error that occurs on all ranks. Only rank 0 prints it. The other ranks wait for two seconds,
/// because a launcher ends all processes, also rank 0, as soon as one of them has ended with an error.
void print_common_error(unsigned rank, std::string_view text) {
  if (rank == 0)
    print_message(text);
  else
    std::this_thread::sleep_for(std::chrono::seconds(2));
}

/// Like print_common_error(), for an error that may occur on some computers or with the arguments of some
/// ranks only, so that rank 0 may not have it. After the two seconds, the first rank of each other computer
/// prints it too. If rank 0 has the error, most launchers have ended these ranks by then. Any other rank
/// prints the error if the first rank of its computer, which is still running, does not have it.
void print_error_of_host(const Launcher& launcher, std::string_view text) {
  print_common_error(launcher.rank, text);
  if (launcher.rank > 0 && (launcher.is_first_here || runs_first_here()))
    print_message(fmt::format("rank {} on {}: {}", launcher.rank, host(), text));
}

/// Throws InputError if the launcher started more processes than Transport allows.
void check_number(const Launcher& launcher) {
  if (launcher.ranks > partition::k_most_ranks)
    throw InputError(fmt::format(
        "troupe: error: {} started {} processes, but at most {} are allowed: start fewer processes, and let "
        "each of them use more threads (--threads)",
        launcher.name, launcher.ranks, partition::k_most_ranks));
}

/// Calls work(), prints its errors and returns the exit code. Errors other than InputError end the process.
/// limit_s: the longest time that a rank waits for another, s
ExitCode reported(const Launcher& launcher, double limit_s, const std::function<ExitCode()>& work) {
  try {
    check_number(launcher);
    return work();
  } catch (const ConnectionError& error) {
    print_error_of_host(launcher, fmt::format("{}\n", error.what()));
    return k_bad_input;
  } catch (const InputError& error) {  // the same error on all ranks
    print_common_error(launcher.rank, fmt::format("{}\n", error.what()));
    return k_bad_input;
  } catch (const partition::RankError& error) {
    // Other ranks may wait for this rank, which itself waited for a rank. The launcher ends all processes
    // when this process ends. Therefore this process first waits until the limits of the other ranks have
    // also run out, and until these ranks have printed for which rank they waited. The rank that prints
    // nothing is the rank that does not answer.
    print_error(launcher.rank, error.what());
    std::this_thread::sleep_for(grace(limit_s));
    _exit(k_failed);
  } catch (const std::exception& error) {
    end_at_once(launcher.rank, exception_text(error));
  } catch (...) {
    end_at_once(launcher.rank,
                "unknown exception (not derived from std::exception); a plug-in may have thrown it");
  }
}

}  // namespace

ExitCode on_ranks(const WorldCommandOptions& options, RankSignals signals,
                  const std::function<ExitCode(const SimulationOptions& simulation)>& run) {
  const std::optional<Launcher> launcher = find_launcher();
  if (!launcher) return run(options.simulation);
  return reported(*launcher, options.rank_limit_s, [&] {
    if (options.gives_ranks)
      throw InputError(
          fmt::format("troupe: error: --ranks is for ranks in one process, but {} started {} "
                      "processes, each of which is a rank: leave out --ranks",
                      launcher->name, launcher->ranks));
    if (!options.simulation.scripts.empty()) refuse_scripts(*launcher);
    return with_others(*launcher, options.rank_limit_s, [&](MpiTransport& transport, const Peers& peers) {
      return on_processes(transport, peers, options, signals, run);
    });
  });
}

ExitCode on_each_rank(unsigned threads, double limit_s, const std::function<ExitCode(RankDeal& deal)>& run) {
  const std::optional<Launcher> launcher = find_launcher();
  if (!launcher) {
    RankDeal alone(threads > 0 ? threads : partition::processors_allowed());
    return run(alone);
  }
  return reported(*launcher, limit_s, [&] {
    return with_others(*launcher, limit_s, [&](MpiTransport& transport, const Peers& peers) {
      const unsigned own = threads > 0 ? threads : threads_of_rank(peers, transport.rank());
      RankDeal deal(transport, own, limit_s);
      return run(deal);
    });
  });
}

bool is_refused_on_ranks(std::string_view command) {
  const std::optional<Launcher> launcher = find_launcher();
  if (!launcher) return false;
  print_common_error(
      launcher->rank,
      fmt::format(
          "troupe {}: error: {} started {} processes, but this command uses only one: start it without the "
          "launcher; the commands run, resume, check and sweep use all processes\n",
          command, launcher->name, launcher->ranks));
  return true;
}

bool prints_for_all_ranks() try {
  const std::optional<Launcher> launcher = find_launcher();
  return !launcher || launcher->rank == 0;
} catch (const InputError&) {  // srun without MPI
  return true;
}

void print_usage_error(std::string_view text) {
  if (const std::optional<Launcher> launcher = find_launcher())
    print_error_of_host(*launcher, text);
  else
    print_message(text);
}

}  // namespace troupe::apps
