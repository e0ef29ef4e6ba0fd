#include "apps/observers/checkpointing.hpp"
#include "apps/outputs.hpp"
#include "tests/apps/program.hpp"
#include "troupe/simulation.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps::resume_test {
namespace fs = std::filesystem;
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

class Resume : public ProgramTest {
 protected:
  Resume() { write("room.world", k_room); }
  void SetUp() override {
    if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  }

  /// A run that must end well.
  Outcome good(std::vector<std::string> arguments, int code = 0) const {
    arguments.emplace_back("--quiet");
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, code) << outcome.err;
    return outcome;
  }

  /// The lines of a hash log that must agree between runs.
  std::vector<std::string> ticks(const std::string& log) const {
    std::vector<std::string> lines = lines_of(read(log));
    std::erase_if(lines, [](const std::string& line) { return line.starts_with('#'); });
    return lines;
  }
  void straight_log(const std::string& seconds) const {
    good({"run", "room.world", "--for", seconds, "--hash-log", "straight.log"});
  }
  void remove_world() { std::filesystem::remove(path("room.world")); }
};

TEST_F(Resume, GoesOnWithTheSameBitsInAnEmptyFolder) {
  straight_log("3");
  good({"run", "room.world", "--for", "1.5", "--checkpoint", "c.h5", "--hash-log", "h.log"});
  remove_world();
  good({"resume", "c.h5", "--for", "3", "--threads", "2", "--tile-size", "3", "--hash-log", "h.log"});
  EXPECT_EQ(ticks("h.log"), ticks("straight.log"));
  EXPECT_EQ(troupe({"diff", "straight.log", "h.log"}).code, 0);
  EXPECT_THAT(files(), ElementsAre("c.h5", "h.log", "straight.log"));
}

TEST_F(Resume, AnotherLogBeginsAtTheCheckpoint) {
  straight_log("3");
  good({"run", "room.world", "--for", "1.5", "--checkpoint", "c.h5"});
  good({"resume", "c.h5", "--for", "3", "--hash-log", "later.log"});
  EXPECT_THAT(ticks("later.log").front(), StartsWith("15 "));
  const Outcome outcome = troupe({"diff", "straight.log", "later.log"});
  EXPECT_EQ(outcome.code, 0) << outcome.err << outcome.out;
  EXPECT_THAT(outcome.out, StartsWith("same bits, tick 15 to 30"));
}

TEST_F(Resume, CutsALogThatIsAheadOfTheCheckpoint) {
  straight_log("3");
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5", "--hash-log", "h.log"});
  write("h.log", read("straight.log") + "31 and a line that was cut o");
  good({"resume", "c.h5", "--for", "2", "--hash-log", "h.log"});
  const std::vector<std::string> straight = ticks("straight.log");
  EXPECT_EQ(ticks("h.log"), std::vector<std::string>(straight.begin(), straight.begin() + 21));
}

TEST_F(Resume, OptionsWithALineBreakAreOneLineOfTheLog) {
  write("two\nlines \\n.world", read("room.world"));
  good({"run", "two\nlines \\n.world", "--for", "1", "--checkpoint", "c.h5", "--hash-log", "h.log"});
  EXPECT_THAT(lines_of(read("h.log")), Contains("# world: two\\nlines \\\\n.world"));
  EXPECT_EQ(troupe({"diff", "h.log", "h.log"}).code, 0);
  good({"resume", "c.h5", "--for", "2", "--hash-log", "h.log"});
  EXPECT_EQ(ticks("h.log").size(), 21u);
}

TEST_F(Resume, LeavesTheLogOfAnotherRunAlone) {
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5"});
  good({"run", "room.world", "--for", "2", "--seed", "9", "--hash-log", "seed.log"});
  good({"run", "room.world", "--for", "1", "--hash-log", "other.log"});
  std::string other = read("other.log");
  other.replace(other.rfind("\n10 "), 5 + 16, "\n10 0000000000000000 ");
  other.replace(other.rfind("pose="), other.npos,
                "pose=0000000000000000 velocity=0000000000000000 "
                "sensor=0000000000000000 memory=0000000000000000\n");
  write("other.log", other);
  good({"run", "room.world", "--for", "0.5", "--hash-log", "short.log"});
  write("notes.txt", "no log\n");
  for (const auto& [log, message] : std::vector<std::pair<std::string, std::string>>{
           {"seed.log",
            "seed.log:4: error: seed is \"9\", but \"1\" in the checkpoint: the log belongs to another run"},
           {"other.log",
            "other.log:21: error: the state at tick 10 differs from the checkpoint: the log belongs to "
            "another run"},
           {"short.log", "short.log: error: the log ends before tick 10, at which the checkpoint was saved"},
           {"notes.txt", "notes.txt:1: error: not a hash log"}}) {
    const std::string before = read(log);
    const Outcome outcome = troupe({"resume", "c.h5", "--for", "2", "--hash-log", log});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, StartsWith(message));
    EXPECT_EQ(read(log), before);
  }
}

TEST_F(Resume, TellsOfThisPartOfTheRun) {
  good({"run", "room.world", "--for", "2", "--checkpoint", "c.h5"});
  const Outcome outcome = troupe({"resume", "c.h5", "--for", "3", "--json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("ticks"), 30);
  EXPECT_EQ(json.at("resumed_at_tick"), 20);
  EXPECT_EQ(json.at("beams"), 30 * 108);
  EXPECT_EQ(json.at("beams_per_tick"), 108);
  EXPECT_EQ(json.at("world"), "room.world");
  EXPECT_NEAR(json.at("times_real_time").get<double>(), 1.0 / json.at("wall_s").get<double>(), 1e-6);
  EXPECT_NEAR(json.at("ns_per_robot_tick").get<double>(), json.at("wall_s").get<double>() * 1e9 / 120, 1e-3);
  const auto straight = nlohmann::json::parse(troupe({"run", "room.world", "--for", "3", "--json"}).out);
  for (const char* key :
       {"state_hash", "beams", "stalled", "conflict_rounds", "mean_displacement_m", "sim_s"})
    EXPECT_EQ(json.at(key), straight.at(key)) << key;
  const std::string text = troupe({"resume", "c.h5", "--for", "3"}).out;
  EXPECT_THAT(text, HasSubstr("  resumed_at_tick    20\n"));
}

class ResumeAfterStop : public Resume, public ::testing::WithParamInterface<int> {};

TEST_P(ResumeAfterStop, ASignalSavesTheState) {
  const Outcome stopped =
      troupe_until({"run", "room.world", "--for", "1e9", "--checkpoint", "c.h5", "--hash-log", "h.log"},
                   "h.log", 40, GetParam());
  EXPECT_EQ(stopped.code, 3) << stopped.err;
  EXPECT_THAT(stopped.out, HasSubstr("stopped early"));
  EXPECT_THAT(stopped.out, HasSubstr("  checkpoint         c.h5\n"));
  const std::vector<std::string> before = ticks("h.log");
  const std::string end = std::to_string(static_cast<double>(before.size() + 20) / 10);
  good({"resume", "c.h5", "--for", end, "--hash-log", "h.log"});
  straight_log(end);
  EXPECT_GT(ticks("h.log").size(), before.size());
  EXPECT_EQ(ticks("h.log"), ticks("straight.log"));
}

INSTANTIATE_TEST_SUITE_P(Resume, ResumeAfterStop, ::testing::Values(SIGTERM, SIGHUP));

/// On SIGUSR1 the run saves its checkpoint and goes on; the tests end it later.
class ResumeAfterUsr1 : public Resume, public ::testing::WithParamInterface<std::string> {
 protected:
  /// Returns a condition: the hash log has this number of ticks more than when it was last looked at.
  std::function<bool()> further(std::size_t more) {
    return [this, more, first = std::size_t{0}, is_first = true]() mutable {
      const std::size_t now = fs::exists(path("h.log")) ? ticks("h.log").size() : 0;
      if (std::exchange(is_first, false)) first = now;
      return now >= first + more;
    };
  }
};
INSTANTIATE_TEST_SUITE_P(Ranks, ResumeAfterUsr1, ::testing::Values("1", "3"));

TEST_P(ResumeAfterUsr1, GoesOnFromTheCheckpoint) {
  const auto saved = [&] { return fs::exists(path("c.h5")); };
  bool is_early = false;
  const auto later = [&, enough = further(40)]() mutable {
    is_early = is_early || saved();
    return enough();
  };
  const auto after = [&, enough = further(40)]() mutable { return saved() && enough(); };
  const Outcome killed = troupe_with_signals({"run", "room.world", "--for", "1e9", "--checkpoint", "c.h5",
                                              "--hash-log", "h.log", "--ranks", GetParam()},
                                             {{SIGUSR1, later}, {SIGKILL, after}});
  EXPECT_FALSE(is_early);
  EXPECT_EQ(killed.code, 128 + SIGKILL);
  good({"resume", "c.h5", "--for", "1e9", "--wall-limit", "0.01", "--hash-log", "later.log"}, 3);
  const std::string first = ticks("later.log").front();
  EXPECT_GE(std::stoi(first), 39);
  EXPECT_THAT(ticks("h.log"), Contains(first));
  EXPECT_NE(ticks("h.log").back(), first) << "the run did not go on";
}

TEST_P(ResumeAfterUsr1, WithoutACheckpointIsAWarning) {
  const Outcome outcome =
      troupe_with_signals({"run", "room.world", "--for", "1e9", "--hash-log", "h.log", "--ranks", GetParam()},
                          {{SIGUSR1, further(40)}, {SIGTERM, further(40)}});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(
      outcome.err,
      HasSubstr("room.world: warning: SIGUSR1 requests a checkpoint, but the run has no checkpoint file"));
}

TEST_F(Resume, AKillLeavesTheLastCheckpoint) {
  const Outcome killed = troupe_until({"run", "room.world", "--for", "1e9", "--checkpoint", "c.h5",
                                       "--checkpoint-every", "0.5", "--hash-log", "h.log"},
                                      "h.log", 80, SIGKILL);
  EXPECT_EQ(killed.code, 128 + SIGKILL);
  good({"resume", "c.h5", "--for", "1e9", "--wall-limit", "0.01", "--hash-log", "later.log"}, 3);
  const std::vector<std::string> later = ticks("later.log");
  EXPECT_EQ(std::stoi(later.front()) % 5, 0);
  EXPECT_GE(std::stoi(later.front()), 50);
  EXPECT_THAT(ticks("h.log"), Contains(later.front()));
}

TEST_F(Resume, TheWallLimitStopsAndSaves) {
  good({"run", "room.world", "--for", "1e9", "--wall-limit", "0.05", "--checkpoint", "c.h5", "--hash-log",
        "h.log"},
       3);
  const std::string last = ticks("h.log").back();
  good({"resume", "c.h5", "--for", "1e9", "--wall-limit", "0.001", "--hash-log", "later.log"}, 3);
  EXPECT_EQ(ticks("later.log").front(), last);
}

TEST_F(Resume, AChainOfRunsUnderOneNameNeedsNoForce) {
  straight_log("3");
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5"});
  good({"resume", "c.h5", "--for", "2", "--checkpoint", "c.h5", "--checkpoint-every", "0.3"});
  good({"resume", "./c.h5", "--for", "3", "--checkpoint", "c.h5", "--hash-log", "h.log"});
  EXPECT_EQ(ticks("h.log").back(), ticks("straight.log").back());
  EXPECT_EQ(ticks("h.log").size(), 11u);
}

TEST_F(Resume, AnExistingCheckpointIsRefusedWithoutForce) {
  write("c.h5", "precious");
  const Outcome outcome = troupe({"run", "room.world", "--for", "1", "--checkpoint", "c.h5"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "c.h5: error: the file exists; --force replaces it\n");
  EXPECT_EQ(read("c.h5"), "precious");
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5", "--force"});
  good({"resume", "c.h5", "--for", "1.1"});
}

TEST_F(Resume, TheRehearsalOfACheckpointIsWhereTheCheckpointIs) {
  fs::create_directory(path("real"));
  write("real/c.h5", "an earlier checkpoint");
  fs::permissions(path("real/c.h5"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("real/c.h5", path("c.h5"));
  const Simulation simulation(path("room.world"), {.threads = 1});
  const pid_t child = fork();
  if (child == 0) {  // the limit kills it during the rehearsal, so that its files remain
    const rlimit small{4096, 4096};
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    setrlimit(RLIMIT_FSIZE, &small);
    rehearse_checkpoint(path("c.h5"), simulation);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  std::size_t files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(path("real"))) {
    ++files;
    EXPECT_EQ(entry.status().permissions(), fs::perms::owner_read | fs::perms::owner_write) << entry.path();
  }
  EXPECT_GT(files, 1u);
  for (const fs::directory_entry& entry : fs::directory_iterator(path(".")))
    EXPECT_THAT(entry.path().filename().string(), AnyOf("c.h5", "real", "room.world"));
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5", "--force"});
  EXPECT_EQ(std::distance(fs::directory_iterator(path("real")), fs::directory_iterator()), 1) << "leftovers";
}

TEST_F(Resume, ACheckpointOfNoTickIsTheWholeRun) {
  straight_log("1");
  good({"run", "room.world", "--for", "0", "--checkpoint", "c.h5"});
  good({"resume", "c.h5", "--for", "1", "--hash-log", "h.log"});
  EXPECT_EQ(ticks("h.log"), ticks("straight.log"));
}

TEST_F(Resume, ChangesWhatIsSet) {
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5"});
  good({"resume", "c.h5", "--for", "2", "--set", "/seed=8", "--hash-log", "eight.log"});
  good({"resume", "c.h5", "--set", "/quit_time_s=2", "--hash-log", "one.log"});
  EXPECT_EQ(ticks("eight.log").front(), ticks("one.log").front());
  EXPECT_NE(ticks("eight.log").back(), ticks("one.log").back());
  EXPECT_THAT(read("eight.log"), HasSubstr("# set /seed at tick 10: 8\n"));
  const Outcome outcome = troupe({"resume", "c.h5", "--for", "2", "--set", "/tick_s=0.2"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, StartsWith("--set /tick_s: error: this value of the world in a checkpoint cannot "
                                      "be changed; these values can: "));
}

TEST_F(Resume, BadInputIsOneMessageAndWritesNothing) {
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5"});
  const std::vector<std::string> before = files();
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"resume"}, "troupe resume: error: CHECKPOINT is required"},
      {{"resume", "no.h5", "--for", "2"}, "no.h5: error: there is no such file"},
      {{"resume", "room.world", "--for", "2"}, "room.world: error: this is not a checkpoint"},
      {{"resume", "c.h5", "--for", "9", "--record-every", "1"},
       "troupe resume: error: --record-every and --record-fields need a recording"},
      {{"resume", "c.h5"}, "c.h5: error: no end time: give --for SECONDS, or --set /quit_time_s=SECONDS"},
      {{"resume", "c.h5", "--for", "0.5"},
       "c.h5: error: the checkpoint was saved at 1 s, after the end of the run at 0.5 s"},
      {{"resume", "c.h5", "--for", "2", "--hash-log", "c.h5"},
       "c.h5: error: cannot be written: it is the checkpoint, which this command reads: choose another file "
       "name"},
      {{"resume", "c.h5", "--for", "2", "--seed", "3"}, "troupe resume: error: unknown option \"--seed\""},
      {{"resume", "c.h5", "--for", "2", "--checkpoint-every", "1"}, "--checkpoint"},
      {{"run", "room.world", "--for", "2", "--checkpoint", "no/c.h5"},
       "no/c.h5: error: cannot be written: there is no folder no"},
      {{"run", "room.world", "--for", "2", "--checkpoint", "room.world", "--force"},
       "room.world: error: cannot be written: it is the world, which this command reads: choose another file "
       "name"},
      {{"run", "room.world", "--for", "2", "--checkpoint", "/dev/null", "--force"},
       "/dev/null: error: cannot be written: it is not a regular file"},
      {{"run", "room.world", "--for", "2", "--checkpoint", "d.h5", "--checkpoint-every", "0"},
       "\"0\" is not a simulated time in seconds, above 0"},
      {{"run", "room.world", "--for", "2", "--wall-limit", "-1"},
       "\"-1\" is not a real time in seconds, above 0"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2) << message << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    EXPECT_EQ(files(), before) << message;
  }
}

TEST_F(Resume, AnErrorOfTheFirstCheckpointNeedNotNameItsFile) {
  Simulation simulation(path("room.world"));
  simulation.on_save("mine", []() -> std::vector<std::byte> { throw std::runtime_error("it threw"); });
  EXPECT_THAT([&] { rehearse_checkpoint(path("c.h5"), simulation); },
              ::testing::ThrowsMessage<OutputError>("it threw"));
}

TEST_F(Resume, AFullDiskIsAnErrorThatKeepsTheLastCheckpoint) {
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5"});
  const std::string before = read("c.h5");
  const Outcome at_once =
      troupe_with_file_limit({"resume", "c.h5", "--for", "2", "--checkpoint", "c.h5"}, before.size() / 2);
  EXPECT_EQ(at_once.code, 2);
  EXPECT_THAT(at_once.err, StartsWith("c.h5: error: "));
  EXPECT_THAT(at_once.err, HasSubstr("File too large"));
  EXPECT_EQ(read("c.h5"), before);
  EXPECT_THAT(files(), ElementsAre("c.h5", "room.world"));
}

TEST_F(Resume, ARunWithAnOutputThatFailsReplacesTheCheckpointOfAnotherRun) {
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5"});
  good({"run", "room.world", "--for", "0.5", "--checkpoint", "other.h5"});
  const Outcome failed = troupe_with_file_limit({"resume", "c.h5", "--for", "90", "--checkpoint", "other.h5",
                                                 "--force", "--hash-log", "h.log", "--quiet"},
                                                70000);
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.err, HasSubstr("h.log: error: writing failed at tick "));
  EXPECT_THAT(troupe({"resume", "other.h5", "--for", "2"}).err, HasSubstr("after the end of the run at 2 s"))
      << "it was saved later than at 2 s";
}

/// A run with one file of each output that a resumed run continues. The files go on after the checkpoint.
class ResumeOutputs : public Resume {
 protected:
  using Outputs = std::vector<std::pair<std::string, std::string>>;  // options and their files

  void SetUp() override {
    Resume::SetUp();
    if (IsSkipped()) return;
    good(with({"run", "room.world", "--for", "1", "--checkpoint", "c.h5"}, outputs_));
    good(with({"resume", "c.h5", "--for", "2"}, outputs_));
  }
  static std::vector<std::string> with(std::vector<std::string> arguments, const Outputs& outputs) {
    arguments.insert(arguments.end(), {"--measure", "stalls"});
    for (const auto& [option, file] : outputs) arguments.insert(arguments.end(), {option, file});
    return arguments;
  }
  /// Expects that `call`, which runs the program, ends with exit code 2, that its message begins with
  /// `message`, and that no file in the folder has changed.
  void expect_refused(const std::string& message, const std::function<Outcome()>& call) const {
    std::map<std::string, std::string> before;
    for (const std::string& name : files()) before[name] = read(name);
    const Outcome outcome = call();
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_THAT(outcome.err, StartsWith(message));
    EXPECT_EQ(files().size(), before.size());
    for (const auto& [name, content] : before) EXPECT_TRUE(read(name) == content) << name << ": " << message;
  }

  const Outputs outputs_{
      {"--record", "r.h5"}, {"--hash-log", "h.log"}, {"--measures", "m.csv"}, {"--events", "e.csv"}};
};

TEST_F(ResumeOutputs, AFileOfAnotherRunLeavesAllFilesAsTheyAre) {
  good({"run", "room.world", "--for", "2", "--seed", "9", "--record", "r9.h5", "--hash-log", "h9.log"});
  write("m9.csv", "tick,time_s,coverage\n0,0,1\n");
  write("e9.csv", "tick,time_s,event\n");
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    Outputs outputs = outputs_;
    std::string& file = outputs[i].second;
    file.insert(1, "9");
    expect_refused(file, [&] { return troupe(with({"resume", "c.h5", "--for", "2"}, outputs)); });
  }
}

TEST_F(ResumeOutputs, ACheckpointThatCannotBeWrittenLeavesAllFilesAsTheyAre) {
  const std::size_t too_few = read("c.h5").size() / 2;
  expect_refused("new.h5: error: ", [&] {
    return troupe_with_file_limit(with({"resume", "c.h5", "--for", "2", "--checkpoint", "new.h5"}, outputs_),
                                  too_few);
  });
  expect_refused("new.h5: error: ", [&] {
    return troupe_with_file_limit(
        with({"run", "room.world", "--for", "1", "--force", "--checkpoint", "new.h5"}, outputs_), too_few);
  });
}

TEST_F(ResumeOutputs, ASnapshotThatCannotBeWrittenLeavesAllFilesAsTheyAre) {
  const Outcome drawn = troupe({"run", "room.world", "--for", "0.1", "--snapshot", "try.svg"});
  if (lacks_pictures(drawn)) GTEST_SKIP() << "no pictures here: " << drawn.err;
  Outputs outputs = outputs_;
  const std::string name = std::string(246, 's') + ".svg";  // too long for the name of a temporary file
  outputs.emplace_back("--snapshot", name);
  expect_refused(name + ": error: cannot be written: File name too long\n", [&] {
    return troupe(with({"resume", "c.h5", "--for", "2"}, outputs));
  });
}

TEST_F(ResumeOutputs, ImagesThatCannotBeMadeLeaveAllFilesAsTheyAre) {
  Outputs outputs = outputs_;
  outputs.emplace_back("--camera-png", "images");  // the robots have no camera
  expect_refused("c.h5: error: --camera-png: ", [&] {
    return troupe(with({"resume", "c.h5", "--for", "2"}, outputs));
  });
}

TEST_F(Resume, ADryRunFindsFilesThatCannotBeContinued) {
  good({"run", "room.world", "--for", "1", "--checkpoint", "c.h5"});
  write("h.log", "notes\n");
  const Outcome outcome = troupe({"resume", "c.h5", "--for", "2", "--dry-run", "--hash-log", "h.log"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, StartsWith("h.log:1: error: not a hash log"));
}

TEST_F(Resume, ARecordingGoesOnWithoutAGapOrARepeat) {
  const std::vector<std::string> record{"--record-every", "0.3", "--record-fields", "pose,ranges,stall"};
  const auto with = [&record](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), record.begin(), record.end());
    return arguments;
  };
  good(with({"run", "room.world", "--for", "4", "--record", "straight.h5"}));
  good(with({"run", "room.world", "--for", "1.4", "--record", "r.h5", "--checkpoint", "c.h5"}));
  good({"resume", "c.h5", "--for", "2.5", "--record", "r.h5"});  // what came of this is cut off again
  good({"resume", "c.h5", "--for", "2", "--record", "r.h5", "--checkpoint", "c.h5", "--checkpoint-every",
        "0.1"});
  good({"resume", "c.h5", "--for", "4", "--record", "r.h5"});
  const Outcome outcome = troupe({"diff", "straight.h5", "r.h5"});
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("same"));
  good({"resume", "c.h5", "--for", "4", "--record", "later.h5"});
}

TEST_F(Resume, OptionsOfARecordingMayBeRepeatedButNotChanged) {
  const std::vector<std::string> resume{"resume", "c.h5", "--for", "4", "--record", "r.h5"};
  const auto with = [](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const std::vector<std::string> record{"--record-every", "0.3", "--record-fields", "pose,stall"};
  good(with({"run", "room.world", "--for", "2", "--record", "r.h5", "--checkpoint", "c.h5"}, record));
  good(with(resume, record));
  good(with({"run", "room.world", "--for", "4", "--record", "straight.h5"}, record));
  EXPECT_EQ(troupe({"diff", "straight.h5", "r.h5"}).code, 0);

  const std::string before = read("r.h5");
  const Outcome every = troupe(with(resume, {"--record-every", "0.2"}));
  EXPECT_EQ(every.code, 2);
  EXPECT_EQ(every.err,
            "r.h5: error: the recording has a frame every 0.3 s, which cannot change, but --record-every is "
            "0.2 s: omit --record-every (in C++: every_s)\n");
  const Outcome fields = troupe(with(resume, {"--record-fields", "pose"}));
  EXPECT_EQ(fields.code, 2);
  EXPECT_EQ(fields.err,
            "r.h5: error: the recording has the fields pose,stall, which cannot change, but --record-fields "
            "is pose: omit --record-fields (in C++: fields)\n");
  EXPECT_EQ(read("r.h5"), before);
}

TEST_F(Resume, ARecordingWhoseRunWasKilledGoesOn) {
  const Outcome killed =
      troupe_until({"run", "room.world", "--for", "1e9", "--checkpoint", "c.h5", "--checkpoint-every", "0.5",
                    "--record", "r.h5", "--hash-log", "h.log"},
                   "h.log", 80, SIGKILL);
  EXPECT_EQ(killed.code, 128 + SIGKILL);
  good({"resume", "c.h5", "--for", "30", "--record", "r.h5", "--hash-log", "h.log"});
  good({"run", "room.world", "--for", "30", "--record", "straight.h5"});
  const Outcome outcome = troupe({"diff", "straight.h5", "r.h5"});
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
}

TEST_F(Resume, ManyCheckpointsLeaveOneFile) {
  good({"run", "room.world", "--for", "3", "--checkpoint", "c.h5", "--checkpoint-every", "0.1"});
  EXPECT_THAT(files(), ElementsAre("c.h5", "room.world"));
  EXPECT_THAT(troupe({"resume", "c.h5", "--for", "3"}).out, Not(IsEmpty()));
}

}  // namespace
}  // namespace troupe::apps::resume_test
