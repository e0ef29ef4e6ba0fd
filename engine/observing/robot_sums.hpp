#pragma once

#include "base/exact_sum.hpp"
#include "engine/rows/measured_world.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace troupe::engine {

/// Returns how many of the bodies are in the world, that is, neither unborn nor dead. No body may be static.
inline std::size_t count_there(const MeasuredWorld& world, std::span<const BodyId> bodies) {
  if (world.absent_count() == 0) return bodies.size();
  return static_cast<std::size_t>(
      std::ranges::count_if(bodies, [&](BodyId body) { return world.is_there(world.row(body)); }));
}

/// Returns the sum term(0) + ... + term(count - 1), computed exactly and then rounded to double; 0 if `count`
/// is 0. The result depends on neither the number of threads nor the order of the terms. The worker threads
/// of the world call term(i), so it must be thread-safe. Call this between two steps.
template <class Term>
double exact_sum(const MeasuredWorld& world, std::size_t count, Term&& term) {
  constexpr std::size_t k_block = 1024;
  // Reused, because stop conditions call this in every step. It is empty during the call, because term() may
  // compute a sum of another world.
  thread_local std::vector<ExactSum> kept;
  std::vector<ExactSum> memory = std::move(kept);
  memory.assign((count + k_block - 1) / k_block, ExactSum());
  const std::span<ExactSum> sums = memory;
  world.parallel().for_batches(count, k_block, [&, sums](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) sums[first / k_block].add(term(i));
  });
  ExactSum sum;
  for (const ExactSum& of_block : sums) sum.add(of_block);
  kept = std::move(memory);
  return sum.value();
}

}  // namespace troupe::engine
