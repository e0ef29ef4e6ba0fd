#include "partition/job_thread.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <future>
#include <memory>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace troupe::partition::job_thread_test {
namespace {

/// Returns the text of the exception that a call throws; "nothing" if it throws none.
template <class Call>
std::string thrown_by(Call&& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing";
}

TEST(JobThread, DoesOneJobAfterAnotherOnAThreadOfItsOwn) {
  std::vector<int> done;
  std::set<std::thread::id> threads;
  JobThread thread(3);
  for (int i = 0; i < 1000; ++i)
    thread.add([&, i] {
      done.push_back(i);
      threads.insert(std::this_thread::get_id());
    });
  thread.finish();
  std::vector<int> expected(1000);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(done, expected);
  EXPECT_EQ(threads.size(), 1u);
  EXPECT_FALSE(threads.contains(std::this_thread::get_id()));
}

TEST(JobThread, MakesTheCallerWaitWhereJobsComeTooFast) {
  JobThread thread(1);
  std::promise<void> begun;
  std::promise<void> go_on;
  thread.add([&] {
    begun.set_value();
    go_on.get_future().wait();
  });
  begun.get_future().wait();
  thread.add([] {});  // it waits: there is room for one
  std::atomic<bool> added = false;
  std::thread caller([&] {
    thread.add([] {});
    added = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(added);
  go_on.set_value();
  caller.join();
  EXPECT_TRUE(added);
}

TEST(JobThread, NoJobFollowsOneThatThrows) {
  std::atomic<bool> followed = false;
  JobThread thread(2);
  std::promise<void> go_on;
  thread.add([&] {
    go_on.get_future().wait();
    throw std::runtime_error("the disk is full");
  });
  thread.add([&] { followed = true; });
  EXPECT_EQ(thrown_by([&] { thread.rethrow(); }), "nothing");
  go_on.set_value();
  EXPECT_EQ(thrown_by([&] { thread.finish(); }), "the disk is full");
  EXPECT_EQ(thrown_by([&] { thread.finish(); }), "the disk is full");
  EXPECT_EQ(thrown_by([&] { thread.rethrow(); }), "the disk is full");
  EXPECT_EQ(thrown_by([&] { thread.add([&] { followed = true; }); }), "the disk is full");
  EXPECT_FALSE(followed);
}

TEST(JobThread, ItsEndDropsJobsThatHaveNotBegun) {
  std::atomic<bool> followed = false;
  std::atomic<bool> ended = false;
  auto held = std::make_shared<int>(0);
  {
    JobThread thread(1);
    // The first job ends when the second one, which holds the last reference, has been dropped.
    thread.add([&, dropped = std::weak_ptr<int>(held)] {
      while (!dropped.expired()) std::this_thread::yield();
      ended = true;
    });
    thread.add([&, held] { followed = true; });
    held.reset();
  }
  EXPECT_TRUE(ended);
  EXPECT_FALSE(followed);
}

TEST(TryThreads, TellsWhetherTheSystemAllowsThem) {
  constexpr std::size_t k_more_than_any_memory = std::size_t{1} << 50;
  EXPECT_FALSE(try_threads(0));
  EXPECT_FALSE(try_threads(5));
  EXPECT_FALSE(try_threads(5, 1 << 20));
  EXPECT_EQ(try_threads(1, k_more_than_any_memory), std::errc::resource_unavailable_try_again);
}

}  // namespace
}  // namespace troupe::partition::job_thread_test
