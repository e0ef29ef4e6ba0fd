#include "troupe/swarm.hpp"

#include "base/diagnostics.hpp"
#include "base/math.hpp"
#include "engine/kinds/make_device_kind.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "troupe/world_builder.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace troupe::swarm_test {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

const std::filesystem::path k_worlds = test::source_dir() / "worlds";

/// Bots and trucks that stand in anything but the order of their ids, one bot that is yet to be born, and a
/// wall.
constexpr std::string_view k_yard = R"({
  "troupe": 1, "mortal": true, "types": {
    "wall": {"size_m": [0.2, 30, 1]},
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "omni"}, "sensors": [
      {"name": "lamp", "kind": "fiducial"},
      {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 3, "fov_deg": 90, "samples": 3}]},
      {"name": "nape", "kind": "ranger", "active": false, "transducers": [{"pose": {"heading_deg": 180}, "range_max_m": 2}]}]},
    "truck": {"size_m": [1, 0.5, 0.5], "drive": {"kind": "omni"}, "sensors": [
      {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 4, "fov_deg": 90, "samples": 5}]}]}
  },
  "models": [
    {"name": "east", "type": "wall", "pose": {"x_m": 5}},
    {"name": "b0", "type": "bot", "pose": {"x_m": 3, "y_m": 9, "heading_deg": 10}},
    {"name": "t0", "type": "truck", "pose": {"x_m": -9, "y_m": -9}},
    {"name": "b1", "type": "bot", "pose": {"x_m": -3, "y_m": -9, "heading_deg": 20}},
    {"name": "t1", "type": "truck", "pose": {"x_m": 2, "y_m": 4}},
    {"name": "b2", "type": "bot", "pose": {"x_m": 4, "heading_deg": 30}}
  ],
  "populations": [{"name": "c", "type": "bot", "count": 1, "reserve": 1, "place": {"rule": "uniform", "region_m": [[-5, 5], [-4, 6]]}}]
})";

Simulation yard(std::string_view text = k_yard) {
  return Simulation::from_text(std::string(text), "yard.json");
}

TEST(WorldsFromText, AreThoseOfTheirFiles) {
  const std::filesystem::path file = k_worlds / "noise.world";  // includes nothing, but is of Stage's syntax
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  Simulation loaded(file);
  Simulation read = Simulation::from_text(text, file);
  loaded.step();
  read.step();
  EXPECT_EQ(read.state_hash(), loaded.state_hash());
}

TEST(WorldsFromText, NameWhatIsWrongByTheirNames) {
  EXPECT_EQ(message_of<InputError>([] { Simulation::from_text("{\n\"troupe\": 2}", "made/here.json"); }),
            "made/here.json:2: error: /troupe: unknown format version 2: this program reads version 1");
  EXPECT_THAT(
      message_of<InputError>([] { Simulation::from_text("", "here.yaml"); }),
      HasSubstr("here.yaml: error: the name of a world file must end in .world (Stage's syntax) or .json"));
}

TEST(Swarms, AreOrderedByIdAndSayWhatModelsSay) {
  Simulation simulation = yard();
  const Swarm all = simulation.swarm();
  EXPECT_THAT(all.names(), ElementsAre("b0", "t0", "b1", "t1", "b2", "c0", "c1"));
  EXPECT_THAT(all.types(), ElementsAre("bot", "truck"));
  EXPECT_TRUE(std::ranges::is_sorted(all.ids()));
  EXPECT_THAT(simulation.swarm("truck").names(), ElementsAre("t0", "t1"));
  EXPECT_THAT(simulation.swarm("b").names(), ElementsAre("b0", "b1", "b2"));
  EXPECT_THAT(simulation.swarm("t1").names(), ElementsAre("t1"));

  Swarm bots = simulation.swarm("bot");
  std::vector<Model::Speed> speeds(bots.size());
  for (std::size_t i = 0; i < bots.size(); ++i)
    speeds[i] = {0.1 * static_cast<double>(i), -0.2, 0.3 * static_cast<double>(i)};
  bots.set_speeds(speeds);
  simulation.run_for(2);

  std::vector<Pose> poses(bots.size());
  std::vector<Pose> estimates(bots.size());
  std::vector<std::uint8_t> stalled(bots.size());
  std::vector<std::uint8_t> alive(bots.size());
  std::vector<float> ranges(bots.size() * bots.beams());
  bots.poses(poses);
  bots.estimates(estimates);
  bots.speeds(speeds);
  bots.stalled(stalled);
  bots.alive(alive);
  bots.ranges(ranges);
  const std::vector<std::string> names = bots.names();
  ASSERT_THAT(names, ElementsAre("b0", "b1", "b2", "c0", "c1"));
  EXPECT_THAT(alive, ElementsAre(1, 1, 1, 1, 0));
  EXPECT_TRUE(std::isnan(poses[4].x));
  for (std::size_t i = 0; i < 4; ++i) {
    const Model model = simulation.find(names[i]);
    EXPECT_EQ(poses[i], model.pose());
    EXPECT_EQ(estimates[i], model.estimate());
    EXPECT_EQ(speeds[i].forward, 0.1 * static_cast<double>(i));
    EXPECT_EQ(speeds[i].left, -0.2);
    EXPECT_EQ(speeds[i].turn, 0.3 * static_cast<double>(i));
    EXPECT_EQ(stalled[i] != 0, model.stalled());
    EXPECT_THAT(std::span(ranges).subspan(3 * i, 3), ElementsAreArray(model.ranges("eye")));
  }
  EXPECT_THAT(bots.bearings("eye"),
              ElementsAre(testing::DoubleEq(-k_pi / 4), 0, testing::DoubleEq(k_pi / 4)));
  EXPECT_GE(bots.range_bound(), 3);
}

TEST(Swarms, CommandWhomTheyAreToldTo) {
  Simulation simulation = yard();
  Swarm bots = simulation.swarm("b");
  const std::vector<Model::Speed> fast(3, {1, 0, 0});
  const std::vector<std::uint8_t> last{0, 0, 1};
  bots.accelerate(fast, last);
  simulation.run_for(0.3);
  EXPECT_EQ(simulation.find("b0").speed().forward, 0);
  EXPECT_GT(simulation.find("b2").speed().forward, 0.1);

  std::vector<Pose> poses(3);
  bots.poses(poses);
  poses[0] = {-2, 1, 0, 0};
  bots.set_poses(poses, std::vector<std::uint8_t>{1, 0, 0});
  EXPECT_EQ(simulation.find("b0").pose(), poses[0]);
  bots.go_to(std::vector<Pose>(3, {-1, 1, 0, 0}), std::vector<std::uint8_t>{1, 0, 0});
  simulation.run_for(20);
  EXPECT_NEAR(simulation.find("b0").pose().x, -1, 0.05);

  // Robots that are not there are left out; no other rows are touched.
  simulation.remove(simulation.find("b1"));
  const std::uint64_t dead = simulation.state_hash();
  bots.set_speeds(fast, std::vector<std::uint8_t>{0, 1, 0});
  EXPECT_EQ(simulation.state_hash(), dead);
}

TEST(Swarms, GiveReadingsOfSensorsThatRun) {
  Simulation simulation = yard();
  Swarm bots = simulation.swarm("bot");
  std::vector<float> nape(bots.size());
  EXPECT_THAT(message_of<std::logic_error>([&] { bots.ranges(nape, "nape"); }),
              HasSubstr("sensor \"nape\" of \"b0\" does not run: call subscribe() before the first step"));
  bots.subscribe();
  simulation.step();
  bots.ranges(nape, "nape");
  nape.pop_back();  // the reading of an unborn robot, 0
  EXPECT_THAT(nape, Each(testing::Gt(0)));
  EXPECT_THAT(message_of<std::logic_error>([&] { bots.subscribe(); }), HasSubstr("before the first step"));
}

TEST(Swarms, OfAPopulationOrATypeWithoutRobotsAreEmpty) {
  std::string text(k_yard);
  text.replace(text.find(R"("count": 1, "reserve": 1)"), 24, R"("count": 0)");
  text.insert(text.find(R"("truck": {)"), R"("cart": {"size_m": [1, 1, 1], "drive": {"kind": "omni"}}, )");
  Simulation simulation = yard(text);
  for (const char* name : {"c", "cart"}) {
    Swarm none = simulation.swarm(name);
    EXPECT_EQ(none.size(), 0u) << name;
    EXPECT_THAT(none.types(), ElementsAre());
    none.set_speeds({});
  }
  EXPECT_THAT(message_of<std::out_of_range>([&] { static_cast<void>(simulation.swarm("d")); }),
              HasSubstr("known: b, bot, c, t, truck"));
  simulation.step();
}

// If each robot were looked at once for each type, this would take minutes.
TEST(Swarms, OfThousandsOfTypesNameThemQuickly) {
  constexpr int k_types = test::k_slow_build ? 2'000 : 20'000;
  test::SceneBuilder scene;
  for (int i = 0; i < k_types; ++i) {
    const std::string number = std::to_string(i);
    scene.body("r" + number, scene.robot("t" + number, {test::box(0.2, 0.2)}), {0, 1.0 * i, 0, 0});
  }
  Simulation simulation(scene.spec);
  const Swarm all = simulation.swarm();
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(all.types().size(), std::size_t{k_types});
  EXPECT_EQ(all.types().back(), "t" + std::to_string(k_types - 1));
}

TEST(Swarms, SayWhatIsWrong) {
  Simulation simulation = yard();
  EXPECT_EQ(
      message_of<std::out_of_range>([&] { static_cast<void>(simulation.swarm("bots")); }),
      "unknown type or population of robots \"bots\"; known: b, bot, c, t, truck (did you mean \"bot\"?)");
  for (const char* name : {"wall", "east"})
    EXPECT_EQ(message_of<std::out_of_range>([&] { static_cast<void>(simulation.swarm(name)); }),
              "\"" + std::string(name) + "\" has no drive: robots are bodies with a drive");
  Swarm bots = simulation.swarm("b");
  std::vector<float> ranges(9);
  EXPECT_EQ(message_of<std::out_of_range>([&] { bots.ranges(ranges, "ear"); }),
            "\"b0\" has no ranger \"ear\"; it has: eye, nape");
  EXPECT_EQ(message_of<std::invalid_argument>([&] { static_cast<void>(simulation.swarm().beams("eye")); }),
            "the robots have different rangers: the ranger of \"b0\" has 3 beams, that of \"t0\" has 5; use "
            "a swarm of one type");
  ranges.pop_back();
  EXPECT_EQ(message_of<std::invalid_argument>([&] { bots.ranges(ranges); }),
            "found a span of 8 elements, but 3 robots with 3 beams each need 9, one per robot and beam");
  EXPECT_EQ(message_of<std::invalid_argument>([&] { bots.set_speeds(std::vector<Model::Speed>(2)); }),
            "found 2 elements for a swarm of 3 robots: give one per robot");
  EXPECT_EQ(message_of<std::invalid_argument>(
                [&] { bots.set_speeds(std::vector<Model::Speed>(3), std::vector<std::uint8_t>(4)); }),
            "found 4 elements of `where` for a swarm of 3 robots: give one per robot");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Model::Speed> speeds{{0.1, 0, 0}, {0, 0, nan}, {0.1, 0, 0}};
  EXPECT_EQ(message_of<std::invalid_argument>([&] { bots.set_speeds(speeds); }),
            "\"b1\" was commanded 0, 0, nan: give finite numbers");
  EXPECT_THROW(bots.accelerate(speeds), std::invalid_argument);
  EXPECT_THROW(bots.go_to(std::vector<Pose>(3, {0, 0, 0, nan})), std::invalid_argument);
  simulation.step();
  std::vector<Model::Speed> now(3);
  bots.speeds(now);
  EXPECT_EQ(now[0].forward, 0) << "an invalid command changes nothing";
  bots.set_speeds(speeds, std::vector<std::uint8_t>{1, 0, 1});  // the robot with nan is not selected
  EXPECT_NO_THROW(simulation.step());
}

/// The controller expand_swarm, for all robots in one call from outside.
class Outside {
 public:
  explicit Outside(Simulation& simulation)
      : swarm_(simulation.swarm()),
        speeds_(swarm_.size()),
        moves_(swarm_.size()),
        ranges_(swarm_.size() * swarm_.beams()) {
    for (const double bearing : swarm_.bearings()) directions_.push_back(sincos(bearing));
  }

  void command() {
    constexpr double d = 0.5;
    const std::vector<double> clearances{d, d / 1.5, d / 3, d / 5, -1, -1, -1, -1, -1, d / 5, d / 3, d / 1.5};
    swarm_.ranges(ranges_);
    for (std::size_t i = 0; i < swarm_.size(); ++i) {
      double x = 0;
      double y = 0;
      bool is_clear = true;
      for (std::size_t b = 0; b < directions_.size(); ++b) {
        const double range = ranges_[i * directions_.size() + b];
        x += range * directions_[b].cos;
        y += range * directions_[b].sin;
        is_clear = is_clear && range > clearances[b];
      }
      const double turn = atan2(y, x);
      speeds_[i] = {is_clear && std::abs(turn) < 0.5 ? 0.3 : 0.0, 0, turn};
      moves_[i] = x != 0 && y != 0;
    }
    swarm_.set_speeds(speeds_, moves_);
  }

 private:
  Swarm swarm_;
  std::vector<Model::Speed> speeds_;
  std::vector<std::uint8_t> moves_;
  std::vector<float> ranges_;
  std::vector<SinCos> directions_;
};

// Without a body, or without a row in the state tables, a robot would be a place in memory beyond them.
TEST(Swarms, OfIdsThatAreNoRobotsAreErrors) {
  Simulation simulation = yard();
  engine::World& world = simulation.world();
  const BodyId wall = simulation.find("east").id();
  const BodyId bot = simulation.find("b0").id();
  EXPECT_EQ(Swarm::of(world, {bot}).names(), std::vector<std::string>{"b0"});
  EXPECT_EQ(message_of<std::out_of_range>([&] {
              Swarm::of(world, {bot, BodyId(std::size_t{77})});
            }),
            "no robot with id 77: the world has 9 bodies, whose ids begin at 0");
  EXPECT_THROW(Swarm::of(world, {BodyId()}), std::out_of_range);
  EXPECT_EQ(message_of<std::out_of_range>([&] { Swarm::of(world, {wall}); }),
            "\"east\" (id 1) is not a robot: it is static");
}

TEST(Swarms, DrivenFromOutsideMakeTheBitsOfControllers) {
  SimulationOptions options;
  options.robots = {{"", test::k_slow_build ? 60 : 500}};
  Simulation inside(k_worlds / "hospital.json", options);
  const std::filesystem::path file = k_worlds / "hospital.json";
  std::ifstream stream(file);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::string controller = R"("controller": {"kind": "expand_swarm"})";
  const std::size_t at = text.find(",\n      " + controller);
  ASSERT_NE(at, text.npos);
  text.erase(at, controller.size() + 8);
  for (const unsigned threads : {1u, 2u}) {
    options.threads = threads;
    Simulation simulation = Simulation::from_text(text, file, options);
    Outside outside(simulation);
    inside.reset();
    EXPECT_EQ(simulation.state_hash(), inside.state_hash());
    for (int tick = 0; tick < (test::k_slow_build ? 10 : 50); ++tick) {
      inside.step();
      simulation.step();
      outside.command();
      ASSERT_EQ(simulation.state_hash(), inside.state_hash()) << tick;
    }
  }
}

/// Two kinds of robots that talk and shine; those of the first can say more.
constexpr std::string_view k_talkers = R"({
  "troupe": 1, "mortal": true, "types": {
    "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
      "sensors": [{"name": "radio", "kind": "radio", "range_m": 3, "payload": 4, "most_heard": 5}],
      "devices": [{"name": "lamp", "kind": "led"}]},
    "truck": {"size_m": [1, 0.5, 0.5], "drive": {"kind": "omni"},
      "sensors": [{"name": "radio", "kind": "radio", "range_m": 3, "payload": 8, "most_heard": 5}],
      "devices": [{"name": "lamp", "kind": "led"}]}
  },
  "models": [
    {"name": "b0", "type": "bot"}, {"name": "t0", "type": "truck", "pose": {"x_m": 1}},
    {"name": "b1", "type": "bot", "pose": {"x_m": 2}}, {"name": "b2", "type": "bot", "pose": {"x_m": 20}}]
})";

template <class T>
std::vector<T> read(const Swarm& swarm, std::string_view field, std::string_view device) {
  const engine::StateField& its = swarm.reading_field(field, device);
  std::vector<T> values(swarm.size() * its.columns);
  swarm.readings(std::as_writable_bytes(std::span(values)), field, device);
  return values;
}

TEST(SwarmDevices, AreReadAndCommandedInTheOrderOfTheSwarm) {
  Simulation simulation = yard(k_talkers);
  Swarm bots = simulation.swarm("bot");
  const std::vector<float> red{0.25f, 0.5f, 0.75f};
  const std::vector<std::uint8_t> on{1, 1, 1};
  bots.set_commands(std::as_bytes(std::span(red)), "red", "lamp");
  bots.set_commands(std::as_bytes(std::span(on)), "shows", "lamp", std::vector<std::uint8_t>{1, 0, 1});
  std::vector<std::uint8_t> shows(3);
  bots.commands(std::as_writable_bytes(std::span(shows)), "shows", "lamp");
  EXPECT_THAT(shows, ElementsAre(1, 0, 1));
  EXPECT_EQ(bots.command_fields("lamp").size(), 4u);
  const std::vector<std::uint8_t> words{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const std::vector<std::uint8_t> lengths{4, 4, 4};
  bots.set_commands(std::as_bytes(std::span(on)), "mode", "radio");
  bots.set_commands(std::as_bytes(std::span(lengths)), "length", "radio");
  bots.set_commands(std::as_bytes(std::span(words)), "payload", "radio");
  simulation.step();
  simulation.step();
  EXPECT_THAT(read<float>(bots, "shown_color", "lamp"), ElementsAre(0.25f, 0, 0, 1, 1, 1, 0.75f, 0, 0));
  EXPECT_THAT(read<std::uint32_t>(bots, "count", "radio"), ElementsAre(1, 1, 0));
  const std::vector<std::uint8_t> heard = read<std::uint8_t>(bots, "payload", {});
  ASSERT_EQ(heard.size(), 3u * 5 * 4);
  EXPECT_THAT(std::vector(heard.begin(), heard.begin() + 4), ElementsAre(5, 6, 7, 8));
  EXPECT_THAT(std::vector(heard.begin() + 20, heard.begin() + 24), ElementsAre(1, 2, 3, 4));
  // Each is what the model says.
  Model b1 = simulation.find("b1");
  const Model::Reading one = b1.reading("payload", "radio");
  EXPECT_TRUE(std::ranges::equal(one.bytes, std::as_bytes(std::span(heard)).subspan(20, 20)));
}

TEST(SwarmDevices, AreFoundByAFieldOfTheirCommand) {
  Simulation simulation = yard(k_talkers);
  const Swarm all = simulation.swarm();
  EXPECT_THAT(all.devices_with_command("payload"), ElementsAre("radio"));
  EXPECT_THAT(all.devices_with_command("red"), ElementsAre("lamp"));
  EXPECT_THAT(all.devices_with_command("ranges"), testing::IsEmpty());
}

TEST(SwarmDevices, IncludeTheMemoriesOfControllers) {
  constexpr std::string_view k_world = R"({
    "troupe": 1, "arena": {"size_m": [4, 4]},
    "types": {
      "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "wander"}, "sensors": [
        {"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 3, "fov_deg": 90, "samples": 9}]}]},
      "fast": {"extends": "bot", "controller": {"kind": "wander", "cruise_speed_mps": 1}},
      "still": {"extends": "bot", "controllers": []}
    },
    "populations": [
      {"name": "f", "type": "fast", "count": 5, "place": {"rule": "uniform"}},
      {"name": "b", "type": "bot", "count": 20, "place": {"rule": "uniform"}},
      {"name": "s", "type": "still", "count": 1, "place": {"rule": "uniform"}}]
  })";
  Simulation simulation = yard(k_world);
  simulation.run_for(2);
  const Swarm bots = simulation.swarm("b");
  std::vector<std::int32_t> expected(bots.size());
  std::size_t found = 0;
  for (const engine::StateTable& table : simulation.world().tables()) {
    if (table.component() != "wander/0") continue;
    const auto field = std::ranges::find(table.fields(), "avoid_updates", &engine::StateField::name);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const auto at = std::ranges::find(bots.ids(), table.ids()[row]);
      if (at == bots.ids().end()) continue;
      ++found;
      expected[static_cast<std::size_t>(at - bots.ids().begin())] =
          table.cell<std::int32_t>(row, static_cast<std::size_t>(field - table.fields().begin()))[0];
    }
  }
  ASSERT_EQ(found, bots.size());
  EXPECT_GT(std::ranges::max(expected), 0);
  EXPECT_EQ(read<std::int32_t>(bots, "avoid_updates", "wander/0"), expected);
  std::vector<std::byte> bytes(4);
  EXPECT_THAT(message_of<std::out_of_range>([&] { bots.readings(bytes, "avoid", "wander/0"); }),
              HasSubstr("controller \"wander/0\" of \"b0\": unknown field \"avoid\"; known: "));
  EXPECT_THAT(
      message_of<std::out_of_range>([&] { bots.readings(bytes, "avoid", "wander"); }),
      HasSubstr("\"b0\" has no device \"wander\"; it has: eye, wander/0 (did you mean \"wander/0\"?)"));
  EXPECT_THAT(
      message_of<std::out_of_range>([&] { simulation.swarm("s").readings(bytes, "avoid", "wander/0"); }),
      HasSubstr("\"s0\" has no device \"wander/0\"; it has: eye"));
  // A model reads and says the same.
  for (std::size_t i = 0; i < bots.size(); ++i) {
    const Model robot = simulation.model(bots.ids()[i]);
    EXPECT_THAT(robot.readings<std::int32_t>("avoid_updates", "wander/0"), ElementsAre(expected[i]));
  }
  const Model b0 = simulation.find("b0");
  EXPECT_THAT(b0.fields("wander/0"),
              testing::Contains(testing::Field(&engine::StateField::name, "avoid_updates")));
  EXPECT_EQ(message_of<std::invalid_argument>([&] { b0.readings<float>("avoid_updates", "wander/0"); }),
            "field \"avoid_updates\" of controller \"wander/0\" of \"b0\" has the type int32, not float32");
  EXPECT_THAT(message_of<std::out_of_range>([&] { b0.reading("avoid", "wander/0"); }),
              HasSubstr("controller \"wander/0\" of \"b0\": unknown field \"avoid\"; known: "));
  EXPECT_EQ(message_of<std::out_of_range>([&] { b0.reading("avoid_updates", "wander/1"); }),
            "\"b0\" has no device \"wander/1\"; it has: eye, wander/0 (did you mean \"wander/0\"?)");
}

TEST(SwarmDevices, SayWhatIsWrong) {
  Simulation simulation = yard(k_talkers);
  Swarm all = simulation.swarm();
  std::vector<std::byte> bytes(4);
  EXPECT_THAT(message_of<std::out_of_range>([&] { all.readings(bytes, "cuont", "radio"); }),
              HasSubstr("device \"radio\" of \"b0\": unknown field \"cuont\"; known: bearing, count, "));
  EXPECT_THAT(message_of<std::out_of_range>([&] { all.readings(bytes, "cuont", ""); }),
              AllOf(HasSubstr("devices of \"b0\": unknown field \"cuont\"; known: bearing, "),
                    HasSubstr("(did you mean \"count\"?)")));
  EXPECT_THAT(message_of<std::out_of_range>([&] { all.readings(bytes, "count", "radoi"); }),
              HasSubstr("\"b0\" has no device \"radoi\"; it has: radio, lamp (did you mean \"radio\"?)"));
  EXPECT_THAT(message_of<std::out_of_range>([&] { all.command_fields("eye"); }),
              HasSubstr("\"b0\" has no device that takes commands \"eye\"; it has: radio, lamp"));
  EXPECT_THAT(message_of<std::invalid_argument>([&] { all.readings(bytes, "count", "radio"); }),
              HasSubstr("found 4 bytes for \"count\" of 4 robots with 1 columns each"));
  bytes.resize(4 * 5 * 4);
  EXPECT_THAT(
      message_of<std::invalid_argument>([&] { all.readings(bytes, "payload", "radio"); }),
      HasSubstr("the robots have different devices: \"payload\" of \"b0\" has 20 columns of type uint8, that "
                "of \"t0\" has 40"));
}

TEST(SwarmDevices, CommandsOfUnlikeDevicesAreRefusedAndNoneIsSet) {
  Simulation simulation = yard(k_talkers);
  Swarm all = simulation.swarm();
  const std::vector<std::byte> bytes(all.size() * 4, std::byte{7});
  EXPECT_THAT(message_of<std::invalid_argument>([&] { all.set_commands(bytes, "payload", "radio"); }),
              HasSubstr("the robots have different devices: "));
  std::vector<std::byte> words(3 * 4, std::byte{1});
  simulation.swarm("bot").commands(words, "payload", "radio");
  EXPECT_THAT(words, Each(std::byte{0}));
}

/// A device with a command that is a bool. (The commands of Troupe's own devices have none.)
struct Horn {
  struct Command {
    bool blows = false;
    TROUPE_FIELDS(blows)
  };
  void act(const engine::DeviceBatch&) const {}
};

// A bool with another value than 0 or 1 is undefined behaviour in the device, and makes a checkpoint that
// cannot be resumed.
TEST(SwarmDevices, BoolsAreZeroOrOne) {
  engine::Registry registry = make_registry();
  registry.devices.push_back(engine::make_device_kind<Horn>("horn", "makes noise"));
  WorldBuilder world;
  world.type("bot").size(0.2, 0.2, 0.2).drive("diff").device("horn", "horn");
  for (int i = 0; i < 3; ++i) world.add("b" + std::to_string(i), "bot", {.x = 1.0 * i});
  Simulation simulation(world, {.threads = 1}, registry);
  Swarm bots = simulation.swarm();
  const auto blow = [&](std::vector<std::uint8_t> blows, std::vector<std::uint8_t> where = {}) {
    bots.set_commands(std::as_bytes(std::span(blows)), "blows", "horn", where);
  };
  EXPECT_EQ(message_of<std::invalid_argument>([&] {
              blow({1, 0, 7});
            }),
            "found 7 for the command \"blows\" of \"b2\", which is a bool: give 0 or 1");
  EXPECT_FALSE(simulation.find("b0").command<Horn::Command>("horn").blows) << "no command has changed";
  blow({1, 0, 7}, {1, 1, 0});
  EXPECT_TRUE(simulation.find("b0").command<Horn::Command>("horn").blows);
}

}  // namespace
}  // namespace troupe::swarm_test
