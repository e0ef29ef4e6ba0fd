#include "troupe/plugins.hpp"

#include "base/diagnostics.hpp"
#include "base/fp_environment.hpp"
#include "base/hash.hpp"
#include "engine/world/world.hpp"
#include "tests/support/hash_log.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/lint.hpp"
#include "troupe/plugin_library.hpp"
#include "troupe/recording.hpp"
#include "troupe/registry.hpp"
#include "troupe/simulation.hpp"
#include "troupe/swarm.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/recording_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

/// In a program that links troupe::troupe and exports nothing for plug-ins, as a user's does.
namespace troupe::plugins_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::Pair;

fs::path folder_of(std::string_view name) { return test::binary_dir() / "plugins" / name; }

class PluginsTest : public test::ScratchTest {
 protected:
  /// Twelve robots whose controller is `call`, from line 3 on.
  fs::path stage_world(std::string_view call) const {
    std::string text = "interval_sim 100\ndefine bot position (\n  ctrl \"" + std::string(call) + "\"\n)\n";
    for (int i = 0; i < 12; ++i)
      text += "bot( pose [" + std::to_string(i % 4) + " " + std::to_string(i / 4) + " 0 0] )\n";
    return write("w.world", text);
  }
  fs::path json_world(std::string_view controller) const {
    return write("w.json", R"({"troupe": 1,
      "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
        "controller": )" + std::string(controller) +
                               R"(}},
      "populations": [{"name": "r", "type": "bot", "count": 12,
                       "place": {"rule": "grid", "region_m": [[0, 0], [4, 4]], "pitch_m": 1}}]})");
  }
  static SimulationOptions options(const std::vector<fs::path>& path, unsigned threads = 2) {
    SimulationOptions made;
    made.threads = threads;
    made.plugin_path = path;
    return made;
  }
  std::vector<std::string> log_with(std::string_view folder, unsigned threads = 2) const {
    Simulation simulation(stage_world("walker"), options({folder_of(folder)}, threads));
    return test::hash_log(simulation, 20);
  }
  static std::string error_of(const fs::path& world, const SimulationOptions& with) {
    try {
      const Simulation simulation(world, with);
      ADD_FAILURE() << "loaded";
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  std::string error_of(std::string_view call, std::string_view folder = "unusable") const {
    const std::string world = stage_world(call).string();
    const std::string error = error_of(world, options({folder_of(folder)}));
    EXPECT_TRUE(error.starts_with(world + ":3: error: ")) << error;
    return error.substr(error.find("error: "));
  }
  static std::string file(std::string_view folder, std::string_view name) {
    return (folder_of(folder) / name).string() + ".so ";
  }
};

// The layouts of one version of the interface never change, so that a plug-in that was built for another
// layout has another version too, and the error that refuses it says so.
TEST(PluginLayout, ChangesOnlyWithTheVersionOfTheInterface) {
#if !defined(__x86_64__) || defined(_LIBCPP_VERSION) || defined(_GLIBCXX_DEBUG)
  GTEST_SKIP() << "layouts.txt has the layouts of libstdc++ on x86-64";
#endif
  const fs::path file = test::source_dir() / "tests/plugins/layouts.txt";
  std::ifstream stream(file);
  std::uint32_t version = 0;
  std::string last;
  std::set<std::string> seen;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    std::istringstream words(line);
    std::uint32_t next = 0;
    ASSERT_TRUE(words >> next >> last) << line;
    EXPECT_GT(next, version) << "versions rise from line to line";
    EXPECT_TRUE(seen.insert(last).second) << "two versions have one layout: " << line;
    version = next;
  }
  EXPECT_EQ(version, plugin::k_interface)
      << file << " needs a line for this version: " << plugin::k_interface << ' ' << hex(plugin::layout());
  EXPECT_EQ(last, hex(plugin::layout())) << "the layout of a type that plug-ins use has changed "
                                            "(troupe/plugin_layout.hpp): raise k_interface in "
                                            "troupe/plugin_library.hpp, and add a line to "
                                         << file;
}

namespace layouts {
struct Before {
  double first = 0;
  double second = 0;
};
struct Swapped {
  double second = 0;
  double first = 0;
};
constexpr std::uint64_t k_before =
    plugin::detail::of_members<Before>({offsetof(Before, first), offsetof(Before, second)});
constexpr std::uint64_t k_swapped =
    plugin::detail::of_members<Swapped>({offsetof(Swapped, first), offsetof(Swapped, second)});
static_assert(k_before != k_swapped, "members of one type that change places are another layout");
}  // namespace layouts

TEST_F(PluginsTest, AreFoundByStageWorlds) {
  Simulation simulation(stage_world("walker speed=0.2"), options({folder_of("plugins")}));
  EXPECT_THAT(simulation.warnings(), IsEmpty());
  EXPECT_THAT(simulation.effective_options(), Contains(Pair("plugin walker", MatchesRegex("[0-9a-f]{16}"))));
  EXPECT_THAT(simulation.hash_log_header(), HasSubstr("\n# plugin walker: "));
  simulation.run_for(1);
  EXPECT_GT(simulation.statistics().mean_displacement_m, 0.05);
  EXPECT_LT(simulation.statistics().mean_displacement_m, 0.2 + 1e-9) << "no faster than the parameter says";
}

TEST_F(PluginsTest, AreFoundByJsonWorlds) {
  Simulation fast(json_world(R"({"kind": "walker", "speed_mps": 0.9})"), options({folder_of("plugins")}));
  Simulation slow(json_world(R"({"kind": "walker"})"), options({folder_of("plugins")}));
  fast.run_for(0.5);
  slow.run_for(0.5);
  EXPECT_GT(fast.statistics().mean_displacement_m, 2 * slow.statistics().mean_displacement_m);
  EXPECT_THAT(error_of(json_world(R"({"kind": "walker", "speed_mps": -1})"), options({folder_of("plugins")})),
              HasSubstr("speed_mps: must be at least 0 m/s"));
}

TEST_F(PluginsTest, GiveTheSameBitsOnAnyThreads) {
  EXPECT_EQ(log_with("plugins", 1), log_with("plugins", 3));
}

TEST_F(PluginsTest, MayHoldSeveralControllers) {
  Simulation simulation(write("w.json", R"({"troupe": 1,
        "types": {
          "a": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "swarm:leader"}},
          "b": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "swarm:follower"}}},
        "models": [{"name": "one", "type": "a"}, {"name": "two", "type": "b", "pose": {"y_m": 1}}]})"),
                        options({folder_of("plugins")}));
  simulation.run_for(1);
  EXPECT_NEAR(simulation.find("one").speed().forward, 0.1, 1e-12);
  EXPECT_NEAR(simulation.find("two").pose().x, 0.2 * 0.9, 1e-9) << "a command takes effect a tick later";
  EXPECT_THAT(simulation.effective_options(), Contains(Key("plugin swarm")));
  EXPECT_EQ(simulation.registry().controller("swarm:leader")->name, "swarm:leader");
  EXPECT_EQ(simulation.registry().controller("leader"), nullptr);
}

TEST_F(PluginsTest, ComeAfterTroupesOwnAndInTheOrderOfThePath) {
  Simulation own(json_world(R"({"kind": "script", "law": "wave"})"), options({folder_of("unusable")}));
  EXPECT_THAT(own.effective_options(), Not(Contains(Key("plugin script"))));
  const auto first_of = [&](const std::vector<fs::path>& path) {
    Simulation simulation(stage_world("walker"), options(path));
    return test::hash_log(simulation, 5).back();
  };
  const std::string here = first_of({folder_of("plugins")});
  const std::string there = first_of({folder_of("other")});
  EXPECT_NE(here, there) << "two builds with classes of one name are two, side by side";
  EXPECT_EQ(first_of({"/nowhere", folder_of("plugins"), folder_of("other")}), here);
  EXPECT_EQ(first_of({folder_of("other"), folder_of("plugins")}), there);
}

/// The end of the error for a controller or measure that is in no plug-in. name: its library
std::string script_remedy(const std::string& name) {
  return "; if it is a Python script, give --controller " + name + ".py (in Python: controllers=[\"" + name +
         ".py\"])";
}

TEST_F(PluginsTest, ThatAreMissingAreLookedForWhereTheErrorSays) {
  const std::string world = stage_world("wonder").string();
  const std::string known = world + ":3: error: unknown controller \"wonder\"; known: ";
  EXPECT_THAT(
      error_of(world, options({"/nowhere", folder_of("other")})),
      AllOf(testing::StartsWith(known), EndsWith("; there is no wonder.so in /nowhere, " +
                                                 folder_of("other").string() + script_remedy("wonder"))));
  EXPECT_THAT(error_of(stage_world("walker"), {}).substr(world.size()),
              AllOf(testing::StartsWith(":3: error: unknown controller \"walker\"; known: "),
                    EndsWith(" (did you mean \"wander\"?); no folder to search for walker.so: give "
                             "--plugin-path (in C++ and Python: plugin_path)" +
                             script_remedy("walker"))));
  EXPECT_THAT(error_of(stage_world("../plugins/walker"), options({folder_of("other")})),
              Not(HasSubstr(".so")))
      << "a name is no path";
  write("libgo.so", "");
  EXPECT_THAT(error_of(stage_world("go"), options({folder_})),
              EndsWith(" (the file name of a plug-in does not begin with \"lib\": rename " +
                       (folder_ / "libgo.so").string() + ")" + script_remedy("go")));
  EXPECT_THAT(error_of(stage_world("team:go"), options({folder_})), EndsWith(script_remedy("team")));
  const std::string file = (folder_of("other") / "walker.so").string();
  EXPECT_THAT(error_of(stage_world("walker"), options({file})),
              EndsWith("there is no walker.so in " + file + " (" + file +
                       " is a file: give the folder that contains it)" + script_remedy("walker")));
}

// Simulations that another() makes share the plug-ins, and a program may step each on a thread of its own.
TEST_F(PluginsTest, AreSearchedByManyThreadsAtOnce) {
  Plugins plugins({folder_of("unusable")}, make_registry());
  std::vector<std::thread> threads;
  std::atomic<int> errors = 0;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 300; ++i) {
        if (!plugins.measure("none" + std::to_string(t % 4 + 4 * i), "unknown")) ++errors;
        if (!plugins.libraries().empty()) ADD_FAILURE() << "a library that does not exist is in use";
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(errors, 8 * 300);
}

TEST_F(PluginsTest, ThatCannotBeUsedSayWhy) {
  const auto about = [](std::string_view name) {
    return "error: controller \"" + std::string(name) + "\": " + file("unusable", name);
  };
  EXPECT_THAT(error_of("of_stage"),
              AllOf(testing::StartsWith(about("of_stage") + "is a controller of Stage (it has Init"),
                    HasSubstr("docs/controllers.md")));
  EXPECT_EQ(
      error_of("nothing"),
      about("nothing") +
          "is not a Troupe plug-in: it has no symbol troupe_plugin, which the macros TROUPE_CONTROLLER, "
          "TROUPE_DEVICE and TROUPE_MEASURE define");
  EXPECT_THAT(
      error_of("undefined_symbol"),
      AllOf(testing::StartsWith(about("undefined_symbol") + "cannot be loaded: undefined symbol: "),
            HasSubstr("no_such_function"), EndsWith(" (link it with the CMake target troupe::plugin)")));
  EXPECT_THAT(error_of("another_version"),
              MatchesRegex(about("another_version") + "was built for troupe 99.1.0 .interface 20., but this "
                                                      "program is troupe 0.3.0 .interface 20.: rebuild it"));
  EXPECT_THAT(error_of("old_interface"),
              MatchesRegex(about("old_interface") + "was built for troupe 0.3.0 .interface 3., but this "
                                                    "program is troupe 0.3.0 .interface 20.: rebuild it"));
  EXPECT_THAT(error_of("another_build"),
              MatchesRegex(about("another_build") +
                           "was built with libc.., vectorized Eigen, but Troupe with libstdc..*"));
  EXPECT_THAT(error_of("other_headers"), HasSubstr("was built with other headers of troupe 0.3.0"));
  EXPECT_THAT(error_of("contracting"), HasSubstr("-ffp-contract=off"));
  EXPECT_THAT(error_of("empty"),
              HasSubstr("registers no controller, sensor, device or measure: register one with TROUPE_"));
  EXPECT_THAT(error_of("throwing"),
              EndsWith("registers controllers, sensors, devices and measures threw: a table is missing"));
  for (const char* number : {"throwing_a_number", "throwing_at_once"})
    EXPECT_THAT(error_of(number),
                EndsWith("devices and measures threw an exception that is not a std::exception"));
  EXPECT_THAT(error_of("null"), EndsWith("cannot be used: troupe_plugin returns null"));
  EXPECT_THAT(error_of("clash"),
              EndsWith("has two kinds with the name \"clash:idle\", each a controller: rename one"));
  EXPECT_THAT(error_of("expand:expand"),
              EndsWith("has a controller \"expand\", but Troupe ships one with this name: rename it"));
  EXPECT_THAT(
      error_of("command"),
      EndsWith(
          "has a controller \"command\" that has the name of a component of the state that Troupe "
          "defines: rename it; all names except alive, carrier, command, condition, contact, joint, life, "
          "odometry, pose, stall, velocity are allowed"));
  EXPECT_EQ(error_of("swarm", "plugins"),
            "error: " + file("plugins", "swarm") +
                "has no controller \"swarm\"; it has: swarm:follower, swarm:leader, swarm:needy");
  EXPECT_THAT(error_of("swarm:leadr", "plugins"), EndsWith("(did you mean \"swarm:leader\"?)"));
  EXPECT_THAT(error_of("swarm:needy", "plugins"),
              EndsWith("controller \"swarm:needy\" needs a device of kind \"ranger\""));
  SimulationOptions with_devices = options({folder_of("plugins")});
  with_devices.set = {{"/types/bot/sensors", R"([{"name": "c", "kind": "compass"}])"},
                      {"/types/bot/devices", R"([{"name": "lamp", "kind": "led"}])"}};
  EXPECT_THAT(
      error_of(json_world(R"({"kind": "swarm:needy"})"), with_devices),
      EndsWith("needs a device of kind \"ranger\"; the devices of the robot are of the kinds compass, led"));
}

TEST_F(PluginsTest, WhoseControllersThrowAreNamedWithTickAndRobot) {
  const auto thrown_by = [&](const std::string& controller, unsigned threads) {
    Simulation simulation(json_world(R"({"kind": "thrower:)" + controller + "\"}"),
                          options({folder_of("plugins")}, threads));
    simulation.step();
    simulation.step();
    try {
      simulation.step();
    } catch (const engine::StepError& error) {
      EXPECT_THROW(simulation.step(), std::logic_error);
      simulation.reset();
      simulation.step();
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  for (const unsigned threads : {1u, 3u}) {
    EXPECT_EQ(thrown_by("says", threads),
              "tick 3: controller \"thrower:says\" of \"r4\" threw: the map is missing");
    EXPECT_EQ(thrown_by("says_nothing", threads),
              "tick 3: controller \"thrower:says_nothing\" of \"r4\" threw an exception that is not a "
              "std::exception");
    EXPECT_THAT(
        thrown_by("for_many", threads),
        MatchesRegex("tick 3: controller \"thrower:for_many\" of \"r[0-9]+\", the first of a batch of "
                     "12 robots, threw: the map is missing"));
  }
  EXPECT_THAT(
      error_of(json_world(R"({"kind": "thrower:when_made"})"), options({folder_of("plugins")})),
      EndsWith("error: controller \"thrower:when_made\" threw an exception that is not a std::exception"));
}

TEST_F(PluginsTest, FilesThatAreNoLibrariesAreNotLoaded) {
  write("text.so", "troupe_plugin");
  write("cut.so",
        content(folder_of("plugins") / "walker.so").substr(0, 3000) + std::string("troupe_plugin\0", 14));
  EXPECT_THAT(error_of(stage_world("text"), options({folder_})),
              EndsWith("text.so is not a shared library: build it with the CMake target troupe::plugin"));
  EXPECT_THAT(error_of(stage_world("cut"), options({folder_})),
              EndsWith("cut.so is truncated: build it again"));
}

#if defined(__x86_64__)
TEST_F(PluginsTest, CompiledWithFusedMultiplicationAreRefused) {
  if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "the processor has no such instruction";
  EXPECT_THAT(error_of("walker", "by_hand"), HasSubstr("was compiled with fused multiply-add"));
}
#endif

TEST_F(PluginsTest, CompiledWithPackedStructsAreRefused) {
  for (const char* folder : {"packed_1", "packed_4"})
    EXPECT_EQ(
        error_of("walker", folder),
        "error: controller \"walker\": " + file(folder, "walker") + "was built with " + plugin::k_build +
            ", -fpack-struct, but Troupe with " + plugin::k_build +
            ": link it with the CMake target troupe::plugin, which sets the flags, and compile it without "
            "flags that change the layout of types");
}

TEST_F(PluginsTest, LinkedWithFastMathsChangeNoBit) {
  const std::vector<std::string> expected = log_with("plugins");
  Simulation simulation(stage_world("walker"), options({folder_of("fast")}));
  EXPECT_TRUE(check_fp_environment());
  // Whether the start-up code is linked at all is the compiler's choice: gcc's is, of shared libraries, until
  // gcc 13.
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ < 13 && defined(__x86_64__)
  EXPECT_THAT(simulation.warnings(),
              ElementsAre(testing::StartsWith(folder_of("fast").string() +
                                              "/walker.so: warning: this plug-in was linked with "
                                              "-ffast-math, which changed the arithmetic")));
#endif
  EXPECT_EQ(test::hash_log(simulation, 20), expected);
}

TEST_F(PluginsTest, ThatWereBuiltAgainNeedAnotherProcess) {
  fs::copy_file(folder_of("plugins") / "walker.so", folder_ / "walker.so");
  { const Simulation simulation(stage_world("walker"), options({folder_})); }
  fs::remove(folder_ / "walker.so");
  fs::copy_file(folder_of("other") / "walker.so", folder_ / "walker.so");
  EXPECT_THAT(error_of(stage_world("walker"), options({folder_})),
              EndsWith("walker.so was rebuilt since this process loaded it: restart the process"));
}

TEST_F(PluginsTest, AreFoundByLintAndByARegistry) {
  EXPECT_THAT(lint(stage_world("walker"), options({folder_of("plugins")})), IsEmpty());
  engine::Registry registry = make_registry();
  const auto plugins = add_plugins(registry, {folder_of("plugins")});
  const engine::ControllerKind* kind = registry.controller("walker");
  ASSERT_NE(kind, nullptr);
  EXPECT_EQ(kind->text, "walk in wiggles");
  EXPECT_EQ(kind->params.fields.size(), 1u);
  EXPECT_EQ(kind->memory.size(), 3u);
  EXPECT_EQ(registry.controller("walker"), kind);
  const std::vector<Plugins::Library> libraries = plugins->libraries();
  ASSERT_EQ(libraries.size(), 1u);
  EXPECT_EQ(libraries[0].file, folder_of("plugins") / "walker.so");
}

TEST_F(PluginsTest, AProgramsOwnKindsAreCheckedToo) {
  const auto error_with = [&](auto change) -> std::string {
    engine::Registry registry = make_registry();
    change(registry);
    try {
      const Simulation simulation(json_world(R"({"kind": "wander"})"), {}, registry);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "loaded";
  };
  EXPECT_EQ(error_with([](engine::Registry& r) { r.controllers.push_back(*r.controller("wander")); }),
            "the registry has two kinds with the name \"wander\", each a controller: rename one");
  EXPECT_EQ(error_with([](engine::Registry& r) { r.devices.push_back({.name = "eye"}); }),
            "the device kind \"eye\" does not set its member `prepare`");
  EXPECT_THAT(error_with([](engine::Registry& r) { r.faults.front().name = ""; }),
              testing::StartsWith("the fault kind \"\" has an invalid name: give one word"));
  EXPECT_THAT(error_with([](engine::Registry& r) {
                r.presets.push_back({"hurry", "wander", "", {{"cruise_sped", 1.0}}});
              }),
              testing::StartsWith("the preset \"hurry\" sets the parameter \"cruise_sped\", which its kind "
                                  "\"wander\" does not have: unknown parameter \"cruise_sped\"; known: "));
}

TEST_F(PluginsTest, AScriptThatIsNullIsAnError) {
  SimulationOptions with = options({});
  with.scripts = {nullptr};
  try {
    const Simulation simulation(json_world(R"({"kind": "wander"})"), with);
    ADD_FAILURE() << "loaded";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "the script 0 of the option scripts (counted from 0) is null: give a script");
  }
}

TEST_F(PluginsTest, OfOneNameHaveParametersOfTheirOwn) {
  engine::Registry here = make_registry();
  engine::Registry there = make_registry();
  const auto plugins = add_plugins(here, {folder_of("plugins")});
  const auto others = add_plugins(there, {folder_of("other")});
  ASSERT_NE(here.controller("walker"), nullptr);
  ASSERT_NE(there.controller("walker"), nullptr);
  EXPECT_EQ(here.controller("walker")->params.fields.front().text, "on the way");
  EXPECT_EQ(there.controller("walker")->params.fields.front().text, "on another way");
}

/// The example of docs/controllers.md.
TEST_F(PluginsTest, TheExampleFollowsTheWallsOfItsRoom) {
  Simulation simulation(test::source_dir() / "apps/examples/plugin/room.json",
                        options({folder_of("plugins")}));
  Model robot = simulation.find("r0");
  double farthest_m = 0;
  bool seen[4] = {};
  while (simulation.time_s() < 100) {
    simulation.step();
    const Pose pose = robot.pose();
    ASSERT_FALSE(robot.stalled()) << "at " << simulation.time_s() << " s";
    seen[(pose.x > 0) + 2 * (pose.y > 0)] = true;
    const double to_wall_m = std::min(3.9 - std::abs(pose.x), 2.9 - std::abs(pose.y));
    farthest_m = std::max(farthest_m, to_wall_m);
  }
  EXPECT_THAT(seen, testing::Each(true)) << "once around";
  EXPECT_LT(farthest_m, 0.8);
}

/// A robot with one sensor that looks at a wall, 1.9 m ahead, from line 3 on.
class PluginSensors : public PluginsTest {
 protected:
  fs::path room(std::string_view kind, std::string_view parameters = {}, std::string_view list = "sensors") {
    std::string text = R"({"troupe": 1, "types": {"wall": {"size_m": [0.2, 8, 1]},
      "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"},
        "LIST": [{"name": "eye", "kind": "KIND", PARAMETERS
          "transducers": [{"fov_deg": 90, "samples": 65, "range_max_m": 4}]}]}},
      "models": [{"name": "wall", "type": "wall", "pose": {"x_m": 2}}],
      "populations": [{"name": "r", "type": "bot", "count": 40,
        "place": {"rule": "grid", "region_m": [[-3, -2], [0, 2]], "pitch_m": 0.5}}]})";
    for (const auto& [word, value] :
         {std::pair("LIST", list), std::pair("KIND", kind), std::pair("PARAMETERS", parameters)})
      text.replace(text.find(word), std::string_view(word).size(), value);
    return write("room.json", text);
  }
  std::string error(const fs::path& world, std::string_view folder = "plugins") const {
    const std::string error = error_of(world, options({folder_of(folder)}));
    EXPECT_TRUE(error.starts_with(world.string())) << error;
    return error.substr(world.string().size());
  }
  std::vector<std::string> log_of(const fs::path& world, unsigned threads = 2) const {
    Simulation simulation(world, options({folder_of("plugins")}, threads));
    return test::hash_log(simulation, 20);
  }
};

/// The example of docs/extending.md: when none of its beams is changed, and when all are.
TEST_F(PluginSensors, ReadWhatTheirModelSays) {
  const auto ranges_of = [&](std::string_view kind, std::string_view parameters) {
    Simulation simulation(room(kind, parameters), options({folder_of("plugins")}));
    simulation.step();
    const auto ranges = simulation.find("r0").ranges();
    return std::vector<float>(ranges.begin(), ranges.end());
  };
  const std::vector<float> truth = ranges_of("ranger", "");
  ASSERT_EQ(truth.size(), 65u);
  EXPECT_EQ(ranges_of("beam_ranger", R"("short_share": 0, "max_share": 0, "random_share": 0,)"), truth);
  EXPECT_THAT(ranges_of("beam_ranger", R"("short_share": 0, "max_share": 1, "random_share": 0,)"),
              testing::Each(4.0f));
  const std::vector<float> cut =
      ranges_of("beam_ranger", R"("short_share": 1, "short_rate": 10, "max_share": 0, "random_share": 0,)");
  for (std::size_t k = 0; k < cut.size(); ++k) EXPECT_LE(cut[k], truth[k]);
  const std::vector<float> anything =
      ranges_of("beam_ranger", R"("short_share": 0, "max_share": 0, "random_share": 1,)");
  EXPECT_THAT(anything, testing::Each(AllOf(testing::Ge(0.0f), testing::Le(4.0f))));
  EXPECT_GT(*std::ranges::max_element(anything) - *std::ranges::min_element(anything), 3);
}

TEST_F(PluginSensors, GiveTheSameBitsOnAnyThreadsAndAreInTheHash) {
  const std::vector<std::string> one = log_of(room("beam_ranger"), 1);
  EXPECT_EQ(log_of(room("beam_ranger"), 3), one);
  EXPECT_NE(log_of(room("beam_ranger", R"("short_share": 0.06,)"), 1), one);
  const Simulation simulation(room("beam_ranger"), options({folder_of("plugins")}));
  EXPECT_THAT(simulation.effective_options(),
              Contains(Pair("plugin beam_ranger", MatchesRegex("[0-9a-f]{16}"))));
}

TEST_F(PluginSensors, ThatThrowAreNamedWithTickAndRobot) {
  const auto bots = [&](std::string_view kind) {
    return write("bots.json", R"({"troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2],
        "drive": {"kind": "diff"}, "sensors": [{"name": "eye", "kind": "thrower:)" +
                                  std::string(kind) + R"("}]}},
      "populations": [{"name": "r", "type": "bot", "count": 3,
        "place": {"rule": "grid", "region_m": [[0, 0], [4, 4]], "pitch_m": 1}}]})");
  };
  Simulation simulation(bots("sensor"), options({folder_of("plugins")}));
  simulation.step();
  simulation.step();
  EXPECT_THAT(test::message_of<engine::StepError>([&] { simulation.step(); }),
              MatchesRegex("tick 3: device \"eye\" .thrower:sensor. of \"r[0-2]\", the first of a "
                           "batch of 3 robots, threw an exception that is not a std::exception"));
  EXPECT_EQ(error(bots("unpreparable")),
            ":2: error: device \"eye\" (thrower:unpreparable) threw: the map is missing");
  EXPECT_THAT(test::message_of<engine::StepError>([&] {
                const Simulation unstartable(bots("unstartable"), options({folder_of("plugins")}));
              }),
              MatchesRegex("tick 0: device \"eye\" .thrower:unstartable. of \"r[0-2]\" threw: the "
                           "map is missing"));
  SimulationOptions mortal = options({folder_of("plugins")});
  mortal.mortal = true;
  Simulation unhaltable(bots("unhaltable"), mortal);
  unhaltable.disable(unhaltable.find("r1"));
  EXPECT_EQ(test::message_of<engine::StepError>([&] { unhaltable.step(); }),
            "tick 1: device \"eye\" (thrower:unhaltable) of \"r1\" threw: the brake is missing");
}

TEST_F(PluginSensors, AreRangersForWhoReadsRangers) {
  Simulation simulation(room("beam_ranger"), options({folder_of("plugins")}));
  Swarm swarm = simulation.swarm("r");
  EXPECT_EQ(swarm.beams(), 65u);
  simulation.run_for(1);
  EXPECT_EQ(simulation.find("r0").readings<float>("ranges", "eye").size(), 65u);
  EXPECT_GT(simulation.statistics().mean_displacement_m, 0) << "wander has taken it";
}

TEST_F(PluginSensors, ThatCannotBeUsedSayWhereAndWhy) {
  const auto at = [](std::string_view line, std::string_view pointer) {
    return ":" + std::string(line) + ": error: /types/bot/sensors/0" + std::string(pointer) + ": ";
  };
  const std::string plugins = folder_of("plugins").string();
  EXPECT_THAT(error(room("sonic")),
              AllOf(testing::StartsWith(at("3", "/kind") + "unknown sensor \"sonic\"; known: "),
                    EndsWith("; there is no sonic.so in " + plugins)));
  EXPECT_EQ(error(room("walker")),
            at("3", "/kind") + plugins +
                "/walker.so has no sensor or device \"walker\"; it has: walker, but no sensor or device");
  EXPECT_EQ(
      error(room("beam_ranger:sonic")),
      at("3", "/kind") + plugins +
          "/beam_ranger.so has no sensor or device \"beam_ranger:sonic\"; it has: beam_ranger (did you mean "
          "\"beam_ranger\"?)");
  EXPECT_THAT(
      error(room("another_version"), "unusable"),
      MatchesRegex(at("3", "/kind") +
                   "sensor or device \"another_version\": .*another_version.so was built for troupe "
                   "99.1.0 .interface 20., but this program is troupe 0.3.0 .interface 20.: rebuild it"));
  EXPECT_THAT(
      error(room("ranger:ranger"), "unusable"),
      EndsWith(
          "ranger.so has a sensor or device \"ranger\", but Troupe ships one with this name: rename it"));
  EXPECT_THAT(
      error(room("twice"), "unusable"),
      EndsWith("twice.so has two kinds with the name \"twice\", each a sensor or device: rename one"));
  EXPECT_THAT(error(room("misnamed"), "unusable"),
              EndsWith("misnamed.so has a sensor or device \"misnamed\" that has a parameter \"active\", but "
                       "\"active\" is a key that every sensor has in JSON worlds: rename the parameter"));
  EXPECT_THAT(
      error(room("unprepared"), "unusable"),
      EndsWith("unprepared.so has a sensor or device \"unprepared\" that does not set its member `prepare`"));
  EXPECT_EQ(error(room("beam_ranger", {}, "devices")),
            ":3: error: /types/bot/devices/0/kind: \"beam_ranger\" is a sensor: move this entry to the list "
            "\"sensors\"");
  EXPECT_EQ(error(room("led")),
            at("3", "/kind") + "\"led\" is not a sensor: move this entry to the list \"devices\"");
  EXPECT_THAT(error_of(stage_world("beam_ranger"), options({folder_of("plugins")})),
              EndsWith("has no controller \"beam_ranger\"; it has: beam_ranger, but no controller"));
}

TEST_F(PluginSensors, HaveTheirParametersChecked) {
  const auto is = [&](std::string_view parameters) { return error(room("beam_ranger", parameters)); };
  EXPECT_EQ(is(R"("short_share": 2,)"),
            ":3: error: /types/bot/sensors/0/short_share: must be from 0 to 1, found 2");
  EXPECT_THAT(is(R"("short_shares": 0.1,)"),
              AllOf(testing::StartsWith(":3: error: /types/bot/sensors/0: unknown key \"short_shares\""),
                    HasSubstr("did you mean \"short_share\"")));
  EXPECT_EQ(
      is(R"("short_share": 0.9, "max_share": 0.2,)"),
      ":3: error: device \"eye\" has short_share, max_share and random_share that add up to more than 1");
}

TEST_F(PluginSensors, AreRecordedAndGoOnFromACheckpoint) {
  if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
  Simulation simulation(room("beam_ranger"), options({folder_of("plugins")}));
  simulation.record(folder_ / "run.h5", {.fields = {"ranges"}});
  simulation.run_for(1);
  simulation.save(folder_ / "c.h5");
  simulation.run_for(1);
  simulation.stop_recording();
  fs::remove(folder_ / "room.json");
  ResumeOptions from;
  from.plugin_path = {folder_of("plugins")};
  Simulation resumed = Simulation::resume(folder_ / "c.h5", from);
  resumed.run_for(1);
  EXPECT_EQ(resumed.hash_log_line(), simulation.hash_log_line());
  from.plugin_path = {"/nowhere"};
  EXPECT_THROW(Simulation::resume(folder_ / "c.h5", from), InputError);
  const worldio::RecordingReader recording(folder_ / "run.h5");
  EXPECT_EQ(recording.ticks().size(), 21u);
}

class PluginsResumed : public PluginsTest {
 protected:
  void SetUp() override {
    if (!worldio::has_hdf5()) GTEST_SKIP() << "built without HDF5";
    Simulation simulation(stage_world("walker"), options({folder_of("plugins")}));
    expected_ = test::hash_log(simulation, 10);
    Simulation saved(stage_world("walker"), options({folder_of("plugins")}));
    saved.run_for(0.4);
    saved.save(folder_ / "c.h5");
    fs::remove(folder_ / "w.world");
  }
  Simulation resumed(std::string_view folder, bool across = false) const {
    ResumeOptions from;
    from.plugin_path = {folder_of(folder)};
    from.across_plugins = across;
    return Simulation::resume(folder_ / "c.h5", from);
  }
  std::string fault_of_resume(std::string_view folder) const {
    try {
      resumed(folder);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  std::vector<std::string> expected_;
};

TEST_F(PluginsResumed, GoOn) {
  Simulation simulation = resumed("plugins");
  EXPECT_THAT(simulation.warnings(), IsEmpty());
  EXPECT_THAT(simulation.effective_options(), Contains(Key("plugin walker")));
  simulation.run_for(0.6);
  EXPECT_EQ(simulation.hash_log_line(), expected_.back());
}

TEST_F(PluginsResumed, WithAnotherBuildNeedToBeToldSo) {
  EXPECT_THAT(
      fault_of_resume("other"),
      AllOf(testing::StartsWith(
                (folder_ / "c.h5").string() + ": error: " + file("other", "walker") +
                "is another build of plug-in \"walker\" than the one that the checkpoint was written with"),
            EndsWith("give --across-plugins (in C++ and Python: across_plugins) to resume it anyway")));
  Simulation simulation = resumed("other", true);
  EXPECT_THAT(simulation.warnings(), ElementsAre(HasSubstr(": warning: ")));
  simulation.run_for(0.6);
  EXPECT_NE(simulation.hash_log_line(), expected_.back()) << "it does go another way";
}

TEST_F(PluginsResumed, WithoutThemSayWhichIsMissing) {
  EXPECT_EQ(fault_of_resume("nowhere"), (folder_ / "c.h5").string() +
                                            ": error: the run needs plug-in \"walker\": there is no "
                                            "walker.so in " +
                                            folder_of("nowhere").string() + script_remedy("walker"));
}

}  // namespace
}  // namespace troupe::plugins_test
