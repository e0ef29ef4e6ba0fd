#include "tests/apps/program.hpp"

#include "engine/kinds/controller_kind.hpp"
#include "partition/simd_target.hpp"
#include "troupe/registry.hpp"

namespace troupe::apps::usage_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

class Usage : public ProgramTest {};

TEST_F(Usage, VersionIsOneLine) {
  const Outcome outcome = troupe({"--version"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(lines_of(outcome.out),
              ElementsAre(AllOf(HasSubstr("troupe"), HasSubstr("0.3.0"),
                                HasSubstr(" simd " + partition::simd_target() + " (available: "))));
  EXPECT_THAT(outcome.err, IsEmpty());
}

TEST_F(Usage, HelpNamesEveryOptionAndExitCode) {
  const Outcome outcome = troupe({"run", "--help"});
  EXPECT_EQ(outcome.code, 0);
  for (const char* word : {"WORLD",
                           "--for",
                           "--rate",
                           "--clock",
                           "--threads",
                           "--seed",
                           "--robots",
                           "--set",
                           "--tile-size",
                           "--hash-log",
                           "--snapshot",
                           "--snapshot-at",
                           "--film",
                           "--camera",
                           "--layers",
                           "[scans]",
                           "--color-by",
                           "--size",
                           "--profile",
                           "--profile-ticks",
                           "--camera-png",
                           "--json",
                           "--quiet",
                           "--camera-every",
                           "quit_time",
                           "Exit codes",
                           "Examples",
                           "Advanced:",
                           "--simd scalar|ssse3|sse4|avx2|avx512|neon|sve|sve2|sve_256|sve2_128"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
  for (const std::string& line : lines_of(outcome.out)) EXPECT_LE(line.size(), 120u) << line;
}

TEST_F(Usage, HelpNamesTheCommands) {
  const Outcome outcome = troupe({"--help"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("run"), HasSubstr("check"), HasSubstr("diff"),
                                 HasSubstr("describe"), HasSubstr("--version")));
}

TEST_F(Usage, HelpIsACommandToo) {
  EXPECT_EQ(troupe({"help"}).out, troupe({"--help"}).out);
  const Outcome outcome = troupe({"help", "lint"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out, troupe({"lint", "--help"}).out);
  const Outcome wrong = troupe({"help", "lnit"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(wrong.err,
            "troupe: error: unknown command \"lnit\" (did you mean \"lint\"?); see troupe --help\n");
}

TEST_F(Usage, HelpOfCheckAndDiffNamesTheirOptionsAndExitCodes) {
  const auto expect = [&](const char* command, const std::vector<const char*>& words) {
    const Outcome outcome = troupe({command, "--help"});
    EXPECT_EQ(outcome.code, 0);
    for (const char* word : words) EXPECT_THAT(outcome.out, HasSubstr(word));
    for (const std::string& line : lines_of(outcome.out)) EXPECT_LE(line.size(), 120u) << line;
  };
  expect("check", {"WORLD", "--for", "--threads", "--tile-size", "--seed", "--raytracer", "--robots", "--set",
                   "--controllers", "quit_time", "Exit codes", "Examples"});
  expect("diff", {"--across-domains", "--across-runs", "Exit codes", "Examples"});
  for (const char* command : {"resume", "render", "view"})  // errors about checkpoints name these options
    expect(command, {"--across-versions", "--across-plugins"});
}

TEST_F(Usage, NoCommandShowsHelpAsAnError) {
  const Outcome outcome = troupe({});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, HasSubstr("Usage: troupe"));
}

struct WrongUsage {
  std::vector<std::string> arguments;
  std::string message;
};

void PrintTo(const WrongUsage& wrong, std::ostream* out) {
  for (const std::string& argument : wrong.arguments) *out << argument.substr(argument.rfind('/') + 1) << ' ';
}

class WrongUsages : public ProgramTest, public ::testing::WithParamInterface<WrongUsage> {};

TEST_P(WrongUsages, IsOneLineAndExitCode2) {
  write("room.world", k_room);
  const Outcome outcome = troupe(GetParam().arguments);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(lines_of(outcome.err), ElementsAre(GetParam().message));
  EXPECT_THAT(files(), ElementsAre("room.world"));
}

std::string in_command(const std::string& command, const std::string& message) {
  return "troupe " + command + ": error: " + message + "; see troupe " + command + " --help";
}
std::string in_run(const std::string& message) { return in_command("run", message); }

std::vector<std::string> room(std::vector<std::string> options) {
  options.insert(options.begin(), {"run", "room.world"});
  return options;
}

/// As texts name them: "avx2, sse4 and scalar".
std::string usable_targets() {
  const std::vector<std::string>& names = partition::simd_targets().usable;
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

INSTANTIATE_TEST_SUITE_P(
    Usage, WrongUsages,
    ::testing::Values(
        WrongUsage{{"rnu", "room.world"},
                   "troupe: error: unknown command \"rnu\" (did you mean \"run\"?); see troupe --help"},
        WrongUsage{
            {"--versoin"},
            "troupe: error: unknown option \"--versoin\" (did you mean \"--version\"?); see troupe --help"},
        WrongUsage{{"run"}, in_run("WORLD is required")},
        WrongUsage{room({"--thraeds", "2"}),
                   in_run("unknown option \"--thraeds\" (did you mean \"--threads\"?)")},
        WrongUsage{room({"-q"}), in_run("unknown option \"-q\"")},
        WrongUsage{room({"--for"}), in_run("--for must be given once, with one value")},
        WrongUsage{room({"--for", "1", "--for", "2"}), in_run("--for must be given once, with one value")},
        WrongUsage{room({"--seed=", "--for", "1"}),
                   in_run("--seed: \"\" is not a whole number from 0 to 2^64 - 1")},
        WrongUsage{room({"--for", "ten"}),
                   in_run("--for: \"ten\" is not a time in seconds, from 0 to 1000000000000")},
        WrongUsage{room({"--for", "10s"}),
                   in_run("--for: \"10s\" is not a time in seconds, from 0 to 1000000000000")},
        WrongUsage{room({"--for", "-1"}),
                   in_run("--for: \"-1\" is not a time in seconds, from 0 to 1000000000000")},
        WrongUsage{room({"--for", "nan"}),
                   in_run("--for: \"nan\" is not a time in seconds, from 0 to 1000000000000")},
        WrongUsage{room({"--for", "inf"}),
                   in_run("--for: \"inf\" is not a time in seconds, from 0 to 1000000000000")},
        WrongUsage{room({"--threads", "0"}),
                   in_run("--threads: \"0\" is not a number of threads from 1 to 1024")},
        WrongUsage{room({"--threads", "-2"}),
                   in_run("--threads: \"-2\" is not a number of threads from 1 to 1024")},
        WrongUsage{room({"--seed", "1.5"}),
                   in_run("--seed: \"1.5\" is not a whole number from 0 to 2^64 - 1")},
        WrongUsage{room({"--seed", "18446744073709551616"}),
                   in_run("--seed: \"18446744073709551616\" is not a whole number from 0 to 2^64 - 1")},
        WrongUsage{
            room({"--robots", "many"}),
            in_run("--robots: \"many\" is not a number of robots, as in --robots 500, or --robots NAME=500 "
                   "for one population")},
        WrongUsage{
            room({"--robots", "minibots="}),
            in_run("--robots: \"minibots=\" is not a number of robots, as in --robots 500, or --robots "
                   "NAME=500 for one population")},
        WrongUsage{room({"--set", "count=5"}),
                   in_run("--set: \"count=5\" is not a JSON pointer, which begins with \"/\", and a value, "
                          "as in --set /populations/0/count=500")},
        WrongUsage{room({"--set", "/count"}),
                   in_run("--set: \"/count\" is not a JSON pointer, which begins with \"/\", and a value, "
                          "as in --set /populations/0/count=500")},
        WrongUsage{room({"--simd", "avx9"}), in_run("--simd: \"avx9\" is not an instruction set that this "
                                                    "program is compiled for; this processor can use " +
                                                    usable_targets())},
        WrongUsage{{"resume", "room.h5", "--simd", ""},
                   in_command("resume",
                              "--simd: \"\" is not an instruction set that this program is compiled "
                              "for; this processor can use " +
                                  usable_targets())},
        WrongUsage{room({"--raytracer", "Grid"}), in_run("--raytracer: \"Grid\" is not exact or grid")},
        WrongUsage{room({"--tile-size", "0"}),
                   in_run("--tile-size: \"0\" is not a length in metres, above 0")},
        WrongUsage{room({"--snapshot", "room.jpg"}),
                   in_run("--snapshot: \"room.jpg\" is not the name of a picture, as in --snapshot "
                          "crowd.png, crowd.svg or "
                          "crowd.pdf")},
        WrongUsage{
            room({"--snapshot", "room.png", "--size", "640"}),
            in_run("--size: \"640\" is not a width and a height in pixels, 1 to 16384 each, as in --size "
                   "1280x720")},
        WrongUsage{
            room({"--snapshot", "room.png", "--size", "0x480"}),
            in_run("--size: \"0x480\" is not a width and a height in pixels, 1 to 16384 each, as in --size "
                   "1280x720")},
        WrongUsage{room({"--size", "640x480"}), in_run("--size requires --snapshot or --film")},
        WrongUsage{room({"--layers", "scans"}), in_run("--layers requires --snapshot or --film")},
        WrongUsage{room({"--snapshot-at", "1"}), in_run("--snapshot-at requires --snapshot")},
        WrongUsage{room({"--fps", "10"}), in_run("--fps requires --film")},
        WrongUsage{room({"--snapshot", "p.png", "--snapshot-at", "1,x"}),
                   in_run("--snapshot-at: \"1,x\" is not a list of simulated times in seconds, each "
                          "from 0 to 1000000000, as in --snapshot-at 0,60,600")},
        WrongUsage{room({"--snapshot", "p.png", "--camera", "side"}),
                   in_run("--camera: unknown camera \"side\"; known: fit, follow:NAME, follow:all, "
                          "perspective, top, window")},
        WrongUsage{room({"--snapshot", "p.png", "--angle", "91"}),
                   in_run("--angle: \"91\" is not a pitch in degrees, 0 (straight down) to 90 (level), and a "
                          "yaw, -360 to 360, as in --angle 50,30")},
        WrongUsage{
            room({"--snapshot", "p.png", "--center", "3"}),
            in_run(
                "--center: \"3\" is not x and y in metres, from -1000000 to 1000000, as in --center 2.5,-4")},
        WrongUsage{room({"--snapshot", "p.png", "--across", "0"}),
                   in_run("--across: \"0\" is not a length in metres, from 1e-06 to 1000000")},
        WrongUsage{room({"--snapshot", "p.png", "--across", "1e-306"}),
                   in_run("--across: \"1e-306\" is not a length in metres, from 1e-06 to 1000000")},
        WrongUsage{room({"--snapshot", "p.png", "--color-range", "2,1"}),
                   in_run("--color-range: \"2,1\" is not two numbers, the lower first, as in --color-range "
                          "0,0.5")},
        WrongUsage{room({"--snapshot", "p.png", "--color-range", "0,1"}),
                   in_run("--color-range requires --color-by")},
        WrongUsage{room({"--film", "crowd.avi"}),
                   in_run("--film: \"crowd.avi\" is not the name of a film, as in --film crowd.mp4 or "
                          "frames/%06d.png")},
        WrongUsage{room({"--film", "crowd.mp4", "--fps", "0"}),
                   in_run("--fps: \"0\" is not a number of frames per second, from 0.001 to 1000")},
        WrongUsage{room({"--record", "run.csv"}),
                   in_run("--record: \"run.csv\" is not the name of an HDF5 file, as in --record run.h5")},
        WrongUsage{
            room({"--checkpoint", "c.JSON"}),
            in_run("--checkpoint: \"c.JSON\" is not the name of an HDF5 file, as in --checkpoint run.h5")},
        WrongUsage{
            room({"--profile", "trace.txt"}),
            in_run("--profile: \"trace.txt\" is not the name of a JSON file, as in --profile trace.json")},
        WrongUsage{room({"--profile", "trace.json", "--profile-ticks", "5:3"}),
                   in_run("--profile-ticks: \"5:3\" is not a first and a last tick, counted from 1, as in "
                          "--profile-ticks 100:120")},
        WrongUsage{room({"--profile", "trace.json", "--profile-ticks", "0:3"}),
                   in_run("--profile-ticks: \"0:3\" is not a first and a last tick, counted from 1, as in "
                          "--profile-ticks 100:120")},
        WrongUsage{room({"--profile", "trace.json", "--profile-ticks", "3"}),
                   in_run("--profile-ticks: \"3\" is not a first and a last tick, counted from 1, as in "
                          "--profile-ticks 100:120")},
        WrongUsage{room({"--profile-ticks", "1:3"}), in_run("--profile-ticks requires --profile")},
        WrongUsage{room({"--hash-log", "--json"}), in_run("--hash-log: \"--json\" is not a file name")},
        WrongUsage{room({"--session", ""}), in_run("--session: \"\" is not a file name")},
        WrongUsage{room({"--film", "f.mp4", "--color-by", ""}),
                   in_run("--color-by: \"\" is not a field of the state, as in --color-by velocity.x")},
        WrongUsage{room({"--json=no"}), in_run("--json takes no value")},
        WrongUsage{{"check"}, in_command("check", "WORLD is required")},
        WrongUsage{{"check", "room.world", "--threads", "1,,2"},
                   in_command("check", "--threads: \"\" is not a number of threads from 1 to 1024")},
        WrongUsage{{"check", "room.world", "--threads", "1,two"},
                   in_command("check", "--threads: \"two\" is not a number of threads from 1 to 1024")},
        WrongUsage{{"check", "room.world", "--tile-size", "auto,-1"},
                   in_command("check", "--tile-size: \"-1\" is not a length in metres, above 0")},
        WrongUsage{{"check", "room.world", "--hash-log", "a.log"},
                   in_command("check", "unknown option \"--hash-log\"")},
        WrongUsage{{"diff", "a.log"}, in_command("diff", "B is required")},
        WrongUsage{{"diff", "a.log", "b.log", "c.log"},
                   in_command("diff", "one argument too many: \"c.log\"")},
        WrongUsage{{"describe", "--schema=no"}, in_command("describe", "--schema takes no value")},
        WrongUsage{
            {"describe", "ranger", "position"},
            "troupe describe: error: one argument too many: \"position\"; see troupe describe --help"}));

class Describe : public ProgramTest {};

TEST_F(Describe, ListsEveryKindWithALineOfText) {
  const Outcome outcome = troupe({"describe"});
  EXPECT_EQ(outcome.code, 0);
  for (const char* heading : {"models", "sensors", "drives", "controllers", "presets of controllers"})
    EXPECT_THAT(lines_of(outcome.out), ::testing::Contains(heading));
  for (const char* kind : {"position", "ranger", "diff", "omni", "car", "expand", "wander", "script",
                           "expand_pioneer", "expand_swarm"})
    EXPECT_THAT(lines_of(outcome.out),
                ::testing::Contains(MatchesRegex("  " + std::string(kind) + " +[^ ].*")));
}

TEST_F(Describe, FieldsHaveKeyDefaultRangeAndMeaning) {
  const Outcome outcome = troupe({"describe", "ranger"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("sensor ranger: "));
  EXPECT_THAT(lines_of(outcome.out),
              ::testing::Contains(MatchesRegex("    ring +none +an object +copies .+")));
  EXPECT_THAT(lines_of(outcome.out), ::testing::Contains(MatchesRegex("  key +default +range +meaning")));
  EXPECT_THAT(lines_of(outcome.out),
              ::testing::Contains(MatchesRegex(" +fov_rad .?_deg. +0\\.1 +number .*rad .+")));
}

TEST_F(Describe, DevicesShowWhatTheyReadAndChangeOfOthers) {
  EXPECT_THAT(troupe({"describe", "radio"}).out,
              HasSubstr("access to bodies\n  reads, in addition to the poses and shapes of other bodies: "
                        "radio/command, runs\n"));
  EXPECT_THAT(
      troupe({"describe", "flags"}).out,
      HasSubstr("access to bodies\n  changes: the body that has the device, one target body anywhere in the "
                "world, and all bodies that carry these two or are carried by them\n"));
  EXPECT_THAT(troupe({"describe", "ranger"}).out, Not(HasSubstr("access to bodies\n")));
}

// What a field of a state or a command means, and its unit, is given where the struct is described.
TEST_F(Describe, EveryFieldOfAStateOrCommandHasAMeaning) {
  std::size_t fields = 0;
  for (const engine::DeviceKind& kind : make_registry().devices) {
    const std::size_t before = fields;
    bool is_field = false;
    for (const std::string& line : lines_of(troupe({"describe", std::string(kind.name)}).out)) {
      if (line.starts_with("readings,") || line.starts_with("state,") || line == "command") {
        is_field = true;
      } else if (line.empty()) {
        is_field = false;
      } else if (is_field) {
        ++fields;
        EXPECT_THAT(line, MatchesRegex("  [a-z_]+ +([0-9]+ x )?(uint|int|float)[0-9]+.*  [^ ].*"))
            << kind.name;
      }
    }
    EXPECT_GT(fields, before) << kind.name;
  }
  EXPECT_GT(fields, 80u);
  EXPECT_THAT(troupe({"describe", "wheels"}).out,
              HasSubstr("  heading  float64 rad           heading of the part"));
  EXPECT_THAT(troupe({"describe", "led"}).out, HasSubstr("from 0 to 1; other values are clamped\n"));
  EXPECT_THAT(troupe({"describe", "brush"}).out, HasSubstr("from 0 to 1; other values are clamped\n"));
}

// Kinds of others may leave the scope at its default, `anything`.
TEST_F(Describe, ShippedKindsDeclareTheScopeOfTheirEffects) {
  int with_effects = 0;
  for (const engine::DeviceKind& kind : make_registry().devices)
    if (kind.apply != nullptr) {
      ++with_effects;
      EXPECT_NE(kind.scope, engine::ApplyScope::anything) << kind.name;
    }
  EXPECT_GT(with_effects, 0);
}

TEST_F(Describe, PresetsShowTheirOwnDefaults) {
  const Outcome outcome = troupe({"describe", "expand_swarm"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, AllOf(StartsWith("controller expand_swarm: "), HasSubstr("preset of expand")));
  EXPECT_NE(outcome.out, troupe({"describe", "expand_pioneer"}).out);
}

TEST_F(Describe, AnUnknownKindBringsASuggestion) {
  const Outcome outcome = troupe({"describe", "rangre"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(
      outcome.err,
      StartsWith("troupe describe: error: \"rangre\" is neither a kind nor a key of JSON worlds (did you "
                 "mean \"ranger\"?); `troupe describe` lists all kinds"));
}

TEST_F(Describe, KeysOfWorldsShowTheirObjects) {
  const Outcome outcome = troupe({"describe", "populations"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out,
              StartsWith("key populations: list; default: none\n\n  at populations[]\n\n  groups of"));
  EXPECT_THAT(lines_of(outcome.out),
              ::testing::Contains(MatchesRegex("  place +required +object +how the bodies are placed")));
  EXPECT_THAT(troupe({"describe", "types.drive"}).out,
              HasSubstr("\n  kinds of drive: car, diff, omni\n  `troupe describe KIND` lists"));
  const std::string tick = troupe({"describe", "tick_s"}).out;
  EXPECT_THAT(tick, StartsWith("key tick_s (_ms): number, from 0.000001 to 3600 s; default: 0.1 s\n"));
  EXPECT_THAT(tick, HasSubstr("in JSON, the key may also have"));
  EXPECT_THAT(troupe({"describe", "size_m"}).out,
              HasSubstr("\n  at types{}.size_m\n  at types{}.sensors[].size_m\n"));
}

TEST_F(Describe, KeysAreFoundByThePointersOfErrors) {
  write("w.json",
        R"({"troupe": 1, "populations": [{"name": "r", "type": "b", "count": 1, "place": {"rule": "grid",
    "pitch_m": -1}}], "types": {"b": {"size_m": [1, 1, 1]}}})");
  const std::string pointer = "/populations/0/place/pitch_m";
  EXPECT_THAT(troupe({"lint", "w.json"}).err, HasSubstr(pointer + ": must be above 0"));
  const Outcome outcome = troupe({"describe", pointer});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("  at populations[].place.pitch_m\n"));
}

TEST_F(Describe, AKindAndAKeyOfOneNameAreBothDescribed) {
  const std::string text = troupe({"describe", "gripper"}).out;
  EXPECT_THAT(text, HasSubstr("device gripper: "));
  EXPECT_EQ(troupe({"describe", "sensors.ranger"}).out, troupe({"describe", "ranger"}).out);
  EXPECT_EQ(troupe({"describe", "devices.ranger"}).out, troupe({"describe", "ranger"}).out);
}

TEST_F(Describe, AMisspeltKeyBringsASuggestion) {
  for (const auto& [given, meant] :
       std::vector<std::pair<std::string, std::string>>{{"popualtions", "populations"},
                                                        {"quit_tme_s", "quit_time_s"},
                                                        {"populations.plase", "populations.place"}}) {
    const Outcome outcome = troupe({"describe", given});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("(did you mean \"" + meant + "\"?)"));
  }
  EXPECT_THAT(troupe({"describe", "populations.plase"}).err, Not(HasSubstr(".so"))) << "it names no plug-in";
}

TEST_F(Describe, ControllersShowWhatTheyNeed) {
  const std::string chain = troupe({"describe", "chain"}).out;
  EXPECT_THAT(
      chain,
      HasSubstr("\nneeds\n  a drive for the role \"robot\"\n  a radio with a payload of 2 bytes or more\n"
                "  a scanner: a ranger with at least"));
  EXPECT_THAT(troupe({"describe", "gradient"}).out, HasSubstr("\nneeds\n  no drive\n"));
  EXPECT_THAT(chain, HasSubstr("\n  uses, if the robot has them: led\n  one call decides for one robot\n"));
  EXPECT_THAT(troupe({"describe", "expand_swarm"}).out, HasSubstr("\nneeds\n  a drive\n  a ranger that"));
  EXPECT_THAT(troupe({"describe", "source"}).out,
              HasSubstr("  in a .world file, a model without flags gets one\n"));
}

TEST_F(Describe, TheNeedsOfEveryShippedControllerAreComplete) {
  std::size_t controllers = 0;
  for (const engine::ControllerKind& kind : make_registry().controllers) {
    const std::string text = troupe({"describe", std::string(kind.name)}).out;
    const std::size_t at = text.find("\nneeds\n");
    ASSERT_NE(at, std::string::npos) << kind.name;
    EXPECT_EQ(text.find("\n  a drive\n", at) != std::string::npos, kind.needs_drive) << kind.name;
    EXPECT_NE(text.find("\n  one call decides for", at), std::string::npos) << kind.name;
    // The devices of `operate` are those that its orders name.
    EXPECT_EQ(text.find("  devices that depend on its parameters\n") != std::string::npos,
              kind.name == "operate")
        << kind.name;
    ++controllers;
  }
  EXPECT_GT(controllers, 10u);
  EXPECT_THAT(
      troupe({"describe", "brazil_nut"}).out,
      HasSubstr("  a light sensor with three directions or more\n  a radio with a payload of 4 bytes or "
                "more\n  one call"));
  EXPECT_THAT(troupe({"describe", "pioneer_flocking"}).out,
              HasSubstr("straight ahead\n  a fiducial finder ("));
}

TEST_F(Describe, WhatJsonTakesComesBeforeWhatStagesFilesDo) {
  const std::string json = troupe({"describe", "ranger"}).out;
  EXPECT_THAT(json, ::testing::EndsWith(
                        "\n`troupe describe ranger --stage` lists the properties in Stage's world files.\n"));
  EXPECT_THAT(json, ::testing::Not(HasSubstr("model ranger: ")));
  EXPECT_THAT(troupe({"describe", "position"}).out,
              HasSubstr("properties in a Stage world"));  // it has no others
  const std::string text = troupe({"describe", "ranger", "--stage"}).out;
  EXPECT_THAT(text, StartsWith("sensor ranger: "));
  EXPECT_LT(text.find("sensor ranger: "), text.find("model ranger: "));
  EXPECT_LT(text.find("in JSON, the key may also have"), text.find("in a Stage world"));
}

}  // namespace
}  // namespace troupe::apps::usage_test
