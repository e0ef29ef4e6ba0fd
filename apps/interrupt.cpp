#include "apps/interrupt.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <string>

namespace troupe::apps {
namespace {

// A signal handler may set lock-free flags, remove a file and raise a signal, but not lock or allocate.
std::atomic<bool> requested = false;  // whether SIGINT or SIGTERM has arrived
std::atomic<bool> hung_up = false;    // whether SIGHUP has arrived
std::atomic<bool> has_doomed = false;
std::atomic<std::uint32_t> saves = 0;  // how often SIGUSR1 has arrived
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::uint32_t>::is_always_lock_free);
std::array<char, 4096> doomed{};  // name of the file that a second signal removes; written only while
                                  // has_doomed is false

void handle(int signal) {
  if (!requested.exchange(true)) return;
  if (has_doomed) unlink(doomed.data());
  std::signal(signal, SIG_DFL);
  raise(signal);
}

}  // namespace

void stop_on_signals() {
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
