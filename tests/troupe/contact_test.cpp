// Who blocked whom: in the state, in events, for programs and controllers; and bumpers that feel crashes.

#include "engine/observing/events.hpp"
#include "engine/world/world.hpp"
#include "models/devices/actuator.hpp"
#include "troupe/acts.hpp"
#include "troupe/troupe.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace troupe::contact_test {
namespace {

using engine::Contact;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* k_types = R"(
  "bot": {"disc": {"radius_m": 0.17, "height_m": 0.1}, "drive": {"kind": "omni", "pushes": 1}, "sensors": [
    {"name": "skin", "kind": "bumper", "active": true PERIOD, "bumpers": [
      {"pose": {"x_m": 0.17, "z_m": 0.05}, "length_m": 0.2},
      {"pose": {"x_m": -0.17, "z_m": 0.05, "heading_deg": 180}, "length_m": 0.2}]}]},
  "crate": {"size_m": [0.2, 0.2, 0.2], "pushable": true},
  "wall": {"size_m": [0.2, 2, 0.5]})";

/// A world of bots, crates and walls. models: the list of models, as JSON
Simulation world(double tick_s, const std::string& models, const std::string& period = "",
                 const std::string& more = R"("contacts": true)",
                 SimulationOptions options = {.threads = 2}) {
  std::string types = k_types;
  types.replace(types.find("PERIOD"), 6, period);
  return Simulation::from_text(
      fmt::format(R"({{"troupe": 1, "tick_s": {}, {}, "types": {{{}}}, "models": [{}]}})", tick_s, more,
                  types, models),
      "world.json", options);
}
std::string model(const std::string& name, const std::string& type, double x, double y = 0) {
  return fmt::format(R"({{"name": "{}", "type": "{}", "pose": {{"x_m": {}, "y_m": {}}}}})", name, type, x, y);
}
void run(Simulation& simulation, int ticks) {
  for (int tick = 0; tick < ticks; ++tick) simulation.step();
}
/// Which strips of a bumper are hit.
std::vector<int> hits(Simulation& simulation, const std::string& name) {
  const auto hit = simulation.find(name).readings<std::uint8_t>("hit", "skin");
  return {hit.begin(), hit.end()};
}
std::string name_of(const Simulation& simulation, BodyId body) {
  return body.valid() ? simulation.world().spec().name(body) : "";
}

// A blocked robot stops up to the way of a tick short of what it hits, and a strip is 2 cm thick.
TEST(Crash, IsFeltAtAnySpeedAndTickByBothSides) {
  struct Case {
    double speed, tick_s;
    const char* period;
  };
  for (const auto& [speed, tick_s, period] :
       std::initializer_list<Case>{{0.5, 0.1, ""},
                                   {0.3, 0.1, ""},
                                   {0.2, 0.1, ""},
                                   {0.5, 0.02, ""},
                                   {5, 0.1, ""},
                                   {0.5, 0.1, R"(, "period_s": 0.5)"}}) {
    int walls = 0;
    int bots = 0;
    int struck = 0;
    constexpr int k_runs = 20;
    for (int run = 0; run < k_runs; ++run) {
      const double start = -0.0073 * run;
      Simulation simulation =
          world(tick_s,
                model("wall", "wall", 1) + ", " + model("to_wall", "bot", start) + ", " +
                    model("to_bot", "bot", start, 3) + ", " + model("stands", "bot", 1, 3),
                period);
      for (const char* name : {"to_wall", "to_bot"}) simulation.find(name).set_speed(speed, 0, 0);
      std::vector<std::vector<int>> felt(3, {0, 0});
      for (int tick = 0; tick < std::max(3 / speed, 1.2) / tick_s; ++tick) {
        simulation.step();
        for (std::size_t i = 0; i < 3; ++i) {
          const std::vector<int> now = hits(simulation, std::vector{"to_wall", "to_bot", "stands"}[i]);
          for (std::size_t k = 0; k < 2; ++k) felt[i][k] |= now[k];
        }
      }
      walls += felt[0] == std::vector{1, 0};
      bots += felt[1] == std::vector{1, 0};
      struck += felt[2] == std::vector{0, 1};
    }
    EXPECT_EQ(walls, k_runs) << speed << " m/s, ticks of " << tick_s << " s" << period;
    EXPECT_EQ(bots, k_runs) << speed << " m/s, ticks of " << tick_s << " s" << period;
    EXPECT_EQ(struck, k_runs) << speed << " m/s, ticks of " << tick_s << " s" << period;
  }
}

TEST(Crash, IsFeltOnlyWithCrashesAndOnlyWhileItLasts) {
  const std::string models = model("wall", "wall", 1) + ", " + model("bot", "bot", 0.65);
  const auto felt = [&](const std::string& crashes) {
    Simulation simulation = world(0.1, models, crashes);
    Model bot = simulation.find("bot");
    bot.set_speed(1, 0, 0);
    run(simulation, 3);  // blocked in each of these ticks, at a distance of 8 cm
    const std::vector<int> driving = hits(simulation, "bot");
    bot.set_speed(0, 0, 0);
    run(simulation, 3);
    return std::pair(driving, hits(simulation, "bot"));
  };
  EXPECT_EQ(felt(""), std::pair(std::vector({1, 0}), std::vector({0, 0})));
  EXPECT_EQ(felt(R"(, "crashes": false)"), std::pair(std::vector({0, 0}), std::vector({0, 0})));
}

TEST(Blocker, IsAStaticBodyBeforeTheLowestId) {
  // Both are met at the same sample: the robot on the left side, the wall, which has the higher id, on the
  // right.
  const std::string robots = model("left", "bot", 0.51, 0.2) + ", " + model("bot", "bot", 0);
  const auto blocker = [](Simulation simulation) {
    simulation.find("bot").set_speed(1, 0, 0);
    run(simulation, 3);
    return name_of(simulation, simulation.find("bot").blocked_by().blocker());
  };
  EXPECT_EQ(blocker(world(0.1, robots)), "left");
  EXPECT_EQ(blocker(world(0.1, robots + ", " + model("right", "bot", 0.51, -0.2))), "left");
  EXPECT_EQ(blocker(world(0.1, robots + ", " + model("right", "wall", 0.43, -1.1))), "right");
}

TEST(Blocker, IsNamedForPushersAndBounds) {
  Simulation simulation = world(0.1,
                                model("wall", "wall", 1) + ", " + model("crate", "crate", 0.7) + ", " +
                                    model("pusher", "bot", 0.3) + ", " + model("runner", "bot", -1.5),
                                "", R"("contacts": true, "bounds_m": [[-2, -2], [2, 2]])");
  simulation.find("pusher").set_speed(0.5, 0, 0);
  simulation.find("runner").set_speed(-0.5, 0, 0);
  run(simulation, 20);
  const Contact pusher = simulation.find("pusher").blocked_by();
  EXPECT_EQ(pusher.cause, Contact::k_pushed);
  EXPECT_EQ(name_of(simulation, pusher.blocker()), "crate");
  EXPECT_EQ(name_of(simulation, pusher.stopper()), "wall");
  EXPECT_EQ(simulation.find("runner").blocked_by(), (Contact{Contact::k_bounds, 0, 0}));
  EXPECT_EQ(simulation.find("crate").blocked_by(), Contact());
}

TEST(Blocker, IsNamedForAJoint) {
  Simulation simulation = Simulation::from_text(R"({"troupe": 1, "contacts": true, "types": {
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
            "devices": [{"name": "arm", "kind": "actuator", "max_speed": 1}],
            "parts": [{"name": "fist", "joint": "arm", "size_m": [0.1, 0.1, 0.1], "pose": {"x_m": 0.2}}]},
    "wall": {"size_m": [0.2, 2, 0.5]}},
    "models": [{"name": "wall", "type": "wall", "pose": {"x_m": 0.75}}, {"name": "bot", "type": "bot"}]})",
                                                "arm.json", {.threads = 1});
  Model bot = simulation.find("bot");
  bot.command<models::ActuatorCommand>("arm") = {models::ActuatorCommand::velocity, 1};
  run(simulation, 10);
  EXPECT_FALSE(bot.stalled());
  EXPECT_EQ(bot.blocked_by().cause, Contact::k_joint);
  EXPECT_EQ(name_of(simulation, bot.blocked_by().blocker()), "wall");
}

TEST(Blocker, IsTheOtherBodyOfAnEventWithoutAChangeOfTheHash) {
  const std::string models = model("wall", "wall", 1) + ", " + model("a", "bot", 0);
  Simulation watched = world(0.1, models, "", R"("title": "w")");
  Simulation plain = world(0.1, models, "", R"("title": "w")");
  Simulation noting = world(0.1, models);
  engine::EventWatch watch(watched.world());
  std::vector<std::string> events;
  for (Simulation* each : {&watched, &plain, &noting}) each->find("a").set_speed(0.5, 0, 0);
  for (int tick = 0; tick < 40; ++tick) {
    for (Simulation* each : {&watched, &plain, &noting}) each->step();
    for (const engine::Event& event : watch.see(watched.world()))
      events.push_back(fmt::format("{} {}", event_name(event.type), name_of(watched, event.other)));
  }
  EXPECT_THAT(events, ElementsAre("stall_begins wall"));
  EXPECT_EQ(watched.hash_log_line(), plain.hash_log_line());
  EXPECT_NE(noting.hash_log_line(), plain.hash_log_line()) << "contacts are state, if they are asked for";
  EXPECT_THROW(
      {
        try {
          plain.find("a").blocked_by();
        } catch (const std::logic_error& error) {
          EXPECT_THAT(error.what(), HasSubstr("add \"contacts\": true to the world file"));
          throw;
        }
      },
      std::logic_error);
}

TEST(Blocker, IsForgottenWhenTheBodyIsPlaced) {
  Simulation simulation = world(0.1, model("wall", "wall", 0.4) + ", " + model("a", "bot", 0));
  simulation.find("a").set_speed(1, 0, 0);
  run(simulation, 3);
  EXPECT_EQ(simulation.find("a").blocked_by().cause, Contact::k_body);
  simulation.find("a").set_pose({-3, 0, 0, 0});
  EXPECT_EQ(simulation.find("a").blocked_by(), Contact());
}

// The intervention `move` places a body where another one is; acts of a session and births need a free place.
TEST(Blocker, HoldsABodyThatWasMovedIntoIt) {
  const auto end = [](double forward) {
    Simulation simulation = world(
        0.1, model("wall", "wall", 1) + ", " + model("a", "bot", -2), "",
        R"("contacts": true, "at": [{"time_s": 0.2, "move": {"model": "a", "pose": {"x_m": 0.75, "y_m": 0}}}])");
    run(simulation, 3);
    simulation.find("a").set_speed(forward, 0, 0);
    run(simulation, 5);
    const Model a = simulation.find("a");
    return std::pair(a.pose().x, name_of(simulation, a.blocked_by().blocker()));
  };
  EXPECT_EQ(end(0.3), std::pair(0.75, std::string("wall")));
  EXPECT_NEAR(end(-0.3).first, 0.63, 0.031);
  EXPECT_EQ(end(-0.3).second, "");

  Simulation simulation = world(0.1, model("wall", "wall", 1) + ", " + model("a", "bot", 0));
  Holds holds;
  EXPECT_THROW(carry_out(simulation, {.kind = Act::Kind::move, .whom = "a", .pose = {0.75, 0, 0, 0}}, holds),
               ActRefused);
}

TEST(Blocker, IsTheSameOnRanks) {
  const std::string text =
      R"({"troupe": 1, CONTACTS"overlaps": "warn", "bounds_m": [[-3, -2.5], [3, 2.5]], "types": {
    "bot": {"disc": {"radius_m": 0.1, "height_m": 0.2}, "drive": {"kind": "diff", "pushes": 2},
            "sensors": [{"name": "skin", "kind": "bumper", "active": true,
                         "bumpers": [{"pose": {"x_m": 0.1}, "length_m": 0.2}]}],
            "controller": {"kind": "script", "legs": [{"until_s": 2, "forward_mps": 0.9}, {"until_s": 99,
                           "forward_mps": 0.7, "turn_radps": 0.6}]}},
    "crate": {"size_m": [0.15, 0.15, 0.2], "pushable": true}, "wall": {"size_m": [4, 0.1, 0.5]}},
    "models": [{"name": "n", "type": "wall", "pose": {"y_m": 2}}, {"name": "s", "type": "wall", "pose": {"y_m": -2}}],
    "populations": [{"name": "b", "type": "bot", "count": 60, "place": {"rule": "uniform", "region_m": [[-2, -1.8], [2, 1.8]]}},
                    {"name": "c", "type": "crate", "count": 20, "place": {"rule": "uniform", "region_m": [[-2, -1.8], [2, 1.8]]}}]})";
  const auto run = [&](bool contacts, const SimulationOptions& options) {
    std::string own = text;
    own.replace(own.find("CONTACTS"), 8, contacts ? R"("contacts": true, )" : "");
    Simulation simulation = Simulation::from_text(own, "ranks.json", options);
    engine::EventWatch watch(simulation.world());
    std::vector<std::string> lines;
    for (int tick = 0; tick < 60; ++tick) {
      simulation.step();
      simulation.world().gather();
      for (const engine::Event& event : watch.see(simulation.world()))
        lines.push_back(fmt::format("{} {} {} {}", tick, event_name(event.type), event.body.value,
                                    name_of(simulation, event.other)));
      lines.push_back(simulation.hash_log_line());
    }
    return lines;
  };
  for (const bool contacts : {false, true}) {
    const std::vector<std::string> alone = run(contacts, {.threads = 1});
    const auto named = [](const std::string& line) {
      return line.find("stall_begins") != std::string::npos && line.back() != ' ';
    };
    EXPECT_GT(std::ranges::count_if(alone, named), 50);
    for (const bool distribute : {false, true}) {
      SimulationOptions options{.threads = 1};
      options.ranks = 3;
      options.rank_seed = 4;  // rows change their ranks every few ticks
      options.distribute = distribute;
      EXPECT_EQ(run(contacts, options), alone) << contacts << ", distributed " << distribute;
    }
  }
}

}  // namespace
}  // namespace troupe::contact_test
