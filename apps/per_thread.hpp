#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

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
      known = {number_, &find_or_make(std::this_thread::get_id())};
    }
    return *known.second;
  }
  std::deque<T>& all() { return all_; }              ///< in the order in which threads first asked
  const std::deque<T>& all() const { return all_; }  ///< the same

 private:
  /// A thread that asks two sets in turn, as in a run of two worlds, finds its own again.
  T& find_or_make(std::thread::id thread) {
    const auto found = std::ranges::find(owners_, thread);
    if (found != owners_.end()) return all_[static_cast<std::size_t>(found - owners_.begin())];
    owners_.push_back(thread);
    return all_.emplace_back();
  }

  std::uint64_t number_;  // tells the sets of a process apart
  std::mutex mutex_;      // of the two below, to which threads add their own
  std::vector<std::thread::id> owners_;
  std::deque<T> all_;
};

}  // namespace troupe::apps
