#include "engine/ranks/distributed_rows.hpp"

#include "engine/kinds/effects.hpp"
#include "engine/world/rank_access.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;

World& require_distributable(World& world) {
  if (const std::string reason = why_replicated(world); !reason.empty())
    throw std::logic_error(fmt::format("the rows of this world cannot be distributed: {}", reason));
  return world;
}

std::vector<std::size_t> tables_sent(std::span<const Sharing> sharing) {
  std::vector<std::size_t> sent;
  for (std::size_t t = 0; t < sharing.size(); ++t)
    if (sharing[t] == Sharing::sent) sent.push_back(t);
  return sent;
}

bool reports_joints(const World& world) {
  return std::ranges::any_of(world.view().types(), [](const BodyType& type) {
    return std::ranges::any_of(type.joint_devices, [&](std::size_t device) {
      return type.devices[device].kind->joints_moved != nullptr;
    });
  });
}

[[noreturn]] void throw_collective() {
  throw std::logic_error(
      "internal error: a controller decides for the robots of all ranks, but the world is distributed; "
      "this is no error of your input: please report it");
}

}  // namespace

DistributedRows::DistributedRows(World& world, RankAccess& access, std::span<const Sharing> sharing,
                                 RankPost post, std::optional<std::uint64_t> cut_seed,
                                 std::optional<double> skin_m)
    : world_(require_distributable(world)),
      access_(access),
      links_(access.links()),
      post_(std::move(post)),
      reports_joints_(reports_joints(world)),
      halo_(world, access, tables_sent(sharing), post_, cut_seed, skin_m),
      effects_(world, halo_, access.effects(), post_) {
  for (const Sharing each : sharing) is_known_.push_back(each != Sharing::kept);
  halo_.divide();
}

// ---- All rows on rank 0

bool DistributedRows::take_all() {
  leads() ? halo_.own_all() : halo_.own_none();
  return leads();
}

/// Appends the data that belong to no row: the tick, and the numbers of births (RankAccess::births()).
/// redistribute() sends the rows later.
void DistributedRows::put_all(MessageWriter& message) {
  message.put(world_.tick());
  message.put_bytes(std::as_bytes(access_.births()));
  halo_.own_all();
  is_on_rank_0_ = true;
}

void DistributedRows::adopt_all(MessageReader message, bool is_in_tick) {
  halo_.own_none();
  access_.adopt(
      message.get<std::uint64_t>(), [](std::span<StateTable>) {}, is_in_tick);
  std::vector<std::uint32_t> births(access_.births().size());
  message.get_bytes(std::as_writable_bytes(std::span(births)));
  access_.set_births(births);
  is_on_rank_0_ = true;
}

// ---- The tick

/// Leaves on each rank only its own rows and its ghosts. Distributes the rows if rank 0 has all of them, if
/// bodies were born or have died while they carried others (must_distribute_), if bodies have jumped or were
/// pushed far, or if a device now has a longer reach (World::set()) than the ghosts cover.
void DistributedRows::redistribute(bool have_jumped) {
  const bool have_changed = std::exchange(must_distribute_, false);
  const bool must_distribute =
      std::exchange(is_on_rank_0_, false) || have_changed || have_jumped || halo_.lacks_ghosts();
  if (!must_distribute && leads() && halo_.is_complete()) halo_.forget_completion();
  if (must_distribute || world_.interventions().settings().longest_reach() > halo_.reach())
    halo_.distribute(0);
}

void DistributedRows::add_candidates(std::vector<Candidate>& candidates) {
  MessageWriter own = post_.begin(Order::candidates);
  for (const Candidate& candidate : candidates) {
    own.put(candidate.key);
    own.put(candidate.body);
  }
  post_.send_to_all(std::move(own));
  post_.receive_from_all(Order::candidates, [&](unsigned, MessageReader& message) {
    while (!message.is_done()) {
      Candidate& candidate = candidates.emplace_back();
      candidate.key = message.get<std::uint64_t>();
      candidate.body = message.get_below<BodyId>(world_.spec().bodies.size());
    }
  });
}

bool DistributedRows::on_any_rank(bool own) { return post_.agree(Order::moves, own, std::logical_or()); }

void DistributedRows::put_rows_of(unsigned, MessageWriter&) const { throw_collective(); }
void DistributedRows::get_rows_of(unsigned, MessageReader&) { throw_collective(); }

RankRows::Messages DistributedRows::written(const MessageWriter& head) {
  longest_ = halo_.longest_motion();
  has_asked_ = links_.has_asked();
  effects_.note();
  Messages messages(post_.ranks);
  for (unsigned to = 0; to < post_.ranks; ++to) {
    if (to == post_.rank) continue;
    MessageWriter message = head;
    message.put(longest_);
    if (reports_joints_) message.put(static_cast<std::uint8_t>(has_asked_));
    halo_.put_shown(to, message);
    effects_.put(message);
    messages[to] = std::make_shared<const partition::Message>(message.take());
  }
  return messages;
}

void DistributedRows::get_written(unsigned from, MessageReader& message) {
  longest_ = std::max(longest_, message.get<double>());
  if (reports_joints_ && message.get<std::uint8_t>() != 0) has_asked_ = true;
  halo_.get_seen(from, message);
  effects_.get(message);
}

bool DistributedRows::prepare_motions(std::span<const std::uint64_t> times) {
  if (!times.empty()) halo_.balance(times);
  const bool lacks_rows = effects_.find_targets();
  const std::uint64_t distributions = halo_.counts().distributions;
  halo_.prepare_motions(longest_, !times.empty() || lacks_rows, effects_.guests());
  effects_.begin(halo_.counts().distributions != distributions);
  return !times.empty();
}

/// The rows of a device are on some ranks only, so a hook may throw on these ranks alone. If no device has
/// the hook, and in a tick without joint motions, no hook is called. Without the hook, has_asked_ may differ
/// between ranks.
void DistributedRows::report_joints(const std::function<void()>& work) {
  if (!reports_joints_ || !has_asked_) return work();
  links_.raise_asked();  // the hook also runs for bodies of a rank on which no joint moves
  error_.attempt(post_.rank, work);
  error_.agree(post_);
}

void DistributedRows::apply_effects(std::span<const Effect> effects,
                                    const std::function<void(const Effect&)>& apply) {
  effects_.apply(effects, apply);
  // When a body dies, it releases the bodies that it carries, which then are trees of their own at other
  // places. The ghosts may not suffice for these places (Halo::suffices_for()).
  const auto is_death = [](const Effect& effect) { return effect.verb == k_death; };
  if (!halo_.has_trees() || std::ranges::none_of(effects, is_death)) return;
  const bool own = std::ranges::any_of(
      effects, [&](const Effect& effect) { return is_death(effect) && halo_.has_cargo(effect.target); });
  const bool any = post_.agree(Order::effects, own, std::logical_or());
  must_distribute_ = must_distribute_ || any;
}

// ---- Births

std::uint32_t DistributedRows::lowest_trial(std::uint32_t own, std::uint32_t trials) {
  const std::uint32_t lowest =
      post_.agree(Order::births, own, [](std::uint32_t a, std::uint32_t b) { return std::min(a, b); });
  must_distribute_ = must_distribute_ || lowest < trials;
  return lowest;
}

/// All ranks make the same calls in the same order. A call therefore has the same number, attempts_, on all
/// ranks, as SharedError::attempt() requires.
void DistributedRows::attempt(const std::function<void()>& work) { error_.attempt(attempts_++, work); }

void DistributedRows::end_attempts() {
  attempts_ = 0;
  error_.agree(post_);
}

// ---- Verification

/// Returns two sums for each rank r: at index 2 r Halo::hash_shown(r), at 2 r + 1 Halo::hash_seen(r).
std::vector<std::uint64_t> DistributedRows::sums() const {
  std::vector<std::uint64_t> sums;
  for (unsigned rank = 0; rank < post_.ranks; ++rank) {
    sums.push_back(halo_.hash_shown(rank, is_known_));
    sums.push_back(halo_.hash_seen(rank, is_known_));
  }
  return sums;
}

/// Throws if, for any pair of ranks, the ghosts on one rank differ from the rows of the other rank of which
/// they are copies.
void DistributedRows::verify(std::span<const std::vector<std::uint64_t>> sums) const {
  for (unsigned a = 0; a < post_.ranks; ++a)
    for (unsigned b = 0; b < post_.ranks; ++b)
      if (sums[a][2 * b] != sums[b][2 * a + 1])
        throw std::logic_error(
            fmt::format("internal error: after tick {2}, the copies on rank {0} of bodies that rank {1} "
                        "computes differ from the originals; if the world uses no plug-in, please report it",
                        b, a, world_.tick()));
}

}  // namespace troupe::engine
