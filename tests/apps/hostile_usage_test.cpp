// Command lines with wrong or malicious arguments.

#include "tests/apps/program.hpp"

#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace troupe::apps::hostile_usage_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class HostileUsage : public ProgramTest {
 protected:
  HostileUsage() { write("room.world", k_room); }

  /// The exit code of a shell that runs `troupe ARGUMENTS REDIRECTIONS` in the folder.
  int shell(const std::string& command) const {
    const std::string line = "cd '" + path("").string() + "' || exit 9; '" + test::program() + "' " + command;
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  /// The exit code of `troupe COMMAND` in a process whose address space is limited. The stack of a further
  /// thread, 4 GB, does not fit into k_no_thread, and that of two does not fit into k_one_thread. The
  /// standard error is in err.txt.
  int limited(int most_kilobytes, const std::string& command) const {
    return shell("--version >/dev/null; ulimit -s 4000000 && ulimit -v " + std::to_string(most_kilobytes) +
                 " || exit 9; timeout -s KILL 240 '" + test::program() + "' " + command + " 2>err.txt");
  }
  static constexpr int k_no_thread = 3'000'000, k_one_thread = 6'000'000;
  bool can_limit_threads() const {
    return !test::k_slow_build && limited(k_no_thread, "--version >/dev/null") == 0;
  }
  std::string study(const std::string& name) {
    write(
        name,
        R"({"troupe_study": 1, "world": "room.world", "for_s": 0.2, "seeds": [1, 2], "measures": ["stalls"]})");
    return name;
  }
};

TEST_F(HostileUsage, ASecondCommandIsNotIgnored) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"lint", "room.world", "info", "room.world"},
        std::vector<std::string>{"manual", "describe", "ranger"},
        std::vector<std::string>{"manual", "manual"},
        std::vector<std::string>{"info", "room.world", "info"}}) {
    const Outcome outcome = troupe(words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, HasSubstr("one argument too many: "));
  }
}

TEST_F(HostileUsage, TheSchemaIsOfNoKind) {
  const Outcome named = troupe({"describe", "--schema", "ranger"});
  EXPECT_EQ(named.code, 2);
  EXPECT_THAT(named.out, IsEmpty());
  EXPECT_THAT(named.err, HasSubstr("NAME excludes --schema"));
  EXPECT_EQ(troupe({"describe", "--schema", "--plugin-path", "."}).code, 2);
}

TEST_F(HostileUsage, LostOutputIsAFailure) {
  study("study.json");
  for (const char* command :
       {"--help", "--version", "describe", "describe ranger", "describe --schema", "completion bash",
        "manual", "run --help", "sweep study.json --list", "sweep study.json -o results", "lint room.world",
        "info room.world", "check room.world --for 0.1 --threads 1", "run room.world --for 0.1"}) {
    EXPECT_EQ(shell(command + std::string(" >/dev/full 2>err.txt")), 1) << command;
    EXPECT_EQ(read("err.txt").substr(0, 15), "troupe: error: ") << command << read("err.txt");
    EXPECT_EQ(shell(command + std::string(" >&- 2>err.txt")), 1) << command;
  }
  EXPECT_EQ(shell("run room.world --for 0.1 --quiet >/dev/full"), 0);  // prints nothing
}

// The first file that is opened gets the number of a stream that was closed: without care, its summary too.
TEST_F(HostileUsage, ClosedStreamsDoNotEndInOutputs) {
  ASSERT_EQ(shell("run room.world --for 0.3 --threads 1 --hash-log right.log --quiet"), 0);
  EXPECT_EQ(shell("run room.world --for 0.3 --threads 1 --hash-log out.log >&- 2>/dev/null"), 1);
  EXPECT_EQ(read("out.log"), read("right.log"));
  write("warned.world", std::string(k_room) + "model( nonsense 1 pose [3 3 0 0] size [0.1 0.1 0.1] )\n");
  ASSERT_EQ(shell("run warned.world --for 0.3 --threads 1 --hash-log right.log --quiet 2>/dev/null"), 0);
  shell("run warned.world --for 0.3 --threads 1 --hash-log err.log --quiet 2>&-");
  EXPECT_EQ(read("err.log"), read("right.log"));
}

// A message that cannot be printed, for example because the disk of the log of a job is full, ends no run and
// changes no exit code.
TEST_F(HostileUsage, LostMessagesChangeNoExitCode) {
  write("wrong.json", "{");
  write("warned.world", "colour \"red\"\n" + std::string(k_room));
  for (const auto& [command, code] : std::vector<std::pair<std::string, int>>{
           {"--nonsense", 2},
           {"run wrong.json --for 1", 2},
           {"lint wrong.json", 2},
           {"check wrong.json --for 1", 2},
           {"repair none.h5", 2},
           {"convert warned.world room.json", 0},
           {"run warned.world --for 20 --threads 1 --clock --hash-log run.log", 0},
           {"run room.world --for 0.1 --hash-log /dev/full", 1}})
    for (const char* lost : {" 2>/dev/full", " 2>&-"}) {
      EXPECT_EQ(shell(command + " >/dev/null" + lost), code) << command << lost;
      fs::remove(path("room.json"));
    }
  EXPECT_EQ(lines_of(read("run.log")).back().substr(0, 4), "200 ");
}

TEST_F(HostileUsage, TheLastPictureIsDrawnIfTheSummaryIsLost) {
  const Outcome drawn = troupe({"run", "room.world", "--for", "0.1", "--snapshot", "last.svg"});
  if (lacks_pictures(drawn)) GTEST_SKIP() << "no pictures here: " << drawn.err;
  fs::remove(path("last.svg"));
  EXPECT_EQ(shell("run room.world --for 0.1 --snapshot last.svg >/dev/full 2>err.txt"), 1);
  EXPECT_THAT(read("err.txt"), HasSubstr("troupe: error: cannot write to standard output"));
  EXPECT_THAT(read("last.svg"), HasSubstr("</svg>"));
}

TEST_F(HostileUsage, APipeWhoseReaderEndsIsAnErrorOfWriting) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(shell("run room.world --for 1000 --threads 1 --hash-log pipe --quiet 2>err.txt & "
                  "head -n 2 pipe >/dev/null; wait $!"),
            1);
  EXPECT_THAT(read("err.txt"), ::testing::StartsWith("pipe: error: writing failed at tick "));
}

TEST_F(HostileUsage, DevicesAreWrittenIntoAndNotReplaced) {
  ASSERT_EQ(shell("run room.world --for 0.3 --record run.h5 --quiet"), 0);
  ASSERT_EQ(mkfifo(path("pipe.html").c_str(), 0600), 0);
  EXPECT_EQ(shell("replay run.h5 -o pipe.html --force >/dev/null & cat pipe.html >page.html; wait $!"), 0);
  EXPECT_THAT(read("page.html"), HasSubstr("</html>"));
  EXPECT_TRUE(fs::is_fifo(path("pipe.html")));
  ASSERT_EQ(symlink("/dev/full", path("full.html").c_str()), 0);
  EXPECT_EQ(shell("replay run.h5 -o full.html --force 2>/dev/null"), 1);
  EXPECT_TRUE(fs::is_symlink(path("full.html")));
  EXPECT_TRUE(fs::is_character_file(path("full.html")));
}

// A world of unknown origin records nowhere but in or below the working folder.
TEST_F(HostileUsage, WorldsRecordBelowTheWorkingFolder) {
  const fs::path elsewhere = path("elsewhere");
  fs::create_directory(elsewhere);
  fs::create_directory(path("inside"));
  const auto world = [](const std::string& file) {
    nlohmann::json json =
        nlohmann::json::parse(R"({"troupe": 1, "quit_time_s": 0.3, "types": {"box": {"size_m": [1, 1, 1]}},
      "models": [{"name": "b", "type": "box"}]})");
    json["record"]["file"] = file;
    return json.dump();
  };
  for (const std::string& file :
       {(elsewhere / "run.h5").string(), std::string("../run.h5"), std::string("inside/../../run.h5")}) {
    write("world.json", world(file));
    const Outcome outcome = troupe({"run", "world.json", "--force"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(
        outcome.err,
        HasSubstr("world.json:1: error: /record/file: must be a file in or below the working folder"));
  }
  const fs::path outside = fs::canonical(path(".")).concat("_outside");
  fs::create_directory(outside);
  fs::create_directory_symlink(outside, path("out"));
  fs::create_symlink(outside / "new.h5", path("link.h5"));  // the file new.h5 does not exist
  fs::create_symlink("inside/kept.h5", path("within.h5"));
  for (const auto& [file, resolved] : {std::pair{"out/run.h5", "run.h5"}, std::pair{"link.h5", "new.h5"}}) {
    write("world.json", world(file));
    for (const Outcome& outcome :
         {troupe({"run", "world.json", "--force"}), troupe({"lint", "world.json"})}) {
      EXPECT_EQ(outcome.code, 2);
      EXPECT_THAT(
          outcome.err,
          HasSubstr("world.json:1: error: /record/file: must be a file in or below the working folder, "
                    "but \"" +
                    std::string(file) + "\" is " + (outside / resolved).string() +
                    ", because of a symbolic link; --record may name any file"));
    }
  }
  EXPECT_TRUE(fs::is_empty(outside));
  fs::remove_all(outside);
  write("world.json", world("within.h5"));
  EXPECT_EQ(troupe({"run", "world.json"}).code, 0);
  EXPECT_TRUE(fs::is_empty(elsewhere));
  EXPECT_FALSE(fs::exists(path("").parent_path().parent_path() / "run.h5"));
  write("world.json", world("inside/run.h5"));
  EXPECT_EQ(troupe({"run", "world.json"}).code, 0);
  EXPECT_TRUE(fs::exists(path("inside/run.h5")));
  // The saved world of a checkpoint says the same; the command line may name any file.
  write("world.json", world("/nowhere/run.h5"));
  EXPECT_EQ(troupe({"run", "world.json", "--record", "a.h5", "--checkpoint", "c.h5"}).code, 0);
  const Outcome resumed = troupe({"resume", "c.h5", "--for", "0.5"});
  EXPECT_EQ(resumed.code, 2);
  EXPECT_THAT(resumed.err, HasSubstr("error: /record/file: must be a file in or below"));
}

TEST_F(HostileUsage, SweepsRefuseWhatCannotBeWrittenBeforeTheirRuns) {
  study("study.json");
  fs::create_directories(path("out/table.csv"));
  const Outcome outcome = troupe({"sweep", "study.json", "-o", "out"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("out/table.csv: error: cannot be written: it is a folder"));
  EXPECT_EQ(std::distance(fs::directory_iterator(path("out")), {}), 1);
  write(
      "series.json",
      R"({"troupe_study": 1, "world": "room.world", "for_s": 0.2, "measures": ["stalls"], "series": true})");
  fs::create_directory(path("o3"));
  write("o3/series", "");
  const Outcome occupied = troupe({"sweep", "series.json", "-o", "o3"});
  EXPECT_EQ(occupied.code, 2);
  EXPECT_THAT(lines_of(occupied.err), ElementsAre("o3/series: error: cannot be written: it is not a folder"));
  for (const char* folder : {"", "--list"}) {
    const Outcome refused = troupe({"sweep", "study.json", "-o", folder});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err, HasSubstr("is not the name of a folder"));
  }
  // Run 1, and run 0 once more where the sum wraps around.
  EXPECT_THAT(troupe({"sweep", "study.json", "-o", "o2", "--part", "2/18446744073709551615"}).err,
              HasSubstr("is not a part I/N, with I from 1 to N and N at most 1000000"));
  EXPECT_FALSE(fs::exists(path("o2")));
}

// No output is changed if another one cannot be written.
TEST_F(HostileUsage, LinksOfOutputsThatLeadNowhereAreRefusedBeforeTheRun) {
  study("study.json");
  const std::string log = "# troupe hash log 1\n# of an earlier run\n";
  write("h.log", log);
  fs::create_symlink("loop", path("loop"));
  fs::create_symlink("none/m.csv", path("m.csv"));  // the folder none does not exist
  fs::create_symlink("none", path("results"));
  const auto before = files();
  const std::string long_name(300, 'x');
  const std::string none = (fs::canonical(path("")) / "none").string();
  for (const auto& [arguments, message] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"run", "room.world", "--for", "1", "--hash-log", "h.log", "--measures", "m.csv"},
            "m.csv: error: cannot be written: there is no folder " + none},
           {{"run", "room.world", "--for", "1", "--hash-log", "h.log", "--measures", "loop/m.csv"},
            "loop/m.csv: error: cannot be written: Too many levels of symbolic links"},
           {{"run", "room.world", "--for", "1", "--hash-log", "h.log", "--camera-png", "results"},
            "results: error: cannot be written: it is a symbolic link to a folder that does not exist"},
           {{"sweep", "study.json", "-o", "loop"},
            "loop: error: cannot be written: Too many levels of symbolic links"},
           {{"sweep", "study.json", "-o", "results"},
            "results: error: cannot be written: it is a symbolic link to a folder that does not exist"},
           {{"sweep", "study.json", "-o", long_name},
            long_name + ": error: cannot be written: File name too long"},
           {{"view", "room.world", "--out", "loop"},
            "loop: error: there is no such folder: create it, or name an existing folder with --out"}}) {
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_THAT(lines_of(outcome.err), ElementsAre(message));
    EXPECT_EQ(read("h.log"), log);
    EXPECT_EQ(files(), before);
  }
}

// As in a container that does not contain the folder of the file into which standard output is redirected.
TEST_F(HostileUsage, AnOutputMayBeAnOpenFileWhoseFolderDoesNotExist) {
  ASSERT_EQ(shell("run room.world --for 0.3 --threads 1 --quiet --hash-log right.log"), 0);
  EXPECT_EQ(
      shell("--version >/dev/null; mkdir gone && exec 5>gone/run.log && rm -r gone && '" + test::program() +
            "' run room.world --for 0.3 --threads 1 --quiet --hash-log /dev/fd/5 && cp /dev/fd/5 run.log"),
      0);
  EXPECT_EQ(read("run.log"), read("right.log"));
}

TEST_F(HostileUsage, AFolderMayEndInASlash) {
  EXPECT_EQ(troupe({"sweep", study("study.json"), "-o", "new/", "--quiet"}).code, 0);
  EXPECT_TRUE(fs::exists(path("new/table.csv")));
}

TEST_F(HostileUsage, TooFewThreadsAreAnErrorThatSaysSo) {
  if (!can_limit_threads())
    GTEST_SKIP() << "the limits cannot be set, or sanitizers reserve more address space";
  study("study.json");
  std::vector<std::string> commands{"sweep study.json -o none",
                                    "check room.world --for 0.1 --threads 1 --controllers"};
  if (worldio::has_hdf5()) commands.push_back("run room.world --for 0.1 --threads 1 --record run.h5");
  const auto expect_error = [&] {
    EXPECT_THAT(read("err.txt"), HasSubstr("error: "));
    EXPECT_THAT(
        read("err.txt"),
        HasSubstr("the system allows no further thread (use fewer threads, or raise the limits on threads "
                  "and memory of this process): Resource temporarily unavailable\n"));
  };
  for (const std::string& command : commands) {
    EXPECT_EQ(limited(k_no_thread, command + " >/dev/null"), 1) << command;
    expect_error();
  }
  // This world is so small that oneTBB starts no thread for it. Without oneTBB (TROUPE_STD_THREADS), too few
  // threads are an error in each world.
  const int exit_code = limited(k_one_thread, "run room.world --for 0.1 --threads 3 >/dev/null");
  if (exit_code != 0) {
    EXPECT_EQ(exit_code, 1);
    expect_error();
  }
  EXPECT_EQ(limited(k_no_thread, "view room.world --for 0.1 >/dev/null"), 1);
  EXPECT_FALSE(fs::exists(path("room.session.jsonl")));
  EXPECT_EQ(limited(k_one_thread, "sweep study.json -o one --threads 2 --quiet"), 0) << read("err.txt");
  EXPECT_TRUE(fs::exists(path("one/table.csv")));
}

// Mesa would wait for ever for threads that it cannot start.
TEST_F(HostileUsage, PicturesAreTheSameIfThereAreTooFewThreads) {
  if (!can_limit_threads())
    GTEST_SKIP() << "the limits cannot be set, or sanitizers reserve more address space";
  const Outcome outcome =
      troupe({"render", "room.world", "-o", "right.png", "--for", "0.1", "--threads", "1"});
  if (lacks_pictures(outcome)) GTEST_SKIP() << outcome.err;
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const int most_kilobytes : {k_no_thread, k_one_thread}) {
    EXPECT_EQ(limited(most_kilobytes, "render room.world -o limited.png --for 0.1 --threads 1"), 0)
        << read("err.txt");
    EXPECT_EQ(read("limited.png"), read("right.png"));
  }
}

TEST_F(HostileUsage, TooLittleMemoryForOsmesaDoesNotMeanThatItIsMissing) {
  if (!can_limit_threads())
    GTEST_SKIP() << "the limits cannot be set, or sanitizers reserve more address space";
  const std::vector<std::string> render{"render", "room.world", "-o", "right.png", "--threads", "1"};
  if (const Outcome outcome = troupe(render); lacks_pictures(outcome)) GTEST_SKIP() << outcome.err;
  constexpr int k_no_library = 100'000;
  EXPECT_EQ(limited(k_no_library, "render room.world -o none.png --for 0.1 --threads 1"), 1);
  EXPECT_THAT(
      read("err.txt"),
      HasSubstr("cannot draw: OSMesa cannot be loaded (raise the limits on memory of this process): "));
}

// Mesa would crash where it gets too little memory.
TEST_F(HostileUsage, TooLittleMemoryForAPictureIsAnError) {
  if (!can_limit_threads())
    GTEST_SKIP() << "the limits cannot be set, or sanitizers reserve more address space";
  const std::vector<std::string> render{"render", "room.world", "-o", "right.png", "--threads", "1"};
  if (const Outcome outcome = troupe(render); lacks_pictures(outcome)) GTEST_SKIP() << outcome.err;
  for (int most_kilobytes = 200'000; most_kilobytes <= 600'000; most_kilobytes += 50'000) {
    const int code = shell("--version >/dev/null; ulimit -v " + std::to_string(most_kilobytes) +
                           " || exit 9; timeout -s KILL 240 '" + test::program() +
                           "' render room.world -o limited.png --for 0.1 --threads 1 2>err.txt");
    if (code == 0) continue;
    EXPECT_EQ(code, 1) << most_kilobytes;
    EXPECT_THAT(read("err.txt"), HasSubstr("(raise the limits on memory of this process)")) << most_kilobytes;
  }
}

TEST_F(HostileUsage, FilmsHaveRatesThatCanBePlayed) {
  for (const auto& [option, value] :
       {std::pair("--fps", "1e-300"), std::pair("--film-speed", "1e-300"), std::pair("--fps", "nan")}) {
    const Outcome outcome = troupe({"run", "room.world", "--for", "1", "--film", "f%06d.png", option, value});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("0.001 to "));
  }
  EXPECT_THAT(files(), ElementsAre("room.world"));
}

// ffmpeg takes names with a colon for protocols: it would open a connection, and write elsewhere.
TEST_F(HostileUsage, NamesOfFilmsAreNamesOfFiles) {
  if (shell("--version >/dev/null; command -v ffmpeg >/dev/null") != 0)
    GTEST_SKIP() << "ffmpeg is not installed";
  ASSERT_EQ(shell("run room.world --for 0.3 --record run.h5 --quiet"), 0);
  for (const char* film : {"file:b.mp4", "http:x.mp4", "a:b.mp4"}) {
    const Outcome outcome = troupe({"render", "run.h5", "--film", film, "--size", "64x64"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(fs::exists(path(film))) << film;
  }
  EXPECT_EQ(files().size(), 5u);  // the world, the recording and three films
}

}  // namespace
}  // namespace troupe::apps::hostile_usage_test
