#pragma once

#include "engine/state/world_state.hpp"
#include "partition/parallel.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

/// Loops over the rows of a world, which the phases of a tick (time step) use. A row is the index of a body
/// in the state tables. The loops call work(), a function that the caller passes. Its argument `rows` is a
/// std::span<const Row>, which is valid only during the call.
///
/// A body is *disabled* if an intervention or a program has stopped it, and *dropped out* if a fault (a
/// random failure) has stopped it. The devices, controllers and drive of such a body do not run.

namespace troupe::engine {

// A task (one call in a parallel loop) has many rows, so that it is worth waking a thread.
inline constexpr std::size_t k_near_batch = 64;  ///< most rows per task of for_neighbours()
inline constexpr std::size_t k_row_block = 256;  ///< most rows per task of for_blocks()
/// Tasks per thread of for_neighbours(), if there are enough rows. With fewer tasks, threads would wait for
/// the thread that got the longest tasks.
inline constexpr std::size_t k_near_tasks_per_thread = 4;

/// Sorts `rows` by type, in ascending order of TypeId. Rows of one type keep their order, so that neighbours,
/// which read the same data, stay together. The time depends on the number of rows, not on that of types.
/// `rows` may have at most k_row_block elements.
void sort_by_type(const WorldState& state, std::span<Row> rows);

/// Calls work(rows, type) once for each body type that occurs in `rows`, with all rows of that type; `type`
/// is the BodyType. The types come in ascending order of their TypeId. Rows of one type keep their order. If
/// `rows` is empty, there is no call. The function sorts `rows` in place by type. `rows` may have at most
/// k_row_block elements.
template <class Work>
void for_types(const WorldState& state, std::span<Row> rows, Work&& work) {
  const auto type_of = [&](Row row) { return state.row_types[row.index()]; };
  if (!std::ranges::all_of(rows, [&](Row row) { return type_of(row) == type_of(rows.front()); }))
    sort_by_type(state, rows);
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i + 1;
    while (end < rows.size() && type_of(rows[end]) == type_of(rows[i])) ++end;
    work(std::span<const Row>(rows.subspan(i, end - i)), state.types[type_of(rows[i])]);
    i = end;
  }
}

/// Calls work(rows, type) in parallel. Each task of the parallel loop handles at most k_near_batch
/// consecutive elements of `order`. A task calls work() once for each body type among its rows, as
/// for_types() does. Use this loop for work that reads the neighbours of a row: consecutive rows of `order`
/// are near one another in the world, so the data of their neighbours are likely to be in the CPU cache.
///
/// order   the rows, in an order in which bodies that are near one another in the world follow one another.
///         BodyIndex::order() is such an order; it lists only bodies in the world. If `order` is empty, there
///         is no call
/// least   number of rows whose work takes long enough to be worth waking a thread, at least 1. If `order`
///         has too few rows to give all threads full tasks, the tasks are made smaller, but not smaller than
///         `least`
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

/// Calls work(rows, type) in parallel for the rows of `range` whose bodies are in the world. Rows of bodies
/// that are not yet born or are dead are left out. Each task of the parallel loop handles at most k_row_block
/// consecutive rows, so that it reads memory sequentially. A task calls work() once for each body type among
/// its rows, as for_types() does. Use this loop for work that does not read the neighbours of a row.
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

/// Calls for_blocks() above for all rows of the world.
template <class Work>
void for_blocks(const WorldState& state, partition::Parallel& parallel, Work&& work) {
  for_blocks(state, parallel, {0, state.row_count()}, work);
}

/// Calls work(rows) for those of `rows` that are due in the present tick. Consecutive due rows are passed in
/// one call: if only the third of five rows is not due, there are two calls with two rows each. If `rows` is
/// empty, work() is called once with an empty span, or not at all.
///
/// A row is due if the age of its body is a multiple of `period` (ticks, at least 1). The age is the number
/// of ticks since the birth of the body, or since tick 0 if the body was present then.
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

/// Calls work(rows) for those of `rows` whose device runs in the present tick. Consecutive rows whose device
/// runs are passed in one call, as in for_due(). All rows must be of the type that `device` belongs to.
///
/// The device of a row runs if all of these hold:
/// - It is due: see for_due() with the period of the device.
/// - It is in use: a controller uses it or the world file makes it active (BodyType::Device::active), or
///   World::subscribe() was called for the body.
/// - It is switched on, has power, and is not broken by a fault.
/// - Its body is neither disabled nor dropped out.
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

/// Calls work(rows) once, with those of `rows` whose bodies are neither disabled nor dropped out, in the same
/// order. The span is empty if there are no such rows. `rows` may have at most k_row_block elements.
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
