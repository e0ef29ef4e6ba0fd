#include "troupe/rank_team.hpp"

#include "base/diagnostics.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/world/world.hpp"
#include "partition/job_thread.hpp"
#include "partition/mailboxes.hpp"
#include "partition/processors.hpp"
#include "troupe/launcher.hpp"
#include "troupe/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace troupe {
namespace {

using engine::begin_message;
using engine::Order;
using partition::Transport;

constexpr std::uint32_t k_world = 0;  // number of the only world of these ranks

/// Throws partition::RankError if the system does not allow the worker threads of all ranks at the same time.
/// The ranks begin their first loops together, and oneTBB would end the program (partition/parallel.hpp).
/// threads: worker threads of each rank, with the thread of the rank
void require_threads(unsigned ranks, unsigned threads) {
  if (const std::error_code error = partition::try_threads(std::size_t{ranks} * threads - 1))
    throw partition::RankError(fmt::format(
        "{} ranks with {} thread{} each: the system allows too few threads ({}): use fewer ranks or "
        "threads, or raise the limits on threads and memory of this process",
        ranks, threads, threads == 1 ? "" : "s", error.message()));
}

}  // namespace

void check_ranks(const RankOptions& options) {
  static_assert(k_most_ranks == partition::k_most_ranks);
  if (options.ranks < 1 || options.ranks > k_most_ranks)
    throw std::invalid_argument(fmt::format("{} ranks: must be 1 to {}", options.ranks, k_most_ranks));
  if (options.ranks == 1) return;
  if (const std::optional<Launcher> launcher = find_launcher())
    throw std::invalid_argument(fmt::format(
        "{} ranks: the ranks of a program are threads of one process, but {} started {} processes: start the "
        "program without the launcher, or use troupe run, whose ranks may be processes",
        options.ranks, launcher->name, launcher->ranks));
}

unsigned threads_per_rank(unsigned threads, unsigned ranks) {
  if (threads > 0 || ranks <= 1) return threads;
  return std::max(1u, partition::processors_allowed() / ranks);
}

struct RankTeam::Impl {
  Impl(engine::World& lead, const engine::Registry& registry, const engine::WorldOptions& world,
       const RankOptions& options)
      : mailboxes(options.ranks, options.seed, options.clock),
        replica_options{.cut_seed = options.seed,
                        .verify = options.seed.has_value(),
                        .keeps_references = !options.distribute,  // distributed rows change
                        .is_distributed = options.distribute} {
    require_threads(options.ranks, lead.parallel().threads());
    try {
      for (unsigned rank = 1; rank < options.ranks; ++rank) {
        threads.push_back(std::make_unique<partition::JobThread>(1));
        threads.back()->add([this, &lead, &registry, world, rank] { follow(lead, registry, world, rank); });
      }
      for (unsigned rank = 1; rank < options.ranks; ++rank) mailboxes.of(0).receive(rank);  // rank is ready
      replica.emplace(lead, registry, mailboxes.of(0), k_world, replica_options);
    } catch (...) {
      mailboxes.close("rank 0 has failed");  // otherwise the threads that wait for rank 0 would not end
      throw;
    }
  }
  ~Impl() {
    if (replica) mailboxes.of(0).send_to_all(begin_message(Order::end, k_world));
    mailboxes.close("rank 0 has ended");
  }

  void follow(const engine::World& lead, const engine::Registry& registry, const engine::WorldOptions& world,
              unsigned rank) {
    try {
      Diagnostics diagnostics(lead.spec().files);  // discarded: rank 0 reports the same warnings
      engine::World own(lead.spec(), registry, world, diagnostics);
      Transport& transport = mailboxes.of(rank);
      engine::Replica replica_here(own, registry, transport, k_world, replica_options);
      transport.send(0, begin_message(Order::make, k_world));
      while (true) {
        const engine::ReceivedOrder received = engine::receive_order(transport, 0);
        if (received.order == Order::end) return;
        replica_here.follow(received.order, received.rest);
      }
    } catch (const std::exception& error) {
      mailboxes.close(fmt::format("rank {} failed: {}", rank, exception_text(error)));
    } catch (...) {  // for example of a plug-in
      mailboxes.close(
          fmt::format("rank {} failed: it threw an exception that is not a std::exception", rank));
    }
  }

  partition::Mailboxes mailboxes;
  engine::ReplicaOptions replica_options;
  std::optional<engine::Replica> replica;
  std::vector<std::unique_ptr<partition::JobThread>> threads;  // destroyed first: they use the members above
};

RankTeam::RankTeam(engine::World& lead, const engine::Registry& registry, const engine::WorldOptions& world,
                   const RankOptions& options)
    : impl_(std::make_unique<Impl>(lead, registry, world, options)) {}

RankTeam::~RankTeam() = default;

const engine::Replica& RankTeam::replica() const { return *impl_->replica; }
engine::Replica& RankTeam::replica() { return *impl_->replica; }

}  // namespace troupe
