#include "engine/ranks/rank_border.hpp"

#include "engine/kinds/step_error.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;

void put_block(MessageWriter& message, const Conflicts::Block& block) {
  message.put(block.contact);
  message.put(block.sample);
  message.put(block.samples);
  message.put_point(block.at.position);
  message.put(block.at.rotation);
  message.put(block.z);
}

Conflicts::Block get_block(MessageReader& message) {
  Conflicts::Block block;
  block.contact = message.get<Contact>();
  block.sample = message.get<std::uint32_t>();
  block.samples = message.get<std::uint32_t>();
  block.at.position = message.get_point();
  block.at.rotation = message.get<Rotation>();
  block.z = message.get<double>();
  return block;
}

[[noreturn]] void throw_bad_message() {
  throw std::logic_error(
      "internal error: a message between ranks has the rows of other bodies; this is no error of your input: "
      "please report it");
}

}  // namespace

RankBorder::RankBorder(World& world, const RankPost& post, bool has_pushable)
    : world_(world),
      post_(post),
      has_pushable_(has_pushable),
      to_send_(post.ranks),
      to_receive_(post.ranks) {}

void RankBorder::begin_tick(const Rows& rows, double farthest) {
  rows_ = rows;
  farthest_ = farthest;
}

double RankBorder::take_pushed() { return std::exchange(pushed_, 0.0); }

std::span<const std::uint32_t> RankBorder::begin(std::span<const Motion> motions,
                                                 std::span<const std::uint32_t> order) {
  for (unsigned rank = 0; rank < post_.ranks; ++rank) {
    const std::vector<std::uint32_t>& shown = rows_.shown[rank];
    to_send_[rank].clear();
    for (std::uint32_t i = 0; i < shown.size(); ++i)
      if (motions[shown[i]].moves) to_send_[rank].push_back(i);
    to_receive_[rank] = static_cast<std::size_t>(
        std::ranges::count_if(rows_.seen[rank], [&](std::uint32_t row) { return motions[row].moves; }));
  }
  return rows_within(order, {0, rows_.own}, order_);
}

/// Exchanges one message with each rank to which this rank still has to send outcomes, or from which it still
/// has to receive some. Both ranks of such a pair count the same motions, so they send each other the same
/// number of messages. A message may contain no outcome, because the outcomes of the sender may depend on
/// those of a third rank.
bool RankBorder::exchange(Conflicts& conflicts) {
  const auto is_open = [&](unsigned rank) { return !to_send_[rank].empty() || to_receive_[rank] > 0; };
  std::vector<unsigned> active;
  for (unsigned rank = 0; rank < post_.ranks; ++rank)
    if (is_open(rank)) active.push_back(rank);
  if (active.empty()) return false;
  ++rounds_;
  for (const unsigned to : active) send_outcomes(to, conflicts);
  for (const unsigned from : active) receive_outcomes(from, conflicts);
  return std::ranges::any_of(active, is_open);
}

/// Sends the outcomes that are known and not yet sent. With pushable bodies, they are sorted by rounds, and
/// the pushes follow each outcome.
void RankBorder::send_outcomes(unsigned to, const Conflicts& conflicts) {
  MessageWriter message = post_.begin(Order::outcomes);
  const std::vector<std::uint32_t>& rows = rows_.shown[to];
  std::vector<std::uint32_t>& moving = to_send_[to];
  const auto resolved = std::stable_partition(moving.begin(), moving.end(), [&](std::uint32_t i) {
    return conflicts.outcome(rows[i]) == Conflicts::Outcome::stands;  // it moves: not yet resolved
  });
  if (has_pushable_)
    std::stable_sort(resolved, moving.end(), [&](std::uint32_t a, std::uint32_t b) {
      return conflicts.round_of(rows[a]) < conflicts.round_of(rows[b]);
    });
  for (auto i = resolved; i != moving.end(); ++i) {
    message.put(*i);
    message.put(conflicts.outcome(rows[*i]));
    if (has_pushable_) put_pushes(message, conflicts.pushes_by(rows[*i]));
  }
  moving.erase(resolved, moving.end());
  post_.send(to, std::move(message));
}

void RankBorder::receive_outcomes(unsigned from, Conflicts& conflicts) {
  ReceivedOrder received = post_.receive(Order::outcomes, from);
  const std::vector<std::uint32_t>& rows = rows_.seen[from];
  while (!received.rest.is_done()) {
    const auto i = received.rest.get<std::uint32_t>();
    const auto outcome = received.rest.get<Conflicts::Outcome>();
    if (i >= rows.size() || to_receive_[from] == 0) throw_bad_message();
    --to_receive_[from];
    if (has_pushable_) get_pushes(received.rest);
    conflicts.receive(rows[i], outcome, pushes_);
  }
}

void RankBorder::put_pushes(MessageWriter& message, std::span<const Conflicts::Push> pushes) const {
  message.put(static_cast<std::uint64_t>(pushes.size()));
  for (const Conflicts::Push& push : pushes) {
    message.put(world_.view().body(Row(push.row)));
    message.put_point(push.position);
  }
}

/// Sets pushes_ to the pushes that put_pushes() has appended, without those of bodies that have no row here.
void RankBorder::get_pushes(MessageReader& message) {
  pushes_.clear();
  for (std::size_t count = message.get_count(1); count > 0; --count) {
    const auto body = message.get_below<BodyId>(world_.spec().bodies.size());
    const Vec2 place = message.get_point();
    if (world_.view().location(body) == RowLocation::here)
      pushes_.push_back({world_.view().row(body).value, place});
  }
}

/// Each rank sends the final positions of those bodies that its own rows have pushed last. It has the rows of
/// each such body and of all pushers of the body, unless a body was pushed farther than begin_tick() allows
/// (class Halo, `pushes`). Each rank therefore also sends the longest push of its rows, so that all ranks
/// throw in that case.
void RankBorder::exchange_places(Conflicts& conflicts) {
  if (!has_pushable_) return;
  const auto pushed = [&](const Conflicts::Push& push) {
    return (push.position - world_.view().transform(Row(push.row)).position).norm();
  };
  pushed_ = 0;
  pushes_.clear();
  for (std::size_t row = 0; row < rows_.own; ++row)
    for (const Conflicts::Push& push : conflicts.pushes_by(row)) {
      pushed_ = std::max(pushed_, pushed(push));
      if (conflicts.is_last(push)) pushes_.push_back(push);
    }
  MessageWriter own = post_.begin(Order::places);
  own.put(pushed_);
  put_pushes(own, pushes_);
  post_.send_to_all(std::move(own));
  post_.receive_from_all(Order::places, [&](unsigned, MessageReader& message) {
    pushed_ = std::max(pushed_, message.get<double>());
    get_pushes(message);
    for (const Conflicts::Push& push : pushes_) conflicts.receive_place(push);
  });
  if (pushed_ > farthest_)
    throw StepError(
        fmt::format("tick {}: several robots pushed one body by {:.3g} m in one tick, too far for ranks that "
                    "divide the robots among themselves: run this world without --distribute",
                    world_.tick(), pushed_));
}

/// For each own tree that moves its joints in this round, each rank sends one byte to every rank on which the
/// tree is a ghost: whether the motion is blocked. Both ranks know which trees these are, so ranks without
/// such trees send no message.
void RankBorder::exchange_blocked(Links& links) {
  for (unsigned to = 0; to < post_.ranks; ++to) {
    std::optional<MessageWriter> message;
    for (const std::uint32_t row : rows_.shown[to]) {
      if (!links.moves_joints(Row(row))) continue;
      if (!message) message = post_.begin(Order::joints);
      message->put(static_cast<std::uint8_t>(links.is_blocked(Row(row))));
    }
    if (message) post_.send(to, *std::move(message));
  }
  for (unsigned from = 0; from < post_.ranks; ++from) {
    std::optional<ReceivedOrder> received;
    for (const std::uint32_t row : rows_.seen[from]) {
      if (!links.moves_joints(Row(row))) continue;
      if (!received) received = post_.receive(Order::joints, from);
      if (received->rest.get<std::uint8_t>() != 0) links.block(Row(row));
    }
  }
}

/// Ranks that have ghosts of each other send one message to each other: if a rank has rows in the list
/// shown[to], rank `to` has rows in the list seen[this rank].
void RankBorder::exchange_blocks(std::span<Conflicts::Block> blocks) {
  for (unsigned to = 0; to < post_.ranks; ++to) {
    const std::vector<std::uint32_t>& rows = rows_.shown[to];
    if (rows.empty()) continue;
    MessageWriter message = post_.begin(Order::blocks);
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
      if (blocks[rows[i]].sample == 0) continue;
      message.put(i);
      put_block(message, blocks[rows[i]]);
    }
    post_.send(to, std::move(message));
  }
  for (unsigned from = 0; from < post_.ranks; ++from) {
    const std::vector<std::uint32_t>& rows = rows_.seen[from];
    if (rows.empty()) continue;
    ReceivedOrder received = post_.receive(Order::blocks, from);
    while (!received.rest.is_done()) {
      const auto i = received.rest.get<std::uint32_t>();
      if (i >= rows.size()) throw_bad_message();
      blocks[rows[i]] = get_block(received.rest);
    }
  }
}

}  // namespace troupe::engine
