#include "apps/check/check.hpp"

#include "engine/kinds/make_device_kind.hpp"
#include "engine/kinds/step_error.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/sensing/sensing_view.hpp"
#include "engine/world/world.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/rogue_controllers.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/registry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <exception>
#include <ostream>
#include <regex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace troupe::apps::check_test {
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

TEST_F(CheckProgram, TheColumnsOfItsTableAreAsWideAsTheirLongestEntry) {
  write("room.world", k_room);
  const Outcome outcome = troupe({"check", "room.world", "--for", "0.2", "--threads", "1", "--tile-size",
                                  "auto", "--amnesia", "--controllers"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_THAT(lines, SizeIs(6));
  EXPECT_THAT(lines[4], StartsWith("1 thread, automatic tiles, bodies moved in memory      2  same bits  "));
  for (std::size_t i = 1; i < lines.size(); ++i)
    EXPECT_EQ(lines[i].find("same bits"), lines[0].find("result")) << lines[i];
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
                          MatchesRegex("120 decisions, each made 3 times +10  same bits  -")));
}

TEST_F(CheckProgram, ComparesNumbersOfRanks) {
  write("room.world", k_room);
  const Outcome outcome = troupe({"check", "room.world", "--for", "1", "--threads", "1,2", "--tile-size",
                                  "auto", "--ranks", "1,3", "--rank-seed", "9"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(lines_of(outcome.out),
              ElementsAre("random delays and order of messages between ranks: --rank-seed 9 repeats them",
                          StartsWith("variant "),
                          MatchesRegex("1 thread, automatic tiles .* same bits  [0-9a-f]{16}"),
                          MatchesRegex("2 threads, automatic tiles .* same bits  [0-9a-f]{16}"),
                          MatchesRegex("3 ranks, 1 thread, automatic tiles .* same bits  [0-9a-f]{16}"),
                          MatchesRegex("3 ranks, 2 threads, automatic tiles .* same bits  [0-9a-f]{16}")));
}

TEST_F(CheckProgram, SaysWhetherTheRobotsAreDistributed) {
  write("room.world", k_room);
  const auto form = [&](const std::string& world) {
    const Outcome outcome = troupe({"check", world, "--for", "0.5", "--threads", "1", "--tile-size", "1",
                                    "--ranks", "1,3", "--distribute"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return lines_of(outcome.out)[1];
  };
  EXPECT_EQ(form("room.world"), "robot data of the ranks: distributed");
  write("walker.json", R"({"troupe": 1, "types": {"walker": {"size_m": [0.2, 0.2, 0.2],
      "devices": [{"name": "feet", "kind": "wheels", "size_m": [0.1, 0.1, 0.1]}]}},
      "models": [{"name": "r", "type": "walker"}]})");
  EXPECT_EQ(
      form("walker.json"),
      "robot data of the ranks: replicated, because robots of type \"walker\" have the device \"feet\" of "
      "the kind \"wheels\", which can drive a part of the robot to any distance");
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
            "troupe check: error: only one run is requested, so there is nothing to compare: give several "
            "numbers of threads, as in --threads 1,8 (--ranks, --tile-size, --amnesia, --reach and "
            "--controllers also add runs)\n");
  EXPECT_EQ(error_of({"check", "room.world", "--for", "1", "--distribute"}),
            "--distribute: error: no run of this check has several ranks, so no robots would be distributed: "
            "give numbers of ranks, as in --ranks 2,3\n");
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

/// A device that in each tick writes to the next body of the world. `k_has_target`: that body is the target
/// of the effect; otherwise the effect has no target.
template <bool k_has_target>
struct Meddler {
  struct State {
    std::uint32_t count = 0;
    TROUPE_FIELDS(count)
  };

  static engine::DeviceKind::Prepared prepare(const Pose&) { return {.data = Meddler(), .most_effects = 1}; }
  void act(const engine::DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const BodyId next(batch.body(i).index() + 1);
      if (next.index() < batch.view.spec().bodies.size())
        batch.emit(i, 0, 0, k_has_target ? next : BodyId(), {static_cast<double>(slot_of(batch, next))});
    }
  }
  void apply(engine::OwnDevice own, const engine::Effect& effect) const {
    const auto slot = static_cast<std::size_t>(effect.payload[0]);
    if (slot < own.table().rows()) ++own.table().template as<State>(slot).count;
  }
  /// The slot of another body of the same type; of another type: no slot.
  static std::size_t slot_of(const engine::DeviceBatch& batch, BodyId body) {
    const Row row = batch.view.row(body);
    const bool is_same = row.valid() && &batch.view.type(row) == &batch.view.type(batch.rows.front());
    return is_same ? batch.view.slot(row) : 1e6;
  }
};

/// Sensors that read the joints of all other bodies, and the places of bodies that are not in the world.
struct JointPeeker {
  struct State {
    double lift = 0;
    TROUPE_FIELDS(lift)
  };

  static engine::DeviceKind::Prepared prepare(const Pose&) { return {.data = JointPeeker()}; }
  std::uint64_t sense(const engine::DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      double& lift = batch.state.as<State>(batch.slot(i)).lift;
      lift = 0;
      for (std::size_t r = 0; r < batch.view.rows(); ++r)
        if (!batch.view.same_tree(Row(r), batch.rows[i])) lift += batch.view.lift(Row(r), 0);
    }
    return 0;
  }
};
struct GhostPeeker {
  struct State {
    double x = 0;
    TROUPE_FIELDS(x)
  };

  static engine::DeviceKind::Prepared prepare(const Pose&) {
    return {.data = GhostPeeker(), .reach_m = 1000};
  }
  std::uint64_t sense(const engine::DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      double& x = batch.state.as<State>(batch.slot(i)).x;
      x = 0;
      for (std::size_t r = 0; r < batch.view.rows(); ++r)
        if (!batch.view.is_there(Row(r))) x += batch.view.transform(Row(r)).position.x();
    }
    return 0;
  }
};

/// A device that throws in tick 3.
struct Thrower {
  static engine::DeviceKind::Prepared prepare(const Pose&) { return {.data = Thrower()}; }
  void act(const engine::DeviceBatch& batch) const {
    if (batch.view.tick() == 3) throw std::runtime_error("out of order");
  }
};

/// A measure whose value depends on how often measures of all runs were computed before.
struct FickleMeasure : engine::Measure {
  explicit FickleMeasure(const engine::MeasuredWorld&, std::vector<BodyId>) {}
  double value(const engine::MeasuredWorld&) override {
    static int count = 0;
    return ++count;
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
      for (const auto& [prefix, scope] : {std::pair("trees", engine::ApplyScope::trees),
                                          std::pair("any_target", engine::ApplyScope::any_target),
                                          std::pair("anything", engine::ApplyScope::anything)}) {
        for (const bool has_target : {false, true}) {
          static std::deque<std::string> names;  // the kinds refer to them
          names.push_back(fmt::format("{}_{}", prefix, has_target ? "far_target" : "no_target"));
          all.devices.push_back(has_target
                                    ? engine::make_device_kind<Meddler<true>>(names.back(), "meddles")
                                    : engine::make_device_kind<Meddler<false>>(names.back(), "meddles"));
          all.devices.back().scope = scope;
        }
      }
      all.devices.push_back(engine::make_device_kind<Thrower>("thrower", "throws"));
      all.devices.push_back(engine::make_device_kind<JointPeeker>("joint_peeker", "reads joints of others"));
      all.devices.push_back(engine::make_device_kind<GhostPeeker>("ghost_peeker", "reads unborn bodies"));
      all.measures.push_back(
          engine::make_measure_kind<FickleMeasure>("fickle", engine::Unit::meters, "", ""));
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
    std::exception_ptr thrown;
    try {
      outcome.code = apps::check(options, registry());
    } catch (...) {
      thrown = std::current_exception();
    }
    // Also after an exception: otherwise the next test would find the output captured already.
    outcome.out = ::testing::internal::GetCapturedStdout();
    outcome.err = ::testing::internal::GetCapturedStderr();
    if (thrown) std::rethrow_exception(thrown);
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

TEST_F(Check, ComparesTheMeasuresOfTheWorld) {
  CheckOptions fickle = options("honest");
  fickle.simulation.set = {{"/measures", R"(["stalls", "fickle"])"}};
  const Outcome outcome = check(fickle);
  EXPECT_EQ(outcome.code, 1);
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_THAT(lines, SizeIs(6)) << outcome.out;
  EXPECT_THAT(lines[2], MatchesRegex("2 threads, automatic tiles +0  DIFFERS    [0-9a-f]{16}"));
  EXPECT_THAT(lines[5], MatchesRegex("    measure fickle_m is 0x4[0-9a-f]{15} .[0-9]+., not "
                                     "0x[34][0-9a-f]{15} .[0-9]+."));
  fickle.simulation.set = {{"/measures", R"(["stalls", "path_length", {"kind": "order"}])"}};
  fickle.amnesia = fickle.reach = true;
  fickle.ranks = {1, 2};
  EXPECT_EQ(check(fickle).code, 0);
}

TEST_F(Check, AnHonestControllerPasses) {
  CheckOptions watched = options("honest");
  watched.controllers = true;
  const Outcome outcome = check(watched);
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_THAT(lines_of(outcome.out).back(),
              MatchesRegex("200 decisions, each made 3 times +5  same bits  -"));
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
                  MatchesRegex("2 threads, automatic tiles, junk in derived data +5  same bits  .*"),
                  MatchesRegex("2 threads, automatic tiles, world rebuilt +5  same bits  .*"),
                  MatchesRegex("2 threads, automatic tiles, bodies moved in memory +5  same bits  .*")));
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

TEST_F(Check, ReachHidesJointsAndBodiesThatAreNotInTheWorld) {
  for (const std::string kind : {"compass", "joint_peeker", "ghost_peeker"}) {
    CheckOptions blinkered = options("honest");
    blinkered.world = write(kind + ".json", fmt::format(R"({{
      "troupe": 1, "types": {{"bot": {{"size_m": [0.1, 0.1, 0.2], "drive": {{"kind": "diff"}},
        "controller": {{"kind": "honest"}}, "devices": [{{"kind": "gripper", "name": "hand"}}],
        "sensors": [{{"name": "it", "kind": "{}", "active": true}}]}}}},
      "populations": [{{"name": "r", "type": "bot", "count": 8, "reserve": 2,
                        "place": {{"rule": "uniform", "region_m": [[-5, -5], [5, 5]]}}}}]}})",
                                                        kind));
    blinkered.threads = {1};
    blinkered.reach = true;
    const Outcome outcome = check(blinkered);
    EXPECT_EQ(outcome.code, kind == "compass" ? 0 : 1) << kind << "\n" << outcome.out << outcome.err;
  }
}

struct Meddling {
  std::string kind;    ///< the scope that it declares, and what its effects are
  std::string report;  ///< what the check says; empty: nothing
};

void PrintTo(const Meddling& meddling, std::ostream* out) { *out << meddling.kind; }

class CheckScope : public Check, public ::testing::WithParamInterface<Meddling> {};

/// Replaces the names of robots, because the order in which bodies have their rows decides which is named.
std::string without_names(const std::string& text) {
  return std::regex_replace(text, std::regex("\"r[0-9]+\""), "\"r\"");
}

TEST_P(CheckScope, OfAnEffectIsWhatItsKindDeclares) {
  CheckOptions blinkered = options("honest");
  blinkered.threads = {1};
  blinkered.reach = true;
  blinkered.world = write("meddlers.json", crowd_with("devices", GetParam().kind));
  const Outcome outcome = check(blinkered);
  if (GetParam().report.empty()) {
    EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    return;
  }
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, IsEmpty());
  const std::vector<std::string> lines = lines_of(outcome.out);
  ASSERT_THAT(lines, SizeIs(6)) << outcome.out;
  EXPECT_THAT(lines[1], MatchesRegex("1 thread, automatic tiles +1  same bits  [0-9a-f]{16}"));
  EXPECT_THAT(lines[2],
              MatchesRegex("1 thread, automatic tiles, bodies beyond reach hidden +1  DIFFERS    -"));
  EXPECT_EQ(lines[3], "differs at tick 1 (0.1 s):");
  EXPECT_EQ(
      lines[4],
      "  1 thread, automatic tiles, bodies beyond reach hidden, compared with 1 thread, automatic tiles:");
  EXPECT_EQ(without_names(lines[5]),
            without_names(fmt::format("    stopped with an error: tick 1: device \"it\" ({}) of \"r0\" {}",
                                      GetParam().kind, GetParam().report)));
}

std::string changed(std::string_view kind) {
  return fmt::format(
      "changed the component \"{}/it\" of \"r1\", a body that is neither the body of the device nor the "
      "target of its effect, nor moves together with one of them: if this is intended, set "
      "DeviceKind::scope to ApplyScope::anything",
      kind);
}

INSTANTIATE_TEST_SUITE_P(
    Scopes, CheckScope,
    ::testing::Values(Meddling{"trees_no_target", changed("trees_no_target")},
                      Meddling{"any_target_no_target", changed("any_target_no_target")},
                      Meddling{"anything_no_target", ""},
                      Meddling{
                          "trees_far_target",
                          "requested an effect on \"r1\", which is farther away than the kind of the device "
                          "declares: declare a larger reach (DeviceKind::Prepared::reach_m) or a wider scope "
                          "(DeviceKind::scope)"},
                      Meddling{"any_target_far_target", ""}, Meddling{"anything_far_target", ""}),
    [](const auto& meddling) {
      std::string name = meddling.param.kind;
      std::erase(name, '_');
      return name;
    });

TEST_F(Check, AnErrorOfAllVariantsIsAnErrorOfTheWorld) {
  CheckOptions both = options("honest");
  both.world = write("throwers.json", crowd_with("devices", "thrower"));
  EXPECT_THAT([&] { check(both); },
              ThrowsMessage<engine::StepError>(
                  MatchesRegex("tick 3: device \"it\" .thrower. of \"r[0-9]+\".* threw: out of order")));
}

TEST_F(CheckProgram, ReachNeedsTheExactRayEngine) {
  write("room.world", k_room);
  const Outcome outcome = troupe({"check", "room.world", "--for", "1", "--reach", "--raytracer", "grid"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "troupe check: error: --reach needs the exact ray engine, but this run uses the grid engine: "
            "give --raytracer exact\n");
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
}  // namespace troupe::apps::check_test
