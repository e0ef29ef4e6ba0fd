#include "tests/apps/program.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/slow_build.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps::program_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

std::string folder_of(const std::string& name) { return test::binary_dir().string() + "/plugins/" + name; }

/// An environment variable, for as long as a test.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

class PluginProgram : public ProgramTest {
 protected:
  PluginProgram() {
    unsetenv("TROUPE_PLUGIN_PATH");
    unsetenv("STAGEPATH");
    write_world("walker");
  }
  void write_world(const std::string& controller) {
    write("w.json", R"({"troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
        "controller": {"kind": ")" +
                        controller + R"("}}},
      "populations": [{"name": "r", "type": "bot", "count": 10,
                       "place": {"rule": "grid", "region_m": [[0, 0], [4, 4]], "pitch_m": 1}}]})");
  }
  Outcome run(std::vector<std::string> more) const {
    more.insert(more.begin(), {"run", "w.json", "--for", "0.5"});
    return troupe(more);
  }
};

TEST_F(PluginProgram, TakesFoldersFromTheCommandLineThenFromTheEnvironment) {
  const Outcome expected = run({"--plugin-path", folder_of("plugins")});
  EXPECT_EQ(expected.code, 0) << expected.err;
  EXPECT_THAT(expected.out, HasSubstr("  plugin walker "));
  const auto hash_of = [](const Outcome& outcome) {
    const auto at = outcome.out.find("plugin walker");
    return at == std::string::npos ? "none: " + outcome.err : outcome.out.substr(at + 14, 22);
  };
  EXPECT_EQ(hash_of(run({"--plugin-path", "/nowhere:" + folder_of("plugins")})), hash_of(expected));
  EXPECT_EQ(hash_of(run({"--plugin-path", "/nowhere", "--plugin-path", folder_of("plugins")})),
            hash_of(expected));
  {
    const Variable stage("STAGEPATH", "/nowhere:" + folder_of("plugins"));
    EXPECT_EQ(hash_of(run({})), hash_of(expected));
    const Variable ours("TROUPE_PLUGIN_PATH", "/nowhere:" + folder_of("other"));
    EXPECT_NE(hash_of(run({})), hash_of(expected)) << "before STAGEPATH";
    EXPECT_EQ(hash_of(run({"--plugin-path", folder_of("plugins")})), hash_of(expected)) << "before both";
  }
  const Outcome none = run({"--hash-log", "run.log"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(
      none.err,
      AllOf(
          StartsWith("w.json:2: error: /types/bot/controller/kind: unknown controller \"walker\"; known: "),
          EndsWith(
              "; no folder to search for walker.so: give --plugin-path (in C++ and Python: plugin_path); if "
              "it "
              "is a Python script, give --controller walker.py (in Python: controllers=[\"walker.py\"])\n")));
  EXPECT_THAT(files(), ElementsAre("w.json"));
  EXPECT_EQ(run({"--plugin-path", ":"}).code, 2);
}

TEST_F(PluginProgram, DescribesThem) {
  const Outcome outcome = troupe({"describe", "walker", "--plugin-path", folder_of("plugins")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("controller walker: walk in wiggles"), HasSubstr("speed_mps"),
                                 HasSubstr("on the way")));
  const Outcome missing = troupe({"describe", "swarm", "--plugin-path", folder_of("plugins")});
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(missing.err,
            "troupe describe: error: " + folder_of("plugins") +
                "/swarm.so has no kind \"swarm\"; it has: swarm:follower, swarm:leader, swarm:needy\n");
  // A plug-in with controllers, devices and measures.
  const Outcome misspelt = troupe({"describe", "thrower:measure_sen", "--plugin-path", folder_of("plugins")});
  EXPECT_EQ(misspelt.code, 2);
  EXPECT_THAT(misspelt.err,
              AllOf(HasSubstr("/thrower.so has no kind \"thrower:measure_sen\"; it has: thrower:"),
                    HasSubstr("(did you mean \"thrower:measure_seen\"?)\n")));
}

TEST_F(PluginProgram, MeasuresWithThem) {
  const std::vector<std::string> path{"--plugin-path", folder_of("plugins")};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), path.begin(), path.end());
    return words;
  };
  const Outcome described = troupe(with({"describe", "crowd"}));
  EXPECT_EQ(described.code, 0) << described.err;
  EXPECT_THAT(described.out, AllOf(HasSubstr("measure crowd (m): distance between the two robots"),
                                   HasSubstr("    max_(i, j) |x_i - x_j|\n")));
  // Of all robots, of one, with the name of the library and with parameters.
  const Outcome outcome = run(with({"--measures", "m.csv", "--measure", "crowd,crowd:r3", "--measure",
                                    R"({"kind": "crowd:beyond", "x_m": -9})", "--measure-every", "0.5"}));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<std::string> lines = lines_of(read("m.csv"));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "tick,time_s,crowd_m,crowd_m:r3,crowd:beyond");
  EXPECT_THAT(lines[1], MatchesRegex("0,0,4.12[0-9]+,0,1"));
  EXPECT_THAT(lines[2], MatchesRegex("5,0.5,4.[0-9]+,0,6"));

  const Outcome missing = run(with({"--measures", "n.csv", "--measure", "crowd:beyondd"}));
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.err, HasSubstr("crowd"));
  const Outcome misspelt = run(with({"--measures", "n.csv", "--measure", "thrower:measure_sen"}));
  EXPECT_EQ(misspelt.code, 2);
  EXPECT_THAT(misspelt.err, AllOf(HasSubstr("thrower.so has no measure \"thrower:measure_sen\"; it has: "),
                                  HasSubstr("(did you mean \"thrower:measure_seen\"?)")));
  const Outcome nowhere = run({"--measure", "crowd", "--measures", "n.csv", "--plugin-path", "/nowhere"});
  EXPECT_EQ(nowhere.code, 2);
}

TEST_F(PluginProgram, StopsAndSweepsByTheirMeasures) {
  const std::string folder = folder_of("plugins");
  const std::string text = read("w.json");
  write(
      "w.json",
      text.substr(0, text.size() - 1) +
          R"(, "quit_time_s": 2, "stop_when": [{"measure": {"kind": "crowd:beyond", "x_m": -9}, "is": ">= 4"}]})");
  const Outcome stopped = troupe({"run", "w.json", "--plugin-path", folder});
  EXPECT_EQ(stopped.code, 0) << stopped.err;
  EXPECT_THAT(stopped.out, HasSubstr("ticks              3 of 0.1 s"));
  // The memory of the measure is in the checkpoint.
  EXPECT_EQ(troupe({"run", "w.json", "--plugin-path", folder, "--for", "0.1", "--checkpoint", "c.h5"}).code,
            worldio::has_hdf5() ? 0 : 2);
  if (worldio::has_hdf5()) {
    const Outcome resumed = troupe({"resume", "c.h5", "--plugin-path", folder, "--for", "2"});
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_THAT(resumed.out, HasSubstr("ticks              3 of 0.1 s"));
  }
  write("study.json", R"({"troupe_study": 1, "world": "w.json", "seeds": [1, 2], "measures": ["crowd"]})");
  const Outcome sweep = troupe({"sweep", "study.json", "-o", "out", "--plugin-path", folder});
  EXPECT_EQ(sweep.code, 0) << sweep.err << sweep.out;
  EXPECT_THAT(lines_of(read("out/table.csv")).front(), HasSubstr("crowd_m"));
}

TEST_F(PluginProgram, ASweepDoesNotMixTheResultsOfTwoBuilds) {
  std::filesystem::create_directory(path("plugins"));
  const auto use_build = [&](const std::string& folder) {
    std::filesystem::copy_file(folder_of(folder) + "/walker.so", path("plugins/walker.so"),
                               std::filesystem::copy_options::overwrite_existing);
  };
  const auto sweep = [&](const std::string& study) {
    return troupe({"sweep", study, "-o", study + ".out", "--plugin-path", "plugins"});
  };
  write("uses.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 0.5, "seeds": [1]})");
  // The first run does not use the plug-in.
  write("chooses.json", R"({"troupe_study": 1, "world": "w.json", "for_s": 0.5, "parameters": [
    {"set": "/types/bot/controller", "values": [{"kind": "script", "law": "line"}, {"kind": "walker"}]}]})");
  for (const char* study : {"uses.json", "chooses.json"}) {
    use_build("plugins");
    ASSERT_EQ(sweep(study).code, 0);
    EXPECT_EQ(sweep(study).code, 0);
    use_build("other");
    const Outcome other = sweep(study);
    EXPECT_EQ(other.code, 2) << study;
    EXPECT_THAT(other.err, HasSubstr("the folder contains runs with another plug-in walker: "));
  }
}

TEST_F(PluginProgram, LintsAndTellsOfWorldsThatNeedThem) {
  EXPECT_EQ(troupe({"lint", "w.json"}).code, 2);
  EXPECT_EQ(troupe({"lint", "w.json", "--plugin-path", folder_of("plugins")}).out, "w.json: nothing found\n");
  EXPECT_THAT(troupe({"info", "w.json", "--plugin-path", folder_of("plugins")}).out,
              HasSubstr("diff, walker"));
}

TEST_F(PluginProgram, WarnsOfFastMathsAndKeepsTheHash) {
  const Outcome fast = run({"--plugin-path", folder_of("fast"), "--hash-log", "fast.log"});
  EXPECT_EQ(fast.code, 0);
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ < 13 && defined(__x86_64__)
  EXPECT_THAT(fast.err, StartsWith(folder_of("fast") +
                                   "/walker.so: warning: this plug-in was linked with -ffast-math"));
#endif
  EXPECT_EQ(run({"--plugin-path", folder_of("plugins"), "--hash-log", "slow.log"}).code, 0);
  const auto state_of = [&](const std::string& log) {
    const std::string text = read(log);
    return text.substr(text.find("\n0 "));
  };
  EXPECT_EQ(state_of("fast.log"), state_of("slow.log"));
  const Outcome diff = troupe({"diff", "fast.log", "slow.log"});
  EXPECT_EQ(diff.code, 2) << "the builds are two";
  EXPECT_THAT(diff.err, HasSubstr("plugin walker is "));
  EXPECT_EQ(troupe({"diff", "fast.log", "slow.log", "--across-runs"}).code, 0);
}

TEST_F(PluginProgram, GoesOnFromACheckpoint) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  const std::string path = folder_of("plugins");
  EXPECT_EQ(troupe({"run", "w.json", "--for", "1", "--hash-log", "whole.log", "--plugin-path", path}).code,
            0);
  EXPECT_EQ(
      run({"--checkpoint", "c.h5", "--hash-log", "parts.log", "--record", "r.h5", "--plugin-path", path})
          .code,
      0);
  EXPECT_THAT(troupe({"info", "c.h5"}).out, HasSubstr("plugin walker"));
  EXPECT_THAT(troupe({"info", "r.h5"}).out, HasSubstr("plugin walker"));
  const auto resume = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"resume", "c.h5", "--for", "1"});
    return troupe(more);
  };
  EXPECT_EQ(resume({"--hash-log", "parts.log", "--plugin-path", path}).code, 0);
  EXPECT_EQ(troupe({"diff", "whole.log", "parts.log"}).code, 0);

  EXPECT_EQ(resume({}).err,
            "c.h5: error: the run needs plug-in \"walker\": no folder to search for walker.so: give "
            "--plugin-path (in C++ and Python: plugin_path); if it is a Python script, give --controller "
            "walker.py (in Python: controllers=[\"walker.py\"])\n");
  const Outcome other = resume({"--plugin-path", folder_of("other")});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err,
              HasSubstr("give --across-plugins (in C++ and Python: across_plugins) to resume it anyway"));
  const Outcome across =
      resume({"--plugin-path", folder_of("other"), "--across-plugins", "--hash-log", "parts.log"});
  EXPECT_EQ(across.code, 0) << across.err;
  EXPECT_THAT(across.err, StartsWith("c.h5: warning: "));
  EXPECT_EQ(troupe({"diff", "whole.log", "parts.log"}).code, 1) << "it goes another way";

  std::vector<std::string> render{"render", "c.h5", "-o", "c.svg", "--plugin-path", folder_of("other")};
  EXPECT_THAT(troupe(render).err, HasSubstr("give --across-plugins "));
  render.push_back("--across-plugins");
  EXPECT_EQ(troupe(render).code, 0);
}

TEST_F(PluginProgram, AControllerThatThrowsEndsTheRunWithAnError) {
  for (const auto& [controller, thrown] :
       {std::pair("says", "threw: the map is missing"),
        std::pair("says_nothing", "threw an exception that is not a std::exception")}) {
    write_world(std::string("thrower:") + controller);
    const std::string expected =
        fmt::format("troupe: error: tick 3: controller \"thrower:{}\" of \"r4\" {}\n", controller, thrown);
    const std::string path = folder_of("plugins");
    const Outcome ran = run({"--plugin-path", path});
    EXPECT_EQ(ran.code, 1);
    EXPECT_EQ(ran.err, expected);
    const Outcome checked = troupe({"check", "w.json", "--for", "0.5", "--threads", "2", "--tile-size",
                                    "auto", "--controllers", "--plugin-path", path});
    EXPECT_EQ(checked.code, 1);
    EXPECT_EQ(checked.err, expected);
  }
}

TEST_F(PluginProgram, AMeasureThatThrowsIsNamedWithItsTick) {
  const std::vector<std::string> path{"--plugin-path", folder_of("plugins")};
  for (const auto& [measure, thrown] :
       {std::pair("measure_seen", "threw: the map is missing"),
        std::pair("measure_read", "threw an exception that is not a std::exception")}) {
    const std::string name = std::string("thrower:") + measure;
    const std::string expected = fmt::format("troupe: error: tick 3: measure \"{}\" {}\n", name, thrown);
    for (const std::vector<std::string>& options :
         {std::vector<std::string>{"--measures", "m.csv", "--measure", name, "--measure-every", "0.1"},
          std::vector<std::string>{"--set", fmt::format("/stop_when=[\"{} > 1\"]", name)}}) {
      std::vector<std::string> words = options;
      words.insert(words.end(), path.begin(), path.end());
      const Outcome ran = run(words);
      EXPECT_EQ(ran.code, 1) << name;
      EXPECT_EQ(ran.err, expected);
    }
  }
  const Outcome made =
      run({"--measures", "n.csv", "--measure", "thrower:measure_made", "--plugin-path", path.back()});
  EXPECT_EQ(made.code, 2);
  EXPECT_THAT(made.err, EndsWith("error: measure \"thrower:measure_made\" threw an exception that is not a "
                                 "std::exception\n"));
}

TEST_F(PluginProgram, AnHonestOnePassesTheCheck) {
  const Outcome outcome = troupe({"check", "w.json", "--for", "0.3", "--threads", "2", "--tile-size", "auto",
                                  "--controllers", "--plugin-path", folder_of("plugins")});
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(lines_of(outcome.out).back(), MatchesRegex("30 decisions, each made 3 times +3  same bits  -"));
}

struct Rogue {
  std::string controller;
  std::string finding;
};

void PrintTo(const Rogue& rogue, std::ostream* out) { *out << rogue.controller; }

class PluginRogue : public PluginProgram, public ::testing::WithParamInterface<Rogue> {};

TEST_P(PluginRogue, IsCaughtWithItsField) {
  if (test::k_slow_build && GetParam().controller == "leaves_a_member_unset")
    GTEST_SKIP() << "the address sanitizer's stack is not the one that the check leaves junk on";
  const std::string name = "rogue:" + GetParam().controller;
  write_world(name);
  const Outcome outcome = troupe({"check", "w.json", "--for", "0.3", "--threads", "2", "--tile-size", "auto",
                                  "--controllers", "--plugin-path", folder_of("plugins")});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_THAT(lines_of(outcome.out).back(),
              StartsWith("  controller \"" + name + "/0\": " + GetParam().finding));
}

INSTANTIATE_TEST_SUITE_P(Controllers, PluginRogue,
                         ::testing::Values(Rogue{"calls_rand", "command turn"},
                                           Rogue{"keeps_a_static", "memory calls"},
                                           Rogue{"reads_the_clock", "memory now_s"},
                                           Rogue{"leaves_a_member_unset", "command x"}),
                         [](const auto& rogue) {
                           std::string name = rogue.param.controller;
                           std::erase(name, '_');
                           return name;
                         });

}  // namespace
}  // namespace troupe::apps::program_test
