#include "engine/conflicts/conflicts.hpp"

#include "base/capacity.hpp"
#include "engine/conflicts/conflict_resolver.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>

namespace troupe::engine {
namespace {

constexpr std::size_t k_batch = 128;  // rows per task
// Rows per task in loops that compute little per row.
constexpr std::size_t k_large_batch = 512;
// Rows per task in the rounds after the first. In these rounds few rows are left, and a row in which bodies
// are pushed can take some ten microseconds: with larger tasks, most threads would have none.
constexpr std::size_t k_waiting_batch = 16;
constexpr std::uint32_t k_last_round = 1u << 29;  // Resolution stores a round and an outcome in 32 bits

}  // namespace

void Conflicts::reserve(std::size_t rows, std::size_t most_pushes, const Pushables& pushables) {
  resize_with_capacity(resolutions_, rows);
  if (pushables.any()) {
    resize_with_capacity(zones_, rows);
    resize_with_capacity(pushes_of_, rows);
    resize_with_capacity(pushed_last_, rows);
    pushes_.resize(std::max(pushes_.size(), most_pushes));
  }
  if (const std::size_t room = capacity_for(rows, reserved_); room != reserved_) {
    reserved_ = room;
    waiting_ = std::make_unique_for_overwrite<Waiting[]>(room);
    still_waiting_ = std::make_unique_for_overwrite<Waiting[]>(room);
    others_ = std::make_unique_for_overwrite<Dependency[]>(2 * room);
  }
}

void Conflicts::forget() {
  constexpr std::uint32_t k_junk = 0x5a5a5a5a;
  base_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(base_ + rounds_, k_last_round));
  rounds_ = 0;
  std::ranges::fill(resolutions_, Resolution(base_, Outcome::out_of_bounds));
  longest_ = std::numeric_limits<double>::quiet_NaN();
  far_.fill(k_junk);
  std::fill_n(waiting_.get(), reserved_, Waiting{k_junk, k_junk, k_junk});
  std::fill_n(still_waiting_.get(), reserved_, Waiting{k_junk, k_junk, k_junk});
  std::fill_n(others_.get(), 2 * reserved_, Dependency(k_junk / 2, true));
  std::ranges::fill(zones_, Zone::may_push);
  std::ranges::fill(pushes_of_, PushesOf{k_junk, k_junk});
  std::ranges::fill(pushes_, Push{k_junk, Vec2::Constant(longest_)});
  std::ranges::fill(pushed_last_, 0u);
  push_count_ = 0;
}

void Conflicts::resolve(const Crowd& crowd, const partition::StaticScene& scene,
                        const partition::BodyIndex& index, partition::Parallel& parallel, Border* border) {
  const std::size_t rows = crowd.motions.size();
  for (const Push& push : pushes()) pushed_last_[push.row] = 0;
  push_count_ = 0;
  // After the loop, which may need more rows than there are now. Each row may get a place from another rank.
  reserve(rows, crowd.pushables.most + (border ? rows : 0), crowd.pushables);
  std::ranges::fill(crowd.blocks, Block());
  if (base_ + rounds_ > k_last_round) {
    std::ranges::fill(resolutions_, Resolution());
    base_ = 0;
    rounds_ = 0;
  }
  base_ += static_cast<std::uint32_t>(rounds_);
  // After an exception, the next call must not take outcomes of this call for its own: it forgets them all.
  rounds_ = k_last_round + 1;
  Resolver resolver(*this, crowd, scene, index);
  parallel.for_batches(rows, k_large_batch,
                       [&](std::size_t first, std::size_t end) { resolver.bound_motions(first, end); });
  resolver.finish_bounds();
  const std::span<const std::uint32_t> order =
      border ? border->begin(crowd.motions, index.order()) : index.order();
  if (crowd.pushables.any()) {
    parallel.for_batches(rows, k_large_batch,
                         [&](std::size_t first, std::size_t end) { resolver.bound_zones(first, end); });
    const std::span<const std::uint32_t> all = index.order();  // ghosts too, for widen_zone()
    parallel.for_batches(all.size(), k_batch, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) resolver.find_zone(all[i]);
    });
    parallel.for_batches(order.size(), k_batch, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) resolver.widen_zone(order[i]);
    });
    parallel.for_batches(order.size(), k_batch, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i)
        resolver.is_plain(order[i]) ? resolver.propose_and_check(order[i])
                                    : resolver.propose_and_check_in_zone(order[i]);
    });
  } else {
    parallel.for_batches(order.size(), k_batch, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) resolver.propose_and_check(order[i]);
    });
  }
  if (border)
    finish_with(*border, resolver, parallel);
  else
    while (const std::size_t waiting = resolver.next_round()) resolve_waiting(waiting, resolver, parallel);
  if (!crowd.blocks.empty())
    parallel.for_batches(order.size(), k_batch, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) resolver.explain(order[i]);
    });
  if (border) border->exchange_places(*this);  // changes the places of pushes, which explain() reads
  rounds_ = resolver.round() - base_ - 1;
  for (const Push& push : pushes())
    longest_ = std::max(longest_, (push.position - crowd.transforms[push.row].position).norm());
}

/// Computes a round after the first, in which `waiting` rows wait.
void Conflicts::resolve_waiting(std::size_t waiting, Resolver& resolver, partition::Parallel& parallel) {
  parallel.for_batches(waiting, k_waiting_batch, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) resolver.resolve_waiting(waiting_[i]);
  });
  std::swap(waiting_, still_waiting_);
}

/// Computes the rounds after the first if there are ghosts. A row that depends on a ghost waits until the
/// rank that owns the ghost has sent the outcome of the ghost. The exchanges end, because at any time some
/// rank can resolve a row: of all rows that wait on any rank, the one with the highest priority depends only
/// on rows that are already resolved, and its rank resolves it as soon as it has received their outcomes.
void Conflicts::finish_with(Border& border, Resolver& resolver, partition::Parallel& parallel) {
  std::size_t waiting = resolver.next_round();
  bool has_ghosts_left = true;
  while (waiting > 0 || has_ghosts_left) {
    const std::size_t before = waiting;
    if (waiting > 0) {
      resolve_waiting(waiting, resolver, parallel);
      waiting = resolver.next_round();
    }
    if (waiting > 0 && waiting < before) continue;
    if (!has_ghosts_left && waiting > 0)
      throw std::logic_error(
          "internal error: motions depend on one another in a circle; this is no error of your input: please "
          "report it");
    received_round_ = resolver.round() - base_ - 1;
    if (has_ghosts_left) has_ghosts_left = border.exchange(*this);
  }
}

void Conflicts::receive(std::uint32_t row, Outcome outcome, std::span<const Push> pushes) {
  resolutions_[row] = {base_ + received_round_, outcome};
  if (zones_.empty()) return;
  zones_[row] = Zone::may_push;  // not plain, so that movers of lower priority look for its pushes
  pushes_of_[row] = {static_cast<std::uint32_t>(push_count_), static_cast<std::uint32_t>(pushes.size())};
  for (const Push& push : pushes) {
    pushes_[push_count_] = push;
    pushed_last_[push.row] = static_cast<std::uint32_t>(++push_count_);
  }
}

void Conflicts::receive_place(const Push& push) {
  std::uint32_t& last = pushed_last_[push.row];
  if (last == 0) {
    pushes_[push_count_].row = push.row;
    last = static_cast<std::uint32_t>(++push_count_);
  }
  pushes_[last - 1].position = push.position;
}

}  // namespace troupe::engine
