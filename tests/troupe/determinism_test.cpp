// The short form of scripts/prove: runs have the same bits for any number of threads and any tile size,
// and the golden hashes. The rounding mode, denormals and locale of the caller, and the working directory,
// do not change the state.

#include "base/fp_environment.hpp"
#include "base/hash.hpp"
#include "engine/observing/remade_world.hpp"
#include "engine/world/world.hpp"
#include "tests/support/hash_log.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "tests/troupe/golden_hashes.hpp"
#include "troupe/troupe.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cfenv>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <locale>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace troupe::determinism_test {
namespace {

namespace fs = std::filesystem;

SimulationOptions options_of(const scenes::Run& run, unsigned threads, double tile_size_m = 0) {
  SimulationOptions options;
  options.threads = threads;
  options.tile_size_m = tile_size_m;
  if (run.by_grid) options.ranging = RangingEngine::grid;
  if (run.robots) options.robots = {{"", *run.robots}};
  return options;
}

/// The lines of the hash log of a run.
std::vector<std::string> log_of(const scenes::Run& run, unsigned threads, double tile_size_m = 0) {
  Simulation simulation(run.file(), options_of(run, threads, tile_size_m));
  const std::vector<std::string> lines = test::hash_log(simulation, run.ticks);
  EXPECT_EQ(lines.back().find(hex(simulation.state_hash())), lines.back().find(' ') + 1);
  return lines;
}

std::string state_of(const std::string& line) { return line.substr(line.find(' ') + 1, 16); }

class SameBits : public ::testing::TestWithParam<scenes::Run> {};

TEST_P(SameBits, ForAnyThreadsAndTiles) {
  const scenes::Run& run = GetParam();
  const std::vector<std::string> expected = log_of(run, 1, 1.7);
  for (const double tile_size_m : {1.7, 45.1}) {
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
      if (threads == 1 && tile_size_m == 1.7) continue;
      const std::vector<std::string> got = log_of(run, threads, tile_size_m);
      for (std::size_t tick = 0; tick < expected.size(); ++tick)
        ASSERT_EQ(got[tick], expected[tick]) << threads << " threads, tiles of " << tile_size_m << " m";
    }
  }
  const auto golden = test::golden_hashes();
  const test::GoldenRun line = test::golden_run(run);
  ASSERT_TRUE(golden.contains(line))
      << "no line in worlds/golden_hashes.txt: scripts/prove --golden makes it";
  EXPECT_EQ(state_of(expected.back()), golden.at(line))
      << "results have changed; if that was meant, scripts/prove --golden, and docs/decisions.md says why";
}

// The amnesia test: whatever influences a later tick is in a state table, or derived from tables, spec and
// tick. One run has all else overwritten with junk after each tick, another goes on as a new world each tick,
// and in the third all bodies change their rows after each tick.
TEST_P(SameBits, WithNothingKeptButTheState) {
  const scenes::Run& run = GetParam();
  Simulation whole(run.file(), options_of(run, 1));
  Simulation forgetful(run.file(), options_of(run, 2));
  std::unique_ptr<engine::World> remade =
      engine::remade_world(whole.world(), whole.registry(), {.threads = 2, .tile_size_m = 1.7});
  Simulation shuffled(run.file(), options_of(run, 2, 1.7));
  forgetful.world().forget();
  shuffled.world().shuffle_rows(1);
  while (whole.tick() < run.ticks) {
    whole.step();
    forgetful.step();
    forgetful.world().forget();
    remade->step();
    ASSERT_EQ(forgetful.hash_log_line(), whole.hash_log_line());
    shuffled.step();
    shuffled.world().shuffle_rows(1);
    ASSERT_EQ(shuffled.hash_log_line(), whole.hash_log_line()) << "with shuffled rows";
    ASSERT_EQ(hex(remade->hashes().state), hex(whole.state_hash())) << "tick " << whole.tick();
    remade = engine::remade_world(*remade, whole.registry(), {.threads = 2, .tile_size_m = 1.7});
  }
}

// What a device reads of other bodies lies within the reach that it declares: nothing changes if all other
// bodies are hidden from it, one row at a time.
TEST_P(SameBits, WithBodiesBeyondReachHidden) {
  const scenes::Run& run = GetParam();
  if (run.by_grid) GTEST_SKIP() << "the grid ray engine draws all bodies in advance";
  Simulation whole(run.file(), options_of(run, 1));
  Simulation blinkered(run.file(), options_of(run, 1));
  if (blinkered.world().spec().ranging == RangingEngine::grid)
    GTEST_SKIP() << "a world of the grid ray engine";
  blinkered.world().hide_beyond_reach(true);
  const double rows = static_cast<double>(whole.world().view().rows());
  // The time of a tick grows with the square of the number of rows.
  if (rows > 4000) GTEST_SKIP() << "a tick of " << rows << " rows takes minutes";
  const auto ticks = std::min<std::uint64_t>(run.ticks, 2 + static_cast<std::uint64_t>(2e7 / (rows * rows)));
  while (whole.tick() < ticks) {
    whole.step();
    blinkered.step();
    ASSERT_EQ(blinkered.hash_log_line(), whole.hash_log_line());
  }
}

/// The file names of all shipped worlds.
std::vector<std::string> shipped_worlds() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(test::source_dir() / "worlds")) {
    const fs::path& file = entry.path();
    if ((file.extension() == ".json" || file.extension() == ".world") && file.filename() != "scenes.json")
      names.push_back(file.filename());
  }
  std::ranges::sort(names);
  return names;
}

/// Numbers of robots for the populations of a world file, in the proportions of the file, but with about
/// `most` bodies in all. Empty if the file has no more.
std::vector<std::pair<std::string, std::size_t>> fewer_robots(const fs::path& file, double most) {
  if (file.extension() != ".json") return {};
  std::ifstream stream(file);
  const auto world = nlohmann::json::parse(stream);
  if (!world.contains("populations")) return {};
  double all = 0;
  for (const auto& population : world.at("populations")) all += population.at("count").get<double>();
  std::vector<std::pair<std::string, std::size_t>> robots;
  if (all <= most) return robots;
  for (const auto& population : world.at("populations"))
    robots.emplace_back(
        population.at("name").get<std::string>(),
        static_cast<std::size_t>(std::ceil(population.at("count").get<double>() * most / all)));
  return robots;
}

class Reach : public ::testing::TestWithParam<std::string> {};

// The reach test of every shipped world. The time of a tick grows with the square of the number of rows, so
// large worlds have fewer robots here; `scripts/prove --reach` runs them with more.
TEST_P(Reach, OfEveryDeviceHoldsInEveryWorld) {
  const fs::path file = test::source_dir() / "worlds" / GetParam();
  SimulationOptions options;
  options.threads = 1;
  options.robots = fewer_robots(file, 60);
  Simulation whole(file, options);
  Simulation blinkered(file, options);
  ASSERT_EQ(whole.world().spec().ranging, RangingEngine::exact);
  blinkered.world().hide_beyond_reach(true);
  const std::uint64_t ticks = test::k_slow_build ? 10 : 50;
  while (whole.tick() < ticks) {
    whole.step();
    blinkered.step();
    ASSERT_EQ(blinkered.hash_log_line(), whole.hash_log_line());
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, Reach, ::testing::ValuesIn(shipped_worlds()), [](const auto& world) {
  std::string name = world.param;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
});

std::vector<scenes::Run> runs() {
  return scenes::runs_of(test::k_slow_build ? "same_bits_slow" : "same_bits");
}

INSTANTIATE_TEST_SUITE_P(Worlds, SameBits, ::testing::ValuesIn(runs()),
                         [](const auto& run) { return run.param.name(); });

// A robot at the origin creeps by less than the smallest normal number a tick, among others that do ordinary
// things: flush-to-zero would leave it where it is, and another rounding would show in all of them.
class Environment : public test::ScratchTest {
 protected:
  static constexpr double k_creep_mps = 0x1p-1040;

  fs::path world() const {
    return write("creep.json", R"({
  "troupe": 1, "title": "One creeps, others wander",
  "types": {
    "wall": {"size_m": [0.2, 6.5, 1]},
    "creeper": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}},
    "wanderer": {"size_m": [0.31, 0.17, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"}, "sensors": [
      {"name": "eyes", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 3.3, "fov_deg": 170.5, "samples": 9}]}]}
  },
  "models": [
    {"name": "creeper", "type": "creeper"},
    {"name": "wall", "type": "wall", "pose": {"x_m": 3.7, "heading_deg": 0.7}}
  ],
  "populations": [
    {"name": "w", "type": "wanderer", "count": 40, "place": {"rule": "uniform", "region_m": [[-3.3, -3.3], [3.3, 3.3]]}}
  ]
})");
  }
  static SimulationOptions threads(unsigned n) {
    SimulationOptions options;
    options.threads = n;
    return options;
  }
  static std::string log(Simulation& simulation) {
    simulation.find("creeper").set_speed(k_creep_mps, 0);
    std::string lines = simulation.hash_log_line();
    for (int i = 0; i < 10; ++i) {
      simulation.step();
      lines += '\n' + simulation.hash_log_line();
    }
    return lines;
  }
  std::string expected() const {
    Simulation simulation(world(), threads(3));
    std::string lines = log(simulation);
    EXPECT_GT(simulation.find("creeper").pose().x, 0);
    EXPECT_LT(simulation.find("creeper").pose().x, 0x1p-1022);
    EXPECT_GT(simulation.statistics().mean_displacement_m, 0.1);
    return lines;
  }
  /// In a thread of its own, whose environment goes with it.
  template <class Work>
  static void in_thread(Work&& work) {
    std::thread(std::forward<Work>(work)).join();
  }
  static void spoil_rounding() { std::fesetround(FE_UPWARD); }
  static void spoil_denormals() {
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() | 0x8040);  // what gcc's -ffast-math start-up code sets: FTZ and DAZ
#endif
  }
};

TEST_F(Environment, IsPutRightBeforeALoad) {
  const std::string clean = expected();
  for (const auto spoil : {spoil_rounding, spoil_denormals}) {
    for (const unsigned n : {1u, 3u}) {
      std::string got;
      in_thread([&] {
        spoil();
        Simulation simulation(world(), threads(n));
        EXPECT_TRUE(check_fp_environment());
        got = log(simulation);
      });
      EXPECT_EQ(got, clean) << n << " threads";
    }
  }
}

TEST_F(Environment, IsPutRightBeforeAStep) {
  const std::string clean = expected();
  for (const auto spoil : {spoil_rounding, spoil_denormals}) {
    for (const unsigned n : {1u, 3u}) {
      Simulation simulation(world(), threads(n));
      std::string got;
      in_thread([&] {  // another thread than loaded it, as when a plug-in was loaded there
        spoil();
        got = log(simulation);
      });
      EXPECT_EQ(got, clean) << n << " threads";
    }
  }
}

TEST_F(Environment, IsPutRightBeforeAResetAndASetting) {
  const auto run = [this](void (*spoil)()) {
    std::string lines;
    in_thread([&] {
      Simulation simulation(world(), threads(1));
      spoil();
      simulation.reset(7);
      spoil();
      simulation.set("wanderer", R"({"controller": {"kind": "wander", "cruise_speed_mps": 0.3}})");
      lines = log(simulation);
    });
    return lines;
  };
  EXPECT_EQ(run(spoil_rounding), run([] {}));
}

TEST_F(Environment, TheWorkingFolderIsNotState) {
  const std::string clean = expected();
  world();
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  std::string got;
  {
    Simulation simulation("creep.json", threads(3));
    got = log(simulation);
  }
  fs::current_path(before);
  EXPECT_EQ(got, clean);
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST_F(Environment, TheLocaleOfStreamsIsNotState) {
  const std::string clean = expected();
  world();
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  std::string got;
  std::string header;
  {
    Simulation simulation(folder_ / "creep.json", threads(3));
    got = log(simulation);
    header = simulation.hash_log_header();
  }
  std::locale::global(before);
  EXPECT_EQ(got, clean);
  EXPECT_NE(header.find("# tick_s: 0.1\n"), std::string::npos) << header;
}

TEST_F(Environment, TheLocaleOfCIsNotState) {
  const std::string clean = expected();
  const auto comma = [this] {
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "nl_NL.UTF-8"})
      if (std::setlocale(LC_ALL, name)) return true;
    // None is installed: perhaps one can be made.
    const std::string make =
        "localedef -f UTF-8 -i de_DE " + (folder_ / "de_DE.UTF-8").string() + " 2>/dev/null";
    return std::system(make.c_str()) == 0 && setenv("LOCPATH", folder_.c_str(), 1) == 0 &&
           std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
  };
  if (!comma()) GTEST_SKIP() << "no locale with a decimal comma (de_DE.UTF-8) is installed or can be made";
  ASSERT_STREQ(std::localeconv()->decimal_point, ",");
  std::string got;
  {
    Simulation simulation(world(), threads(3));
    got = log(simulation);
  }
  std::setlocale(LC_ALL, "C");
  unsetenv("LOCPATH");
  EXPECT_EQ(got, clean);
}

}  // namespace
}  // namespace troupe::determinism_test
