#include "troupe/rank_processes.hpp"

#include "base/diagnostics.hpp"
#include "base/fp_environment.hpp"
#include "base/hash.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/world/world.hpp"
#include "partition/transport.hpp"
#include "troupe/plugins.hpp"
#include "troupe/registry.hpp"
#include "worldio/json/spec_json.hpp"

#include <fmt/format.h>

#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <utility>

namespace troupe {
namespace {

using engine::begin_message;
using engine::Order;
using partition::MessageReader;
using partition::MessageWriter;
using partition::Transport;

/// Calls visit() with each column of a table of bodies (worldio::BodyColumns).
template <class Bodies, class Visit>
void for_columns(Bodies& bodies, Visit&& visit) {
  std::apply([&](auto&... columns) { (visit(columns), ...); },
             std::tie(bodies.word, bodies.number, bodies.type, bodies.pose, bodies.color, bodies.fiducial,
                      bodies.file, bodies.line, bodies.alias_word, bodies.alias_number, bodies.alias_body));
}

void put_spec(MessageWriter& message, const worldio::StoredSpec& spec) {
  message.put_text(spec.json);
  for_columns(spec.bodies, [&](const auto& column) { message.put_all(std::span(column)); });
}

worldio::StoredSpec get_spec(MessageReader& message) {
  worldio::StoredSpec spec;
  spec.json = message.get_text();
  for_columns(spec.bodies, [&]<class T>(std::vector<T>& column) { column = message.get_all<T>(); });
  return spec;
}

engine::ReplicaOptions options_for(std::optional<std::uint64_t> seed, bool distribute,
                                   const std::function<engine::UserRequests()>& requests = {}) {
  return {.cut_seed = seed,
          .verify = seed.has_value(),
          .keeps_references = false,
          .is_distributed = distribute,
          .requests = requests};
}

/// A replica (a copy) of a world of rank 0 in this process, with the registry and the plug-ins that it uses.
struct Follower {
  engine::Registry registry = make_registry();
  std::shared_ptr<Plugins> plugins;
  std::unique_ptr<engine::World> world;
  std::unique_ptr<engine::Replica> replica;

  Follower(MessageReader& message, const std::vector<std::filesystem::path>& plugin_path, unsigned threads,
           Transport& transport, std::uint32_t number, const std::function<engine::UserRequests()>& requests)
      : plugins(add_plugins(registry, plugin_path)) {
    engine::WorldOptions options;
    options.threads = message.get<std::uint32_t>();
    if (options.threads == 0) options.threads = threads;
    options.tile_size_m = message.get<double>();
    const bool has_seed = message.get<bool>();
    const auto seed = message.get<std::uint64_t>();
    const bool distribute = message.get<bool>();
    for (std::size_t left = message.get_count(1); left > 0; --left) {
      const std::string name = message.get_text();
      const auto contents = message.get<std::uint64_t>();
      // Runs on several processes have no scripts.
      const Result<const Plugins::Library*> loaded = plugins->load(name, false);
      if (!loaded) throw InputError(fmt::format("plug-in \"{}\": {}", name, loaded.error().text));
      if ((*loaded)->contents != contents)
        throw InputError(fmt::format(
            "{} is another build of plug-in \"{}\" than that of rank 0: give all ranks the same file",
            (*loaded)->file.string(), name));
    }
    Diagnostics diagnostics;
    const Where where;
    std::vector<worldio::ParameterChange> none;
    engine::WorldSpec spec = worldio::restore_spec(get_spec(message), registry, {}, where, diagnostics, none);
    diagnostics.throw_if_errors();
    world = std::make_unique<engine::World>(std::move(spec), registry, options, diagnostics);
    replica = std::make_unique<engine::Replica>(
        *world, registry, transport, number,
        options_for(has_seed ? std::optional(seed) : std::nullopt, distribute, requests));
  }
};

/// The ranks of a world if each rank is a process. Holds the replica of rank 0; the destructor makes the
/// other processes destroy their replicas of this world.
class ProcessGroup : public RankGroup {
 public:
  ProcessGroup(engine::World& world, const engine::Registry& registry, Transport& transport, unsigned nodes,
               std::uint32_t number, std::optional<std::uint64_t> seed, bool distribute)
      : transport_(transport),
        nodes_(nodes),
        replica_(world, registry, transport, number, options_for(seed, distribute)) {}
  ~ProcessGroup() override {
    try {
      transport_.send_to_all(begin_message(Order::drop, replica_.number()));
    } catch (const partition::RankError&) {  // the run has failed already, and its error is reported
    }
  }
  unsigned nodes() const override { return nodes_; }
  const engine::Replica& replica() const override { return replica_; }
  engine::Replica& replica() override { return replica_; }

 private:
  Transport& transport_;
  unsigned nodes_;
  engine::Replica replica_;
};

}  // namespace

RankProcesses::~RankProcesses() {
  if (transport_.rank() != 0) return;
  try {
    transport_.send_to_all(begin_message(Order::end, 0));
  } catch (const partition::RankError&) {  // as above
  }
}

std::unique_ptr<RankGroup> RankProcesses::add(engine::World& world, const engine::Registry& registry,
                                              const Plugins& plugins, const engine::WorldOptions& options,
                                              std::optional<std::uint64_t> seed, bool distribute) {
  const std::uint32_t number = worlds_++;
  MessageWriter message = begin_message(Order::make, number);
  message.put(std::uint32_t{options.threads});
  message.put(options.tile_size_m);
  message.put(seed.has_value());
  message.put(seed.value_or(0));
  message.put(distribute);
  const std::vector<Plugins::Library> libraries = plugins.libraries();
  message.put(static_cast<std::uint64_t>(libraries.size()));
  for (const Plugins::Library& library : libraries) {
    message.put_text(library.name);
    message.put(library.contents);
  }
  put_spec(message, worldio::store_spec(world.spec(), registry));
  transport_.send_to_all(std::move(message));
  std::string failures;
  for (unsigned rank = 1; rank < transport_.ranks(); ++rank) {
    engine::ReceivedOrder answer = engine::receive_order(transport_, rank);
    if (answer.order != Order::failed) continue;
    failures += fmt::format("{}troupe: error: rank {}: {}", failures.empty() ? "" : "\n", rank,
                            answer.rest.get_text());
  }
  if (!failures.empty()) {
    transport_.send_to_all(begin_message(Order::drop, number));
    throw InputError(failures);
  }
  return std::make_unique<ProcessGroup>(world, registry, transport_, nodes_, number, seed, distribute);
}

void RankProcesses::follow(const std::vector<std::filesystem::path>& plugin_path,
                           const std::function<engine::UserRequests()>& requests) {
  std::map<std::uint32_t, std::unique_ptr<Follower>> followers;
  while (true) {
    engine::ReceivedOrder received = engine::receive_order(transport_, 0);
    const auto [order, number] = std::pair(received.order, received.world);
    if (order == Order::end) return;
    if (order == Order::make) {
      restore_fp_environment();  // a library, for example that of MPI, may have changed it
      MessageWriter answer = begin_message(Order::make, number);
      try {
        followers[number] =
            std::make_unique<Follower>(received.rest, plugin_path, threads_, transport_, number, requests);
      } catch (const std::exception& error) {
        followers.erase(number);
        answer = begin_message(Order::failed, number);
        answer.put_text(exception_text(error));
      }
      transport_.send(0, std::move(answer));
    } else if (order == Order::drop) {
      followers.erase(number);
    } else if (const auto found = followers.find(number); found != followers.end()) {
      found->second->replica->follow(order, received.rest);
    }
  }
}

}  // namespace troupe
