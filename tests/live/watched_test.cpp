#include "live/watched.hpp"

#include "troupe/simulation.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstddef>
#include <string>

namespace troupe::live {
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

}  // namespace
}  // namespace troupe::live
