#pragma once

#include "engine/state/world_state.hpp"
#include "partition/parallel.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

/// The loops over the rows of a world, which the phases of a tick (time step) use. A row is the index of a
/// body in the state tables. A drop-out fault is a random failure that stops all devices, controllers and the
/// drive of a robot. The argument `rows` of the callbacks is a std::span<const Row>, valid during the call.

namespace troupe::engine {

// A task (one call in a parallel loop) has many rows, so that it is worth waking a thread.
inline constexpr std::size_t k_near_batch = 64;  ///< most rows per task of for_neighbours()
inline constexpr std::size_t k_row_block = 256;  ///< most rows per task of for_blocks()
/// Tasks per thread of for_neighbours(), if there are enough rows. With fewer tasks, threads would wait for
/// the thread that got the longest tasks.
inline constexpr std::size_t k_near_tasks_per_thread = 4;

/// Sorts `rows`, of which there are at most k_row_block, by body type. Then calls work(rows, type) once for
/// each type that occurs, with all rows of that type and the BodyType, in ascending order of the index of the
/// type. Rows of one type keep their order. Without rows there is no call.
template <class Work>
void for_types(const WorldState& state, std::span<Row> rows, Work&& work) {
  const auto type_of = [&](Row row) { return state.row_types[row.index()]; };
  if (!std::ranges::all_of(rows, [&](Row row) { return type_of(row) == type_of(rows.front()); })) {
    // Sorts the rows by type. The sort is stable, so that neighbours, which read the same data, stay
    // together.
    std::array<Row, k_row_block> mixed;
    std::ranges::copy(rows, mixed.begin());
    std::size_t done = 0;
    for (std::uint32_t type = 0; done < rows.size();) {
      std::uint32_t next = ~0u;
      for (const Row row : std::span(mixed).first(rows.size())) {
        const std::uint32_t t = type_of(row);
        if (t == type) rows[done++] = row;
        if (t > type) next = std::min(next, t);
      }
      type = next;
    }
  }
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i + 1;
    while (end < rows.size() && type_of(rows[end]) == type_of(rows[i])) ++end;
    work(std::span<const Row>(rows.subspan(i, end - i)), state.types[type_of(rows[i])]);
    i = end;
  }
}

/// Calls work(rows, type) in parallel for batches of at most k_near_batch rows. The rows of a batch are of
/// one type and near one another in the world. This loop is for work that reads the neighbours of a row:
/// their data are then likely to be in the CPU cache.
///
/// order: the rows, in an order in which bodies that are near one another in the world follow one another.
/// BodyIndex::order() is such an order; it lists only bodies in the world. If `order` is empty, there is no
/// call
/// least: smallest number of rows whose work takes long enough to be worth waking a thread, at least 1. If
/// there are few rows for the number of threads, batches have fewer than k_near_batch rows, but not fewer
/// than `least`
template <class Work>
void for_neighbours(const WorldState& state, partition::Parallel& parallel,
                    std::span<const std::uint32_t> order, std::size_t least, Work&& work) {
  std::size_t batches = (order.size() + k_near_batch - 1) / k_near_batch;
  if (parallel.threads() > 1)
    batches = std::max(batches, std::min(order.size() / least, k_near_tasks_per_thread * parallel.threads()));
  parallel.for_each(batches, [&](std::size_t b) {
    // Batches of nearly equal size: a short last one would not be worth waking a thread.
    const std::size_t first = order.size() * b / batches;
    const std::size_t count = order.size() * (b + 1) / batches - first;
    std::array<Row, k_near_batch> rows;
    for (std::size_t i = 0; i < count; ++i) rows[i] = Row(order[first + i]);
    for_types(state, {rows.data(), count}, work);
  });
}

/// Calls work(rows, type) in parallel for batches of at most k_row_block rows of `range`. The rows of a batch
/// are of one type and from one block of consecutive rows, so that memory is read sequentially. This loop is
/// for work that does not read the neighbours of a row. Rows whose bodies are not in the world (not yet born,
/// or dead) are left out.
template <class Work>
void for_blocks(const WorldState& state, partition::Parallel& parallel, RowRange range, Work&& work) {
  const std::size_t row_count = range.end - range.first;
  const std::size_t blocks = (row_count + k_row_block - 1) / k_row_block;
  parallel.for_each(blocks, [&](std::size_t b) {
    const std::size_t first = range.first + row_count * b / blocks;
    const std::size_t count = range.first + row_count * (b + 1) / blocks - first;
    std::array<Row, k_row_block> rows;
    std::size_t there = 0;
    for (std::size_t i = 0; i < count; ++i)
      if (const Row row(first + i); state.view.is_there(row)) rows[there++] = row;
    for_types(state, {rows.data(), there}, work);
  });
}

/// Calls for_blocks() above for the range of all rows of the world.
template <class Work>
void for_blocks(const WorldState& state, partition::Parallel& parallel, Work&& work) {
  for_blocks(state, parallel, {0, state.row_count()}, work);
}

/// Calls work(rows) for those of `rows` that are due in the present tick, once for each sequence of due rows
/// without a gap in `rows`. A row is due if the age of its body is a multiple of `period`, which is at least
/// 1. The age is the number of ticks since the birth of the body, or since tick 0 if the body was present
/// then. In a world without births, either all rows are due or none. If `rows` is empty, work() may be called
/// once with an empty span.
template <class Work>
void for_due(const WorldState& state, std::span<const Row> rows, std::uint64_t period, Work&& work) {
  if (period == 1 || !state.life_table) {
    if (state.now.tick % period == 0) work(rows);
    return;
  }
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i;
    while (end < rows.size() && (state.now.tick - state.view.birth_tick(rows[end])) % period == 0) ++end;
    if (end > i) work(rows.subspan(i, end - i));
    i = end + 1;
  }
}

/// Calls work(rows) for those of `rows` whose device runs in the present tick, once for each sequence of such
/// rows without a gap in `rows`. All rows must be of the type of the device. The device of a row runs if all
/// of these hold: it is due (its period divides the age of the body, as in for_due()); it is active (a
/// controller uses it, or the world file makes it active: BodyType::Device::active), or World::subscribe()
/// was called for the body; it is switched on, is not broken and has power; its body is neither disabled nor
/// stopped by a drop-out fault (CommittedView::runs()).
template <class Work>
void for_running(const WorldState& state, std::span<const Row> rows, const BodyType::Device& device,
                 Work&& work) {
  for_due(state, rows, device.period, [&](std::span<const Row> due_rows) {
    if (device.active && !device.supply && device.switch_bit == 0 && state.now.impaired == 0)
      return work(due_rows);
    for (std::size_t i = 0; i < due_rows.size();) {
      std::size_t end = i;
      while (end < due_rows.size() && state.view.runs(due_rows[end], device)) ++end;
      if (end > i) work(due_rows.subspan(i, end - i));
      i = end + 1;
    }
  });
}

/// Calls work(rows) once, for those of `rows` whose bodies are neither disabled nor stopped by a drop-out
/// fault, in the same order. If there are none, the span is empty. `rows` has at most k_row_block rows.
template <class Work>
void for_enabled(const WorldState& state, std::span<const Row> rows, Work&& work) {
  if (state.now.impaired == 0) return work(rows);
  std::array<Row, k_row_block> enabled;
  std::size_t count = 0;
  for (const Row row : rows)
    if (state.condition(row).out == 0) enabled[count++] = row;
  work(std::span<const Row>(enabled).first(count));
}

}  // namespace troupe::engine
