#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <utility>

namespace troupe::apps {

/// A T for each thread that asks for its own. all() may be read while no thread is at work.
template <class T>
class PerThread {
 public:
  PerThread() {
    static std::atomic<std::uint64_t> made = 0;
    number_ = ++made;
  }
  PerThread(const PerThread&) = delete;
  PerThread& operator=(const PerThread&) = delete;

  /// The calling thread's; made at its first call.
  T& own() {
    thread_local std::pair<std::uint64_t, T*> known{0, nullptr};  // of the set that this thread asked last
    if (known.first != number_) {
      const std::lock_guard lock(mutex_);
      known = {number_, &all_.emplace_back()};
    }
    return *known.second;
  }
  std::deque<T>& all() { return all_; }              ///< in the order in which threads first asked
  const std::deque<T>& all() const { return all_; }  ///< the same

 private:
  std::uint64_t number_;  // tells the sets of a process apart
  std::mutex mutex_;      // of all_, to which threads add their own
  std::deque<T> all_;
};

}  // namespace troupe::apps
