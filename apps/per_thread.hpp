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

/// A set of objects of type T, one for each thread that calls own(). Each thread may write its own object
/// without a lock. A thread may call all(), and use the objects that all() returns, only while no thread
/// calls own() or writes its own object.
template <class T>
class PerThread {
 public:
  PerThread() {
    static std::atomic<std::uint64_t> made = 0;
    number_ = ++made;
  }
  PerThread(const PerThread&) = delete;
  PerThread& operator=(const PerThread&) = delete;

  /// Returns the object of the calling thread. The first call on a thread creates the object.
  T& own() {
    // Number of the set that this thread used last, and the thread's object in it.
    thread_local std::pair<std::uint64_t, T*> known{0, nullptr};
    if (known.first != number_) {
      const std::lock_guard lock(mutex_);
      known = {number_, &find_or_make(std::this_thread::get_id())};
    }
    return *known.second;
  }
  std::deque<T>& all() { return all_; }              ///< all objects, ordered by first call of own()
  const std::deque<T>& all() const { return all_; }  ///< all objects, ordered by first call of own()

 private:
  /// Returns the object of a thread; creates it if there is none. own() remembers only the set that a thread
  /// used last. A thread that uses two sets in turn therefore needs this search to find its existing object.
  T& find_or_make(std::thread::id thread) {
    const auto found = std::ranges::find(owners_, thread);
    if (found != owners_.end()) return all_[static_cast<std::size_t>(found - owners_.begin())];
    owners_.push_back(thread);
    return all_.emplace_back();
  }

  std::uint64_t number_;  // identifies the set within the process
  std::mutex mutex_;      // guards owners_ and all_
  std::vector<std::thread::id> owners_;
  std::deque<T> all_;
};

}  // namespace troupe::apps
