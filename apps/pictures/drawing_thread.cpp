#include "apps/pictures/drawing_thread.hpp"

#include <utility>

namespace troupe::apps {

DrawingThread::DrawingThread(std::size_t most_waiting)
    : most_waiting_(most_waiting), thread_([this] { run(); }) {}

DrawingThread::~DrawingThread() {
  {
    const std::lock_guard lock(mutex_);
    jobs_.clear();
    is_over_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void DrawingThread::add(std::function<void()> job) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return jobs_.size() < most_waiting_ || failure_; });
    throw_if_failed(lock);
    jobs_.push_back(std::move(job));
  }
  changed_.notify_all();
}

void DrawingThread::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return (jobs_.empty() && !is_busy_) || failure_; });
  throw_if_failed(lock);
}

void DrawingThread::throw_if_failed(std::unique_lock<std::mutex>& lock) {
  if (!failure_) return;
  const std::exception_ptr failure = failure_;
  lock.unlock();
  std::rethrow_exception(failure);
}

void DrawingThread::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return !jobs_.empty() || is_over_; });
    if (jobs_.empty()) return;
    const std::function<void()> job = std::move(jobs_.front());
    jobs_.pop_front();
    is_busy_ = true;
    lock.unlock();
    changed_.notify_all();  // there is room
    std::exception_ptr failure;
    try {
      job();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    is_busy_ = false;
    if (failure) {
      failure_ = failure;
      jobs_.clear();
      is_over_ = true;
    }
    changed_.notify_all();
  }
}

}  // namespace troupe::apps
