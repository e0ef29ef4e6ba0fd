#include "live/watched.hpp"

#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/registry.hpp"
#include "troupe/simulation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace troupe::live::watched_test {
namespace {

constexpr const char* k_radios = R"({"troupe": 1, "bounds_m": [[-9, -9], [9, 9]],
  "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"},
                    "sensors": [{"kind": "radio", "name": "com", "range_m": 5, "beacon": true}]}},
  "models": [{"name": "a", "type": "bot"}, {"name": "b", "type": "bot", "pose": {"x_m": 2}},
             {"name": "c", "type": "bot", "pose": {"x_m": 4}}]})";

/// Number of lines from senders to receivers.
std::size_t links(const Simulation& simulation) {
  const std::array<std::string, 1> layers{"radio"};
  return lines_of(simulation.world(), layers)["radio"].size() / 6;
}

TEST(LinesOf, ADisabledRobotHasNoRadioLinks) {
  Simulation simulation = Simulation::from_text(k_radios, "w.json", {.threads = 1, .mortal = true});
  simulation.run_for(0.5);
  EXPECT_EQ(links(simulation), 6u);
  simulation.act({.kind = engine::Act::Kind::disable, .whom = "a"});
  simulation.run_for(0.5);
  EXPECT_EQ(links(simulation), 2u) << "between the other two";
  simulation.act({.kind = engine::Act::Kind::enable, .whom = "a"});
  simulation.run_for(0.5);
  EXPECT_EQ(links(simulation), 6u);
}

TEST(LinesOf, DevicesOfOtherKindsThatReceiveMessagesHaveLinks) {
  engine::Registry registry = make_registry();
  engine::DeviceKind modem = *registry.device("radio");
  modem.name = "modem";
  registry.devices.push_back(modem);
  std::string text = k_radios;
  text.replace(text.find("radio"), std::string("radio").size(), "modem");  // its kind
  Simulation simulation = Simulation::from_text(text, "w.json", {.threads = 1}, registry);
  EXPECT_THAT(layers_of(simulation.world()), testing::ElementsAre("radio"));
  simulation.run_for(0.5);
  EXPECT_EQ(links(simulation), 6u);
}

// The difference of the largest and the smallest value is infinite.
TEST(TakeShades, ValuesFarApartHaveDifferentShades) {
  Simulation simulation = Simulation::from_text(k_radios, "w.json", {.threads = 1});
  simulation.find("a").set_speed(1.5e308, 0);
  simulation.find("b").set_speed(-1.5e308, 0);
  constexpr std::size_t k_robots = 3;
  const std::array<std::uint32_t, 4> places{k_robots, 0, 1, 2};  // body 0 is the ground
  ColorValue color{.component = "command", .field = "x", .column = {}};
  std::vector<std::uint8_t> shades;
  take_shades(simulation.world(), places, k_robots, color, shades);
  EXPECT_THAT(shades, testing::ElementsAre(255, 1, 128));
  for (const char* name : {"a", "b"}) simulation.find(name).set_speed(0, 0);
  color = {.component = "command", .field = "x", .column = {}};
  take_shades(simulation.world(), places, k_robots, color, shades);
  EXPECT_THAT(shades, testing::ElementsAre(1, 1, 1));
}

// If each field were sought among all fields so far, this would take minutes.
TEST(ColorValues, ThoseOfThousandsOfDevicesAreListedQuickly) {
  constexpr std::size_t k_types = test::k_slow_build ? 500 : 8'000;
  const auto count = [](std::size_t types) {
    test::SceneBuilder scene;
    for (std::size_t i = 0; i < types; ++i) {
      const TypeId type = scene.robot("t" + std::to_string(i), {test::box(0.2, 0.2)});
      scene[type].devices = {test::device("radio")};
      scene[type].devices.front().name = "radio" + std::to_string(i);
      scene.body("r" + std::to_string(i), type, {0, 1.0 * static_cast<double>(i), 0, 0});
    }
    return color_values(scene.world()).size();
  };
  const std::size_t one = count(1);
  const std::size_t per_radio = count(2) - one;
  EXPECT_EQ(count(k_types), one + (k_types - 1) * per_radio);
}

}  // namespace
}  // namespace troupe::live::watched_test
