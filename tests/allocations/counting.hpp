#pragma once

#include <cstddef>

namespace troupe::test {

/// Starts to count, from 0, the allocations of the process: the calls of the global operator new in all
/// threads. Standard containers, std::function, Eigen's dynamic matrices and exceptions all allocate with
/// operator new. Direct calls of malloc are not counted. Troupe makes none; oneTBB calls malloc to fill the
/// pools from which it takes its task objects.
void start_counting();
/// Stops counting. Returns the number of allocations since start_counting().
std::size_t stop_counting();

template <class Work>
std::size_t allocations_in(Work&& work) {
  start_counting();
  work();
  return stop_counting();
}

/// The memory that the process has allocated with operator new and not yet freed.
struct Live {
  std::size_t bytes;   ///< size of all blocks, as malloc_usable_size() returns it
  std::size_t blocks;  ///< number of blocks
  friend bool operator==(const Live&, const Live&) = default;
};
Live live();

/// Returns the size of the memory of the process that is in RAM, bytes. It includes memory that malloc keeps
/// for later allocations.
std::size_t resident_bytes();

}  // namespace troupe::test
