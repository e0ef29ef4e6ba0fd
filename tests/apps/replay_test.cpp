#include "apps/exit_code.hpp"
#include "tests/apps/program.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <string>
#include <vector>

namespace troupe::apps::replay_test {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

/// What pages are made of; what they show is for tests/replay_page_test.py.
class ReplayPage : public ProgramTest {
 protected:
  void SetUp() override {
    if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
    write("room.world", k_room);
    record("run.h5", "pose,stall");
  }
  void record(const std::string& file, const std::string& fields) {
    const Outcome outcome =
        troupe({"run", "room.world", "--quiet", "--for", "3", "--record", file, "--record-fields", fields});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  /// An error in one line that leaves no file behind.
  std::string error_of(std::vector<std::string> arguments, int code = k_bad_input) {
    arguments.insert(arguments.begin(), "replay");
    const std::vector<std::string> before = files();
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, code) << outcome.out;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    EXPECT_EQ(files(), before);
    return outcome.err;
  }
};

TEST_F(ReplayPage, IsOneFileThatNeedsNoOther) {
  const Outcome outcome = troupe({"replay", "run.h5", "-o", "swarm.html"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, MatchesRegex("swarm.html: 12 robots, 31 frames every 0.1 s, 0\\.[0-9] MB\n"));
  const std::string page = read("swarm.html");
  EXPECT_THAT(page, StartsWith("<!doctype html>"));
  EXPECT_THAT(page, EndsWith("</html>\n"));
  EXPECT_THAT(page, Not(HasSubstr("@RECORDING@")));
  EXPECT_THAT(page, HasSubstr("Permission is hereby granted, free of charge"));
  for (const char* link : {"src=\"http", "href=\"http", "@import"}) EXPECT_THAT(page, Not(HasSubstr(link)));
  EXPECT_THAT(page, HasSubstr("content=\"default-src 'none';")) << "the browser fetches nothing";

  ASSERT_EQ(troupe({"replay", "run.h5"}).code, 0);
  EXPECT_EQ(read("run.html"), page);
  EXPECT_THAT(files(), ElementsAre("room.world", "run.h5", "run.html", "swarm.html"));
}

TEST_F(ReplayPage, ADeviceHasTheNamesThatRecordingAccepts) {
  record("ranges.h5", "pose,ranger/ranger:0");
  std::string page;
  for (const char* name :
       {"ranger:0", "ranger/ranger:0", "bot/ranger:0", "ranger/ranger:0.ranges", "ranges"}) {
    const Outcome outcome = troupe({"replay", "ranges.h5", "--force", "--fields", name});
    ASSERT_EQ(outcome.code, 0) << name << outcome.err;
    if (page.empty()) page = read("ranges.html");
    EXPECT_EQ(read("ranges.html"), page) << name;
  }
  EXPECT_THAT(error_of({"ranges.h5", "--force", "--fields", "ranger/eye"}),
              HasSubstr("unknown field \"ranger/eye\"; known: "));
}

TEST_F(ReplayPage, SaysThePresentNameOfAnEarlierSpelling) {
  record("ranges.h5", "pose,ranger:0");
  const auto warnings_of = [&](const std::string& name) {
    const Outcome outcome = troupe({"replay", "ranges.h5", "--force", "--fields", name});
    EXPECT_EQ(outcome.code, 0) << name << outcome.err;
    return outcome.err;
  };
  const auto warning = [](const std::string& old, const std::string& present) {
    return "ranges.h5: warning: --fields: \"" + old +
           "\" is a name of an earlier version of Troupe; the name is now \"" + present + "\"\n";
  };
  for (const char* old : {"sensors/bot/ranger:0.ranges", "sensors/bot/ranger:0/ranges", "ranger:0/ranges"})
    EXPECT_EQ(warnings_of(old), warning(old, "ranger:0.ranges"));
  EXPECT_EQ(warnings_of("sensors/bot/ranger:0"), warning("sensors/bot/ranger:0", "ranger:0"));
  EXPECT_EQ(warnings_of("pose/x"), warning("pose/x", "pose.x"));
  for (const char* name : {"ranger:0.ranges", "ranger/ranger:0", "bot/ranger:0", "pose.x"})
    EXPECT_EQ(warnings_of(name), "") << name;
}

TEST_F(ReplayPage, SaysThatFramesAreLeftOut) {
  ASSERT_EQ(troupe({"run", "room.world", "--quiet", "--for", "200", "--record", "long.h5"}).code, 0);
  ASSERT_EQ(troupe({"replay", "long.h5"}).code, 0);
  const double whole = static_cast<double>(read("long.html").size()) / 1e6;
  const Outcome outcome = troupe({"replay", "long.h5", "--force", "--max-mb", std::to_string(whole - 0.005)});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_THAT(lines[1],
              MatchesRegex("long.html: contains every (2nd|3rd) of 2001 recorded frames, to stay under "
                           "[0-9.]+ MB \\(--max-mb\\)"));
  EXPECT_LE(static_cast<double>(read("long.html").size()) / 1e6, whole - 0.005);
}

TEST_F(ReplayPage, WrongInputIsRefusedBeforeAnythingIsWritten) {
  record("stalls.h5", "stall");
  EXPECT_THAT(error_of({"stalls.h5"}), StartsWith("stalls.h5: error: has no poses"));
  EXPECT_THAT(error_of({"none.h5"}), HasSubstr("none.h5: error: there is no such file"));
  EXPECT_THAT(error_of({"room.world"}),
              StartsWith("room.world: error: this is not a recording (troupe run --record)"));
  EXPECT_THAT(error_of({"run.h5", "-o", "none/swarm.html"}),
              HasSubstr("none/swarm.html: error: cannot be written: there is no folder none"));
  EXPECT_THAT(error_of({"run.h5", "-o", "run.h5"}),
              HasSubstr("run.h5: error: cannot be written: it is the recording, which this command reads: "
                        "choose another file name"));
  EXPECT_THAT(error_of({"run.h5", "-o", "."}), HasSubstr("it is a folder"));
  for (const char* name : {"room.json", "page"})
    EXPECT_EQ(error_of({"run.h5", "-o", name, "--force"}),
              std::string(name) +
                  ": error: the page would be in the format HTML: choose a name that ends in .html, "
                  "such as swarm.html\n");
  write("precious.html", "precious");
  EXPECT_EQ(error_of({"run.h5", "-o", "precious.html"}),
            "precious.html: error: the file exists; --force replaces it\n");
  EXPECT_EQ(read("precious.html"), "precious");
  EXPECT_THAT(error_of({"run.h5", "--fields", "stal"}),
              HasSubstr("run.h5: error: unknown field \"stal\"; known: pose.heading, pose.x, pose.y, pose.z, "
                        "stall.stalled;"));
  EXPECT_THAT(error_of({"run.h5", "--fields", "pose,,stall"}), HasSubstr("is not a list of names"));
  EXPECT_THAT(error_of({"run.h5", "--max-mb", "0"}), HasSubstr("is not a size in megabytes"));
  EXPECT_THAT(error_of({"run.h5", "--max-mb", "0.01"}), HasSubstr("too small for even two frames (bodies per "
                                                                  "frame: 12)"));
  EXPECT_THAT(error_of({}), HasSubstr("RECORDING is required"));
}

TEST_F(ReplayPage, AFullDiskLeavesThePageThatWasThere) {
  write("run.html", "precious");
  const Outcome outcome = troupe_with_file_limit({"replay", "run.h5", "--force"}, 100000);
  EXPECT_EQ(outcome.code, k_failed);
  EXPECT_THAT(outcome.err, StartsWith("run.html: error: cannot be written: "));
  EXPECT_EQ(read("run.html"), "precious");
  EXPECT_THAT(files(), ElementsAre("room.world", "run.h5", "run.html"));
}

}  // namespace
}  // namespace troupe::apps::replay_test
