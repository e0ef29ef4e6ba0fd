// Acts of users on a running world, which session files store and repeat: docs/live.md.

#include "engine/kinds/make_device_kind.hpp"
#include "tests/support/draw.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "troupe/troupe.hpp"
#include "worldio/json/session_json.hpp"
#include "worldio/results/hdf5_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::session_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Kind = Act::Kind;
using test::Draw;

constexpr const char* k_yard = R"({"troupe": 1, "title": "yard", "seed": 5, "bounds_m": [[-6, -6], [6, 6]],
  "types": {
    "bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff", "velocity_max_x_mps": 1},
            "sensors": [{"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2, "samples": 9, "fov_deg": 180}]}],
            "devices": [{"name": "lamp", "kind": "led"}], "controller": {"kind": "wander"}},
    "rock": {"size_m": [1, 1, 0.5]}},
  "populations": [{"name": "b", "type": "bot", "count": 12, "reserve": 20, "place": {"rule": "uniform"}}],
  "models": [{"name": "rock", "type": "rock", "pose": {"x_m": 3, "y_m": 3}}],
  "at": [{"time_s": 2, "add": {"population": "b", "count": 2}}, {"time_s": 3, "disable": {"type": "bot", "share": 0.3}},
         {"time_s": 4, "enable": {"type": "bot"}}]})";

struct Switch {
  struct Command {
    bool on = false;
    TROUPE_FIELDS(on)
  };
};

Act random_act(Draw& draw) {
  Act act{.kind = static_cast<Kind>(draw.below(engine::k_acts.size()))};
  act.whom = act.kind == Kind::add   ? "b"
             : act.kind == Kind::set ? "bot"
             : draw.below(20) == 0   ? "rock"
                                     : fmt::format("b{}", draw.below(20));
  act.pose = {draw.real(-7, 7), draw.real(-7, 7), 0, draw.real(-4, 4)};
  act.speed = {draw.real(-1, 1), 0, draw.real(-2, 2)};
  if (act.kind == Kind::command) {
    act.device = "lamp";
    act.values = {{"shows", {static_cast<double>(draw.below(2))}}, {"red", {draw.real(0, 1)}}};
  }
  if (act.kind == Kind::set)
    act.setting = fmt::format(
        fmt::runtime(draw.below(2) == 0 ? R"({{"controller": {{"kind": "wander", "cruise_speed_mps": {}}}}})"
                     : draw.below(2) == 0
                         ? R"({{"drive": {{"velocity_max_x_mps": {}}}}})"
                         : R"({{"device": {{"name": "eye", "transducers": [{{"range_max_m": {}, )"
                           R"("samples": 9, "fov_deg": 180}}]}}}})"),
        draw.real(0.1, 2));
  return act;
}

class Sessions : public test::ScratchTest {
 protected:
  Simulation yard(unsigned threads, std::uint64_t seed = 5) const {
    return Simulation::from_text(k_yard, "yard.json", {.threads = threads, .seed = seed, .mortal = true});
  }

  /// The message of a session of these lines.
  std::string error(const std::string& text, std::uint64_t seed = 5) {
    const fs::path file = write("s.jsonl", text);
    try {
      Simulation simulation = yard(1, seed);
      SessionReplay replay(file, simulation);
      simulation.before_tick([&](Simulation& s) { replay.act(s); });
      for (int i = 0; i < 20; ++i) simulation.step();
    } catch (const InputError& error) {
      std::string message = error.what();
      while (message.find(folder_.string()) != message.npos)
        message.erase(message.find(folder_.string()), folder_.string().size() + 1);
      return message;
    }
    return {};
  }
  std::string header(std::uint64_t seed = 5) {
    const Simulation simulation = yard(1, seed);
    const SessionLog log(folder_, simulation);
    return content(log.file());
  }
};

TEST_F(Sessions, AreRepeatedToTheSameBitsOnAnyThreadsAndFromACheckpoint) {
  const int runs = test::k_slow_build ? 2 : 12;
  constexpr std::uint64_t k_ticks = 60;
  std::array<int, engine::k_acts.size()> done{};
  int refused = 0;
  for (int run = 0; run < runs; ++run) {
    Draw draw(static_cast<std::uint64_t>(run));
    std::vector<std::string> lines;
    fs::path file;
    const fs::path checkpoint = folder_ / fmt::format("{}.h5", run);
    const std::uint64_t saved = 1 + draw.below(k_ticks - 1);
    {
      Simulation simulation = yard(2);
      SessionLog log(folder_, simulation);
      file = log.file();
      simulation.before_tick([&](Simulation& s) {
        for (std::size_t i = draw.below(10); i > 0; --i) {
          const Act act = random_act(draw);
          try {
            s.act(act);
            log.add(s, act);
            ++done[static_cast<std::size_t>(act.kind)];
          } catch (const ActRefused&) {
            ++refused;
          }
        }
      });
      lines.push_back(simulation.hash_log_line());
      while (simulation.tick() < k_ticks) {
        simulation.step();
        lines.push_back(simulation.hash_log_line());
        if (simulation.tick() == saved && worldio::has_hdf5()) simulation.save(checkpoint);
      }
      log.end(simulation.tick());
    }
    const auto repeat = [&](Simulation simulation) {
      SessionReplay replay(file, simulation);
      EXPECT_EQ(replay.end_tick(), k_ticks);
      simulation.before_tick([&](Simulation& s) { replay.act(s); });
      while (simulation.tick() < k_ticks) {
        simulation.step();
        ASSERT_EQ(simulation.hash_log_line(), lines[simulation.tick()]) << "run " << run;
      }
      EXPECT_EQ(replay.left(), 0u);
    };
    for (const unsigned threads : {1u, 2u, 3u}) repeat(yard(threads));
    if (worldio::has_hdf5()) repeat(Simulation::resume(checkpoint, {.threads = 3}));
  }
  for (std::size_t kind = 0; kind < done.size(); ++kind) EXPECT_GT(done[kind], 0) << engine::k_acts[kind];
  EXPECT_GT(refused, 0);
}

TEST_F(Sessions, AWorldThatMayBeTouchedHasTheHashesOfOneThatMayNot) {
  Simulation touched = yard(1);
  Simulation plain = Simulation::from_text(k_yard, "yard.json", {.threads = 1});
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(touched.hash_log_line(), plain.hash_log_line());
    touched.step();
    plain.step();
  }
}

TEST_F(Sessions, ActsComeAfterWhatTheWorldAsksFor) {
  Simulation simulation = yard(1);
  std::size_t robots = 0;
  simulation.before_tick([&](Simulation& s) {
    if (s.tick() == 20) robots = s.robots();  // two were added at 2 s
  });
  for (int i = 0; i < 20; ++i) simulation.step();
  EXPECT_EQ(simulation.robots(), 12u);
  simulation.step();
  EXPECT_EQ(robots, 14u);
}

TEST_F(Sessions, AHoldEndsWithAReset) {
  for (const bool with_seed : {false, true}) {
    Simulation simulation = yard(1);
    simulation.act({.kind = Kind::hold, .whom = "b1", .speed = {0, 0, 0.5}});
    simulation.step();
    with_seed ? simulation.reset(simulation.seed()) : simulation.reset();
    Simulation fresh = yard(1);
    simulation.step();
    fresh.step();
    simulation.step();
    fresh.step();
    EXPECT_EQ(simulation.state_hash(), fresh.state_hash()) << with_seed;
  }
}

TEST_F(Sessions, AHoldBeatsTheControllerUntilItIsReleasedAndIsSaved) {
  Simulation simulation = yard(1);
  simulation.act({.kind = Kind::hold, .whom = "b1", .speed = {0, 0, 0.5}});
  const auto turn = [](Simulation& s) { return s.find("b1").speed().turn; };
  for (int i = 0; i < 5; ++i) {
    simulation.step();
    EXPECT_EQ(turn(simulation), 0.5);
    EXPECT_EQ(simulation.find("b1").speed().forward, 0);
  }
  if (worldio::has_hdf5()) {
    simulation.save(folder_ / "held.h5");
    Simulation resumed = Simulation::resume(folder_ / "held.h5");
    resumed.step();
    simulation.step();
    EXPECT_EQ(resumed.state_hash(), simulation.state_hash());
    resumed.step();
    EXPECT_EQ(turn(resumed), 0.5);
  }
  simulation.act({.kind = Kind::release, .whom = "b1"});
  simulation.step();
  simulation.step();
  EXPECT_NE(simulation.find("b1").speed().forward, 0) << "it wanders again";
}

constexpr const char* k_track = R"({"troupe": 1, "title": "track", "bounds_m": [[0, -2], [1000, 2]],
  "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff", "velocity_max_x_mps": 9},
    "sensors": [{"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2, "samples": 9, "fov_deg": 90}]}],
    "controller": {"kind": "wander", "cruise_speed_mps": 1}}},
  "models": [{"name": "b", "type": "bot", "pose": {"x_m": 1}}],
  "at": [{"time_s": 2, "set": {"type": "bot", "drive": {"velocity_max_x_mps": 4}}},
         {"time_s": 3, "set": {"type": "bot", "controller": {"kind": "wander", "cruise_speed_mps": 6}}}]})";

TEST_F(Sessions, AParameterThatIsSetHoldsWithThoseThatTheWorldSetsLater) {
  const auto track = [] { return Simulation::from_text(k_track, "track.json", {.threads = 1}); };
  const auto speed_at = [](Simulation& simulation, std::uint64_t tick) {
    while (simulation.tick() < tick) simulation.step();
    return simulation.find("b").speed().forward;
  };
  const auto set = [](Simulation& simulation, const char* setting) {
    simulation.act({.kind = Kind::set, .whom = "bot", .setting = setting});
  };
  Simulation simulation = track();
  EXPECT_EQ(speed_at(simulation, 5), 1);
  set(simulation, R"({"controller": {"kind": "wander", "cruise_speed_mps": 3}})");
  EXPECT_EQ(speed_at(simulation, 8), 3);
  set(simulation, R"({"drive": {"velocity_max_x_mps": 2}})");
  EXPECT_EQ(speed_at(simulation, 11), 2) << "both changes hold";
  EXPECT_THAT(simulation.parameters("bot"), HasSubstr("\"velocity_max_x_mps\": 2"));
  EXPECT_EQ(speed_at(simulation, 25), 3) << "at 2 s the world sets the limit to 4 m/s";
  if (worldio::has_hdf5()) {
    simulation.save(folder_ / "set.h5");
    Simulation resumed = Simulation::resume(folder_ / "set.h5", {.threads = 2});
    EXPECT_EQ(speed_at(resumed, 28), 3);
    EXPECT_EQ(speed_at(resumed, 35), 4) << "6 m/s are commanded, 4 m/s are the limit";
  }
  EXPECT_EQ(speed_at(simulation, 35), 4);
  for (const bool with_seed : {false, true}) {
    with_seed ? simulation.reset(simulation.seed()) : simulation.reset();
    Simulation fresh = track();
    for (int i = 0; i < 40; ++i) {
      simulation.step();
      fresh.step();
      ASSERT_EQ(simulation.state_hash(), fresh.state_hash()) << with_seed << " at tick " << i;
    }
    set(simulation, R"({"controller": {"kind": "wander", "cruise_speed_mps": 0.5}})");
  }
  Simulation other = simulation.another(simulation.seed(), 1);
  EXPECT_EQ(speed_at(other, 45), 4) << "what was set is not of another run";
}

TEST_F(Sessions, ACommandThatIsABoolTakesNoughtAndOne) {
  engine::Registry registry = make_registry();
  registry.devices.push_back(engine::make_device_kind<Switch>("switch", "is on or off"));
  Simulation simulation = Simulation::from_text(
      R"({"troupe": 1, "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "sensors": [{"name": "s", "kind": "switch"}]}},
          "models": [{"name": "a", "type": "bot"}]})",
      "switch.json", {.threads = 1}, std::move(registry));
  const auto command = [&](double on) {
    simulation.act({.kind = Kind::command, .whom = "a", .device = "s", .values = {{"on", {on}}}});
    return static_cast<int>(simulation.find("a").asked("s").bytes[0]);
  };
  EXPECT_EQ(command(1), 1);
  EXPECT_EQ(command(0), 0);
  EXPECT_THAT(test::message_of<ActRefused>([&] { command(2); }),
              HasSubstr("command \"on\" of device \"s\" has the type bool, which cannot represent 2"));
}

TEST_F(Sessions, AnActThatCannotBeDoneSaysWhyAndChangesNothing) {
  Simulation simulation = yard(1);
  simulation.step();
  const std::uint64_t hash = simulation.state_hash();
  const auto refusal = [&](const Act& act) -> std::string {
    try {
      simulation.act(act);
    } catch (const ActRefused& error) {
      EXPECT_EQ(simulation.state_hash(), hash) << error.what();
      return error.what();
    }
    return "done";
  };
  EXPECT_THAT(refusal({.kind = Kind::move, .whom = "b0", .pose = {3, 3, 0, 0}}),
              HasSubstr("\"b0\" cannot be placed at x 3 m, y 3 m: a wall or another body is there"));
  EXPECT_THAT(refusal({.kind = Kind::move, .whom = "b0", .pose = {30, 3, 0, 0}}),
              HasSubstr("outside the world's bounds"));
  EXPECT_THAT(refusal({.kind = Kind::move, .whom = "b0", .pose = {std::nan(""), 3, 0, 0}}),
              HasSubstr("finite"));
  EXPECT_THAT(refusal({.kind = Kind::move, .whom = "rock", .pose = {0, 0, 0, 0}}),
              HasSubstr("\"rock\" is static"));
  EXPECT_THAT(refusal({.kind = Kind::move, .whom = "b99", .pose = {0, 0, 0, 0}}),
              HasSubstr("no body \"b99\""));
  EXPECT_THAT(refusal({.kind = Kind::move, .whom = "b15", .pose = {0, 0, 0, 0}}),
              HasSubstr("\"b15\" is not in the world"));
  EXPECT_THAT(refusal({.kind = Kind::hold, .whom = "rock", .speed = {1, 0, 0}}), HasSubstr("has no drive"));
  EXPECT_THAT(
      refusal({.kind = Kind::speed, .whom = "b0", .speed = {std::numeric_limits<double>::infinity(), 0, 0}}),
      HasSubstr("a speed is inf"));
  EXPECT_THAT(refusal({.kind = Kind::release, .whom = "b0"}),
              HasSubstr("no act \"hold\" of this robot is in effect"));
  EXPECT_THAT(refusal({.kind = Kind::enable, .whom = "b0"}), HasSubstr("not disabled"));
  EXPECT_THAT(refusal({.kind = Kind::add, .whom = "x"}), HasSubstr("no population \"x\" with a reserve"));
  EXPECT_THAT(refusal({.kind = Kind::add, .whom = "b", .pose = {3, 3, 0, 0}}), HasSubstr("can be added at"));
  EXPECT_THAT(refusal({.kind = Kind::command, .whom = "b0", .device = "gun"}), HasSubstr("gun"));
  EXPECT_THAT(refusal({.kind = Kind::command, .whom = "b0", .device = "lamp", .values = {{"shows", {300}}}}),
              HasSubstr("cannot represent 300"));
  EXPECT_THAT(refusal({.kind = Kind::command, .whom = "b0", .device = "lamp", .values = {{"off", {1}}}}),
              HasSubstr("takes no command \"off\"; known: "));
  const auto setting = [&](const std::string& type, const std::string& text) {
    return refusal({.kind = Kind::set, .whom = type, .setting = text});
  };
  EXPECT_THAT(setting("bat", R"({"drive": {"velocity_max_x_mps": 1}})"), HasSubstr("unknown type \"bat\""));
  EXPECT_THAT(setting("bot", R"({"drive": {"velocity_max_x_mps": -5}})"),
              HasSubstr("velocity_min_x, velocity_max_x: lower bound"));
  EXPECT_THAT(setting("bot", R"({"drive": {}})"), HasSubstr("expected at least one parameter"));
  EXPECT_THAT(setting("bot", R"({"controller": {"kind": "wander", "speed_mps": 1}})"),
              HasSubstr("speed_mps"));
  EXPECT_THAT(setting("bot", R"({"controller": {"kind": "script"}})"),
              HasSubstr("unknown controller of this type \"script\""));
  EXPECT_THAT(
      setting("bot", R"({"device": {"name": "eye", "transducers": [{"samples": 8}]}})"),
      HasSubstr("cannot change a parameter that determines how many values a device reads or stores"));
  EXPECT_THAT(setting("bot", R"({"type": "bot", "drive": {"velocity_max_x_mps": 1}})"),
              HasSubstr("unknown key \"type\""));
  EXPECT_THAT(setting("bot", "{}"),
              HasSubstr("give exactly one of \"drive\", \"device\" and \"controller\""));
  EXPECT_THAT(setting("bot", "{"), HasSubstr("error"));
  EXPECT_THAT(setting("rock", R"({"drive": {"velocity_max_x_mps": 1}})"), HasSubstr("has no drive"));
  simulation.act({.kind = Kind::disable, .whom = "b0"});
  EXPECT_THAT([&] { simulation.act({.kind = Kind::disable, .whom = "b0"}); },
              ::testing::ThrowsMessage<ActRefused>(HasSubstr("\"b0\" is already disabled")));
}

TEST_F(Sessions, ThatDoNotFitAreRefusedWithFileAndLine) {
  const std::string good = header();
  EXPECT_EQ(error(good), "");
  const std::string move = R"({"tick":3,"n":1,"do":"remove","robot":"b0"})"
                           "\n";
  EXPECT_EQ(error(good + move), "");
  EXPECT_THAT(error(good, 6), HasSubstr("s.jsonl:1: error: this run has other options than the run of the "
                                        "session: seed is 5 in the session, but 6 in this run"));
  std::string other = good;
  other.replace(other.find("\"hash\":\"") + 8, 4, "0000");
  EXPECT_THAT(error(other), HasSubstr("s.jsonl:1: error: the session began at tick 0 with state hash 0000"));
  other = good;
  other.replace(other.find("troupe 0."), 9, "troupe 9.");
  EXPECT_THAT(error(other), HasSubstr("s.jsonl:1: error: troupe 9."));
  EXPECT_THAT(error(good + move +
                    R"({"tick":4,"n":2,"do":"remove","robot":"b0"})"
                    "\n"),
              HasSubstr("s.jsonl:3: error: at tick 4: \"b0\" is not in the world"));
  for (const auto& [line, message] : std::vector<std::pair<std::string, std::string>>{
           {R"({"tick":3,"n":2,"do":"remove","robot":"b0"})", "\"n\" must be 1, found 2"},
           {R"({"tick":3,"n":1,"do":"fly","robot":"b0"})", "unknown action \"fly\""},
           {R"({"tick":3,"n":1,"do":"remove","robot":"b0","x":1})", "x"},
           {R"({"tick":3,"n":1,"do":"move","robot":"b0","pose":[1,2]})",
            "expected [x, y, z, heading] in m and rad"},
           {R"({"tick":-3,"n":1,"do":"remove","robot":"b0"})", "expected a whole number"},
           {R"({"tick":3,"n":1,"do":"move","robot":"b0","pose":[1e999,2,0,0]})", ""},
           {R"([1])", ""},
           {R"({"tick")", ""}}) {
    EXPECT_THAT(error(good + line + "\n"), HasSubstr("s.jsonl:2: error: ")) << line;
    EXPECT_THAT(error(good + line + "\n"), HasSubstr(message)) << line;
  }
  const std::string wrong = R"({"tick":3,"n":1,"do":"mvoe","robot":"b0","pose":[1,2,0,0]})"
                            "\n";
  const std::string next = R"({"tick":4,"n":2,"do":"remove","robot":"b0"})"
                           "\n";
  EXPECT_THAT(error(good + wrong + next),
              AllOf(StartsWith("s.jsonl:2: error: unknown action \"mvoe\""), Not(HasSubstr("\n"))))
      << "neither its keys nor the number of the next line is a second error";
  EXPECT_THAT(error(""), HasSubstr("s.jsonl: error: the file is empty"));
  EXPECT_THAT(error("{}\n"), HasSubstr("s.jsonl:1: error: "));
  EXPECT_EQ(error(good + move + R"({"tick":4,"n":2,"do":"rem)"), "") << "what a kill cut off is left out";
}

TEST_F(Sessions, SpareBodiesComeBehindAllOthersAndAreAdded) {
  const std::string text =
      R"({"troupe": 1, "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"}}},
    "populations": [{"name": "b", "type": "bot", "count": 3, "place": {"rule": "grid", "pitch_m": 1, "region_m": [[-3, -3], [3, 3]]}}],
    "models": [{"name": "scout", "type": "bot", "pose": {"x_m": 5}}]})";
  const auto world = [&](std::uint32_t spare) {
    return Simulation::from_text(text, "spare.json", {.threads = 1, .spare = spare});
  };
  Simulation plain = world(0);
  EXPECT_THROW(plain.act({.kind = Kind::add, .whom = "b"}), ActRefused);
  Simulation simulation = world(2);
  EXPECT_EQ(simulation.robots(), 4u);
  EXPECT_EQ(simulation.find("scout").id(), plain.find("scout").id());
  for (const double x : {7.0, 8.0}) simulation.act({.kind = Kind::add, .whom = "b", .pose = {x, 0, 0, 0}});
  EXPECT_EQ(simulation.robots(), 6u);
  EXPECT_EQ(simulation.find("b4").pose().x, 8);
  EXPECT_GT(simulation.find("b3").id().value, simulation.find("scout").id().value);
  EXPECT_THAT(
      [&] {
        simulation.act({.kind = Kind::add, .whom = "b", .pose = {9, 0, 0, 0}});
      },
      ::testing::ThrowsMessage<ActRefused>(
          HasSubstr("the reserve of population \"b\" is used up: all its bodies have been born")));
  const fs::path session = SessionLog(folder_, simulation).file();
  Simulation other = world(1);
  EXPECT_THAT([&] { const SessionReplay replay(session, other); },
              ::testing::ThrowsMessage<InputError>(
                  HasSubstr(":1: error: this run has other options than the run of the session: spare is 2 "
                            "in the session, but 1 in this run")));
}

TEST_F(Sessions, PopulationsWhoseNamesEndInDigitsGetSpareBodiesOfTheirOwn) {
  std::string text =
      R"({"troupe": 1, "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"}}},
    "populations": [)";
  for (const std::string name : {"team1", "team2"})
    text +=
        R"({"name": ")" + name +
        R"(", "type": "bot", "count": 9, "place": {"rule": "grid", "pitch_m": 1, "region_m": [[-9, -9], [9, 9]]}},)";
  text.back() = ']';
  Simulation simulation = Simulation::from_text(text + "}", "teams.json", {.threads = 1, .spare = 2});
  const auto add = [&](const std::string& whom, double x) {
    simulation.act({.kind = Kind::add, .whom = whom, .pose = {x, 0, 0, 0}});
  };
  for (const double x : {20.0, 21.0}) add("team1", x);
  add("team2", 22);
  EXPECT_EQ(simulation.find("team19").pose().x, 20);
  EXPECT_EQ(simulation.find("team110").pose().x, 21);
  EXPECT_EQ(simulation.find("team29").pose().x, 22);
  EXPECT_THROW(add("team", 24), ActRefused);
}

TEST_F(Sessions, AreNeverReplaced) {
  const Simulation simulation = yard(1);
  const SessionLog first(folder_, simulation);
  fs::create_symlink(folder_ / "none", folder_ / "yard.session-2.jsonl");
  const SessionLog second(folder_, simulation);
  EXPECT_EQ(first.file().filename(), "yard.session.jsonl");
  EXPECT_EQ(second.file().filename(), "yard.session-3.jsonl") << "a link without a target exists";
  fs::path third;
  {
    const auto log = SessionLog::create(folder_, simulation);
    third = log->file();
    EXPECT_EQ(third.filename(), "yard.session-4.jsonl");
    EXPECT_EQ(content(third), "");
  }
  EXPECT_FALSE(fs::exists(third)) << "it has not begun";
}

TEST_F(Sessions, OfAnotherWorldAreRefused) {
  const std::string text = k_yard;
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    return Simulation::from_text(other, "other.json", {.threads = 2, .seed = 5});
  };
  const Simulation simulation = yard(1);
  const fs::path file = SessionLog(folder_, simulation).file();
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"\"x_m\": 3", "\"x_m\": 4"},                                // a static body
           {"\"velocity_max_x_mps\": 1", "\"velocity_max_x_mps\": 2"},  // a parameter
           {"\"time_s\": 3", "\"time_s\": 3.5"}}) {                     // an intervention
    const Simulation other = changed(from, to);
    EXPECT_THAT([&] { const SessionReplay replay(file, other); },
                ::testing::ThrowsMessage<InputError>(HasSubstr(":1: error: the session is of another world")))
        << to;
  }
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"\"title\": \"yard\"", "\"title\": \"other\""}, {"\"seed\": 5,", "\"seed\": 5, \n\n"}}) {
    const Simulation same = changed(from, to);
    EXPECT_NO_THROW(SessionReplay(file, same)) << to;
  }
  std::string older = content(file);
  const std::size_t begin = older.find("\"world_hash\"");
  ASSERT_NE(begin, older.npos);
  older.erase(begin, older.find("\"options\"") - begin);
  const Simulation other = changed("\"velocity_max_x_mps\": 1", "\"velocity_max_x_mps\": 2");
  EXPECT_NO_THROW(SessionReplay(write("older.jsonl", older), other)) << "it cannot tell";
}

TEST_F(Sessions, OfAWorldWhosePathIsNotUtf8CreateNoFile) {
  const Simulation simulation = Simulation::from_text(k_yard, "\xff.json", {.threads = 1});
  EXPECT_THAT([&] { const SessionLog log(folder_, simulation); },
              ::testing::ThrowsMessage<std::runtime_error>(
                  AllOf(StartsWith("\xff.json: error: the path of the world is not UTF-8"))));
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Sessions, AnActOfNoKindIsRefused) {
  Simulation simulation = yard(1);
  try {
    simulation.act({.kind = static_cast<Kind>(99), .whom = "b0"});
    ADD_FAILURE();
  } catch (const ActRefused& error) {
    EXPECT_STREQ(error.what(), "the kind of the act, 99, is no value of Act::Kind");
  }
}

TEST_F(Sessions, HaveOneFirstLineBeforeTheirActs) {
  const Simulation simulation = yard(1);
  const std::unique_ptr<SessionLog> log = SessionLog::create(folder_, simulation);
  EXPECT_THROW(log->add(simulation, {.whom = "b0"}), std::logic_error);
  EXPECT_THROW(log->end(0), std::logic_error);
  EXPECT_EQ(content(log->file()), "");
  log->begin(simulation);
  const std::string first = content(log->file());
  EXPECT_THROW(log->begin(simulation), std::logic_error);
  EXPECT_EQ(content(log->file()), first);
  EXPECT_NO_THROW(log->end(0));
}

TEST_F(Sessions, NothingIsWrittenAfterAnError) {
  const Simulation simulation = yard(1);
  SessionLog log(folder_, simulation);
  const std::string begun = content(log.file());
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit less{begun.size() + 10, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &less);
  const Act act{.kind = Kind::remove, .whom = "b0"};
  EXPECT_THROW(log.add(simulation, act), std::runtime_error);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  const std::string torn = content(log.file());
  EXPECT_EQ(torn.size(), begun.size() + 10);
  EXPECT_THROW(log.end(3), std::runtime_error);
  EXPECT_EQ(content(log.file()), torn) << "the incomplete line is the last one";
  EXPECT_EQ(error(torn), "");
}

TEST_F(Sessions, LinesSurviveARoundTrip) {
  Draw draw(9);
  for (int i = 0; i < 300; ++i) {
    Act act = random_act(draw);
    if (act.kind != Kind::move && act.kind != Kind::add) act.pose = {};
    if (act.kind != Kind::speed && act.kind != Kind::hold) act.speed = {};
    Diagnostics diagnostics;
    const auto read = worldio::read_act(worldio::act_line(7, 8, act), {"tick", "n"}, {}, diagnostics);
    diagnostics.throw_if_errors();
    ASSERT_TRUE(read);
    EXPECT_TRUE(*read == act) << worldio::act_line(7, 8, act);
  }
}

}  // namespace
}  // namespace troupe::session_test
