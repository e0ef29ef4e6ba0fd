#include "apps/interrupt.hpp"

#include "tests/support/scratch.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <initializer_list>

namespace troupe::apps {
namespace {

using Interrupt = test::ScratchTest;

constexpr int k_not_requested = 100;  // greater than the number of any signal

/// How a process ends that is sent these signals: the number of the signal that ended it; 0 if none did and a
/// stop was requested, else k_not_requested. at_start: what SIGHUP does when the process starts
int end_after(std::initializer_list<int> signals, const std::filesystem::path& doomed,
              sighandler_t at_start = SIG_DFL) {
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGHUP, at_start);
    stop_on_signals();
    remove_when_killed(doomed);
    for (const int signal : signals) raise(signal);
    _exit(stop_requested() ? 0 : k_not_requested);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
}

TEST_F(Interrupt, ASecondSignalEndsTheProgramAndRemovesWhatIsHalfWritten) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::filesystem::path film = write("film.mp4.partial.mp4", "half");
    EXPECT_EQ(end_after({signal}, film), 0);
    EXPECT_TRUE(std::filesystem::exists(film));
    EXPECT_EQ(end_after({signal, signal}, film), signal);
    EXPECT_FALSE(std::filesystem::exists(film));
    EXPECT_EQ(end_after({signal, signal}, {}), signal);
  }
}

TEST_F(Interrupt, ClosedTerminalsRequestAStopHoweverManySignalsTheySend) {
  EXPECT_EQ(end_after({}, {}), k_not_requested);
  EXPECT_EQ(end_after({SIGHUP}, {}), 0);
  EXPECT_EQ(end_after({SIGHUP, SIGHUP, SIGTERM, SIGHUP}, {}), 0);
  EXPECT_EQ(end_after({SIGHUP, SIGTERM, SIGTERM}, {}), SIGTERM);
}

TEST_F(Interrupt, AHangUpThatIsIgnoredAtTheStartStaysIgnored) {
  EXPECT_EQ(end_after({SIGHUP}, {}, SIG_IGN), k_not_requested);
}

}  // namespace
}  // namespace troupe::apps
