#include "apps/sweep/parallel_runs.hpp"

#include "apps/interrupt.hpp"
#include "apps/messages.hpp"
#include "apps/sweep/one_run.hpp"
#include "apps/sweep/table.hpp"
#include "base/diagnostics.hpp"
#include "partition/job_thread.hpp"
#include "worldio/partial_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace troupe::apps {
namespace {

/// Prints the number of finished runs on standard error, if standard error is a terminal.
class Count {
 public:
  Count(std::size_t done, std::size_t all, bool wanted)
      : done_(done), all_(all), visible_(wanted && isatty(STDERR_FILENO) != 0) {
    show();
  }
  ~Count() {
    if (visible_) std::fputs("\r\x1b[K", stderr);
  }
  Count(const Count&) = delete;
  Count& operator=(const Count&) = delete;
  void add_one() {
    ++done_;
    show();
  }

 private:
  void show() const {
    if (visible_) std::fputs(fmt::format("\r\x1b[K{} of {} runs", done_, all_).c_str(), stderr);
  }
  std::size_t done_;
  std::size_t all_;
  bool visible_;
};

/// Writes the samples of a run, `rows`, to the file that series_file() names, on the disk. Throws
/// std::runtime_error if writing fails.
void keep_series(const std::filesystem::path& file, const std::string& rows) {
  try {
    worldio::PartialFile out(file);
    out.write(std::as_bytes(std::span(rows)));
    out.commit_to_disk();
  } catch (const std::system_error& error) {
    throw std::runtime_error(
        fmt::format("{}: error: writing failed: {}", file.string(), error.code().message()));
  }
}

/// What became of a run. Both members are empty if a signal stopped the run.
struct Attempt {
  std::optional<MadeRun> made;
  std::optional<std::string> error;  ///< text of the exception that ended the run
};

/// Calls make_run() and catches its exceptions.
Attempt attempt_run(const worldio::Study& study, std::size_t index, const std::vector<std::string>& columns,
                    const SweepOptions& options) try {
  return {.made = make_run(study, index, columns, options)};
} catch (const std::exception& thrown) {
  return {.error = exception_text(thrown)};
} catch (...) {  // a plug-in may throw anything
  return {.error = "unknown exception (not derived from std::exception)"};
}

}  // namespace

std::map<std::size_t, std::string> make_runs(const worldio::Study& study,
                                             const std::vector<std::size_t>& runs,
                                             const std::vector<std::string>& columns,
                                             const SweepOptions& options, SweepJournal& journal,
                                             RankDeal& deal) {
  std::map<std::size_t, std::string> failed;
  std::exception_ptr write_error;  // error of writing a result, which ends the sweep
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  Count count(study.run_count() - runs.size(), study.run_count(), !options.quiet);
  const auto keep = [&](std::size_t run, const Attempt& attempt) {
    if (attempt.error) {
      failed.emplace(run, *attempt.error);
      journal.add_failure(run, *attempt.error);
    }
    if (!attempt.made) return;
    // The rows are on the disk before the entry in the journal, so that they exist for every run in the
    // journal, even after a power loss.
    if (study.series) keep_series(series_file(options.folder, run), attempt.made->series);
    journal.add(attempt.made->outcome);
    count.add_one();
  };
  const auto work = [&] {
    while (!stop_requested()) {
      const std::size_t i = next++;
      if (i >= runs.size()) return;
      const Attempt attempt = attempt_run(study, runs[i], columns, options);
      const std::lock_guard lock(mutex);
      if (write_error) return;
      try {
        keep(runs[i], attempt);
      } catch (...) {
        write_error = std::current_exception();
        next = runs.size();
      }
    }
  };
  std::size_t working = std::min<std::size_t>(deal.threads(), runs.size());
  std::condition_variable ended;
  std::vector<std::jthread> workers;
  for (std::size_t w = working; w > 0; --w) try {
      workers.emplace_back([&] {
        work();
        const std::lock_guard lock(mutex);
        working -= 1;
        ended.notify_one();
      });
    } catch (const std::system_error& error) {
      if (workers.empty()) partition::throw_no_thread(error);
      const std::lock_guard lock(mutex);
      working -= w;  // the threads that the system allows make all runs
      break;
    }
  try {
    for (std::unique_lock lock(mutex);
         !ended.wait_for(lock, deal.interval(), [&] { return working == 0; });) {
      lock.unlock();
      deal.tell_that_it_works();
      lock.lock();
    }
  } catch (...) {
    next = runs.size();
    throw;
  }
  workers.clear();  // joins the threads
  if (write_error) std::rethrow_exception(write_error);
  return failed;
}

}  // namespace troupe::apps
