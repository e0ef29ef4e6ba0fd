#include "partition/processors.hpp"

#include "tests/support/scratch.hpp"

#include <sched.h>

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <thread>

namespace troupe::partition::processors_test {
namespace {

/// A folder that stands for `/`, with the files of control groups.
class ProcessorQuota : public test::ScratchTest {
 protected:
  std::optional<double> quota() const { return processor_quota(folder_); }
  void of_process(const std::string& groups) const { write("proc/self/cgroup", groups); }
  void v2(const std::string& group, const std::string& text) const {
    write("sys/fs/cgroup/" + group + "/cpu.max", text + "\n");
  }
  void v1(const std::string& group, const std::string& quota_us, const std::string& period_us) const {
    write("sys/fs/cgroup/" + group + "/cpu.cfs_quota_us", quota_us + "\n");
    write("sys/fs/cgroup/" + group + "/cpu.cfs_period_us", period_us + "\n");
  }
};

TEST_F(ProcessorQuota, OfVersion2IsThatOfTheProcessesGroup) {
  of_process("0::/user/job\n");
  EXPECT_EQ(quota(), std::nullopt) << "no such file";
  v2("user/job", "max 100000");
  EXPECT_EQ(quota(), std::nullopt);
  v2("user/job", "250000 100000");
  EXPECT_EQ(quota(), 2.5);
}

TEST_F(ProcessorQuota, IsTheLeastOfTheGroupsAbove) {
  of_process("0::/user/job\n");
  v2("user/job", "400000 100000");
  v2("user", "150000 50000");
  EXPECT_EQ(quota(), 3);
  v2("user", "max 100000");
  v2("other", "100000 100000");
  EXPECT_EQ(quota(), 4) << "another group is none of ours";
}

/// In a container with a cgroup namespace of its own, the path of the group is "/". Otherwise it is the path
/// on the host.
TEST_F(ProcessorQuota, OfContainersStandsAtTheMountPoint) {
  v2("", "200000 100000");
  of_process("0::/\n");
  EXPECT_EQ(quota(), 2);
  of_process("0::/docker/4bd3\n");
  EXPECT_EQ(quota(), 2);
  of_process("0::/../../job\n");
  EXPECT_EQ(quota(), 2);
}

TEST_F(ProcessorQuota, OfVersion1StandsInTwoFiles) {
  of_process("5:memory:/job\n4:cpu,cpuacct:/job\n3:cpuset:/job\n0::/\n");
  v1("cpuset/job", "1", "100000");
  v1("cpu,cpuacct/job", "-1", "100000");
  EXPECT_EQ(quota(), std::nullopt);
  v1("cpu,cpuacct/job", "50000", "100000");
  EXPECT_EQ(quota(), 0.5);
  v1("cpu,cpuacct/job", "-1", "100000");
  v1("cpu", "300000", "100000");
  EXPECT_EQ(quota(), 3) << "the other name of the mount point, and the group above";
  of_process("1:cpu:/job\n");
  EXPECT_EQ(quota(), 3);
}

TEST_F(ProcessorQuota, IsNoneWhereTheFilesSayNothing) {
  EXPECT_EQ(quota(), std::nullopt);
  for (const char* groups : {"", "\n", "0\n", "0:\n", "0::\n", "::\n", "4:cpu\n"}) {
    of_process(groups);
    EXPECT_EQ(quota(), std::nullopt) << groups;
  }
  of_process("0::/job\n");
  for (const char* text : {"", "max", "100000", "100000 ", "100000 0", "0 100000", "-5 100000", "nan 100000",
                           "inf 100000", "100000 inf", "inf inf", "1e5x 100000", "a b", " 1 2"}) {
    v2("job", text);
    EXPECT_EQ(quota(), std::nullopt) << text;
  }
}

TEST(Processors, AreThoseOfTheAffinityMask) {
  EXPECT_GE(processors_allowed(), 1u);
  unsigned allowed = 0;
  std::string list;
  std::string expected;
  std::thread([&] {  // a thread has a mask of its own
    cpu_set_t all;
    ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
    int first = 0;
    while (!CPU_ISSET(first, &all)) ++first;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    allowed = processors_allowed();
    list = affinity_list();
    expected = std::to_string(first);
  })
      .join();
  EXPECT_EQ(allowed, 1u);
  EXPECT_EQ(list, expected);
}

}  // namespace
}  // namespace troupe::partition::processors_test
