#include "partition/parallel.hpp"

#include "base/fp_environment.hpp"
#include "partition/processors.hpp"
#include "tests/support/message_of.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace troupe::partition::parallel_test {
namespace {

class ParallelOf : public ::testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Threads, ParallelOf, ::testing::Values(1u, 2u, 3u, 4u, 8u),
                         [](const auto& threads) { return std::to_string(threads.param); });

TEST_P(ParallelOf, RunsEveryIndexOnce) {
  Parallel parallel(GetParam());
  EXPECT_EQ(parallel.threads(), GetParam());
  for (const std::size_t count : {0, 1, 2, 3, 7, 8, 9, 64, 1000, 20'000}) {
    std::vector<std::atomic<int>> calls(count);
    parallel.for_each(count, [&](std::size_t i) { ++calls.at(i); });
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(calls[i], 1) << i << " of " << count;
  }
}

TEST_P(ParallelOf, DividesIndicesIntoBatches) {
  Parallel parallel(GetParam());
  for (const std::size_t count : {0, 1, 15, 16, 17, 160, 1000}) {
    std::vector<std::atomic<int>> calls(count);
    parallel.for_batches(count, 16, [&](std::size_t first, std::size_t end) {
      EXPECT_EQ(first % 16, 0u);
      EXPECT_EQ(end, std::min(count, first + 16));
      for (std::size_t i = first; i < end; ++i) ++calls.at(i);
    });
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(calls[i], 1) << i << " of " << count;
  }
}

// In many short loops in a row, a worker that wakes late, or still works on the previous loop, would call
// tasks twice or not at all.
TEST_P(ParallelOf, RunsShortLoopsInARow) {
  Parallel parallel(GetParam());
  std::vector<int> calls(5);
  constexpr int k_loops = 20'000;
  for (int loop = 0; loop < k_loops; ++loop)
    parallel.for_each(calls.size(), [&](std::size_t i) { ++calls[i]; });
  for (const int n : calls) EXPECT_EQ(n, k_loops);
}

// When for_each() has returned, the calling thread sees all that the tasks have written.
TEST_P(ParallelOf, HandsItsWritesOver) {
  Parallel parallel(GetParam());
  std::vector<std::size_t> written(1000);
  for (std::size_t round = 1; round < 200; ++round) {
    parallel.for_each(written.size(), [&](std::size_t i) { written[i] += i * round; });
    std::size_t sum = 0;
    for (const std::size_t w : written) sum += w;
    ASSERT_EQ(sum, 999 * 1000 / 2 * (round * (round + 1) / 2));
  }
}

// The number of threads is the requested one, also on a machine with fewer processors. Otherwise a test with
// 8 threads could run on 2.
TEST_P(ParallelOf, UsesAllItsThreads) {
  Parallel parallel(GetParam());
  std::mutex mutex;
  std::set<std::thread::id> threads;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(240);
  parallel.for_each(GetParam(), [&](std::size_t) {
    for (;;) {  // hold the thread until all the others have come
      {
        const std::lock_guard lock(mutex);
        threads.insert(std::this_thread::get_id());
        if (threads.size() == GetParam() || std::chrono::steady_clock::now() > give_up) return;
      }
      std::this_thread::yield();
    }
  });
  EXPECT_EQ(threads.size(), GetParam());
}

// A task of one object may use another object, as a sweep over parameters does.
TEST_P(ParallelOf, NestsInAnother) {
  Parallel outer(3);
  constexpr std::size_t k_simulations = 6;
  std::vector<std::vector<int>> calls(k_simulations, std::vector<int>(500));
  outer.for_each(k_simulations, [&](std::size_t s) {
    Parallel inner(GetParam());
    for (int loop = 0; loop < 20; ++loop)
      inner.for_each(calls[s].size(), [&](std::size_t i) { ++calls[s][i]; });
  });
  for (const auto& of_one : calls)
    for (const int n : of_one) ASSERT_EQ(n, 20);
}

// The loop would use the threads of the outer loop, and could wait for them forever.
TEST_P(ParallelOf, RefusesALoopInATaskOfItsOwnLoop) {
  Parallel parallel(GetParam());
  for (const std::size_t count : {1, 100}) {
    std::atomic<std::size_t> refused = 0;
    parallel.for_each(count, [&](std::size_t) {
      try {
        parallel.for_each(2, [](std::size_t) {});
      } catch (const std::logic_error&) {
        ++refused;
      }
    });
    EXPECT_EQ(refused, count);
  }
  EXPECT_THROW(parallel.for_each(2, [&](std::size_t) { parallel.for_each(2, [](std::size_t) {}); }),
               std::logic_error);
  std::atomic<int> calls = 0;
  parallel.for_each(100, [&](std::size_t) { ++calls; });
  EXPECT_EQ(calls, 100);
}

TEST_P(ParallelOf, RunsBesideOthers) {
  std::vector<std::vector<int>> calls(4, std::vector<int>(500));
  std::vector<std::thread> programs;
  for (auto& mine : calls)
    programs.emplace_back([&] {
      Parallel parallel(GetParam());
      for (int loop = 0; loop < 100; ++loop)
        parallel.for_each(mine.size(), [&](std::size_t i) { ++mine[i]; });
    });
  for (std::thread& program : programs) program.join();
  for (const auto& of_one : calls)
    for (const int n : of_one) ASSERT_EQ(n, 100);
}

TEST_P(ParallelOf, CanBeMoved) {
  Parallel first(GetParam());
  Parallel parallel = std::move(first);
  std::vector<int> calls(100);
  parallel.for_each(calls.size(), [&](std::size_t i) { ++calls[i]; });
  EXPECT_EQ(calls, std::vector<int>(100, 1));
}

// The callback is called before and after each task, on the thread that runs the task.
TEST_P(ParallelOf, TellsOfEachTaskAsItBeginsAndEnds) {
  Parallel parallel(GetParam());
  constexpr std::size_t k_tasks = 200;
  std::vector<std::thread::id> worker(k_tasks);
  std::vector<int> begun(k_tasks), run(k_tasks), ended(k_tasks);
  parallel.on_task([&](std::size_t i, bool begins) {
    EXPECT_EQ(run[i], begins ? 0 : 1);
    if (begins) worker[i] = std::this_thread::get_id();
    EXPECT_EQ(worker[i], std::this_thread::get_id());
    ++(begins ? begun : ended)[i];
  });
  auto task = [&](std::size_t i) {
    ++run[i];
    if (i == 7) throw std::runtime_error("seven");
  };
  EXPECT_THROW(parallel.for_each(k_tasks, task), std::runtime_error);
  EXPECT_EQ(begun, std::vector<int>(k_tasks, 1));
  EXPECT_EQ(ended, begun);
  parallel.on_task(nullptr);
  EXPECT_THROW(parallel.for_each(k_tasks, task), std::runtime_error);
  EXPECT_EQ(run, std::vector<int>(k_tasks, 2));
  EXPECT_EQ(begun, std::vector<int>(k_tasks, 1));
}

TEST_P(ParallelOf, RethrowsTheExceptionOfTheLowestIndex) {
  Parallel parallel(GetParam());
  for (int round = 0; round < 50; ++round) {
    std::atomic<int> run = 0;
    ASSERT_EQ(test::message_of<std::runtime_error>([&] {
                parallel.for_each(100, [&](std::size_t i) {
                  ++run;
                  if (i % 30 == 13) throw std::runtime_error(std::to_string(i));
                });
              }),
              "13");
    ASSERT_EQ(run, 100);
  }
}

TEST_P(ParallelOf, TellsOfEachLoopAsItBeginsAndEnds) {
  Parallel parallel(GetParam());
  std::vector<bool> told;
  parallel.on_loop([&](bool begins) { told.push_back(begins); });
  auto fail = [](std::size_t i) {
    if (i == 7) throw std::runtime_error("seven");
  };
  EXPECT_THROW(parallel.for_each(10, fail), std::runtime_error);
  parallel.for_each(1, [&](std::size_t) { EXPECT_EQ(told, (std::vector<bool>{true, false, true})); });
  EXPECT_EQ(told, (std::vector<bool>{true, false, true, false}));
}

#ifdef __SSE__
TEST_P(ParallelOf, PutsEachThreadsArithmeticRight) {
  _mm_setcsr(_mm_getcsr() |
             0x8040);  // flush to zero, denormals are zero: as a library built with -ffast-math does
  ASSERT_FALSE(check_fp_environment());
  Parallel parallel(GetParam());
  std::atomic<int> wrong = 0;
  parallel.for_each(200, [&](std::size_t) { wrong += !check_fp_environment(); });
  restore_fp_environment();
  EXPECT_EQ(wrong, 0);
}
#endif

/// Runs a loop on eight threads in a process that may start no thread, prints the error, and ends the
/// process.
[[noreturn]] void loop_without_threads() {
  constexpr uid_t k_other = 65534;
  constexpr rlimit k_one{1, 1};
  std::string error;
  // The limit does not apply to root.
  if ((geteuid() == 0 && setuid(k_other) != 0) || setrlimit(RLIMIT_NPROC, &k_one) != 0) error = "unlimited";
  try {
    std::thread([] {}).join();
    error = "unlimited";
  } catch (const std::system_error&) {
  }
  if (error.empty()) try {
      Parallel parallel(8);
      parallel.for_each(100, [](std::size_t) {});
    } catch (const std::exception& thrown) {
      error = thrown.what();
    }
  std::fputs(error.c_str(), stderr);
  std::_Exit(0);  // the search for leaks at a usual end would need a thread
}

TEST(ParallelDeathTest, TooFewThreadsAreAnErrorThatSaysSo) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a new process, in which oneTBB has no threads yet
  EXPECT_EXIT(loop_without_threads(), ::testing::ExitedWithCode(0),
              "the system allows no further thread .use fewer threads, or raise the limits|unlimited");
}

std::ptrdiff_t threads_of_process() {
  const std::filesystem::directory_iterator threads("/proc/self/task");
  return std::distance(begin(threads), end(threads));
}

/// Runs loops on eight threads of many objects, one after the other, prints how many threads the process has
/// afterwards in addition to those that it had before, and ends the process.
[[noreturn]] void loop_in_objects_in_a_row() {
  constexpr int k_objects = 200;
  constexpr std::ptrdiff_t k_others = 7;
  const std::ptrdiff_t before = threads_of_process();
  for (int i = 0; i < k_objects; ++i) {
    Parallel parallel(k_others + 1);
    parallel.for_each(100, [](std::size_t) { std::this_thread::sleep_for(std::chrono::microseconds(1)); });
  }
  // A thread that has been joined remains in /proc for a moment.
  for (int i = 0; i < 1000 && threads_of_process() > before + k_others; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::fprintf(stderr, "further threads: %td.", std::max(threads_of_process() - before, k_others));
  std::_Exit(0);
}

// Otherwise, a limit that allows the threads of one object could end the process in the loops of the second.
TEST(ParallelDeathTest, ObjectsUseTheThreadsOfDestroyedOnes) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a new process, in which oneTBB has no threads yet
  EXPECT_EXIT(loop_in_objects_in_a_row(), ::testing::ExitedWithCode(0), "further threads: 7[.]");
}

TEST(Parallel, TakesTheProcessorsThatItMayUseByDefault) {
  EXPECT_EQ(Parallel(0).threads(), processors_allowed());
  EXPECT_EQ(test::message_of<std::invalid_argument>([&] { Parallel(Parallel::k_most_threads + 1); }),
            "1025 threads: must be 1 to 1024, or 0 for one per processor that the process "
            "may use");
}

}  // namespace
}  // namespace troupe::partition::parallel_test
