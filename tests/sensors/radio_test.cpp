#include "sensors/radio.hpp"

#include "base/random.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/world/world.hpp"
#include "tests/support/access_of.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace troupe::sensors::radio_test {
namespace {

using engine::World;
using test::box;
using test::SceneBuilder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Params = std::vector<std::pair<std::string_view, engine::Value>>;

constexpr double k_height = 0.2;  // m, of the radios

engine::DeviceSpec radio(const Params& params = {}, const Pose& pose = {0, 0, k_height, 0}) {
  return {.name = "radio",
          .kind = "radio",
          .params = test::record(test::registry().device("radio")->params, params),
          .pose_body_device = pose,
          .active = true,
          .where = {}};
}

/// Says the number of the tick, four bytes, from tick 1 to tick 20.
struct Counting {
  static constexpr bool needs_drive = false;
  static constexpr std::array k_uses{std::string_view("radio")};
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    const RadioPort port(percept.devices[0], actions.devices[0]);
    if (percept.tick <= 20)
      port.say(static_cast<std::uint32_t>(percept.tick));
    else
      port.be_silent();
  }
};

/// Says a payload of five bytes, as two numbers.
struct Wordy {
  static constexpr bool needs_drive = false;
  static constexpr std::array k_uses{std::string_view("radio")};
  void operator()(const engine::Percept& percept, Random&, engine::Actions& actions) const {
    const RadioPort port(percept.devices[0], actions.devices[0]);
    port.say(std::uint8_t{7}, 1.5f);
    const bool has_room = port.say(1.0, 2.0);  // sixteen bytes
    if (!has_room && percept.tick % 2 == 1) port.say(std::uint8_t{7}, 1.5f);
  }
};

const engine::Registry& registry() {
  static const engine::Registry kinds = [] {
    engine::Registry all = make_registry();
    all.controllers.push_back(engine::make_controller_kind<Counting>("counting", ""));
    all.controllers.push_back(engine::make_controller_kind<Wordy>("wordy", ""));
    return all;
  }();
  return kinds;
}

struct RadioScene : SceneBuilder {
  /// A post of 0.1 m with a radio, and perhaps a controller.
  BodyId post(const Pose& pose, const Params& params = {}, const std::string& controller = {}) {
    const std::string name = "post" + std::to_string(spec.bodies.size());
    const TypeId id = type(name, {box(0.1, 0.1)});
    (*this)[id].devices = {radio(params)};
    if (!controller.empty()) (*this)[id].controllers = {{.kind = controller, .params = {}, .where = {}}};
    return body(name, id, pose);
  }
  BodyId beacon(const Pose& pose, Params params = {}) {
    params.emplace_back("beacon", true);
    return post(pose, params);
  }
  World world(engine::WorldOptions options = {.threads = 2}) const {
    Diagnostics diagnostics;
    return World(spec, registry(), options, diagnostics);
  }
};
/// A radio that sends its beacon to another one, 1 m away. Both can be removed and disabled.
struct MortalPair : RadioScene {
  MortalPair() { spec.mortal = true; }
  const BodyId listener = post({0, 0, 0, 0});
  const BodyId talker = beacon({1, 0, 0, 0});
};

engine::Readings readings(const World& world, BodyId body, std::size_t device = 0) {
  const Row row = world.view().row(body);
  return {world.tables()[world.view().type(row).devices[device].table], world.view().slot(row)};
}

std::vector<RadioPort::Message> heard(const World& world, BodyId body, std::size_t device = 0) {
  const RadioPort port(readings(world, body, device), nullptr);
  std::vector<RadioPort::Message> messages;
  for (std::size_t i = 0; i < port.count(); ++i) messages.push_back(port[i]);
  return messages;
}
std::vector<std::uint32_t> senders(const World& world, BodyId body, std::size_t device = 0) {
  std::vector<std::uint32_t> ids;
  for (const RadioPort::Message& message : heard(world, body, device)) ids.push_back(message.sender);
  return ids;
}
std::uint32_t number(const World& world, BodyId body, RadioField field) {
  return readings(world, body).field<std::uint32_t>(field)[0];
}

TEST(Radio, TwentyOfTwentyMessagesArriveATickLater) {
  RadioScene scene;
  const BodyId talker = scene.post({0, 0, 0, 0}, {}, "counting");
  const BodyId listener = scene.post({3, 4, 0, k_pi / 2});  // 5 m away, which is the range
  World world = scene.world();
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t tick = 1; tick <= 25; ++tick) {
    world.step();
    for (const RadioPort::Message& message : heard(world, listener)) {
      std::uint32_t said = 0;
      EXPECT_TRUE(message.read(said));
      EXPECT_EQ(said, tick - 1) << "what was said in the tick before";
      EXPECT_EQ(message.sender, talker.value);
      EXPECT_EQ(message.range, 5.0f);
      // From (3, 4) the origin lies at -126.87 degrees, and the listener looks along +y.
      EXPECT_NEAR(degrees(message.bearing), -126.8699 - 90 + 360, 1e-4);
      EXPECT_EQ(message.strength, 20);
      EXPECT_EQ(message.quality, 0);
      numbers.push_back(said);
    }
    EXPECT_THAT(heard(world, talker), IsEmpty());
  }
  ASSERT_EQ(numbers.size(), 20u);
  for (std::uint32_t i = 0; i < 20; ++i) EXPECT_EQ(numbers[i], i + 1);
}

/// How many of twenty messages go 2 m from (0, 0) to (2, 0).
int arriving(RadioScene scene, const Params& params = {}, double z_talker = 0, double z_listener = 0) {
  scene.post({0, 0, z_talker, 0}, params, "counting");
  const BodyId listener = scene.post({2, 0, z_listener, 0}, params);
  World world = scene.world();
  int count = 0;
  for (int tick = 0; tick < 25; ++tick) {
    world.step();
    count += static_cast<int>(heard(world, listener).size());
  }
  return count;
}

TEST(Radio, NoMessagePassesAWall) {
  RadioScene between;
  between.wall(1, -1, 1.1, 1);  // 1 m high
  EXPECT_EQ(arriving(between), 0);
  EXPECT_EQ(arriving(between, {{"walls", "pass"}}), 20);
  RadioScene beside;
  beside.wall(1, 0.2, 1.1, 1);
  beside.wall(2.3, -1, 2.4, 1);
  EXPECT_EQ(arriving(beside), 20);
  RadioScene open;
  open.wall(1, -1, 1.1, 1, {.obstacle = false, .ranger = -1});  // that rangers do not see, either
  EXPECT_EQ(arriving(open), 20);
}

TEST(Radio, ALineMayPassOverAWall) {
  // Radios at 0.9 and 1.5 m above the ground: at x = 0.5 m the line is 1.05 m high, at 0.1 m 0.93.
  RadioScene middle;
  middle.wall(0.5, -1, 0.6, 1);
  EXPECT_EQ(arriving(middle, {}, 0.7, 1.3), 20);
  RadioScene near;
  near.wall(0.1, -1, 0.2, 1);
  EXPECT_EQ(arriving(near, {}, 0.7, 1.3), 0);
}

TEST(Radio, NoLineSlipsBetweenTwoEdges) {
  RadioScene through;
  const Ring diamond{{1, -0.5}, {1.5, 0}, {1, 0.5}, {0.5, 0}};
  through.body("diamond", through.type("diamond", {Solid{{diamond}, {0, 1}}}), {});
  EXPECT_EQ(arriving(through), 0) << "through two vertices";
}

TEST(Radio, WhatTouchesALineHidesBothWaysOrNeither) {
  const std::array<Ring, 4> rings{test::rectangle(0.5, 0, 1, 1), test::rectangle(0.5, -1, 1, 0),
                                  Ring{{1, 0}, {1.5, 0.5}, {1, 1}, {0.5, 0.5}},
                                  Ring{{1, -1}, {1.5, -0.5}, {1, 0}, {0.5, -0.5}}};
  for (const Ring& ring : rings) {
    RadioScene scene;
    scene.body("wall", scene.type("wall", {Solid{{ring}, {0, 1}}}), {});
    const BodyId one = scene.beacon({0, 0, 0, 0});
    const BodyId other = scene.beacon({2, 0, 0, 0});
    World world = scene.world();
    world.step();
    EXPECT_EQ(senders(world, one).size(), senders(world, other).size());
  }
}

TEST(Radio, BodiesHideWhereTheyAreToldTo) {
  RadioScene scene;
  scene.body("crate", scene.robot("crate", {box(0.3, 0.3)}), {1, 0.1, 0, 0});
  EXPECT_EQ(arriving(scene), 20);
  EXPECT_EQ(arriving(scene, {{"bodies", "block"}}), 0);
  EXPECT_EQ(arriving(scene, {{"bodies", "block"}}, 1, 1), 20) << "it is 1 m high, and the line 1.2 m";
  RadioScene beside;
  beside.body("crate", beside.robot("crate", {box(0.3, 0.3)}), {1, 0.3, 0, 0});
  EXPECT_EQ(arriving(beside, {{"bodies", "block"}}), 20);
}

TEST(Radio, OfMoreThanItCanTakeTheNearestAreHeard) {
  RadioScene scene;
  const BodyId listener = scene.post({0, 0, 0, 0}, {{"most_heard", 3}});
  const BodyId far = scene.beacon({0, 3, 0, 0});
  const BodyId second = scene.beacon({2, 0, 0, 0});  // three at 2 m: the two with the lower ids are heard
  const BodyId third = scene.beacon({-2, 0, 0, 0});
  const BodyId fourth = scene.beacon({0, -2, 0, 0});
  const BodyId nearest = scene.beacon({1, 0, 0, 0});
  World world = scene.world();
  world.step();
  EXPECT_THAT(senders(world, listener), ElementsAre(second.value, third.value, nearest.value)) << "by id";
  EXPECT_EQ(number(world, listener, k_radio_lost), 2u);
  world.set_poses(std::vector<World::Placed>{{world.view().row(nearest), {9, 9, 0, 0}}});
  world.step();
  EXPECT_THAT(senders(world, listener), ElementsAre(second.value, third.value, fourth.value));
  EXPECT_EQ(number(world, listener, k_radio_lost), 1u);
  world.set_poses(std::vector<World::Placed>{{world.view().row(second), {9, 8, 0, 0}},
                                             {world.view().row(third), {9, 7, 0, 0}}});
  world.step();
  EXPECT_THAT(senders(world, listener), ElementsAre(far.value, fourth.value));
  EXPECT_EQ(number(world, listener, k_radio_lost), 0u);
  EXPECT_EQ(readings(world, listener).field<float>(k_radio_range)[2], 0) << "what was there before is gone";
  EXPECT_EQ(readings(world, listener).field<std::uint32_t>(k_radio_sender)[2], 0u);
}

TEST(Radio, MessagesAreNumbersOneBehindAnother) {
  RadioScene scene;
  scene.post({0, 0, 0, 0}, {}, "wordy");
  const BodyId listener = scene.post({1, 0, 0, 0});
  const BodyId small = scene.post({0, 1, 0, 0}, {{"payload", 4}});
  World world = scene.world();
  world.step();
  world.step();
  ASSERT_EQ(heard(world, listener).size(), 1u);
  const RadioPort::Message message = heard(world, listener)[0];
  EXPECT_EQ(message.payload.size(), 5u);
  std::uint8_t a = 0;
  float b = 0;
  EXPECT_FALSE(message.read(b));
  EXPECT_TRUE(message.read(a, b));
  EXPECT_EQ(a, 7);
  EXPECT_EQ(b, 1.5f);
  EXPECT_THAT(heard(world, small), IsEmpty()) << "it takes four bytes";
  EXPECT_EQ(number(world, small, k_radio_lost), 1u);
  world.step();
  EXPECT_THAT(heard(world, listener), IsEmpty()) << "a message that is too long is not sent";
}

// The bytes of a shorter command end before the message does: the rest would be those of other robots.
TEST(RadioPort, RefusesTheCommandOfAnotherDevice) {
  RadioScene scene;
  const BodyId body = scene.post({0, 0, 0, 0}, {{"payload", 4}});
  const World world = scene.world();
  std::array<std::byte, 6> bytes{};
  const RadioPort right(readings(world, body), bytes);
  EXPECT_TRUE(right.say(1.5f));
  EXPECT_FALSE(right.say(1.5));
  EXPECT_EQ(bytes[0], std::byte{static_cast<std::uint8_t>(RadioMode::silent)});
  const RadioPort of_another(readings(world, body), std::span(bytes).first(5));
  const RadioPort of_a_sensor(readings(world, body), std::span<std::byte>());
  EXPECT_EQ(test::message_of<std::logic_error>([&] { of_another.say(std::uint8_t{7}); }),
            "commands a radio, whose command has 6 bytes, through a command of 5 bytes: give RadioPort the "
            "readings and the command of the same radio");
  EXPECT_THROW(of_a_sensor.be_silent(), std::logic_error);
}

TEST(Radio, AsManyMessagesAreDroppedAsItSays) {
  RadioScene scene;
  const BodyId listener =
      scene.post({0, 0, 0, 0}, {{"drop_rate", 0.3}, {"most_heard", 100}, {"hears", 100.0}});
  for (int i = 0; i < 100; ++i) scene.beacon({1.0 + i % 10, 1.0 + i / 10, 0, 0}, {{"range", 100.0}});
  World world = scene.world();
  std::uint32_t dropped = 0;
  std::vector<int> of_sender(scene.spec.bodies.size());
  std::set<std::vector<std::uint32_t>> patterns;
  for (int tick = 0; tick < 100; ++tick) {
    world.step();
    dropped += number(world, listener, k_radio_dropped);
    EXPECT_EQ(number(world, listener, k_radio_dropped) + number(world, listener, k_radio_count), 100u);
    for (const std::uint32_t sender : senders(world, listener)) ++of_sender[sender];
    patterns.insert(senders(world, listener));
  }
  // Binomial, 10,000 draws: 3,000 with a standard deviation of 45.8. Four of them.
  EXPECT_NEAR(dropped, 3000, 184);
  EXPECT_EQ(patterns.size(), 100u) << "each tick has its own";
  for (std::size_t b = 2; b < of_sender.size(); ++b) EXPECT_NEAR(of_sender[b], 70, 23) << b;  // 5 of 4.58

  RadioScene other = scene;
  other.spec.seed = 2;
  World second = other.world();
  World again = scene.world();
  second.step();
  again.step();
  World first = scene.world();
  first.step();
  EXPECT_EQ(senders(again, listener), senders(first, listener));
  EXPECT_NE(senders(second, listener), senders(first, listener));
}

TEST(Radio, MessagesOfTheRadiosOfOneBodyAreDroppedIndependently) {
  RadioScene scene;
  const BodyId listener =
      scene.post({0, 0, 0, 0}, {{"drop_rate", 0.3}, {"most_heard", 100}, {"hears", 100.0}});
  const TypeId type = scene.type("talker", {box(0.4, 0.4)});
  constexpr int k_radios = 5, k_talkers = 20, k_ticks = 100;
  for (int r = 0; r < k_radios; ++r) {
    scene[type].devices.push_back(radio({{"range", 100.0}, {"beacon", true}}));
    scene[type].devices.back().name = std::string(1, static_cast<char>('a' + r));
  }
  for (int i = 0; i < k_talkers; ++i)
    scene.body(std::string(1, static_cast<char>('a' + i)), type, {1.0 + i % 5, 1.0 + i / 5, 0, 0});
  World world = scene.world();
  double sum = 0, squares = 0;
  for (int tick = 0; tick < k_ticks; ++tick) {
    world.step();
    std::vector<int> arrived(scene.spec.bodies.size());
    for (const std::uint32_t sender : senders(world, listener)) ++arrived[sender];
    for (const int count : std::span(arrived).last(k_talkers)) {
      sum += count;
      squares += count * count;
    }
  }
  constexpr double k_draws = k_talkers * k_ticks;
  const double mean = sum / k_draws;
  EXPECT_NEAR(mean, 0.7 * k_radios, 0.12);
  // The variance of a sum of five independent draws, with a standard deviation of 0.033. If two of them were
  // equal, it would be 1.47.
  EXPECT_NEAR(squares / k_draws - mean * mean, 0.3 * 0.7 * k_radios, 0.17);
}

TEST(Radio, ChannelsAndRangesAreEachRadiosOwn) {
  RadioScene scene;
  const BodyId a = scene.beacon({0, 0, 0, 0}, {{"range", 1.0}, {"hears", 3.0}});
  const BodyId b = scene.beacon({2, 0, 0, 0}, {{"range", 3.0}});
  const BodyId c = scene.beacon({0, 2, 0, 0}, {{"range", 3.0}, {"channel", "other"}});
  const BodyId d = scene.beacon({2, 2, 0, 0}, {{"range", 3.0}, {"channel", "other"}});
  const BodyId asleep = scene.beacon({1, 1, 0, 0});
  scene[scene.spec.bodies[asleep.index()].type].devices[0].active = false;
  World world = scene.world();
  world.step();
  EXPECT_THAT(senders(world, a), ElementsAre(b.value));
  EXPECT_THAT(senders(world, b), IsEmpty()) << "a is heard 1 m far";
  EXPECT_THAT(senders(world, c), ElementsAre(d.value));
  EXPECT_THAT(senders(world, d), ElementsAre(c.value));
  EXPECT_THAT(senders(world, asleep), IsEmpty());
}

TEST(Radio, ASpeakerThatIsTooWeakIsNotHeardAtAnyDistance) {
  for (const double drop_rate : {0.0, 1e-9}) {
    RadioScene scene;
    const BodyId weak = scene.beacon(
        {0, 0, 0, 0}, {{"power_dBm", -50.0}, {"sensitivity_dBm", -60.0}, {"drop_rate", drop_rate}});
    const BodyId strong = scene.beacon(
        {1, 0, 0, 0},
        {{"power_dBm", 0.0}, {"sensitivity_dBm", -49.0}, {"walls", "pass"}, {"drop_rate", drop_rate}});
    World world = scene.world();
    world.step();
    EXPECT_THAT(senders(world, strong), IsEmpty()) << "-50 dBm is below its sensitivity";
    EXPECT_THAT(senders(world, weak), ElementsAre(strong.value));
  }
}

TEST(Radio, SeveralOfOneBodyDoNotHearOneAnother) {
  RadioScene scene;
  const TypeId twin = scene.type("twin", {box(1, 0.2)});
  scene[twin].devices = {radio({{"beacon", true}}, {0.4, 0, k_height, 0}),
                         radio({{"beacon", true}}, {-0.4, 0, k_height, k_pi})};
  scene[twin].devices[1].name = "rear";
  const BodyId body = scene.body("twin", twin, {0, 0, 0, k_pi / 2});
  const BodyId listener = scene.beacon({0, 2.4, 0, 0});
  World world = scene.world();
  world.step();
  const auto messages = heard(world, listener);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_FLOAT_EQ(messages[0].range, 2.0f);
  EXPECT_FLOAT_EQ(messages[1].range, 2.8f);
  EXPECT_THAT(senders(world, body, 0), ElementsAre(listener.value));
  EXPECT_THAT(senders(world, body, 1), ElementsAre(listener.value));
  EXPECT_NEAR(heard(world, body, 0)[0].bearing, 0, 1e-6);
  EXPECT_NEAR(std::abs(heard(world, body, 1)[0].bearing), k_pi, 1e-6);
}

TEST(Radio, WhoIsGoneIsSilent) {
  MortalPair scene;
  World world = scene.world();
  world.step();
  EXPECT_THAT(senders(world, scene.listener), ElementsAre(scene.talker.value));
  world.remove(world.view().row(scene.talker));
  world.step();
  EXPECT_THAT(senders(world, scene.listener), IsEmpty());
}

TEST(Radio, WhoIsDisabledIsSilent) {
  MortalPair scene;
  World world = scene.world();
  world.set_disabled(world.view().row(scene.talker), true);
  world.step();
  EXPECT_THAT(senders(world, scene.listener), IsEmpty());
  world.set_disabled(world.view().row(scene.talker), false);
  world.step();
  EXPECT_THAT(senders(world, scene.listener), ElementsAre(scene.talker.value));
}

TEST(Radio, AMessageLongerThanThePayloadOfItsSenderIsNotSent) {
  RadioScene scene;
  const BodyId listener = scene.post({0, 0, 0, 0}, {{"payload", 200}});
  const BodyId talker = scene.post({1, 0, 0, 0}, {{"payload", 8}});
  World world = scene.world();
  std::byte* command =
      world.device_command(world.view().row(talker), world.view().type(world.view().row(talker)).devices[0]);
  command[k_radio_mode] = static_cast<std::byte>(RadioMode::says);
  for (const int length : {8, 9, 150}) {
    command[k_radio_bytes] = static_cast<std::byte>(length);
    world.step();
    EXPECT_EQ(senders(world, listener).size(), length == 8 ? 1u : 0u) << length << " bytes";
  }
}

// The state of a checkpoint is not trusted.
TEST(Radio, AWrongCountReadsNoEntriesThatDoNotExist) {
  RadioScene scene;
  const BodyId listener = scene.post({0, 0, 0, 0}, {{"most_heard", 3}});
  scene.beacon({1, 0, 0, 0});
  World world = scene.world();
  const engine::BodyType::Device& radio = world.view().type(world.view().row(listener)).devices[0];
  test::access_of(world).tables()[radio.table].cell<std::uint32_t>(
      world.view().slot(world.view().row(listener)), k_radio_count)[0] = 3'000'000;
  EXPECT_EQ(heard(world, listener).size(), 3u);
  world.step();
  EXPECT_EQ(heard(world, listener).size(), 1u);
}

/// Strength and quality over 10 m, at 2.4 GHz, 20 dBm; none: not heard.
std::vector<RadioPort::Message> over_10_m(Params params, RadioScene scene = {}) {
  params.emplace_back("range", 100.0);
  const BodyId listener = scene.post({0, 0, 0, 0}, params);
  scene.beacon({10, 0, 0, 0}, params);
  World world = scene.world();
  world.step();
  return heard(world, listener);
}

TEST(Radio, LawsOfTheStrength) {
  // 20 log10(4 pi 2.4e9 / 299792458) = 40.0520 dB over the first metre.
  ASSERT_EQ(over_10_m({{"law", "friis"}}).size(), 1u);
  EXPECT_NEAR(over_10_m({{"law", "friis"}})[0].strength, 20 - 40.0520 - 20, 1e-3);
  EXPECT_NEAR(over_10_m({{"law", "friis"}})[0].quality, 1 - 60.0520 / 100, 1e-5);
  // 20 log10(2400) = 67.6042.
  EXPECT_NEAR(over_10_m({{"law", "itu_indoor"}})[0].strength, 20 - (67.6042 + 30 - 28), 1e-3);
  EXPECT_NEAR(over_10_m({{"law", "itu_indoor"}, {"power_loss_coefficient", 22.0}})[0].strength,
              20 - (67.6042 + 22 - 28), 1e-3);
  EXPECT_NEAR(over_10_m({{"law", "log_distance"}, {"path_loss_exponent", 3.0}})[0].strength,
              20 - 40.0520 - 30, 1e-3);
  EXPECT_NEAR(over_10_m({{"law", "friis"}, {"frequency_GHz", 0.24}})[0].strength, 20 - 20.0520 - 20, 1e-3);
  EXPECT_EQ(over_10_m({})[0].strength, 20);
  EXPECT_FLOAT_EQ(over_10_m({})[0].quality, 0.9f);
  // 60.05 dB are lost: 20 dBm arrive as -40.05.
  EXPECT_EQ(over_10_m({{"law", "friis"}, {"sensitivity_dBm", -40.06}}).size(), 1u);
  EXPECT_EQ(over_10_m({{"law", "friis"}, {"sensitivity_dBm", -40.04}}).size(), 0u);
}

TEST(Radio, StrengthAndQualityAreThoseOfTheTwoRadiosOfALink) {
  // The power and the range are the sender's; the sensitivity is the listener's.
  RadioScene scene;
  const BodyId listener =
      scene.post({0, 0, 0, 0}, {{"hears", 8.0}, {"power_dBm", 5.0}, {"sensitivity_dBm", -40.0}});
  scene.beacon({1, 0, 0, 0}, {{"range", 4.0}, {"power_dBm", 10.0}});
  World world = scene.world();
  world.step();
  ASSERT_EQ(heard(world, listener).size(), 1u);
  EXPECT_EQ(heard(world, listener)[0].strength, 10);
  EXPECT_EQ(heard(world, listener)[0].quality, 0.75f) << "1 m of the 4 m at which this sender is heard";

  const Params weaken{{"walls", "weaken"},
                      {"wall_loss_dB", 10.0},
                      {"law", "log_distance"},
                      {"frequency_GHz", 0.001},
                      {"sensitivity_dBm", -40.0}};  // negative over the first metre
  RadioScene walled;
  const BodyId behind = walled.post({0, 0, 0, 0}, weaken);
  walled.beacon({1, 0, 0, 0}, {{"power_dBm", 10.0}});
  World free = walled.world();
  free.step();
  ASSERT_EQ(heard(free, behind).size(), 1u);
  EXPECT_EQ(heard(free, behind)[0].strength, 10) << "no message gains strength on its way";
  EXPECT_EQ(heard(free, behind)[0].quality, 1);
  walled.wall(0.4, -1, 0.6, 1);
  World loss = walled.world();
  loss.step();
  ASSERT_EQ(heard(loss, behind).size(), 1u);
  EXPECT_EQ(heard(loss, behind)[0].strength, 0);
  EXPECT_FLOAT_EQ(heard(loss, behind)[0].quality, 1 - 10.0f / (10 + 40));
}

TEST(Radio, WhatArrivesAtExactlyTheSensitivityIsHeard) {
  RadioScene scene;
  const BodyId listener = scene.post({0, 0, 0, 0}, {{"sensitivity_dBm", -50.0}});
  scene.beacon({1, 0, 0, 0}, {{"power_dBm", -50.0}, {"sensitivity_dBm", -60.0}});
  const Params weaken{{"walls", "weaken"}, {"wall_loss_dB", 70.0}, {"sensitivity_dBm", -50.0}};
  const BodyId behind = scene.post({0, 3, 0, 0}, weaken);
  const BodyId beyond = scene.beacon({0, 5, 0, 0});  // 20 dBm, less a wall of 70 dB
  scene.wall(-1, 3.9, 1, 4.1);
  World world = scene.world();
  world.step();
  ASSERT_EQ(heard(world, listener).size(), 1u);
  EXPECT_EQ(heard(world, listener)[0].strength, -50);
  EXPECT_EQ(heard(world, listener)[0].quality, 0);
  const std::vector<std::uint32_t> ids = senders(world, behind);
  EXPECT_EQ(std::ranges::count(ids, beyond.value), 1);
}

TEST(Radio, AMessageOfExactlyThePayloadIsHeardAndLeavesNothingBehind) {
  RadioScene scene;
  const BodyId listener = scene.post({0, 0, 0, 0}, {{"payload", 4}, {"most_heard", 2}, {"law", "friis"}});
  const BodyId talker = scene.post({1, 0.5, 0, 0}, {{"payload", 4}}, "counting");
  World world = scene.world();
  world.step();
  world.step();
  ASSERT_THAT(senders(world, listener), ElementsAre(talker.value));
  EXPECT_EQ(heard(world, listener)[0].payload.size(), 4u);
  for (int tick = 2; tick < 25; ++tick) world.step();  // it falls silent after tick 20
  ASSERT_THAT(senders(world, listener), IsEmpty());
  const engine::Readings now = readings(world, listener);
  EXPECT_THAT(now.field<std::uint32_t>(k_radio_sender), ::testing::Each(0u));
  for (const RadioField field : {k_radio_range, k_radio_bearing, k_radio_strength, k_radio_quality})
    EXPECT_THAT(now.field<float>(field), ::testing::Each(0.0f)) << field;
  EXPECT_THAT(now.field<std::uint8_t>(k_radio_length), ::testing::Each(0));
  EXPECT_THAT(now.field<std::uint8_t>(k_radio_payload), ::testing::Each(0));
}

TEST(Radio, HeightsOfTheRadiosThemselvesCount) {
  // A wall of 1 m between two posts: the line passes over it between radios at 1.5 m, and not from 0.2 m.
  for (const double talker_z : {0.2, 1.5})
    for (const double listener_z : {0.2, 1.5}) {
      RadioScene scene;
      const BodyId talker = scene.beacon({0, 0, 0, 0});
      const BodyId listener = scene.post({2, 0, 0, 0});
      scene[scene.spec.bodies[talker.index()].type].devices[0].pose_body_device.z = talker_z;
      scene[scene.spec.bodies[listener.index()].type].devices[0].pose_body_device.z = listener_z;
      scene.wall(0.95, -1, 1.05, 1);
      World world = scene.world();
      world.step();
      EXPECT_EQ(senders(world, listener).size(), talker_z + listener_z > 2 ? 1u : 0u)
          << talker_z << " to " << listener_z;
    }
}

TEST(Radio, WallsWeakenByTheirNumber) {
  RadioScene scene;
  scene.wall(2, -1, 2.1, 1);
  scene.wall(4, -8, 4.1, 8);  // its long edges lie in many pieces
  scene.body("ring", scene.type("ring", {Solid{{test::box_ring(2, 2), test::box_ring(1.8, 1.8)}, {0, 1}}}),
             {7, 0, 0, 0});
  const Params weaken{{"walls", "weaken"}, {"wall_loss_dB", 7.0}};
  // Two walls, and a hollow square that is entered and left.
  ASSERT_EQ(over_10_m(weaken, scene).size(), 1u);
  EXPECT_EQ(over_10_m(weaken, scene)[0].strength, 20 - 4 * 7);
  EXPECT_NEAR(over_10_m(weaken, scene)[0].quality, 1 - 28.0 / 100, 1e-6);
  RadioScene inside;
  inside.wall(-1, -1, 1, 1);  // the listener stands in it
  EXPECT_EQ(over_10_m(weaken, inside)[0].strength, 20 - 7);
  Params deaf = weaken;
  deaf.emplace_back("sensitivity_dBm", -7.5);
  EXPECT_THAT(over_10_m(deaf, scene), IsEmpty());
}

// ---- against a loop over all pairs, and geometry of its own

struct Wall {
  Vec2 middle;
  double heading, length, width;
  std::array<Vec2, 4> corners() const {
    const Vec2 along(std::cos(heading) * length / 2, std::sin(heading) * length / 2);
    const Vec2 across(-std::sin(heading) * width / 2, std::cos(heading) * width / 2);
    return {middle + along + across, middle - along + across, middle - along - across,
            middle + along - across};
  }
};

double turn_of(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// How many sides of the wall the line crosses; -1 where it comes so near to a corner that one may differ.
int sides_crossed(const Vec2& p, const Vec2& q, const Wall& wall) {
  int count = 0;
  const auto corners = wall.corners();
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec2 a = corners[i];
    const Vec2 b = corners[(i + 1) % 4];
    const double near = 1e-9;
    const std::array<double, 4> turns{turn_of(p, q, a), turn_of(p, q, b), turn_of(a, b, p), turn_of(a, b, q)};
    if (std::ranges::any_of(turns, [near](double t) { return std::abs(t) < near; })) return -1;
    count += turns[0] * turns[1] < 0 && turns[2] * turns[3] < 0;
  }
  return count;
}

/// Beacons and walls at random in a square of 10 m, all of it `scale` times as large.
struct RandomWorld {
  std::vector<Vec2> places;
  std::vector<Wall> walls;
  double scale;

  RandomWorld(std::uint32_t seed, double its_scale) : scale(its_scale) {
    Random random(seed, 0, 0, 0);
    for (int i = 0; i < 40; ++i)
      places.emplace_back(random.uniform(-5, 5) * scale, random.uniform(-5, 5) * scale);
    for (int i = 0; i < 12; ++i)
      walls.push_back({Vec2(random.uniform(-5, 5), random.uniform(-5, 5)) * scale, random.uniform(-3, 3),
                       random.uniform(0.2, 4) * scale, random.uniform(0.02, 0.4) * scale});
  }
  RadioScene scene(Params params) const {
    RadioScene out;
    for (const Wall& wall : walls) {
      const std::string name = "wall" + std::to_string(out.spec.bodies.size());
      out.body(name, out.type(name, {box(wall.length, wall.width)}),
               {wall.middle.x(), wall.middle.y(), 0, wall.heading});
    }
    params.insert(params.end(), {{"range", 4.0 * scale}, {"most_heard", 40}, {"beacon", true}});
    const TypeId type = out.type("beacon", {box(0.01, 0.01)});
    out[type].devices = {radio(params)};
    for (std::size_t i = 0; i < places.size(); ++i)
      out.body("b" + std::to_string(i), type, {places[i].x(), places[i].y(), 0, 0});
    return out;
  }
  BodyId id(std::size_t i) const { return BodyId(1 + walls.size() + i); }
};

TEST(Radio, EqualsALoopOverAllPairs) {
  std::size_t links = 0;
  std::size_t hidden = 0;
  for (std::uint32_t seed = 1; seed <= (test::k_slow_build ? 4u : 60u); ++seed) {
    const double scale = seed % 3 == 0 ? 10 : 1;  // links of up to 40 m are looked at in another way
    const RandomWorld random(seed, scale);
    World blocks = random.scene({}).world({.threads = 2, .tile_size_m = seed % 2 == 0 ? 1.0 : 0.0});
    World weakens = random.scene({{"walls", "weaken"}, {"wall_loss_dB", 1.0}}).world();
    blocks.step();
    weakens.step();
    for (std::size_t i = 0; i < random.places.size(); ++i) {
      std::vector<std::uint32_t> expected;
      std::vector<float> strengths;
      bool is_sure = true;
      for (std::size_t j = 0; j < random.places.size(); ++j) {
        const double range = (random.places[i] - random.places[j]).norm();
        if (i == j || range > 4 * scale) continue;
        bool is_blocked = false;
        int walls = 0;
        for (const Wall& wall : random.walls) {
          const int sides = sides_crossed(random.places[i], random.places[j], wall);
          is_sure = is_sure && sides >= 0;
          is_blocked = is_blocked || sides > 0;
          walls += (sides + 1) / 2;
        }
        ++links;
        hidden += is_blocked;
        if (!is_blocked) expected.push_back(random.id(j).value);
        strengths.push_back(static_cast<float>(20 - walls));
      }
      if (!is_sure) continue;
      EXPECT_EQ(senders(blocks, random.id(i)), expected) << "seed " << seed << ", beacon " << i;
      std::vector<float> found;
      for (const RadioPort::Message& message : heard(weakens, random.id(i)))
        found.push_back(message.strength);
      EXPECT_EQ(found, strengths) << "seed " << seed << ", beacon " << i;
    }
    // Who hears is heard.
    for (std::size_t i = 0; i < random.places.size(); ++i)
      for (const std::uint32_t sender : senders(blocks, random.id(i)))
        EXPECT_EQ(std::ranges::count(senders(blocks, BodyId(sender)), random.id(i).value), 1);
  }
  EXPECT_GT(hidden, links / 20);
  EXPECT_LT(hidden, links);
}

TEST(Radio, BodiesHideAsWallsDo) {
  for (std::uint32_t seed = 1; seed <= (test::k_slow_build ? 3u : 30u); ++seed) {
    const RandomWorld random(seed, seed % 3 == 0 ? 10 : 1);
    RadioScene as_bodies = random.scene({{"bodies", "block"}});
    for (std::size_t w = 0; w < random.walls.size(); ++w)
      as_bodies[as_bodies.spec.bodies[w + 1].type].drive = test::drive("diff");
    World walls = random.scene({}).world();
    World bodies = as_bodies.world();
    walls.step();
    bodies.step();
    // The beacons themselves, of 0.01 m, are bodies too: what they hide is heard by walls alone.
    for (std::size_t i = 0; i < random.places.size(); ++i) {
      const std::vector<std::uint32_t> all = senders(walls, random.id(i));
      const std::vector<std::uint32_t> fewer = senders(bodies, random.id(i));
      EXPECT_TRUE(std::ranges::includes(all, fewer)) << "seed " << seed << ", beacon " << i;
      EXPECT_GE(fewer.size() + 3, all.size()) << "seed " << seed << ", beacon " << i;
    }
  }
}

TEST(Radio, ThreadsAndTilesChangeNothing) {
  const RandomWorld random(5, 1);
  const RadioScene scene =
      random.scene({{"bodies", "block"}, {"walls", "weaken"}, {"drop_rate", 0.2}, {"law", "friis"}});
  std::vector<std::uint64_t> first;
  for (const auto& [threads, tile_m] : {std::pair(1u, 0.0), std::pair(2u, 0.5), std::pair(8u, 3.0)}) {
    World world = scene.world({.threads = threads, .tile_size_m = tile_m});
    std::vector<std::uint64_t> states;
    for (int tick = 0; tick < 10; ++tick) {
      world.step();
      states.push_back(world.hashes().state);
    }
    if (first.empty()) first = states;
    EXPECT_EQ(states, first) << threads << " threads";
  }
}

// A radio on the rim of its body speaks at exactly the range of the listener. With tiles of 1.8 m, the origin
// of its body is on the border of a cell.
TEST(Radio, TilesChangeNothingAtExactlyTheRange) {
  RadioScene scene;
  const TypeId type = scene.type("diamond", {{{{{0.38, 0}, {0, 0.38}, {-0.38, 0}, {0, -0.38}}}, {0, 0.3}}});
  scene[type].devices = {radio({{"range", 1.42}, {"beacon", true}}, {-0.38, 0, k_height, 0})};
  scene.body("speaker", type, {1.8, 0, 0, 0});
  const BodyId listener = scene.post({0, 0, 0, 0}, {{"range", 1.42}});
  for (const double tile_m : {0.0, 1.8}) {
    World world = scene.world({.threads = 1, .tile_size_m = tile_m});
    world.step();
    EXPECT_EQ(number(world, listener, k_radio_count), 1u) << "tiles of " << tile_m << " m";
  }
}

std::string error(const engine::DeviceSpec& device, const Solid& solid = box(0.4, 0.4)) {
  RadioScene scene;
  const TypeId type = scene.type("robot", {solid});
  scene[type].devices = {device};
  scene.body("r", type);
  return scene.error();
}

TEST(Radio, WhatCannotBeIsAnError) {
  EXPECT_EQ(error(radio()), "");
  EXPECT_THAT(
      error(radio({{"power_dBm", -90.0}})),
      HasSubstr("device \"radio\" has a sensitivity_dBm of -80, which must be below its power_dBm of -90"));
  EXPECT_THAT(error(radio({}, {2, 0, 0, 0})),
              HasSubstr("device \"radio\" is 2 m from the origin of its body; it must be within 0.282843 m, "
                        "the radius of the body"));
}

TEST(Radio, MayBeOnTheRimOfItsBodyInAnyDirection) {
  const double radius = std::sqrt(0.15 * 0.15 + 0.1 * 0.1);
  for (int k = 0; k < 63; ++k) {
    const Pose rim{radius * std::cos(0.1 * k), radius * std::sin(0.1 * k), k_height, 0};
    EXPECT_EQ(error(radio({}, rim), box(0.3, 0.2)), "") << 0.1 * k << " rad";
  }
}

}  // namespace
}  // namespace troupe::sensors::radio_test
