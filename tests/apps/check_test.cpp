#include "apps/check/check.hpp"

#include "engine/device_kind.hpp"
#include "engine/sensing_view.hpp"
#include "engine/world.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/rogue_controllers.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/registry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::apps {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::SizeIs;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

class CheckProgram : public ProgramTest {};

TEST_F(CheckProgram, ComparesEveryVariantAndWritesNothing) {
  write("room.world", k_room);
  const Outcome outcome =
      troupe({"check", "room.world", "--for", "2", "--threads", "1,3", "--tile-size", "auto,0.9,7"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_THAT(lines, SizeIs(7));
  EXPECT_THAT(lines[0], MatchesRegex("variant +ticks +result +hash"));
  EXPECT_THAT(lines[1], MatchesRegex("1 thread, automatic tiles +20  same bits  [0-9a-f]{16}"));
  EXPECT_THAT(lines[6], MatchesRegex("3 threads, tiles of 7 m +20  same bits  [0-9a-f]{16}"));
  const std::string hash = lines[1].substr(lines[1].size() - 16);
  for (std::size_t i = 2; i < lines.size(); ++i) EXPECT_THAT(lines[i], ::testing::EndsWith(hash));
  EXPECT_THAT(troupe({"run", "room.world", "--for", "2"}).out, HasSubstr(hash)) << "as a run ends";
  EXPECT_THAT(files(), ElementsAre("room.world"));
}

TEST_F(CheckProgram, TakesTheOptionsThatChangeResults) {
  write("swarm.json", R"({
    "troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
      "controller": {"kind": "script", "law": "wave"}, "sensors": [
        {"name": "eye", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 2}]}]}},
    "populations": [{"name": "r", "type": "bot", "count": 9,
                     "place": {"rule": "uniform", "region_m": [[-2, -2], [2, 2]]}}]})");
  const auto hash = [&](std::vector<std::string> more) {
    more.insert(more.begin(),
                {"check", "swarm.json", "--for", "1", "--threads", "1,2", "--tile-size", "auto"});
    const Outcome outcome = troupe(more);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const auto lines = lines_of(outcome.out);
    return lines.empty() ? std::string() : lines.back().substr(lines.back().size() - 16);
  };
  const std::string plain = hash({});
  EXPECT_EQ(hash({"--seed", "1", "--robots", "r=9"}), plain);
  EXPECT_NE(hash({"--seed", "2"}), plain);
  EXPECT_NE(hash({"--raytracer", "grid"}), plain);
  EXPECT_NE(hash({"--robots", "8"}), plain);
  EXPECT_NE(hash({"--set", "/populations/0/count=10"}), plain);
}

TEST_F(CheckProgram, ChecksTheControllersOfARoom) {
  write("room.world", k_room);
  const Outcome outcome =
      troupe({"check", "room.world", "--for", "1", "--threads", "2", "--tile-size", "auto", "--controllers"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(lines_of(outcome.out),
              ElementsAre(StartsWith("variant "), MatchesRegex("2 threads, .* same bits  [0-9a-f]{16}"),
                          MatchesRegex("120 decisions, each 3 times +10  same bits  -")));
}

TEST_F(CheckProgram, ComparesNumbersOfRanks) {
  write("room.world", k_room);
  const Outcome outcome = troupe({"check", "room.world", "--for", "1", "--threads", "1,2", "--tile-size",
                                  "auto", "--ranks", "1,3", "--rank-seed", "9"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(lines_of(outcome.out),
              ElementsAre("random delays between ranks: --rank-seed 9", StartsWith("variant "),
                          MatchesRegex("1 thread, automatic tiles .* same bits  [0-9a-f]{16}"),
                          MatchesRegex("2 threads, automatic tiles .* same bits  [0-9a-f]{16}"),
                          MatchesRegex("3 ranks, 1 thread, automatic tiles .* same bits  [0-9a-f]{16}"),
                          MatchesRegex("3 ranks, 2 threads, automatic tiles .* same bits  [0-9a-f]{16}")));
}

TEST_F(CheckProgram, BadInputIsExitCode2) {
  write("room.world", k_room);
  write("bad.json", "{\n  \"troupe\": 1,\n  \"types\": 3\n}\n");
  const auto error_of = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = troupe(arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.out, IsEmpty());
    return outcome.err;
  };
  EXPECT_THAT(error_of({"check", "bad.json", "--for", "1"}), StartsWith("bad.json:3: error: /types"));
  EXPECT_EQ(error_of({"check", "none.world", "--for", "1"}), "none.world: error: there is no such file\n");
  EXPECT_EQ(error_of({"check", "room.world"}),
            "room.world: error: no end time: give --for SECONDS, or set quit_time in the world\n");
  EXPECT_EQ(error_of({"check", "room.world", "--for", "1", "--threads", "2", "--tile-size", "3"}),
            "troupe check: error: there is only one variant and nothing to compare: give several numbers to "
            "--threads, --ranks or --tile-size, or give --amnesia, --reach or --controllers\n");
}

/// A sensor that counts the bodies within 1 m, and declares a reach of its own.
struct Counter {
  struct Params {
    double declared = 0;

    static constexpr void describe(engine::Description<Params>& d) {
      using namespace engine::facts;
      d.member<&Params::declared>("declared", engine::Unit::meters, "its declared reach");
    }
  };
  struct State {
    std::uint32_t count = 0;
    TROUPE_FIELDS(count)
  };

  static engine::DeviceKind::Prepared prepare(const Params& params, const Pose&) {
    return {.data = Counter(), .reach_m = params.declared};
  }
  std::uint64_t sense(const engine::DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const Vec2 here = batch.view.transform(batch.rows[i]).position;
      std::uint32_t count = 0;
      batch.view.index().for_each_near(Box::around(here, 1), [&](const partition::BodyCircle& circle) {
        const Vec2 there = batch.view.transform(Row(circle.row)).position;
        count += (there - here).norm() < 1;
      });
      batch.state.as<State>(batch.slot(i)).count = count;
    }
    return 0;
  }
};

/// A sensor that reads the speeds of the bodies within 1 m, and declares that it does.
struct Doppler {
  struct State {
    double speed = 0;
    TROUPE_FIELDS(speed)
  };
  static constexpr std::array reads{engine::k_velocity_of_others};

  static engine::DeviceKind::Prepared prepare(const Pose&) { return {.data = Doppler(), .reach_m = 1}; }
  std::uint64_t sense(const engine::SenseBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const Vec2 here = batch.view.transform(batch.rows[i]).position;
      double speed = 0;
      batch.view.index().for_each_near(Box::around(here, 1), [&](const partition::BodyCircle& circle) {
        const Row row(circle.row);
        if ((batch.view.transform(row).position - here).norm() < 1)
          speed = std::max(speed, std::abs(batch.committed.velocity(row).x));
      });
      batch.state.as<State>(batch.slot(i)).speed = speed;
    }
    return 0;
  }
};

/// A device that in each tick writes to the next body of the world.
struct Meddler {
  struct State {
    std::uint32_t count = 0;
    TROUPE_FIELDS(count)
  };
  static constexpr engine::ApplyScope scope = engine::ApplyScope::trees;

  static engine::DeviceKind::Prepared prepare(const Pose&) { return {.data = Meddler(), .most_effects = 1}; }
  void act(const engine::DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) batch.emit(i, 0, 0, BodyId());
  }
  void apply(engine::World& world, const engine::Effect& effect) const {
    const BodyId next(effect.source.index() + 1);
    if (next.index() >= world.spec().bodies.size() || !world.row(next).valid()) return;
    const Row row = world.row(next);
    ++world.state(world.type(row).devices[effect.device]).as<State>(world.slot(row)).count;
  }
};

/// With kinds of our own, which the program does not have.
class Check : public test::ScratchTest {
 protected:
  static const engine::Registry& registry() {
    static const engine::Registry kinds = [] {
      engine::Registry all = make_registry();
      for (engine::ControllerKind& kind : test::rogue_controllers())
        all.controllers.push_back(std::move(kind));
      all.devices.push_back(engine::make_device_kind<Counter>("counter", "counts the bodies near it"));
      all.devices.push_back(engine::make_device_kind<Doppler>("doppler", "the speeds of bodies near it"));
      all.devices.push_back(engine::make_device_kind<Doppler>("secret_doppler", "the same, not declared"));
      all.devices.back().reads.clear();
      all.devices.push_back(engine::make_device_kind<Meddler>("meddler", "writes to another body"));
      all.devices.push_back(engine::make_device_kind<Meddler>("frank_meddler", "the same, declared"));
      all.devices.back().scope = engine::ApplyScope::anything;
      return all;
    }();
    return kinds;
  }

  CheckOptions options(const std::string& controller) const {
    CheckOptions options;
    options.world = write("swarm.json", R"({
      "troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": ")" +
                                            controller + R"("}}},
      "populations": [{"name": "r", "type": "bot", "count": 40,
                       "place": {"rule": "uniform", "region_m": [[-5, -5], [5, 5]]}}]})");
    options.for_s = 0.5;
    options.threads = {1, 2};
    options.tile_sizes_m = {0};
    return options;
  }
  Outcome check(const CheckOptions& options) const {
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    Outcome outcome;
    outcome.code = apps::check(options, registry());
    outcome.out = ::testing::internal::GetCapturedStdout();
    outcome.err = ::testing::internal::GetCapturedStderr();
    return outcome;
  }
  Outcome check_controllers(const std::string& controller) const {
    CheckOptions watched = options(controller);
    watched.controllers = true;
    watched.threads = {2};
    return check(watched);
  }
};

TEST_F(Check, StopsAtTheFirstTickThatDiffersAndNamesTheVariants) {
  const Outcome outcome = check(options("keeps_a_static"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, IsEmpty());
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_THAT(lines, SizeIs(6));
  EXPECT_THAT(lines[1], MatchesRegex("1 thread, automatic tiles +1  same bits  [0-9a-f]{16}"));
  EXPECT_THAT(lines[2], MatchesRegex("2 threads, automatic tiles +1  DIFFERS    [0-9a-f]{16}"));
  EXPECT_EQ(lines[3], "differs at tick 1 (0.1 s):");
  EXPECT_EQ(lines[4], "  2 threads, automatic tiles, compared with 1 thread, automatic tiles:");
  EXPECT_THAT(lines[5],
              MatchesRegex("    keeps_a_static/0: calls of \"r0\" .id 1. is 0x[0-9a-f]{8} .[0-9]+., not "
                           "0x[0-9a-f]{8} .[0-9]+.; 40 bodies differ"));
}

TEST_F(Check, AnHonestControllerPasses) {
  CheckOptions watched = options("honest");
  watched.controllers = true;
  const Outcome outcome = check(watched);
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_THAT(lines_of(outcome.out).back(), MatchesRegex("200 decisions, each 3 times +5  same bits  -"));
}

TEST_F(Check, AmnesiaFindsWhatIsRememberedOutsideOfTheState) {
  CheckOptions forgetful = options("changes_a_member");
  forgetful.threads = {1};
  forgetful.amnesia = true;
  const Outcome outcome = check(forgetful);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, ContainsRegex("world rebuilt +[0-9]+  DIFFERS"));
}

TEST_F(Check, AmnesiaPassesWhereAllIsState) {
  CheckOptions forgetful = options("honest");
  forgetful.threads = {2};
  forgetful.amnesia = true;
  const Outcome outcome = check(forgetful);
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_THAT(
      lines_of(outcome.out),
      ElementsAre(StartsWith("variant "), MatchesRegex("2 threads, automatic tiles +5  same bits  .*"),
                  MatchesRegex("2 threads, automatic tiles, caches cleared +5  same bits  .*"),
                  MatchesRegex("2 threads, automatic tiles, world rebuilt +5  same bits  .*")));
}

TEST_F(Check, ReachFindsADeviceThatReadsFurtherThanItDeclares) {
  for (const auto& [declared, code] : {std::pair("1.0", 0), std::pair("0.8", 1)}) {
    CheckOptions blinkered = options("honest");
    blinkered.world = write("counters.json", R"({
      "troupe": 1, "types": {"bot": {"size_m": [0.02, 0.02, 0.2], "drive": {"kind": "diff"}, "sensors": [
        {"name": "count", "kind": "counter", "declared_m": )" +
                                                 std::string(declared) + R"(, "active": true}]}},
      "populations": [{"name": "r", "type": "bot", "count": 60,
                       "place": {"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}}]})");
    blinkered.threads = {2};
    blinkered.reach = true;
    const Outcome outcome = check(blinkered);
    EXPECT_EQ(outcome.code, code) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, ContainsRegex(code == 0 ? "bodies beyond reach hidden +5  same bits"
                                                     : "bodies beyond reach hidden +1  DIFFERS"));
  }
}

/// Devices in one list of a type, in a crowd of robots that drive.
std::string crowd_with(std::string_view list, std::string_view kind) {
  return fmt::format(R"({{
    "troupe": 1, "types": {{"bot": {{"size_m": [0.1, 0.1, 0.2], "drive": {{"kind": "diff"}},
      "controller": {{"kind": "honest"}}, "{}": [{{"name": "it", "kind": "{}", "active": true}}]}}}},
    "populations": [{{"name": "r", "type": "bot", "count": 40,
                      "place": {{"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}}}}]}})",
                     list, kind);
}

TEST_F(Check, ReachFindsADeviceThatReadsMoreThanItDeclares) {
  for (const auto& [kind, code] : {std::pair("doppler", 0), std::pair("secret_doppler", 1)}) {
    CheckOptions blinkered = options("honest");
    blinkered.world = write("crowd.json", crowd_with("sensors", kind));
    blinkered.threads = {2};
    blinkered.reach = true;
    const Outcome outcome = check(blinkered);
    EXPECT_EQ(outcome.code, code) << kind << "\n" << outcome.out << outcome.err;
  }
}

TEST_F(Check, ReachFindsAnEffectThatChangesMoreThanItsKindDeclares) {
  CheckOptions blinkered = options("honest");
  blinkered.threads = {1};
  blinkered.reach = true;
  blinkered.world = write("frank.json", crowd_with("devices", "frank_meddler"));
  const Outcome frank = check(blinkered);
  EXPECT_EQ(frank.code, 0) << frank.out << frank.err;
  blinkered.world = write("meddlers.json", crowd_with("devices", "meddler"));
  EXPECT_THAT(
      [&] { check(blinkered); },
      ThrowsMessage<engine::StepError>("tick 1: device \"it\" (meddler) of \"r0\" changed the component "
                                       "\"meddler/it\" of \"r1\", but that body is outside the scope "
                                       "that the device's kind declares (DeviceKind::scope)"));
}

TEST_F(CheckProgram, ReachNeedsTheExactRayEngine) {
  write("room.world", k_room);
  const Outcome outcome = troupe({"check", "room.world", "--for", "1", "--reach", "--raytracer", "grid"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "troupe check: error: --reach needs the exact ray engine, but this run uses the grid engine "
            "(key \"ranging\" of the world file, or option --raytracer)\n");
}

struct Rogue {
  std::string controller;
  std::string finding;
};

void PrintTo(const Rogue& rogue, std::ostream* out) { *out << rogue.controller; }

class CheckRogue : public Check, public ::testing::WithParamInterface<Rogue> {};

TEST_P(CheckRogue, IsNamedWithItsField) {
  const Outcome outcome = check_controllers(GetParam().controller);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(lines_of(outcome.out).back(),
              AllOf(StartsWith("  controller \"" + GetParam().controller + "/0\": " + GetParam().finding),
                    HasSubstr(" of \"r0\" (id 1) is 0x")));
  EXPECT_THAT(outcome.out, HasSubstr("DIFFERS"));
}

INSTANTIATE_TEST_SUITE_P(Controllers, CheckRogue,
                         ::testing::Values(Rogue{"calls_rand", "command turn"},
                                           Rogue{"keeps_a_static", "memory calls"},
                                           Rogue{"reads_a_slow_clock", "memory now"},
                                           Rogue{"leaves_a_member_unset", "command x"},
                                           Rogue{"starts_half", "memory unset"}),
                         [](const auto& rogue) {
                           std::string name = rogue.param.controller;
                           std::erase(name, '_');
                           return name;
                         });

}  // namespace
}  // namespace troupe::apps
