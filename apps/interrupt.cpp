#include "apps/interrupt.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <string>

namespace troupe::apps {
namespace {

// A signal handler may set lock-free flags, write, remove a file and raise a signal, but not lock or
// allocate.
std::atomic<bool> requested = false;   // whether SIGINT or SIGTERM has arrived
std::atomic<bool> hung_up = false;     // whether SIGHUP has arrived, or another process got a signal
std::atomic<bool> is_noticed = false;  // whether the notice was printed
std::atomic<bool> has_doomed = false;
std::atomic<std::uint32_t> saves = 0;  // how often SIGUSR1 has arrived
std::atomic<std::size_t> notice_bytes = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::uint32_t>::is_always_lock_free &&
              std::atomic<std::size_t>::is_always_lock_free);
std::array<char, 4096> doomed{};  // name of the file that a second signal removes; written only while
                                  // has_doomed is false
std::array<char, 512> notice{};   // what the first signal prints; written only while notice_bytes is 0

/// Prints the notice. Does not wait for a full pipe or a stopped terminal: the run must stop nevertheless.
void print_notice() {
  if (is_noticed.exchange(true)) return;
  const int error = errno;
  pollfd stream{STDERR_FILENO, POLLOUT, 0};
  if (notice_bytes > 0 && poll(&stream, 1, 0) == 1 && (stream.revents & POLLOUT) != 0) {
    [[maybe_unused]] const ssize_t printed = write(STDERR_FILENO, notice.data(), notice_bytes);
  }
  errno = error;  // of the code that the signal has interrupted
}

void handle(int signal) {
  if (!requested.exchange(true)) return print_notice();
  if (has_doomed) unlink(doomed.data());
  std::signal(signal, SIG_DFL);
  raise(signal);
}

}  // namespace

void stop_on_signals(std::string_view what) {
  // Overwrites a progress bar, and the "^C" that the terminal shows.
  const std::string_view wipe = isatty(STDERR_FILENO) != 0 ? "\r\x1b[K" : "";
  const std::string text =
      fmt::format("{}{}; a second Ctrl-C or SIGTERM ends the program at once\n", wipe, what);
  notice_bytes = 0;
  is_noticed = false;
  if (!what.empty() && text.size() <= notice.size()) {
    std::ranges::copy(text, notice.begin());
    notice_bytes = text.size();
  }
  struct sigaction action {};
  action.sa_handler = handle;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  // When a terminal closes, the shell and the kernel may each send a SIGHUP. Only people send a second signal
  // to end the program immediately.
  action.sa_handler = [](int) { hung_up = true; };
  struct sigaction started {};
  sigaction(SIGHUP, nullptr, &started);
  if (started.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup ignores it
  std::signal(SIGPIPE, SIG_IGN);
}

bool stop_requested() { return requested || hung_up; }

void request_stop() {
  hung_up = true;
  print_notice();
}

void count_save_requests() {
  saves = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { saves.fetch_add(1, std::memory_order_relaxed); };
  action.sa_flags = SA_RESTART;
  sigaction(SIGUSR1, &action, nullptr);
}

std::uint32_t save_requests() { return saves; }

void remove_when_killed(const std::filesystem::path& file) {
  const std::string& name = file.native();
  has_doomed = false;
  if (name.empty() || name.size() >= doomed.size()) return;
  name.copy(doomed.data(), name.size());
  doomed[name.size()] = '\0';
  has_doomed = true;
}

}  // namespace troupe::apps
