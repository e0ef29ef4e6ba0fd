#include "tests/apps/program.hpp"
#include "tests/support/paths.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <map>
#include <string>
#include <vector>

namespace troupe::apps::tables_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::SizeIs;
using ::testing::StartsWith;

class Tables : public ProgramTest {
 protected:
  Tables() { write("room.world", k_room); }

  /// A run of the room that must end well.
  void run(std::vector<std::string> options) const {
    options.insert(options.begin(), {"run", "room.world", "--quiet"});
    const Outcome outcome = troupe(options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }

  /// What must be refused, with one line, and nothing written.
  void refused(std::vector<std::string> options, const std::string& message) const {
    const std::vector<std::string> before = files();
    options.insert(options.begin(), {"run", "room.world", "--for", "1"});
    const Outcome outcome = troupe(options);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(lines_of(outcome.err), ElementsAre(message));
    EXPECT_EQ(files(), before);
  }
};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

double number_of(const std::string& text) {
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  EXPECT_EQ(result.ptr, text.data() + text.size()) << text;
  return value;
}

TEST_F(Tables, MeasuresHaveALineOfNamesAndOneForEachSample) {
  run({"--for", "2", "--measures", "m.csv", "--measure", "stalls,displacement", "--measure", "coverage",
       "--measure-every", "0.5"});
  const std::vector<std::string> lines = lines_of(read("m.csv"));
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_EQ(lines[0], "tick,time_s,stalls,displacement_m,coverage");
  EXPECT_THAT(lines[1], StartsWith("0,0,0,0,"));
  EXPECT_THAT(lines[2], StartsWith("5,0.5,"));
  EXPECT_THAT(lines[5], StartsWith("20,2,"));
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> cells = cells_of(lines[i]);
    ASSERT_EQ(cells.size(), 5u);
    for (const std::string& cell : cells) number_of(cell);
    if (i > 1) {
      EXPECT_GE(number_of(cells[4]), number_of(cells_of(lines[i - 1])[4]));
    }
  }
  EXPECT_GT(number_of(cells_of(lines[5])[3]), 0.1);
}

TEST_F(Tables, WithoutAnyNameEveryMeasureIsTakenEverySecond) {
  run({"--for", "2", "--measures", "m.csv"});
  const std::vector<std::string> lines = lines_of(read("m.csv"));
  EXPECT_EQ(
      lines[0],
      "tick,time_s,coverage,mean_nearest_distance_m,neighbours,stalls,held,displacement_m,path_length_m,"
      "mean_speed_mps,order,spread_m,alive");
  EXPECT_THAT(lines, ElementsAre(StartsWith("tick"), StartsWith("0,"), StartsWith("10,"), StartsWith("20,")));
}

TEST_F(Tables, EveryTickIsAskedForWithZero) {
  run({"--for", "1", "--measures", "m.csv", "--measure", "order", "--measure-every", "0"});
  EXPECT_THAT(lines_of(read("m.csv")), SizeIs(12));
}

TEST_F(Tables, AreTheSameOnAnyThreadsAndTilesAndChangeNoHash) {
  std::vector<std::string> measures, events, hashes;
  for (const char* threads : {"1", "2", "8"})
    for (const char* tile : {"1", "5"}) {
      run({"--for", "20", "--threads", threads, "--tile-size", tile, "--measures", "m.csv", "--measure-every",
           "0.1", "--events", "e.csv", "--hash-log", "h.log"});
      measures.push_back(read("m.csv"));
      events.push_back(read("e.csv"));
      hashes.push_back(lines_of(read("h.log")).back());
    }
  run({"--for", "20", "--hash-log", "h.log"});
  hashes.push_back(lines_of(read("h.log")).back());
  EXPECT_THAT(measures, Each(measures.front()));
  EXPECT_THAT(events, Each(events.front()));
  EXPECT_THAT(hashes, Each(hashes.front()));
  EXPECT_GT(lines_of(events.front()).size(), 1u);
}

TEST_F(Tables, EventsAddUpToTheStallsThatAreMeasured) {
  run({"--for", "20", "--measures", "m.csv", "--measure", "stalls", "--measure-every", "0", "--events",
       "e.csv"});
  const std::vector<std::string> events = lines_of(read("e.csv"));
  EXPECT_EQ(events[0], "tick,time_s,event,robot,id,x_m,y_m,heading_rad,other,other_id");
  std::map<std::string, int> change;  // by tick
  int last_tick = 0;
  for (std::size_t i = 1; i < events.size(); ++i) {
    const bool is_named = events[i].find("stall_begins") != std::string::npos;  // who is in the way
    EXPECT_THAT(events[i], MatchesRegex("[0-9]+,[0-9.]+,(stall|held)_(begins|ends),position:[0-9]+,[0-9]+,"
                                        "[-0-9.e]+,[-0-9.e]+,[-0-9.e]+," +
                                        std::string(is_named ? "[^,]+,[0-9]+" : ",")));
    const std::vector<std::string> cells = cells_of(events[i]);
    change[cells[0]] += cells[2].ends_with("_begins") ? 1 : -1;
    EXPECT_GE(std::stoi(cells[0]), last_tick);
    last_tick = std::stoi(cells[0]);
  }
  EXPECT_GT(events.size(), 3u);
  int stalled = 0;
  const std::vector<std::string> lines = lines_of(read("m.csv"));
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> cells = cells_of(lines[i]);
    stalled += change[cells[0]];
    EXPECT_EQ(cells[2], std::to_string(stalled)) << lines[i];
  }
}

TEST_F(Tables, BirthsAndDeathsAreToldAndCounted) {
  const std::string world = (test::source_dir() / "worlds/colony.json").string();
  EXPECT_EQ(troupe({"run", world, "--quiet", "--for", "13", "--events", "e.csv", "--measures", "m.csv"}).code,
            0);
  std::vector<std::string> told;
  for (const std::string& line : lines_of(read("e.csv"))) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells[3] == "walker0") told.push_back(cells[0] + " " + cells[2]);
    if (cells[2] == "birth" && cells[3] == "walker0") {
      EXPECT_EQ(cells[5], "-6");
    }
  }
  EXPECT_THAT(told, ElementsAre("20 birth", "122 death"));
  const std::vector<std::string> lines = lines_of(read("m.csv"));
  EXPECT_EQ(lines[0], "tick,time_s,alive:ant,alive:walker");
  EXPECT_THAT(lines[1], EndsWith(",8,0"));
  EXPECT_THAT(lines[5], EndsWith(",8,2")) << lines[5];  // 4 s
  EXPECT_THAT(lines[14], EndsWith(",5")) << "six that were born, and one that died";
  const Outcome info = troupe({"info", world});
  EXPECT_THAT(info.out, HasSubstr("60 of ant, 200 of walker"));
}

TEST_F(Tables, NamesThatNeedItStandInQuotes) {
  write("odd.json", R"({"troupe": 1, "types": {
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
            "controller": {"kind": "script", "legs": [{"until_s": 9, "forward_mps": 1}]}},
    "wall": {"size_m": [0.1, 1, 1]}},
    "models": [{"name": "a \"b\", c", "type": "bot"}, {"name": "w", "type": "wall", "pose": {"x_m": 0.4}}]})");
  EXPECT_EQ(troupe({"run", "odd.json", "--quiet", "--for", "1", "--events", "e.csv"}).code, 0);
  const std::vector<std::string> lines = lines_of(read("e.csv"));
  ASSERT_GE(lines.size(), 2u);
  EXPECT_THAT(lines[1], HasSubstr(",stall_begins,\"a \"\"b\"\", c\",1,"));
}

TEST_F(Tables, AWorldMaySayWhatIsMeasuredAndTheCommandLineBeatsIt) {
  const std::string world = R"({"troupe": 1, "measure_every_s": 0.2,
    "measures": ["order", {"kind": "coverage", "name": "fine", "cell_m": 0.5}, "stalls:a",
                 {"kind": "displacement", "of": "bot"}],
    "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}}},
    "populations": [{"name": "a", "type": "bot", "count": 3, "place": {"rule": "uniform", "region_m": [[0, 0], [4, 4]]}},
                    {"name": "b", "type": "bot", "count": 2, "place": {"rule": "uniform", "region_m": [[4, 4], [8, 8]]}}]})";
  write("w.json", world);
  EXPECT_EQ(troupe({"run", "w.json", "--quiet", "--for", "1", "--measures", "m.csv"}).code, 0);
  EXPECT_THAT(lines_of(read("m.csv")),
              AllOf(SizeIs(7), Contains("tick,time_s,order,fine,stalls:a,displacement_m:bot")));
  EXPECT_EQ(troupe({"run", "w.json", "--quiet", "--for", "1", "--measures", "m.csv", "--measure",
                    "neighbours:b,spread", "--measure",
                    R"({"kind": "neighbours", "name": "wide", "radius_m": 9})", "--measure-every", "0.5"})
                .code,
            0);
  EXPECT_THAT(lines_of(read("m.csv")), AllOf(SizeIs(4), Contains("tick,time_s,neighbours:b,spread_m,wide")));
}

TEST_F(Tables, WrongMeasuresOfAWorldAreFoundAtTheirLines) {
  write("w.json",
        "{\"troupe\": 1,\n \"measures\": [\n  \"stals\",\n  {\"kind\": \"coverage\", \"cell_m\": 0},\n"
        "  {\"kind\": \"order\", \"name\": \"a,b\"},\n  7, \"stalls:\",\n {\"of\": \"x\"}]}");
  const Outcome outcome = troupe({"run", "w.json", "--for", "1"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(
      lines_of(outcome.err),
      ElementsAre(
          StartsWith("w.json:3: error: /measures/0: unknown measure \"stals\"; known: "),
          StartsWith("w.json:4: error: /measures/1/cell_m: "),
          "w.json:5: error: /measures/2/name: \"a,b\" is not a column name: only letters, digits and _ - . : "
          "are allowed",
          StartsWith(
              "w.json:6: error: /measures/3: expected the name of a measure, or {\"kind\": ..., ...}, "),
          "w.json:6: error: /measures/4: \"stalls:\": expected the name of a type, a population or a "
          "robot after the colon",
          StartsWith("w.json:7: error: /measures/5: missing \"kind\"")));
  write("w.json", "{\"troupe\": 1,\n \"measures\": [\n  \"stalls:missing\"]}");
  EXPECT_THAT(
      lines_of(troupe({"run", "w.json", "--for", "1", "--measures", "m.csv"}).err),
      ElementsAre(
          "w.json:3: error: /measures/0: unknown type or population of robots \"missing\"; no type or "
          "population of robots exists"));
}

TEST_F(Tables, WhatCannotBeMeasuredIsRefusedBeforeTheRun) {
  refused(
      {"--measures", "m.csv", "--measure", "coverge", "--hash-log", "h.log"},
      "measure coverge: error: unknown measure \"coverge\"; known: alive, clusters, coverage, deaths, "
      "displacement, held, "
      "largest_cluster, mean_nearest_distance, mean_speed, neighbours, order, path_length, polarisation, "
      "rank_errors, share_within, spread, stalls, state_mean, state_variance (did you mean "
      "\"coverage\"?); no folder to search for coverge.so: give --plugin-path "
      "(in C++ and Python: plugin_path); if it is a Python script, give --controller coverge.py (in Python: "
      "controllers=[\"coverge.py\"])");
  refused({"--measures", "m.csv", "--measure", "share_within"},
          "measure share_within: error: the measure \"share_within\" has parameters without a default: write "
          "{\"kind\": \"share_within\", \"center_m\": ..., \"radius_m\": ...}");
  refused({"--events", "none/e.csv"}, "none/e.csv: error: cannot be written: there is no folder none");
  refused({"--events", "m.csv", "--measures", "./m.csv"},
          "m.csv: error: cannot be written: another output has the same name: choose another file name");
  refused({"--measure", "order"}, "troupe run: error: --measure requires --measures; see troupe run --help");
  refused({"--measures", "m.csv", "--measure", "order,,stalls"},
          "troupe run: error: --measure: \"order,,stalls\" is not a list of measures, as in --measure "
          "coverage,stalls; `troupe describe` lists them; see troupe run --help");
  refused({"--measures", "m.csv", "--measure-every", "-1"},
          "troupe run: error: --measure-every: \"-1\" is not a time in seconds, from 0 to 1000000000; see "
          "troupe run --help");
}

TEST_F(Tables, AnExistingTableIsOverwrittenLikeAHashLog) {
  const std::string events = "tick,time_s,event,robot,id,x_m,y_m,heading_rad,other,other_id\n";
  for (const auto& [m, e, h, p] : std::vector<std::array<std::string, 4>>{
           {"tick,time_s,stalls\n0,0,1\n", events + std::string(100000, 'x'), "# troupe hash log 1\n# old\n",
            "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\nold"},
           {"", "", "", ""},
           {"tick,ti", "tick,time_s,ev", "# tro", "{\"disp"}}) {  // runs that were killed
    write("m.csv", m);
    write("e.csv", e);
    write("h.log", h);
    write("p.json", p);
    run({"--for", "0.1", "--measures", "m.csv", "--measure", "order", "--events", "e.csv", "--hash-log",
         "h.log", "--profile", "p.json"});
    EXPECT_THAT(lines_of(read("m.csv")), ElementsAre("tick,time_s,order", StartsWith("0,0,")));
    EXPECT_THAT(read("e.csv"), AllOf(StartsWith(events), ::testing::Not(HasSubstr("xxx"))));
    EXPECT_THAT(read("h.log"), StartsWith("# troupe hash log 1\n# version: "));
    EXPECT_THAT(read("p.json"),
                AllOf(StartsWith("{\"displayTimeUnit\""), ::testing::Not(HasSubstr("\nold"))));
  }
}

TEST_F(Tables, AnExistingFileOfAnotherTypeIsKept) {
  const std::string measures = "tick,time_s,stalls\n0,0,1\n", events = "tick,time_s,event,robot,id\n";
  const std::vector<std::array<std::string, 4>> cases{
      {"--events", "study.json", "{\"troupe_study\": 1}\n", "a table of events (--events)"},
      {"--events", "m.csv", measures, "a table of events (--events)"},
      {"--events", "n", "n", "a table of events (--events)"},
      {"--measures", "e.csv", events, "a table of measures (--measures)"},
      {"--measures", "t.csv", "tick,robot\n", "a table of measures (--measures)"},
      {"--hash-log", "house.pgm", "P5 1 1 255\n0", "a hash log (--hash-log)"},
      {"--profile", "w.json", "{\"troupe\": 1}\n", "a profile (--profile)"},
  };
  for (const auto& [option, file, text, type] : cases) {
    write(file, text);
    refused({"--snapshot", "new.png", option, file},
            fmt::format("{}: error: cannot be written: the file exists and is not {}: choose another file "
                        "name, or remove the file",
                        file, type));
    EXPECT_EQ(read(file), text);
  }
  for (const char* option : {"--measures", "--events", "--hash-log"})
    run({"--for", "0.1", option, "/dev/null"});
}

TEST_F(Tables, AFullDiskIsAFailureAndNotASuccess) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  for (const char* option : {"--measures", "--events"}) {
    const Outcome outcome = troupe({"run", "room.world", "--for", "1", option, "/dev/full"});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("/dev/full: error: writing failed at tick 0"));
  }
}

TEST_F(Tables, GoOnWithARunThatIsResumedAsIfItHadNeverStopped) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  const std::vector<std::string> outputs{"--measures", "m.csv",    "--measure-every",
                                         "0.3",        "--events", "e.csv"};
  const auto with_outputs = [&](std::vector<std::string> options) {
    options.insert(options.end(), outputs.begin(), outputs.end());
    return options;
  };
  run(with_outputs({"--for", "20"}));
  const std::string measures = read("m.csv");
  const std::string events = read("e.csv");
  ASSERT_GT(lines_of(events).size(), 3u);
  for (const char* stop : {"6", "7.1"}) {  // with a line for that tick, and without
    run(with_outputs({"--for", stop, "--checkpoint", "c.h5", "--force"}));
    // What a run that was killed later had written already is written again.
    write("m.csv", read("m.csv") + "90,9,1,1,1,1,1,1,1,1,1,1\n93,9.3");
    write("e.csv", read("e.csv") + "90,9,stall_begins,r,1,0,0,0\n");
    const Outcome resumed =
        troupe(with_outputs({"resume", "c.h5", "--quiet", "--for", "20", "--threads", "1"}));
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(read("m.csv"), measures) << stop;
    EXPECT_EQ(read("e.csv"), events) << stop;
  }
}

TEST_F(Tables, ThatCannotGoOnAreRefusedAndLeftAsTheyAre) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  run({"--for", "1", "--measures", "m.csv", "--measure", "coverage"});
  run({"--for", "1", "--checkpoint", "c.h5"});
  const std::string before = read("m.csv");
  const std::vector<std::string> resume{"resume", "c.h5", "--for", "2", "--measures", "m.csv", "--measure"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), resume.begin(), resume.end());
    return troupe(more);
  };
  Outcome outcome = with({"coverage"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(
      lines_of(outcome.err),
      ElementsAre(
          "m.csv: error: this table cannot be continued: when the checkpoint was saved, \"coverage\" was not "
          "computed, or with other robots, parameters or bounds: repeat the --measure options of the run "
          "that wrote the table, or give --measures a new file"));
  outcome = with({"order"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(
      outcome.err,
      "m.csv: error: this table cannot be continued: its first line is \"tick,time_s,coverage\", but the "
      "measures of this run have the columns \"tick,time_s,order\": repeat the --measure options of the "
      "run that wrote the table, or give --measures a new file\n");
  EXPECT_EQ(read("m.csv"), before);
}

TEST_F(Tables, RecogniseMeasuresByWhatTheyCompute) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  const auto near = [](const char* radius_m) {
    return fmt::format(R"({{"kind": "neighbours", "radius_m": {}}})", radius_m);
  };
  run({"--for", "2", "--checkpoint", "c.h5", "--measures", "m.csv", "--measure", "coverage,stalls",
       "--measure", near("1")});
  const auto resumed = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"resume", "c.h5", "--for", "3", "--quiet", "--measures"});
    return troupe(more);
  };
  const std::string coverage = cells_of(lines_of(read("m.csv")).back())[2];
  ASSERT_GT(number_of(coverage), 0);
  // Another list of measures, or another name, does not change what a measure remembers.
  EXPECT_EQ(resumed({"n.csv", "--measure", "stalls,displacement", "--measure",
                     R"({"kind": "coverage", "name": "seen"})"})
                .err,
            "");
  EXPECT_EQ(cells_of(lines_of(read("n.csv"))[1])[4], coverage);

  const std::string before = read("m.csv");
  const Outcome wider = resumed({"m.csv", "--measure", "coverage,stalls", "--measure", near("3")});
  EXPECT_EQ(wider.code, 2);
  EXPECT_THAT(wider.err,
              StartsWith("m.csv: error: this table cannot be continued: when the checkpoint was saved, "
                         "\"neighbours\" was not computed, or with other robots, parameters or bounds: "));
  EXPECT_EQ(read("m.csv"), before);

  const Outcome fresh = troupe({"resume", "c.h5", "--for", "3", "--measures", "p.csv", "--measure",
                                "path_length,stalls", "--threads", "1"});
  EXPECT_EQ(fresh.code, 0);
  EXPECT_THAT(fresh.err, HasSubstr("p.csv: warning: the checkpoint has no data of earlier ticks for "
                                   "\"path_length_m\", which was not computed before, or with other robots, "
                                   "parameters or bounds: the measure begins at tick 20\n"));
}

TEST_F(Tables, AreCompleteIfTheRunEndsBecauseAnotherOutputFailed) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  const std::vector<std::string> tables{"--measures",      "m.csv", "--measure", "path_length",
                                        "--measure-every", "0",     "--events",  "e.csv"};
  const auto with_tables = [&](std::vector<std::string> options) {
    options.insert(options.end(), tables.begin(), tables.end());
    return options;
  };
  run(with_tables({"--for", "90"}));
  const std::string measures = read("m.csv");
  const std::string events = read("e.csv");
  const Outcome failed = troupe_with_file_limit(
      with_tables({"run", "room.world", "--for", "90", "--hash-log", "h.log", "--checkpoint", "c.h5"}),
      70000);
  EXPECT_EQ(failed.code, 1);
  EXPECT_THAT(failed.err, HasSubstr("h.log: error: writing failed at tick "));
  EXPECT_THAT(read("h.log"), ::testing::EndsWith("\n")) << "it has only whole lines";
  const Outcome resumed = troupe(with_tables({"resume", "c.h5", "--for", "90", "--quiet"}));
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(read("m.csv"), measures);
  EXPECT_EQ(read("e.csv"), events);
}

TEST_F(Tables, KeepTheirPeriodWhenTheRunIsResumed) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  const auto resumed = [&](std::vector<std::string> more) {
    run({"--for", "1", "--checkpoint", "c.h5", "--force", "--measures", "m.csv", "--measure", "stalls",
         "--measure-every", "0.4"});
    more.insert(more.begin(),
                {"resume", "c.h5", "--quiet", "--for", "2", "--measure", "stalls", "--measures"});
    const Outcome outcome = troupe(more);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::vector<std::string> times;
    for (const std::string& line : lines_of(read(more[8])))
      times.push_back(line.substr(line.find(',') + 1, line.rfind(',') - line.find(',') - 1));
    return times;
  };
  EXPECT_THAT(resumed({"m.csv"}), ElementsAre("time_s", "0", "0.4", "0.8", "1.2", "1.6", "2"));
  EXPECT_THAT(resumed({"m.csv", "--measure-every", "0.5"}),
              ElementsAre("time_s", "0", "0.4", "0.8", "1", "1.5", "2"));
  EXPECT_THAT(resumed({"new.csv"}), ElementsAre("time_s", "1", "2"));
}

TEST_F(Tables, OfOtherRunsAreRefusedAndLeftAsTheyAre) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "this build has no HDF5";
  run({"--for", "20", "--events", "e.csv", "--measures", "m.csv", "--measure", "stalls"});
  run({"--for", "1", "--checkpoint", "without.h5"});
  run({"--for", "20", "--seed", "9", "--checkpoint", "other.h5", "--events", "e9.csv", "--measures", "m9.csv",
       "--measure", "stalls"});
  const auto refused = [&](const std::string& checkpoint, const std::string& file,
                           const std::vector<std::string>& options, const std::string& reason) {
    const std::string before = read(file);
    std::vector<std::string> arguments{"resume", checkpoint, "--for", "21"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(lines_of(outcome.err),
                ElementsAre(file +
                            ": error: cannot be written: this table cannot be continued after the "
                            "checkpoint, because " +
                            reason + ": choose another file"));
    EXPECT_EQ(read(file), before);
  };
  const std::vector<std::string> events{"--events", "e.csv"};
  const std::vector<std::string> measures{"--measures", "m.csv", "--measure", "stalls"};
  for (const char* checkpoint : {"without.h5", "other.h5"}) {
    const std::string reason =
        checkpoint == std::string_view("other.h5")
            ? "it is not the table that the run had written when the checkpoint was saved"
            : "the checkpoint was saved by a run without this table";
    refused(checkpoint, "e.csv", events, reason);
    refused(checkpoint, "m.csv", measures, reason);
  }
}

TEST_F(Tables, DescribeTellsWhatIsMeasured) {
  const Outcome list = troupe({"describe"});
  EXPECT_THAT(lines_of(list.out), Contains("measures"));
  EXPECT_THAT(lines_of(list.out), Contains("events"));
  EXPECT_THAT(lines_of(list.out), Contains(StartsWith("  stall_begins ")));
  const Outcome one = troupe({"describe", "mean_nearest_distance"});
  EXPECT_EQ(one.code, 0);
  EXPECT_THAT(one.out,
              AllOf(StartsWith("measure mean_nearest_distance (m): "), HasSubstr("Clark and Evans")));
  EXPECT_THAT(troupe({"describe", "coverage"}).out, HasSubstr("cell_m (_cm, _mm)"));
}

}  // namespace
}  // namespace troupe::apps::tables_test
