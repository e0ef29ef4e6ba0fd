#include "engine/ranks/replicated_rows.hpp"

#include "base/random.hpp"
#include "engine/kinds/effects.hpp"
#include "engine/links/links.hpp"
#include "engine/world/rank_access.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

namespace troupe::engine {
namespace {

using partition::MessageReader;
using partition::MessageWriter;

Cut equal_cut(std::size_t rows, unsigned ranks) {
  Cut cut;
  for (std::size_t r = 0; r <= ranks; ++r) cut.push_back(static_cast<std::uint32_t>(rows * r / ranks));
  return cut;
}

}  // namespace

Cut balanced_cut(const Cut& cut, std::span<const std::uint64_t> times) {
  const std::size_t ranks = times.size();
  const auto rows = [&](std::size_t rank) { return cut[rank + 1] - cut[rank]; };
  double total = 0;
  for (std::size_t rank = 0; rank < ranks; ++rank)
    if (rows(rank) > 0) total += static_cast<double>(times[rank]);
  if (!(total > 0)) return cut;
  Cut balanced(ranks + 1, cut.back());
  balanced[0] = 0;
  double before = 0;  // time of the ranks before `rank`
  std::size_t rank = 0;
  for (std::size_t next = 1; next < ranks; ++next) {
    const double wanted = total * static_cast<double>(next) / static_cast<double>(ranks);
    const auto time = [&] { return rows(rank) > 0 ? static_cast<double>(times[rank]) : 0.0; };
    while (rank + 1 < ranks && before + time() < wanted) before += time(), ++rank;
    const double part = time() > 0 ? std::min(1.0, (wanted - before) / time()) : 0.0;
    balanced[next] = cut[rank] + static_cast<std::uint32_t>(std::lround(part * rows(rank)));
  }
  return balanced;
}

ReplicatedRows::ReplicatedRows(World& world, RankAccess& access, std::span<const Sharing> sharing,
                               RankPost post, std::optional<std::uint64_t> cut_seed)
    : world_(world),
      access_(access),
      sharing_(sharing),
      post_(std::move(post)),
      cut_seed_(cut_seed),
      cut_(equal_cut(world.view().rows(), post_.ranks)) {}

/// For each table with this sharing, calls visit(bytes) with the table rows of the bodies that have the rows
/// `rows` in the world. These table rows are contiguous. If there are none, visit() is not called.
template <class Visit>
void ReplicatedRows::for_rows(Sharing sharing, const RowRange& rows, Visit&& visit) const {
  for (std::size_t t = 0; t < access_.tables().size(); ++t) {
    if (sharing_[t] != sharing) continue;
    StateTable& table = access_.tables()[t];
    const RowRange in = rows_in(world_, table, rows);
    if (in.first < in.end) visit(std::span(table.row(in.first), table.row(in.end)));
  }
}

void ReplicatedRows::put_rows(Sharing sharing, const RowRange& rows, MessageWriter& message) const {
  for_rows(sharing, rows, [&](std::span<std::byte> bytes) { message.put_bytes(bytes); });
}

void ReplicatedRows::get_rows(Sharing sharing, const RowRange& rows, MessageReader& message) {
  for_rows(sharing, rows, [&](std::span<std::byte> bytes) { message.get_bytes(bytes); });
}

// ---- All rows on rank 0

void ReplicatedRows::put_missing(MessageWriter& message) const { put_rows(Sharing::kept, own(), message); }

void ReplicatedRows::complete(std::span<ReceivedOrder> messages) {
  for (unsigned from = 1; from < post_.ranks; ++from)
    get_rows(Sharing::kept, rows_of(from), messages[from - 1].rest);
  is_complete_ = true;
}

bool ReplicatedRows::take_all() {
  is_complete_ = true;
  return false;
}

/// Appends the tick, the subscriptions (World::subscribe()) and all state tables.
void ReplicatedRows::put_all(MessageWriter& message) {
  message.put(world_.tick());
  message.put_all(std::span<const BodyId>(world_.view().subscribed()));
  for (StateTable& table : access_.tables()) message.put_bytes(table.data());
}

void ReplicatedRows::adopt_all(MessageReader message, bool is_in_tick) {
  const auto tick = message.get<std::uint64_t>();
  for (const BodyId body : message.get_all<BodyId>()) {
    message.require(body.index() < world_.spec().bodies.size() &&
                    world_.view().location(body) == RowLocation::here);
    world_.subscribe(body);
  }
  access_.adopt(
      tick,
      [&](std::span<StateTable> tables) {
        for (StateTable& table : tables) message.get_bytes(table.data());
      },
      is_in_tick);
}

// ---- The tick

/// Appends the table rows of `rank` whose present values other ranks lack at the end of the phase decide:
/// those in tables with Sharing::kept or Sharing::sent.
void ReplicatedRows::put_rows_of(unsigned rank, MessageWriter& message) const {
  for (const Sharing sharing : {Sharing::kept, Sharing::sent}) put_rows(sharing, rows_of(rank), message);
}

void ReplicatedRows::get_rows_of(unsigned rank, MessageReader& message) {
  for (const Sharing sharing : {Sharing::kept, Sharing::sent}) get_rows(sharing, rows_of(rank), message);
}

RankRows::Messages ReplicatedRows::written(const MessageWriter& head) {
  MessageWriter message = head;
  message.reserve(written_);
  put_rows(Sharing::sent, own(), message);
  message.put_all(std::span<const Links::AskedGoal>(access_.links().asked_goals(own())));
  message.put_all(access_.effects().emitted());
  written_ = message.size();
  return Messages(post_.ranks, std::make_shared<const partition::Message>(message.take()));
}

void ReplicatedRows::get_written(unsigned from, MessageReader& message) {
  get_rows(Sharing::sent, rows_of(from), message);
  for (std::size_t left = message.get_count(sizeof(Links::AskedGoal)); left > 0; --left) {
    const auto [row, joint, goal] = message.get<Links::AskedGoal>();
    message.require(row < world_.view().rows() && joint < world_.view().type(Row(row)).joints.size());
    access_.links().ask(Row(row), joint, goal);
  }
  for (std::size_t left = message.get_count(sizeof(Effect)); left > 0; --left)
    access_.effects().emit(get_effect(message, world_));
  if (!message.is_done())
    throw std::logic_error(
        "internal error: a message between ranks is too long; this is no error of your input: please report "
        "it");
}

/// Gives rows to other ranks if the ranks take unequal times or, for tests, at random. All ranks have the
/// same times, so they compute the same cut.
bool ReplicatedRows::prepare_motions(std::span<const std::uint64_t> times) {
  is_complete_ = false;
  ++counts_.ticks;
  counts_.own += own().end - own().first;
  if (cut_seed_) adopt_cut(random_cut());
  if (times.empty()) return false;
  Cut cut = balanced_cut(cut_, times);
  const bool is_new = cut != cut_;
  adopt_cut(std::move(cut));
  return is_new;
}

Cut ReplicatedRows::random_cut() const {
  Random random(*cut_seed_, 0, 0, static_cast<std::uint32_t>(world_.tick()));
  const auto rows = static_cast<std::uint32_t>(world_.view().rows());
  Cut cut{0};
  for (unsigned r = 1; r < post_.ranks; ++r) cut.push_back(random.below(rows + 1));
  cut.push_back(rows);
  std::ranges::sort(cut);
  return cut;
}

/// Replaces the cut. For each row that gets another owner, the old owner sends the new one its rows in the
/// tables with Sharing::kept. The new owner already has the present values in all other tables.
void ReplicatedRows::adopt_cut(Cut cut) {
  const Cut before = std::exchange(cut_, std::move(cut));
  const auto common = [](const Cut& a, unsigned i, const Cut& b, unsigned j) {
    return RowRange{std::max(a[i], b[j]), std::min(a[i + 1], b[j + 1])};
  };
  const unsigned own = post_.rank;
  for (unsigned to = 0; to < post_.ranks; ++to) {
    const RowRange rows = common(before, own, cut_, to);
    if (to == own || rows.first >= rows.end) continue;
    MessageWriter message = post_.begin(Order::exchange);
    put_rows(Sharing::kept, rows, message);
    post_.send(to, std::move(message));
  }
  for (unsigned from = 0; from < post_.ranks; ++from) {
    const RowRange rows = common(before, from, cut_, own);
    if (from == own || rows.first >= rows.end) continue;
    ReceivedOrder received = post_.receive(Order::exchange, from);
    get_rows(Sharing::kept, rows, received.rest);
  }
}

void ReplicatedRows::apply_effects(std::span<const Effect> effects,
                                   const std::function<void(const Effect&)>& apply) {
  std::ranges::for_each(effects, apply);
}

// ---- Verification

/// Returns the hashes of the tables that must be equal on all ranks: those with Sharing::alike or
/// Sharing::sent.
std::vector<std::uint64_t> ReplicatedRows::sums() const {
  std::vector<std::uint64_t> sums;
  for (std::size_t t = 0; t < sharing_.size(); ++t)
    if (const StateTable& table = access_.tables()[t]; sharing_[t] != Sharing::kept)
      sums.push_back(hash_rows(world_.parallel(), table, {0, table.rows()}));
  return sums;
}

void ReplicatedRows::verify(std::span<const std::vector<std::uint64_t>> sums) const {
  for (unsigned from = 1; from < post_.ranks; ++from) {
    std::size_t sum = 0;
    for (std::size_t t = 0; t < sharing_.size(); ++t) {
      if (sharing_[t] == Sharing::kept) continue;
      if (sums[from][sum] != sums[0][sum])
        throw std::logic_error(
            fmt::format("internal error: the tables \"{}\" of ranks 0 and {} differ after tick {}; unless a "
                        "plug-in caused this, it is no error of your input: please report it",
                        access_.tables()[t].component(), from, world_.tick()));
      ++sum;
    }
  }
}

}  // namespace troupe::engine
