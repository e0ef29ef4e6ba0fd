#include "tests/apps/program.hpp"
#include "tests/support/paths.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace troupe::apps::info_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class Info : public ProgramTest {
 protected:
  Info() { write("room.world", k_room); }

  /// What is told of a file, its lines without indent and with single spaces.
  std::vector<std::string> info(const std::string& name) const {
    const Outcome outcome = troupe({"info", name});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::vector<std::string> lines;
    for (const std::string& line : lines_of(outcome.out)) {
      lines.emplace_back();
      for (const char c : line)
        if (c != ' ' || (!lines.back().empty() && lines.back().back() != ' ')) lines.back() += c;
    }
    return lines;
  }

  void run(std::vector<std::string> options) const {
    options.insert(options.begin(), {"run", "room.world", "--quiet", "--for", "2", "--seed", "7"});
    const Outcome outcome = troupe(options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }

  /// Copies a file without its last bytes, under a name that says nothing.
  void cut(const std::string& name, std::size_t bytes) {
    const std::string text = read(name);
    write("copy", text.substr(0, text.size() - bytes));
  }

  std::string error_of(const std::string& name) const {
    const Outcome outcome = troupe({"info", name});
    EXPECT_EQ(outcome.code, 2) << outcome.out;
    EXPECT_THAT(outcome.out, IsEmpty());
    return outcome.err;
  }
};

TEST_F(Info, OfAHashLogWhateverItsName) {
  run({"--hash-log", "odd.csv", "--threads", "2"});
  const std::vector<std::string> lines = info("odd.csv");
  EXPECT_THAT(lines, Contains("kind hash log, format 1"));
  EXPECT_THAT(lines, Contains(StartsWith("written by troupe ")));
  EXPECT_THAT(lines, Contains("world room.world"));
  EXPECT_THAT(lines, Contains("seed 7"));
  EXPECT_THAT(lines, Contains("robots 12"));
  EXPECT_THAT(lines, Contains("ticks 0 to 20, 0 to 2 s"));
  EXPECT_THAT(lines, Contains("last state " + lines_of(read("odd.csv")).back().substr(3, 16)));
  EXPECT_EQ(lines.back(), "complete yes");

  cut("odd.csv", 1);
  EXPECT_THAT(info("copy"), Contains("ticks 0 to 19, 0 to 1.9 s"));
  EXPECT_THAT(info("copy").back(), StartsWith("complete no: copy:"));
}

TEST_F(Info, OfATableOfMeasures) {
  run({"--measures", "m", "--measure", "stalls,displacement", "--measure-every", "0.5"});
  EXPECT_THAT(info("m"), ElementsAre("m", "kind table of measures", "measures stalls,displacement_m",
                                     "lines 5", "ticks 0 to 20, 0 to 2 s", "complete yes"));
  cut("m", 3);
  EXPECT_THAT(info("copy"),
              ElementsAre("copy", "kind table of measures", "measures stalls,displacement_m", "lines 4",
                          "ticks 0 to 15, 0 to 1.5 s", "complete no: cut off in line 6"));
  write("lines", "tick,time_s,\"stalls:a\nb\"\n0,0,1\n5,0.5,1\n");
  EXPECT_THAT(info("lines"),
              AllOf(Contains("lines 2"), Contains("ticks 0 to 5, 0 to 0.5 s"), Contains("complete yes")));
  write("copy", "tick,time_s,order\n0,0,1\nx,1,1\n");
  EXPECT_EQ(error_of("copy"),
            "copy:3: error: the line must begin with a tick and a time in seconds, found \"x,1\"\n");
}

TEST_F(Info, OfATableOfEvents) {
  write("e",
        "tick,time_s,event,robot,id,x_m,y_m,heading_rad\n"
        "3,0.3,stall_begins,\"a,b\",4,0,0,0\n"
        "5,0.5,stall_ends,\"a,b\",4,0,0,0\n"
        "9,0.9,stall_begins,r,5,0,0,0\n");
  EXPECT_THAT(info("e"), ElementsAre("e", "kind table of events", "events 3", "stall_begins 2",
                                     "stall_ends 1", "ticks 3 to 9, 0.3 to 0.9 s", "complete yes"));
  write("broken",
        "tick,time_s,event,robot,id,x_m,y_m,heading_rad\n"
        "3,0.3,stall_begins,\"a\nb \"\"c\"\"\",4,0,0,0\n"
        "5,0.5,stall_ends,\"a\nb");
  EXPECT_THAT(info("broken"), ElementsAre("broken", "kind table of events", "events 1", "stall_begins 1",
                                          "ticks 3 to 3, 0.3 to 0.3 s", "complete no: cut off in line 5"));
  run({"--events", "own"});
  EXPECT_THAT(info("own"), AllOf(Contains("kind table of events"), Contains("complete yes")));
  write("none", "tick,time_s,event,robot,id,x_m,y_m,heading_rad\n");
  EXPECT_THAT(info("none"), AllOf(Contains("events 0"), Contains("ticks none"), Contains("complete yes")));
}

TEST_F(Info, OfAProfile) {
  run({"--profile", "p.json", "--profile-ticks", "3:6"});
  const std::vector<std::string> lines = info("p.json");
  EXPECT_THAT(lines, Contains("kind profile, in the Trace Event Format"));
  EXPECT_THAT(lines, Contains(StartsWith("written by troupe ")));
  EXPECT_THAT(lines, Contains("seed 7"));
  EXPECT_THAT(lines, Contains("ticks 4"));
  EXPECT_EQ(lines.back(), "complete yes");
  std::string other_ends;
  for (const char c : read("p.json")) other_ends += c == '\n' ? "\r\n" : std::string(1, c);
  write("p2.json", other_ends);
  std::vector<std::string> same = info("p2.json");
  EXPECT_EQ(std::exchange(same.front(), "p.json"), "p2.json");
  EXPECT_EQ(same, lines);
  cut("p.json", 30);
  EXPECT_EQ(info("copy").back(), "complete no: cut off");
}

TEST_F(Info, OfARecording) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  run({"--record", "r", "--record-every", "0.5", "--record-fields", "pose,ranges"});
  const std::vector<std::string> lines = info("r");
  EXPECT_THAT(lines, Contains("kind recording, layout 1"));
  EXPECT_THAT(lines, Contains(StartsWith("written by troupe ")));
  EXPECT_THAT(lines, Contains("world room.world"));
  EXPECT_THAT(lines, Contains("seed 7"));
  EXPECT_THAT(lines, Contains("bodies 12"));
  EXPECT_THAT(lines, Contains("frames 5"));
  EXPECT_THAT(lines, Contains("ticks 0 to 20, 0 to 2 s"));
  EXPECT_THAT(lines, Contains("pose heading, x, y, z"));
  EXPECT_THAT(lines, Contains("ranger:0 (bot) ranges[9]")) << "as in --record-fields and --color-by";
  EXPECT_EQ(lines.back(), "complete yes");

  write("copy", read("r").substr(0, 3000));
  EXPECT_THAT(error_of("copy"), StartsWith("copy: error: "));
  write("copy", read("r").substr(0, 8) + std::string(4000, 'x'));
  EXPECT_THAT(error_of("copy"), StartsWith("copy: error: "));
  // HDF5 cannot close a file with a damaged object header at the exit of the program, and must not try to.
  std::string damaged = read("r");
  damaged[damaged.rfind("OHDR") + 20] ^= 1;
  write("copy", damaged);
  EXPECT_THAT(lines_of(error_of("copy")), ElementsAre(HasSubstr("incorrect metadata checksum")));
}

TEST_F(Info, OfACheckpoint) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  run({"--checkpoint", "c", "--hash-log", "h.log"});
  const std::vector<std::string> lines = info("c");
  EXPECT_THAT(lines, Contains("kind checkpoint, layout 1"));
  EXPECT_THAT(lines, Contains(StartsWith("written by troupe ")));
  EXPECT_THAT(lines, Contains("world room.world"));
  EXPECT_THAT(lines, Contains("seed 7"));
  EXPECT_THAT(lines, Contains("robots 12"));
  EXPECT_THAT(lines, Contains("tick 20, 2 s"));
  EXPECT_THAT(lines, Contains("state " + lines_of(read("h.log")).back().substr(3, 16)));
  EXPECT_EQ(lines.back(), "complete yes");
  cut("c", 1);
  EXPECT_THAT(error_of("copy"), StartsWith("copy: error: "));
}

TEST_F(Info, OfWorlds) {
  write("stage", std::string("# a comment\n\n# and another\n") + std::string(k_room));
  const std::vector<std::string> stage = info("stage");
  EXPECT_THAT(stage, Contains("kind world, in Stage's syntax"));
  EXPECT_THAT(stage, Contains("robots 12"));
  EXPECT_THAT(stage, Contains("other models 4"));
  EXPECT_THAT(stage, Contains("seed 1"));
  EXPECT_THAT(stage, Contains("tick 0.1 s"));

  write("ours",
        R"(  {"title": "T", "troupe": 1, "seed": 9, "quit_time_s": 3, "measures": ["order", "stalls:b"],
    "types": {"bot": {"size_m": [1, 1, 1], "drive": {"kind": "omni"}, "controller": {"kind": "script"}}},
    "populations": [{"name": "b", "type": "bot", "count": 2,
                     "place": {"rule": "uniform", "region_m": [[0, 0], [9, 9]]}}]})");
  EXPECT_THAT(
      info("ours"),
      ElementsAre("ours", "kind world, in JSON, format 1", "title T", "seed 9", "tick 0.1 s", "ends at 3 s",
                  "ranging exact", "robots 2", "bot 2: omni, script", "other models 0",
                  "bounds none: the world reaches 100 km in each direction", "measures order, stalls:b"));
}

TEST_F(Info, OfAnExperiment) {
  const Outcome outcome = troupe({"info", (test::source_dir() / "worlds/failures.json").string()});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("covered >= 0.9\n"));
  EXPECT_THAT(outcome.out,
              HasSubstr("move at 5 s, disable at 10 s, enable at 15 s, remove at 20 s, set at 25 s\n"));
  EXPECT_THAT(outcome.out, HasSubstr("slow_wheels of rover, dead_sensors of rover, drop_out of rover\n"));
}

TEST_F(Info, OfAStudyAndItsTables) {
  write("s.json", R"({"troupe_study": 1, "world": "room.world", "for_s": 1, "series": true, "seeds": [4, 5],
    "parameters": [{"name": "period_s", "set": "/period_s", "values": [0.5, 0.25]},
    {"set": "/speed", "from": 1, "to": 3, "steps": 2, "with": "period_s"}], "measures": ["stalls"]})");
  EXPECT_THAT(info("s.json"),
              ElementsAre("s.json", "kind study, format 1", "world room.world", "runs 4", "ends at 1 s",
                          "parameters 2", "period_s 0.5, 0.25", "speed 1 to 3 in 2 steps, with period_s",
                          "seeds 2", "measures stalls"));
  const std::string columns = "columns run,period_s,seed,ticks,time_s,stalls,stopped_by,state_hash,error";
  write("table", columns.substr(8) + "\n0,0.5,4,10,1,0,,aa,\n1,0.5,5,0,nan,nan,,,\"a,\nb\"\n");
  EXPECT_THAT(info("table"),
              ElementsAre("table", "kind table of the results of a sweep", columns,
                          "runs 2, of which 1 failed: see the column \"error\"", "complete yes"));
  write("table", columns.substr(8) + "\r\n0,0.5,4,10,1,0,,aa,\r\n1,0.5,5,0,nan,nan,,,\"a,\r\nb\"\r\n");
  EXPECT_THAT(info("table"),
              ElementsAre("table", "kind table of the results of a sweep", columns,
                          "runs 2, of which 1 failed: see the column \"error\"", "complete yes"));
  write("table",
        "run," + std::string(5000, 'x') + columns.substr(columns.find(",seed,")) + "\n0,0.5,4,10,1,0,,aa,\n");
  EXPECT_THAT(info("table"), Contains("kind table of the results of a sweep"));
  write("table", "run,time_step,seed,ticks,time_s,stalls,stopped_by,state_hash,error\n0,0.5,4,10,1,0,,aa,\n");
  EXPECT_THAT(info("table"), Contains("kind table of the results of a sweep"));
  write("table", columns.substr(8) + "\n0,0.5,4,10,1,0,,aa,\n1,0.5");
  EXPECT_THAT(info("table"), AllOf(Contains("runs 1"), Contains("complete no: cut off in line 3")));
  write("series", "run,time_s,stalls\n0,0,0\n0,1,0\n2,0,0\n");
  EXPECT_THAT(info("series"), ElementsAre("series", "kind measures over time of the runs of a sweep",
                                          "columns run,time_s,stalls", "runs 2", "lines 3", "complete yes"));

  write("s.json", R"({"troupe_study": 1, "world": "room.world", "for_s": 1,
    "parameters": [{"name": "p", "set": "/seed", "values": [1, 2]}], "measures": ["stalls"]})");
  ASSERT_EQ(troupe({"sweep", "s.json", "-o", "out", "--quiet"}).code, 0);
  EXPECT_THAT(info("out/table.csv"), Contains("runs 2"));
  if (worldio::has_hdf5()) {
    EXPECT_THAT(info("out/table.h5"), AllOf(Contains("kind table of the results of a sweep, in HDF5"),
                                            Contains("runs 2"), Contains("complete yes")));
  }
  EXPECT_THAT(info("out/runs-1-of-1.jsonl"),
              AllOf(Contains(::testing::StartsWith("kind journal of a sweep")), Contains("finished runs 2"),
                    Contains("failed runs 0"), Contains("complete yes")));
  write("torn.jsonl", read("out/runs-1-of-1.jsonl") + "{\"run\":1,\"err");
  EXPECT_THAT(info("torn.jsonl"),
              AllOf(Contains("finished runs 2"), Contains("complete no: cut off in line 4")));
  write("bad.jsonl", read("out/runs-1-of-1.jsonl") + "oh\n");
  EXPECT_THAT(error_of("bad.jsonl"), HasSubstr("bad.jsonl:4: error: not a result that troupe sweep writes"));
  write("s.json", "{\"troupe_study\": 1,\n \"word\": 1}");
  EXPECT_THAT(error_of("s.json"), HasSubstr("s.json:2: error: unknown key \"word\""));
}

TEST_F(Info, OfASession) {
  const std::string header =
      R"({"troupe_session":1,"version":"troupe 0.1","tick":2,"hash":"00","options":{"seed":"7"}})";
  const std::string acts =
      "\n{\"tick\":3,\"n\":1,\"do\":\"remove\",\"robot\":\"r0\"}\n"
      "{\"tick\":4,\"n\":2,\"do\":\"remove\",\"robot\":\"r1\"}\n";
  write("s.jsonl", header + acts + "{\"tick\":9,\"n\":3,\"do\":\"end\"}\n");
  EXPECT_THAT(info("s.jsonl"),
              ElementsAre("s.jsonl", "kind session, format 1", "written by troupe 0.1", "seed 7", "actions 2",
                          "remove 2", "ticks 2 to 9", "complete yes"));
  write("s.jsonl", header + acts);
  EXPECT_THAT(info("s.jsonl"), AllOf(Contains("ticks 2 to 4"),
                                     Contains("complete no: the line that ends the session is missing")));
  write("s.jsonl", header + "\n{\"tick\":3,\"n\":1,\"do\":\"fly\"}\n");
  EXPECT_THAT(error_of("s.jsonl"), StartsWith("s.jsonl:2: error: unknown action \"fly\""));
}

TEST_F(Info, WrongWorldsTellWhatIsWrong) {
  write("ours", "{\"troupe\": 1,\n \"sed\": 9}");
  EXPECT_THAT(error_of("ours"), StartsWith("ours:2: error: unknown key \"sed\""));
  write("ours", "{\"troupe\": 1,\n \"seed\": ");
  EXPECT_THAT(error_of("ours"), StartsWith("ours:2: error: "));
  write("stage", "define bot position ( size [1 1\n");
  EXPECT_THAT(error_of("stage"), StartsWith("stage:"));
}

TEST_F(Info, WorldsHaveByteOrderMarksAndLineEndsOfOtherSystems) {
  const std::string mark = "\xef\xbb\xbf";
  write("mark", mark + std::string(k_room));
  EXPECT_THAT(info("mark"), Contains("kind world, in Stage's syntax"));
  write("mark.json", mark + "{\"troupe\": 1}");
  EXPECT_THAT(info("mark.json"), Contains("kind world, in JSON, format 1"));
  write("study.json", mark + R"({"troupe_study": 1, "world": "mark.json", "for_s": 1})");
  EXPECT_THAT(info("study.json"), Contains("kind study, format 1"));
  std::string mac = "# a world\n" + std::string(k_room);
  std::ranges::replace(mac, '\n', '\r');
  write("mac", mac);
  EXPECT_THAT(info("mac"), Contains("robots 12"));
  write("long", "# " + std::string(5000, 'x') + "\n" + std::string(k_room));
  EXPECT_THAT(info("long"), Contains("robots 12"));
  write("empty.world", "");
  EXPECT_THAT(info("empty.world"), Contains("robots 0"));
  for (const std::string name : {"wide.json", "wide.world"}) {
    write(name, std::string("\xff\xfe{\0", 4));
    EXPECT_EQ(error_of(name), name + ": error: the file is encoded in UTF-16: save it in UTF-8\n");
  }
}

TEST_F(Info, ShowsTheNamesOfDevicesInARecordingAsTheWorldGivesThem) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  write("room.world",
        "define bot position ( ranger( name \"x/y\" sensor( samples 9 ) ) )\nbot( name \"b\" )\n");
  run({"--record", "r", "--record-fields", "ranges"});
  EXPECT_THAT(info("r"), Contains("x/y (bot) ranges[9]"));
}

TEST_F(Info, OtherFilesAreNoneOfOurs) {
  const std::string what =
      ": error: not a file that this command knows: expected a world (Stage's or JSON), a hash log, ";
  write("notes", "Buy milk (and bread)\n");
  write("empty", "");
  write("other.json", "{\"name\": [1, 2]}");
  write("list.json", "[1, 2]");
  write("bytes", std::string("define\0x", 8));
  write("other.csv", "time,x\n1,2\n");
  for (const char* name : {"notes", "empty", "other.json", "list.json", "bytes", "other.csv"})
    EXPECT_THAT(error_of(name), StartsWith(name + what)) << name;
  EXPECT_EQ(error_of("nowhere"), "nowhere: error: there is no such file\n");
  EXPECT_EQ(error_of("."), ".: error: this is a folder, not a file\n");
  EXPECT_EQ(error_of("/proc/self/mem"), "/proc/self/mem: error: cannot be read: Input/output error\n");
}

TEST_F(Info, HelpSaysWhatItTakes) {
  const Outcome outcome = troupe({"info", "--help"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("hash log"), HasSubstr("Exit codes: 0 printed; 2 ")));
}

}  // namespace
}  // namespace troupe::apps::info_test
