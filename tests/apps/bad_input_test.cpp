#include "tests/apps/program.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <ostream>

namespace troupe::apps::bad_input_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

/// A world that must be refused: where the error is said to be, and a part of what it says.
struct BadInput {
  std::string name;  ///< of the case
  std::string world;
  std::string text;
  std::string where;
  std::string says;
  std::vector<std::string> options;
};

std::ostream& operator<<(std::ostream& stream, const BadInput& input) { return stream << input.name; }

/// A JSON world that is right but for what a case replaces in it. A line each for what cases point at.
std::string json_world(const std::string& right = {}, const std::string& wrong = {}) {
  std::string text = R"({ "troupe": 1,
  "tick_s": 0.1,
  "types": { "bot": {
    "size_m": [0.2, 0.2, 0.2],
    "drive": { "kind": "diff" },
    "sensors": [ { "name": "ir", "kind": "ranger", "transducers": [
      { "range_max_m": 2.0, "fov_deg": 180, "samples": 9 } ] } ],
    "controller": { "kind": "wander" } } },
  "populations": [ { "name": "bots", "type": "bot",
    "count": 5,
    "place": { "rule": "grid",
      "region_m": [[0, 0], [2, 2]],
      "pitch_m": 0.5 } } ] }
)";
  if (!right.empty()) text.replace(text.find(right), right.size(), wrong);
  return text;
}

std::vector<BadInput> stage_inputs() {
  const std::string robot = "position( pose [0 0 0 0] )\n";
  return {
      {"comma", "bad.world", robot + "position( pose [1, 2, 0, 0] )\n", "bad.world:2", "','"},
      {"missing_parenthesis", "bad.world", "\n\nposition( pose [0 0 0 0]\n", "bad.world:3", "never closed"},
      {"extra_parenthesis", "bad.world", robot + ")\n", "bad.world:2", ")"},
      {"unquoted_text", "bad.world", robot + "model( name bob )\n", "bad.world:2", "bob"},
      {"open_text", "bad.world", "name \"bob\n" + robot, "bad.world:1", "\""},
      {"exponent", "bad.world", robot + "model( mass 2e-2 )\n", "bad.world:2", "e-2"},
      {"define_without_base", "bad.world", robot + "define bot ( size [1 1 1] )\n", "bad.world:2", "define"},
      {"unknown_type", "bad.world", robot + "positoin( pose [0 0 0 0] )\n", "bad.world:2",
       "did you mean \"position\"?"},
      {"text_for_number", "bad.world", robot + "quit_time \"late\"\n", "bad.world:2", "quit_time"},
      {"short_tuple", "bad.world", robot + "model( pose [1] )\n", "bad.world:2", "pose"},
      {"zero_size", "bad.world", robot + "model( size [0 1 1] )\n", "bad.world:2", "size"},
      {"negative_size", "bad.world", robot + "model( size [1 -1 1] )\n", "bad.world:2", "size"},
      {"nan", "bad.world", robot + "model( pose [nan 0 0 0] )\n", "bad.world:2", "nan"},
      {"zero_resolution",
       "bad.world",
       robot + "resolution 0\n",
       "bad.world:2",
       "\"resolution\" must be from 0.0001 to 100 m for the grid ray engine, found 0",
       {"--raytracer", "grid"}},
      {"zero_tick", "bad.world", robot + "interval_sim 0\n", "bad.world:2", "interval_sim"},
      {"unknown_drive", "bad.world", robot + "position( drive \"omnii\" )\n", "bad.world:2",
       "did you mean \"omni\"?"},
      {"missing_controller", "bad.world", robot + "position(\n  ctrl \"wandr\" )\n", "bad.world:3", "wandr"},
      {"missing_image", "bad.world", robot + "model( bitmap \"none.png\" )\n", "bad.world:2", "none.png"},
      {"broken_image", "bad.world", robot + "model( bitmap \"broken.png\" )\n", "bad.world:2", "broken.png"},
      {"missing_include", "bad.world", robot + "include \"none.inc\"\n", "bad.world:2", "none.inc"},
      {"include_cycle", "bad.world", robot + "include \"loop.inc\"\n", "loop.inc:2", "loop.inc"},
      {"error_in_include", "bad.world", "include \"wrong.inc\"\n" + robot, "wrong.inc:2", "size"},
      {"macro_cycle", "bad.world", robot + "define bot bot( size [1 1 1] )\nbot()\n", "bad.world:", "bot"},
      {"long_name", "bad.world", robot + "model( name \"" + std::string(5000, 'b') + "\" )\n", "bad.world:2",
       "the name has 5000 bytes, but a name has at most 4096"},
      {"long_macro", "bad.world", robot + "define " + std::string(5000, 'b') + " model( mass 1 )\n",
       "bad.world:2", "the name has 5000 bytes, but a name has at most 4096"},
      {"robots_without_population",
       "bad.world",
       robot,
       "bad.world: ",
       "the number of robots can be set only in a .json world with populations",
       {"--robots", "5"}},
  };
}

std::vector<BadInput> json_inputs() {
  return {
      {"syntax", "bad.json", json_world("\"tick_s\": 0.1,", "\"tick_s\": 0.1"), "bad.json:3",
       "a comma is missing before"},
      {"cut_off", "bad.json", json_world().substr(0, 200), "bad.json:7", "no closing quotation mark"},
      {"empty", "bad.json", "", "bad.json", "the file is empty: a world has at least one model"},
      {"repeated_key", "bad.json", json_world("\"tick_s\": 0.1,", "\"tick_s\": 0.1, \"tick_s\": 0.2,"),
       "bad.json:2", "tick_s"},
      {"unknown_key", "bad.json", json_world("\"count\": 5", "\"cuont\": 5"), "bad.json:10",
       "did you mean \"count\"?"},
      {"wrong_unit", "bad.json", json_world("\"pitch_m\"", "\"pitch_deg\""), "bad.json:13", "pitch_deg"},
      {"wrong_type", "bad.json", json_world("\"count\": 5", "\"count\": \"five\""), "bad.json:10",
       "/populations/0/count"},
      {"fraction", "bad.json", json_world("\"count\": 5", "\"count\": 5.5"), "bad.json:10",
       "/populations/0/count"},
      {"negative_count", "bad.json", json_world("\"count\": 5", "\"count\": -5"), "bad.json:10",
       "/populations/0/count"},
      {"long_name", "bad.json", json_world("\"bots\"", '"' + std::string(5000, 'b') + '"'), "bad.json:9",
       "/populations/0/name: the name has 5000 bytes, but a name has at most 4096"},
      {"long_type", "bad.json",
       json_world("\"types\": {", "\"types\": { \"" + std::string(5000, 'b') + "\": {},"), "bad.json:3",
       "/types: the name has 5000 bytes, but a name has at most 4096"},
      {"zero_size", "bad.json", json_world("[0.2, 0.2, 0.2]", "[0, 0.2, 0.2]"), "bad.json:4",
       "/types/bot/size_m"},
      {"negative_size", "bad.json", json_world("[0.2, 0.2, 0.2]", "[0.2, -0.2, 0.2]"), "bad.json:4",
       "above 0"},
      {"short_size", "bad.json", json_world("[0.2, 0.2, 0.2]", "[0.2, 0.2]"), "bad.json:4",
       "/types/bot/size_m"},
      {"nan", "bad.json", json_world("\"tick_s\": 0.1", "\"tick_s\": NaN"), "bad.json:2", "JSON has no NaN"},
      {"infinite", "bad.json", json_world("\"tick_s\": 0.1", "\"tick_s\": 1e999"), "bad.json:2", "1e999"},
      {"zero_tick", "bad.json", json_world("\"tick_s\": 0.1", "\"tick_s\": 0"), "bad.json:2",
       "must be from 0.000001 to 3600 s"},
      {"unknown_drive", "bad.json", json_world("\"kind\": \"diff\"", "\"kind\": \"dif\""), "bad.json:5",
       "did you mean \"diff\"?"},
      {"unknown_sensor", "bad.json", json_world("\"kind\": \"ranger\"", "\"kind\": \"rangre\""), "bad.json:6",
       "did you mean \"ranger\"?"},
      {"missing_controller", "bad.json", json_world("\"wander\"", "\"wandr\""), "bad.json:8",
       "did you mean \"wander\"?"},
      {"out_of_range", "bad.json", json_world("\"fov_deg\": 180", "\"fov_deg\": 400"), "bad.json:7",
       "360 deg"},
      {"unknown_type", "bad.json", json_world("\"type\": \"bot\"", "\"type\": \"bots\""), "bad.json:9",
       "did you mean \"bot\"?"},
      {"too_many", "bad.json", json_world("\"count\": 5", "\"count\": 500"), "bad.json:11", "of 500"},
      {"missing_image", "bad.json",
       json_world("\"tick_s\": 0.1,",
                  R"("floorplans": [{ "name": "p", "bitmap": "none.png", "size_m": [9, 9, 1] }],)"),
       "bad.json:2", "none.png"},
      {"broken_image", "bad.json",
       json_world("\"tick_s\": 0.1,",
                  R"("floorplans": [{ "name": "p", "bitmap": "broken.png", "size_m": [9, 9, 1] }],)"),
       "bad.json:2", "broken.png"},
      {"pushable_drive", "bad.json",
       json_world("\"drive\": { \"kind\": \"diff\" },", R"("drive": { "kind": "diff" }, "pushable": true,)"),
       "bad.json:5", "type \"bot\" has a drive and is pushable"},
      {"two_power_supplies", "bad.json",
       json_world("\"sensors\": [", R"("devices": [ {"name": "a", "kind": "power_pack", "capacity_J": 1},
         {"name": "b", "kind": "power_pack", "capacity_J": 1} ], "sensors": [)"),
       "bad.json:3", "the power supplies \"a\" and \"b\" are on the same part"},
      {"flags_of_no_device", "bad.json",
       json_world(
           "\"sensors\": [",
           R"("devices": [ {"kind": "spawner", "population": "bots", "per_flags": 2} ], "sensors": [)"),
       "bad.json:6", "its body has no device of kind \"flags\""},
      {"no_orders", "bad.json", json_world("\"wander\"", "\"operate\""), "bad.json:8", "has no orders"},
      {"set_without_parameter", "bad.json",
       json_world("\"tick_s\": 0.1,", R"("at": [ {"time_s": 1, "set": {"type": "bot", "drive": {}}} ],)"),
       "bad.json:2", "/at/0/set/drive: no parameter is given"},
      {"robots_of_no_population",
       "good.json",
       json_world(),
       "--robots botz=3",
       "bots",
       {"--robots", "botz=3"}},
      {"set_of_nothing", "good.json", json_world(), "--set /tick/s", "tick", {"--set", "/tick/s=1"}},
      {"set_to_nonsense", "good.json", json_world(), "--set /tick_s", "number", {"--set", "/tick_s=fast"}},
  };
}

class BadInputs : public ProgramTest, public ::testing::WithParamInterface<BadInput> {};

TEST_P(BadInputs, NamesFileAndLineAndLeavesNothingBehind) {
  const BadInput& input = GetParam();
  write("broken.png", "\x89PNG\r\n\x1a\n and then nothing of the kind");
  write("loop.inc", "# a file that includes itself\ninclude \"loop.inc\"\n");
  write("wrong.inc", "# the error is in here\nmodel( size [0 0 0] )\n");
  write(input.world, input.text);
  const std::vector<std::string> before = files();

  std::vector<std::string> arguments{"run",        input.world, "--for",      "1",    "--json",
                                     "--hash-log", "h.log",     "--snapshot", "p.png"};
  arguments.insert(arguments.end(), input.options.begin(), input.options.end());
  const Outcome outcome = troupe(arguments);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(lines_of(outcome.err), Each(MatchesRegex(".*: (error|warning): .+")));
  EXPECT_THAT(lines_of(outcome.err),
              Contains(AllOf(StartsWith(input.where), HasSubstr(": error: "), HasSubstr(input.says))));
  EXPECT_EQ(files(), before);
}

const auto k_name_of_case = [](const auto& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(Stage, BadInputs, ::testing::ValuesIn(stage_inputs()), k_name_of_case);
INSTANTIATE_TEST_SUITE_P(Json, BadInputs, ::testing::ValuesIn(json_inputs()), k_name_of_case);
INSTANTIATE_TEST_SUITE_P(Other, BadInputs,
                         ::testing::Values(BadInput{
                             "ending", "bad.txt", "name \"w\"\n", "bad.txt", ".world", {}}),
                         k_name_of_case);

class GoodInput : public ProgramTest {};

TEST_F(GoodInput, TheWorldThatTheBadOnesAreMadeFromRuns) {
  write("good.json", json_world());
  const Outcome outcome = troupe({"run", "good.json", "--for", "1"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out, HasSubstr("robots             5\n"));
}

TEST_F(GoodInput, RobotsAndSetChangeIt) {
  write("good.json", json_world());
  EXPECT_THAT(troupe({"run", "good.json", "--for", "1", "--robots", "3"}).out,
              HasSubstr("robots             3\n"));
  EXPECT_THAT(troupe({"run", "good.json", "--for", "1", "--robots", "bots=7"}).out,
              HasSubstr("robots             7\n"));
  EXPECT_THAT(
      troupe({"run", "good.json", "--for", "1", "--set", "/populations/0/count=2", "--set", "/tick_s=0.5"})
          .out,
      AllOf(HasSubstr("robots             2\n"), HasSubstr("2 of 0.5 s")));
  EXPECT_THAT(troupe({"run", "good.json", "--for", "1", "--robots", "0"}).out,
              HasSubstr("robots             0\n"));
}

TEST_F(GoodInput, NeedsAnEndAllTheSame) {
  write("good.json", json_world());
  const Outcome outcome = troupe({"run", "good.json", "--hash-log", "h.log"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(lines_of(outcome.err),
              ::testing::ElementsAre("good.json: error: no end time: give --for SECONDS, or set "
                                     "quit_time_s in the world"));
  EXPECT_THAT(files(), ::testing::ElementsAre("good.json"));
  EXPECT_THAT(troupe({"run", "good.json", "--set", "/quit_time_s=0.7"}).out, HasSubstr("7 of 0.1 s"));
}

class NoWorld : public ProgramTest {};

TEST_F(NoWorld, IsNamed) {
  const Outcome outcome = troupe({"run", "none.world", "--for", "1", "--hash-log", "h.log"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(lines_of(outcome.err), ::testing::ElementsAre(StartsWith("none.world: error: ")));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(NoWorld, AnInterventionMayMakeAWrongValueEffective) {
  const auto world = [](const std::string& at) {
    return R"({"troupe": 1, "quit_time_s": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
    "sensors": [{"name": "eye", "kind": "fiducial", "range_min_m": -1}]}},
    "models": [{"name": "a", "type": "bot"}])" +
           at + "}\n";
  };
  const std::string message = "/types/bot/sensors/0/range_min_m: must be from 0 to 10000 m, found -1";
  write("w.json", world(""));
  const Outcome warned = troupe({"run", "w.json"});
  EXPECT_EQ(warned.code, 0) << warned.err;
  EXPECT_THAT(warned.err, HasSubstr("w.json:2: warning: " + message +
                                    "; it has no effect, because \"apply_range_min\" is false\n"));
  write("w.json", world(R"(,
    "at": [{"time_s": 0.5, "set": {"type": "bot", "device": {"name": "eye", "apply_range_min": true}}}])"));
  const Outcome refused = troupe({"run", "w.json"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("\"range_min\" must be at least 0 m, found -1"));
}

TEST_F(NoWorld, EveryErrorOfAWorldIsReportedAtOnce) {
  write("bad.json", json_world("\"count\": 5", "\"cuont\": 5, \"colour\": 1"));
  EXPECT_GE(lines_of(troupe({"run", "bad.json", "--for", "1"}).err).size(), 2u);
}

/// Every command that reads a file, with this one.
std::vector<std::vector<std::string>> commands_with(const std::string& file) {
  std::vector<std::vector<std::string>> commands{{"run", file, "--for", "1"},
                                                 {"check", file, "--for", "1"},
                                                 {"lint", file},
                                                 {"convert", file, "out.json"},
                                                 {"render", file, "-o", "p.png"},
                                                 {"info", file},
                                                 {"sweep", file, "-o", "out"},
                                                 {"diff", file, file}};
  if (worldio::has_hdf5())
    for (const char* command : {"replay", "repair", "resume"}) commands.push_back({command, file});
  return commands;
}

class NoRegularFile : public ProgramTest {
 protected:
  void refused(const std::string& file, const std::string& reason) {
    for (const std::vector<std::string>& command : commands_with(file)) {
      const Outcome outcome = troupe(command);
      EXPECT_EQ(outcome.code, 2) << command.front() << ' ' << file;
      EXPECT_EQ(outcome.err.substr(0, outcome.err.find('\n') + 1), file + ": error: " + reason + "\n")
          << command.front();
      EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
    }
  }
};

class HugeFile : public ProgramTest {
 protected:
  /// Makes a file of zeros that takes no space on the disk and is one byte longer than allowed.
  void write_huge(const std::string& name) {
    write(name, "");
    std::filesystem::resize_file(path(name), (std::uintmax_t{4} << 30) + 1);
  }
};

TEST_F(HugeFile, OfAWorldAStudyOrAnImageIsRefused) {
  const std::string too_large = "the file is too large: 4294967297 bytes; at most 4294967296 are allowed\n";
  write_huge("huge.json");
  write_huge("huge.world");
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"run", "huge.json", "--for", "1"},
                                             {"run", "huge.world", "--for", "1"},
                                             {"sweep", "huge.json", "-o", "out"}}) {
    const Outcome outcome = troupe(command);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err, command[1] + ": error: " + too_large);
  }
  write_huge("huge.pgm");
  write("w.json",
        R"({"troupe": 1, "floorplans": [{"name": "f", "bitmap": "huge.pgm", "size_m": [3, 3, 1]}]})");
  const Outcome outcome = troupe({"run", "w.json", "--for", "1"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "w.json:1: error: cannot read the image huge.pgm: " + too_large);
}

TEST_F(NoRegularFile, IsRefusedByEveryCommandAtOnce) {
  ASSERT_EQ(mkfifo(path("pipe.world").c_str(), 0600), 0);
  refused("pipe.world", "this is a pipe, not a regular file");
  std::filesystem::create_symlink("loop.json", path("loop.json"));
  refused("loop.json", "cannot be read: Too many levels of symbolic links");
  std::filesystem::create_symlink("/dev/zero", path("zero.json"));
  refused("zero.json", "this is a device, not a regular file");
  std::filesystem::create_directory(path("folder.json"));
  refused("folder.json", "this is a folder, not a file");
  EXPECT_THAT(files(), ::testing::ElementsAre("folder.json", "loop.json", "pipe.world", "zero.json"));
}

TEST_F(NoRegularFile, IsNoOutputOfARecordingOrALogEither) {
  write("room.world", k_room);
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink("loop", path("loop"));
  std::vector<std::vector<std::string>> outputs{{"--hash-log", "loop"}, {"--measures", "loop"}};
  if (worldio::has_hdf5()) {
    outputs.push_back({"--record", "pipe", "--force"});
    outputs.push_back({"--record", "loop"});
    outputs.push_back({"--checkpoint", "pipe", "--force"});
  }
  for (const std::vector<std::string>& output : outputs) {
    std::vector<std::string> command{"run", "room.world", "--for", "1", "--quiet"};
    command.insert(command.end(), output.begin(), output.end());
    const Outcome outcome = troupe(command);
    EXPECT_EQ(outcome.code, 2) << output[0] << ' ' << output[1] << outcome.err;
    EXPECT_THAT(outcome.err, StartsWith(output[1] + ": error: "));
    EXPECT_EQ(lines_of(outcome.err).size(), 1u) << outcome.err;
  }
}

class ControlCharacters : public ProgramTest {
 protected:
  /// Runs a command. Its output and its messages must have no control character but line breaks.
  void runs(const std::vector<std::string>& arguments) const {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    const Outcome outcome = troupe(arguments);
    EXPECT_LT(outcome.code, 3) << outcome.err;
    const std::string text = outcome.out + outcome.err;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const auto byte = static_cast<unsigned char>(text[i]);
      const bool is_late =
          byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
      EXPECT_FALSE((byte < 0x20 && byte != '\n') || byte == 0x7f || is_late)
          << "byte " << i << " of " << text;
    }
  }
};

/// A terminal obeys them: such a world could, for example, clear the screen and print a hash of its own.
TEST_F(ControlCharacters, OfAWorldDoNotReachTheTerminal) {
  const std::string evil = R"(e\u001b[2J\u009b1m\rv\u0007\u007f\nil)";
  const std::string good = json_world("\"troupe\": 1,", R"("troupe": 1, "title": ")" + evil + R"(",)");
  const auto with = [&](const std::string& right, const std::string& wrong) {
    std::string text = good;
    for (std::size_t at = text.find(right); at != text.npos; at = text.find(right, at + wrong.size()))
      text.replace(at, right.size(), wrong);
    return text;
  };
  write("names.json", with("\"bots\"", '"' + evil + '"'));
  write("types.json", with("\"bot\"", '"' + evil + '"'));
  write("key.json", with("\"pitch_m\"", '"' + evil + R"(": 1, "pitch_m")"));
  write("kind.json", with("\"diff\"", '"' + evil + '"'));
  write("stage.world", "position( name \"e\x1b[2J\x9b 1mvil\" pose [0 0 0 0] ctrl \"e\x1b[2Jvil\" )\n");
  for (const char* world : {"names.json", "types.json", "key.json", "kind.json", "stage.world"}) {
    runs({"run", world, "--for", "1", "--clock", "--hash-log", "a.log"});
    runs({"run", world, "--for", "1", "--dry-run"});
    runs({"run", world, "--for", "1", "--record", "a.h5", "--checkpoint", "c.h5", "--force", "--hash-log",
          "b.log"});
    runs({"info", world});
    runs({"lint", world});
    runs({"check", world, "--for", "0.3", "--threads", "1,2"});
    runs({"convert", world, "new.json", "--force"});
    runs({"info", "a.h5"});
    runs({"info", "c.h5"});
    runs({"info", "b.log"});
    runs({"resume", "c.h5", "--for", "1.2"});
    runs({"run", world, "--for", "1", "--robots", "x=3"});
    runs({"run", world, "--for", "1", "--measure", "stalls:x"});
  }
  // A hash log whose second line has another group.
  ASSERT_EQ(troupe({"run", "names.json", "--for", "1", "--hash-log", "log"}).code, 0);
  std::string log = read("log");
  log.replace(log.find(" pose="), 6, " \x1b[2Jpo\x9b=");
  write("other.log", log);
  runs({"diff", "log", "other.log"});
}

}  // namespace
}  // namespace troupe::apps::bad_input_test
