#include "apps/interrupt.hpp"

#include "tests/support/scratch.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace troupe::apps {
namespace {

using Interrupt = test::ScratchTest;

/// How a process ends that is sent so many signals: the number of the signal that ended it, 0 where none did.
int end_after(int signals, int signal, const std::filesystem::path& doomed) {
  const pid_t child = fork();
  if (child == 0) {
    stop_on_signals();
    remove_when_killed(doomed);
    for (int i = 0; i < signals; ++i) raise(signal);
    _exit(stop_requested() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
}

TEST_F(Interrupt, ASecondSignalEndsTheProgramAndRemovesWhatIsHalfWritten) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::filesystem::path film = write("film.mp4.partial.mp4", "half");
    EXPECT_EQ(end_after(1, signal, film), 0);
    EXPECT_TRUE(std::filesystem::exists(film));
    EXPECT_EQ(end_after(2, signal, film), signal);
    EXPECT_FALSE(std::filesystem::exists(film));
    EXPECT_EQ(end_after(2, signal, {}), signal);
  }
}

}  // namespace
}  // namespace troupe::apps
