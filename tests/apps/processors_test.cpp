// Default numbers of threads if the process may use only some of the processors: taskset, SLURM, containers.

#include "tests/apps/program.hpp"

#include <sched.h>

#include <string>

namespace troupe::apps::processors_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::IsEmpty;

/// The programs that it starts may use one processor.
class OnOneProcessor : public ProgramTest {
 protected:
  OnOneProcessor() {
    sched_getaffinity(0, sizeof before_, &before_);
    int first = 0;
    while (!CPU_ISSET(first, &before_)) ++first;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    EXPECT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    write("room.world", k_room);
  }
  ~OnOneProcessor() override { sched_setaffinity(0, sizeof before_, &before_); }

 private:
  cpu_set_t before_;
};

TEST_F(OnOneProcessor, ThereIsOneThreadByDefault) {
  const Outcome outcome = troupe({"run", "room.world", "--for", "1"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out, ContainsRegex("  threads +1\n"));
  EXPECT_THAT(troupe({"lint", "room.world"}).err, IsEmpty());
}

TEST_F(OnOneProcessor, MoreThreadsRunAndNothingWarnsOfThem) {
  for (const char* threads : {"2", "8", "300", "1024"}) {
    const Outcome outcome = troupe({"run", "room.world", "--for", "1", "--threads", threads});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_THAT(outcome.err, IsEmpty()) << threads;
    EXPECT_THAT(outcome.out, ContainsRegex("  threads +" + std::string(threads) + "\n"));
  }
  const Outcome checked =
      troupe({"check", "room.world", "--for", "0.5", "--threads", "1,2,8,300,3", "--tile-size", "auto"});
  EXPECT_EQ(checked.code, 0) << checked.out;
  EXPECT_THAT(checked.err, IsEmpty());
}

}  // namespace
}  // namespace troupe::apps::processors_test
