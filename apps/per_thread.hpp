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

/// A set of objects of type T, one for each thread that calls own(). Each thread writes only its own object,
/// without locks. all() may be called, and its result used, only while no thread calls own() or writes its
/// object.
template <class T>
class PerThread {
 public:
  PerThread() {
    static std::atomic<std::uint64_t> made = 0;
    number_ = ++made;
  }
  PerThread(const PerThread&) = delete;
  PerThread& operator=(const PerThread&) = delete;

  /// Returns the object of the calling thread, which is created at the first call of this thread.
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
  /// Returns the object of a thread; creates it if there is none. A thread that uses two PerThread objects in
  /// turn, as in a run of two worlds, must get the same object again.
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
