// The orders that rank 0 gives to the other ranks between two ticks or during the callback of
// World::before_tick(), and how the other ranks obey them.

#include "engine/ranks/record_message.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/world/rank_access.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;

}  // namespace

/// Calls work(). A StepError is only stored, because rank 0 also throws it, and reports it.
template <class Work>
void Replica::keep_step_error(Work&& work) {
  try {
    work();
  } catch (const StepError& error) {
    unreported_ = error.what();
  }
}

/// Reads the flags of Order::step.
void Replica::follow_step(std::uint8_t flags) {
  has_callback_ = (flags & k_has_callback) != 0;
  if ((flags & k_watches_contacts) != 0) world_.watch_contacts();
}

void Replica::follow(Order order, MessageReader message) {
  const auto answer = [&](auto&& put_data) {
    MessageWriter data = message_of(order);
    put_data(data);
    transport_.send(0, std::move(data));
  };
  switch (order) {
    case Order::step:
      follow_step(message.get<std::uint8_t>());
      require_equal_rejections(message.get<std::uint64_t>());
      get_changes(message, false);
      require_whole();
      return keep_step_error([&] { world_.step(); });
    case Order::reset: return keep_step_error([&] { world_.reset(); });
    case Order::restart: return follow_restart(message);
    case Order::set: return follow_set(message);
    case Order::hash:
      return answer([&](MessageWriter& data) {
        data.put(own_hashes());
        if (message.get<bool>())
          for (const std::uint64_t sum : rows_->sums()) data.put(sum);
      });
    case Order::gather: return answer([&](MessageWriter& data) { rows_->put_missing(data); });
    case Order::counts: return answer([&](MessageWriter& data) { data.put(own_counts()); });
    default:
      throw std::logic_error(
          fmt::format("internal error: rank {} got order {} between two ticks; this is no error of your "
                      "input: please report it",
                      transport_.rank(), static_cast<int>(order)));
  }
}

/// If the new bodies are rejected, rank 0 also throws the error, and all worlds return to the old bodies.
void Replica::follow_restart(MessageReader& message) {
  const auto seed = message.get<std::uint64_t>();
  std::vector<BodySpec> bodies = world_.spec().bodies;
  for (BodySpec& body : bodies) {
    body.pose_world_body = message.get<Pose>();
    body.color = message.get<Color>();
  }
  try {
    keep_step_error([&] { world_.restart(seed, bodies, registry_); });
  } catch (const InputError& error) {
    unreported_ = error.what();
  } catch (const std::logic_error& error) {
    unreported_ = error.what();
  }
}

void Replica::follow_set(MessageReader& message) {
  const auto tick = message.get<std::uint64_t>();
  SettingSpec setting;
  setting.type = message.get<TypeId>();
  setting.of = message.get<SettingSpec::Of>();
  setting.index = message.get<std::uint32_t>();
  message.require(has_params(world_.spec().types, setting));
  setting.params = get_record(message);
  if (const Result<> done = access_.set_at(tick, setting, registry_); !done)
    throw std::logic_error(
        fmt::format("internal error: rank {}: {}; this is no error of your input: please report it",
                    transport_.rank(), done.error().text));
}

/// Rank 0 makes no tick after a tick that has failed on all ranks, until the program has replaced the state.
/// If the state of this rank is incomplete, a hook has therefore thrown an exception on this rank only.
void Replica::require_whole() const {
  try {
    world_.require_whole();
  } catch (const std::logic_error&) {
    throw std::logic_error(fmt::format(
        "an error that did not occur on rank 0, so its cause differs between ranks: {}", unreported_));
  }
}

/// Throws if rank 0 and this rank have not rejected the bodies of the same calls of World::restart(): their
/// worlds would have different bodies. rejections: note_rejection() calls on rank 0
void Replica::require_equal_rejections(std::uint64_t rejections) const {
  if (rejections == rejections_) return;
  throw std::logic_error(
      rejections < rejections_
          ? fmt::format("an error that did not occur on rank 0, so its cause differs between ranks: {}",
                        unreported_)
          : "an error of rank 0 in World::restart() did not occur on this rank, so its cause differs between "
            "ranks");
}

void Replica::gather() {
  if (!leads() || is_in_tick_) return;
  if (!is_read_) is_read_ = true;  // only the first call writes: later, several threads may call this
  if (rows_->is_complete()) return;
  transport_.send_to_all(message_of(Order::gather));
  std::vector<ReceivedOrder> answers;
  for (unsigned from = 1; from < ranks(); ++from) answers.push_back(expect(Order::gather, from));
  rows_->complete(answers);
}

void Replica::gather_distributed() {
  if (halo() != nullptr) gather();
}

void Replica::touch() {
  if (!leads() || is_in_tick_) return;
  gather();
  is_touched_.store(true, std::memory_order_relaxed);
  is_written_.store(true, std::memory_order_relaxed);
}

/// Called before a new state replaces the whole state, on all ranks that make the new state.
void Replica::take_all() {
  gather_distributed();  // the rows also have data that the new state keeps, such as subscriptions
  is_touched_ = rows_->take_all() || may_write();
}

void Replica::replace() {
  take_all();
  is_touched_ = true;
  is_replaced_ = true;
}

void Replica::reset() {
  take_all();
  if (leads()) transport_.send_to_all(message_of(Order::reset));
}

void Replica::restart(std::uint64_t seed, std::span<const BodySpec> bodies) {
  take_all();
  if (!leads()) return;
  MessageWriter message = message_of(Order::restart);
  message.put(seed);
  for (const BodySpec& body : bodies) {
    message.put(body.pose_world_body);
    message.put(body.color);
  }
  transport_.send_to_all(std::move(message));
}

void Replica::set(const SettingSpec& setting) {
  if (!leads()) return;
  MessageWriter message = message_of(Order::set);
  message.put(world_.tick());  // the other ranks may still have the tick of an earlier state (is_touched_)
  message.put(setting.type);
  message.put(setting.of);
  message.put(setting.index);
  put_record(message, setting.params);
  transport_.send_to_all(std::move(message));
}

RankCounts Replica::own_counts() const {
  RankCounts counts = rows_->counts();
  counts.messages = transport_.traffic().messages;
  counts.bytes = transport_.traffic().bytes;
  return counts;
}

std::vector<RankCounts> Replica::all_counts() {
  std::vector<RankCounts> counts{own_counts()};  // first, so that the messages sent below do not count
  transport_.send_to_all(message_of(Order::counts));
  for (unsigned from = 1; from < ranks(); ++from)
    counts.push_back(expect(Order::counts, from).rest.get<RankCounts>());
  return counts;
}

Hashes Replica::own_hashes() {
  Hashes hashes;
  for (const StateTable& table : access_.tables()) {
    const std::uint64_t sum = hash_rows(world_.parallel(), table, rows_in(world_, table, own()));
    hashes.groups[static_cast<std::size_t>(table.group())] += sum;
    hashes.state += sum;
  }
  return hashes;
}

std::optional<Hashes> Replica::hashes() {
  if (!leads() || is_touched_) return {};
  // If rank 0 has all rows of a distributed world, it has no ghosts that could be verified.
  if (rows_->is_complete() && (!options_.verify || halo() != nullptr)) return {};
  MessageWriter question = message_of(Order::hash);
  question.put(options_.verify);
  transport_.send_to_all(std::move(question));
  Hashes sum = own_hashes();
  std::vector<std::vector<std::uint64_t>> sums(ranks());
  if (options_.verify) sums[0] = rows_->sums();
  for (unsigned from = 1; from < ranks(); ++from) {
    ReceivedOrder answer = expect(Order::hash, from);
    const auto part = answer.rest.get<Hashes>();
    sum.state += part.state;
    for (std::size_t g = 0; g < k_hash_groups; ++g) sum.groups[g] += part.groups[g];
    sums[from].resize(sums[0].size());
    answer.rest.get_bytes(std::as_writable_bytes(std::span(sums[from])));
  }
  if (options_.verify) rows_->verify(sums);
  return sum;
}

}  // namespace troupe::engine
