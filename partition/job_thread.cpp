#include "partition/job_thread.hpp"

#include <pthread.h>

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace troupe::partition {
namespace {

void* wait_for_mutex(void* mutex) {
  const std::lock_guard lock(*static_cast<std::mutex*>(mutex));
  return nullptr;
}

}  // namespace

struct JobThread::Impl {
  explicit Impl(std::size_t most) : most_waiting(most), thread([this] { run(); }) {}
  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      jobs.clear();
      is_over = true;
    }
    changed.notify_all();
    thread.join();
  }

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return !jobs.empty() || is_over; });
      if (jobs.empty()) return;
      const std::function<void()> job = std::move(jobs.front());
      jobs.pop_front();
      is_busy = true;
      lock.unlock();
      changed.notify_all();  // add() may continue
      std::exception_ptr thrown;
      try {
        job();
      } catch (...) {
        thrown = std::current_exception();
      }
      lock.lock();
      is_busy = false;
      if (thrown) {
        failure = thrown;
        jobs.clear();
        is_over = true;
      }
      changed.notify_all();
    }
  }

  void throw_if_failed(std::unique_lock<std::mutex>& lock) {
    if (!failure) return;
    const std::exception_ptr thrown = failure;
    lock.unlock();
    std::rethrow_exception(thrown);
  }

  const std::size_t most_waiting;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::function<void()>> jobs;
  bool is_busy = false;
  bool is_over = false;
  std::exception_ptr failure;
  std::thread thread;  // last member, so that it starts after the members that it uses are constructed
};

void throw_no_thread(const std::system_error& error) {
  throw std::system_error(
      error.code(),
      "the system allows no further thread (use fewer threads, or raise the limits on threads and memory of "
      "this process)");
}

std::error_code try_threads(std::size_t count, std::size_t stack_bytes) {
  std::mutex mutex;
  std::vector<pthread_t> threads(count);
  std::size_t started = 0;
  int error = 0;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  if (stack_bytes > 0) pthread_attr_setstacksize(&attributes, stack_bytes);
  {
    const std::lock_guard lock(mutex);  // no thread ends before all are started
    while (started < count && error == 0) {
      error = pthread_create(&threads[started], &attributes, wait_for_mutex, &mutex);
      if (error == 0) ++started;
    }
  }
  pthread_attr_destroy(&attributes);
  for (std::size_t i = 0; i < started; ++i) pthread_join(threads[i], nullptr);
  return {error, std::generic_category()};
}

JobThread::JobThread(std::size_t most_waiting) try : impl_(std::make_unique<Impl>(most_waiting)) {
} catch (const std::system_error& error) {
  throw_no_thread(error);
}

JobThread::~JobThread() = default;

void JobThread::add(std::function<void()> job) {
  {
    std::unique_lock lock(impl_->mutex);
    impl_->changed.wait(lock, [this] { return impl_->jobs.size() < impl_->most_waiting || impl_->failure; });
    impl_->throw_if_failed(lock);
    impl_->jobs.push_back(std::move(job));
  }
  impl_->changed.notify_all();
}

void JobThread::finish() {
  std::unique_lock lock(impl_->mutex);
  impl_->changed.wait(lock, [this] { return (impl_->jobs.empty() && !impl_->is_busy) || impl_->failure; });
  impl_->throw_if_failed(lock);
}

void JobThread::rethrow() {
  std::unique_lock lock(impl_->mutex);
  impl_->throw_if_failed(lock);
}

}  // namespace troupe::partition
