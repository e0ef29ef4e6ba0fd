#include "apps/interrupt.hpp"

#include "tests/support/scratch.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <initializer_list>
#include <string>
#include <string_view>

namespace troupe::apps::interrupt_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

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

/// What a process prints on standard error that calls stop_on_signals(what) and gets one SIGINT. fills:
/// whether standard error is a pipe that is full
std::string printed_after_one(std::string_view what, bool fills = false) {
  constexpr unsigned k_patience_s = 60;  // then SIGALRM ends a process that waits
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe(ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    alarm(k_patience_s);
    dup2(ends[1], STDERR_FILENO);
    fcntl(STDERR_FILENO, F_SETFL, O_NONBLOCK);
    while (fills && write(STDERR_FILENO, "x", 1) == 1) {
    }
    fcntl(STDERR_FILENO, F_SETFL, 0);
    stop_on_signals(what);
    raise(SIGINT);
    _exit(stop_requested() ? 0 : k_not_requested);
  }
  close(ends[1]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  std::string text(1 << 20, '\0');  // longer than any pipe
  const ssize_t bytes = read(ends[0], text.data(), text.size());
  close(ends[0]);
  return text.substr(0, bytes > 0 ? static_cast<std::size_t>(bytes) : 0);
}

TEST_F(Interrupt, TheFirstSignalPrintsWhatItDoes) {
  EXPECT_EQ(printed_after_one("troupe run: stopping"),
            "troupe run: stopping; a second Ctrl-C or SIGTERM ends the program at once\n");
  EXPECT_EQ(printed_after_one(""), "");
}

TEST_F(Interrupt, AFullPipeDoesNotKeepTheProgramFromStopping) {
  EXPECT_THAT(printed_after_one("troupe run: stopping", true), Not(HasSubstr("stopping")));
}

}  // namespace
}  // namespace troupe::apps::interrupt_test
