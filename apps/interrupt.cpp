#include "apps/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace troupe::apps {
namespace {

// The one thing a signal handler may do is to set a flag.
std::atomic<bool> requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { requested = true; };
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool stop_requested() { return requested; }

}  // namespace troupe::apps
