#pragma once

#include <cstddef>

namespace troupe::test {

/// What this program asks of the global operator new, in any thread, from anywhere in the process: standard
/// containers, std::function, Eigen's dynamic matrices and exceptions all go through it. Not counted is
/// malloc itself, which nothing in this library calls: oneTBB takes its own task objects from pools that it
/// fills by malloc.

void start_counting();
/// Allocations since start_counting().
std::size_t stop_counting();

template <class Work>
std::size_t allocations_in(Work&& work) {
  start_counting();
  work();
  return stop_counting();
}

/// Bytes, and blocks, that were allocated and not freed yet.
struct Live {
  std::size_t bytes;
  std::size_t blocks;
  friend bool operator==(const Live&, const Live&) = default;
};
Live live();

/// What the process occupies of the machine's memory, malloc's and the system's share included.
std::size_t resident_bytes();

}  // namespace troupe::test
