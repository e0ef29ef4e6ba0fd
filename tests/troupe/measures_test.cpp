#include "troupe/measures.hpp"

#include "base/diagnostics.hpp"
#include "engine/observing/measures.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scratch.hpp"
#include "troupe/registry.hpp"
#include "troupe/simulation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <stdexcept>

namespace troupe::measures_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class MeasuresOfASimulation : public test::ScratchTest {
 protected:
  Simulation simulation(engine::Registry registry = make_registry(), std::string_view measures = "") const {
    const std::string list = measures.empty() ? "" : R"("measures": )" + std::string(measures) + ", ";
    return Simulation(write("w.json", R"({"troupe": 1, )" + list + R"("types": {
      "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"},
              "controller": {"kind": "script", "legs": [{"until_s": 9, "forward_mps": 0.5}]}}},
      "models": [{"name": "a", "type": "bot"}, {"name": "b", "type": "bot", "pose": {"y_m": 3}}]})"),
                      {}, std::move(registry));
  }
};

TEST_F(MeasuresOfASimulation, AreAskedForByName) {
  Simulation world = simulation();
  Measures measures(world, {"displacement", "mean_nearest_distance", "path_length:b",
                            R"({"kind": "neighbours", "name": "near", "radius_m": 3.5})"});
  EXPECT_THAT(measures.columns(),
              ElementsAre("displacement_m", "mean_nearest_distance_m", "path_length_m:b", "near"));
  for (int i = 0; i < 11; ++i) {
    world.step();
    measures.see();
  }
  EXPECT_NEAR(measures.value("displacement"), 0.5, 1e-12);  // a command takes effect a tick later
  EXPECT_NEAR(measures.value("displacement_m"), 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(measures.value("mean_nearest_distance"), 3);
  EXPECT_NEAR(measures.value("path_length:b"), 0.5, 1e-12);
  EXPECT_EQ(measures.value("near"), 1);
  EXPECT_EQ(measures.values().size(), 4u);
  EXPECT_THAT(test::message_of<std::out_of_range>([&] { measures.value("displacment"); }),
              HasSubstr("unknown measure \"displacment\"; known: displacement_m, "));
}

TEST_F(MeasuresOfASimulation, BeginAgainWithAnotherSeed) {
  const auto world = [this](std::uint64_t seed) {
    return Simulation(write("random.json", R"({"troupe": 1, "arena": {"size_m": [20, 20]}, "types": {
          "bot": {"size_m": [0.2, 0.2, 0.2], "drive": {"kind": "diff"}}},
          "populations": [{"name": "b", "type": "bot", "count": 5, "place": {"rule": "uniform"}}]})"),
                      {.seed = seed});
  };
  Simulation fresh = world(2);
  Simulation reset = world(1);
  const std::vector<std::string> names{"spread", "coverage"};
  Measures of_fresh(fresh, names);
  Measures of_reset(reset, names);
  EXPECT_NE(of_fresh.values(), of_reset.values());
  reset.reset(2);
  of_reset.see();
  EXPECT_EQ(reset.state_hash(), fresh.state_hash());
  EXPECT_EQ(of_reset.values(), of_fresh.values());
  fresh.step();
  reset.step();
  of_fresh.see();
  of_reset.see();
  EXPECT_EQ(of_reset.values(), of_fresh.values());
}

TEST_F(MeasuresOfASimulation, AreThoseOfTheWorldElseAll) {
  Simulation asks = simulation(make_registry(), R"(["order", "stalls:a"])");
  EXPECT_THAT(Measures(asks).columns(), ElementsAre("order", "stalls:a"));
  EXPECT_THAT(Measures(asks, {"spread"}).columns(), ElementsAre("spread_m"));
  Simulation asks_for_none = simulation();
  const auto all = make_registry().measures;
  EXPECT_EQ(Measures(asks_for_none).columns().size(),
            std::ranges::count_if(all, &engine::MeasureKind::is_usual));
}

TEST_F(MeasuresOfASimulation, WithANameInTheWorldHaveItsParameters) {
  Simulation world = simulation(make_registry(), R"([
      {"kind": "neighbours", "radius_m": 2, "name": "near"}, {"kind": "neighbours", "radius_m": 6},
      {"kind": "neighbours", "radius_m": 7, "of": "a"},
      {"kind": "largest_cluster", "distance_m": 1, "bodies": "robots"}])");
  Measures of_world(world);
  Measures named(world, {"largest_cluster", "near", "neighbours", "neighbours:a", "spread"});
  EXPECT_THAT(named.columns(),
              ElementsAre("largest_cluster", "near", "neighbours", "neighbours:a", "spread_m"));
  const std::vector<double> all = of_world.values();
  std::vector<double> values = named.values();
  values.pop_back();
  EXPECT_THAT(values, ElementsAre(all[3], all[0], all[1], all[2]));
  EXPECT_NE(Measures(world, {R"({"kind": "neighbours"})"}).values().front(), all[1]) << "is of 1 m";
}

TEST_F(MeasuresOfASimulation, LeaveOutUsualOnesThatNeedTooMuchMemory) {
  Simulation large(write("large.json", R"({"troupe": 1, "bounds_m": [[-1e5, -1e5], [1e5, 1e5]]})"));
  Simulation small = simulation();
  Measures measures(large);
  EXPECT_EQ(measures.columns().size() + 1, Measures(small).columns().size());
  EXPECT_FALSE(measures.find("coverage"));
  EXPECT_EQ(measures.columns()[*measures.find("displacement")], "displacement_m");
  EXPECT_THROW(Measures(large, {"coverage"}), InputError);
}

TEST_F(MeasuresOfASimulation, ListWhatIsWrong) {
  Simulation world = simulation();
  try {
    const Measures measures(world, {"ordr", "stalls:", "{\"kind\": "});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("measure ordr: error: unknown measure \"ordr\"; known: "));
    EXPECT_THAT(error.what(),
                HasSubstr("\nmeasure stalls:: error: \"stalls:\": expected the name of a type, "));
    EXPECT_THAT(error.what(), HasSubstr("\nmeasure {\"kind\": : error: "));
  }
}

TEST_F(MeasuresOfASimulation, SuggestTheNameOfAMeasureThatTheWorldLists) {
  Simulation world = simulation(make_registry(), R"([{"kind": "coverage", "name": "visited"}])");
  const std::string error = test::message_of<InputError>([&] { const Measures measures(world, {"visitd"}); });
  EXPECT_THAT(error, testing::StartsWith("measure visitd: error: unknown measure \"visitd\"; known: "));
  EXPECT_THAT(error, testing::EndsWith(", visited (did you mean \"visited\"?)"));
}

/// The greatest x of all robots.
class Front : public engine::Measure {
 public:
  Front(const engine::MeasuredWorld&, std::vector<BodyId> robots) : robots_(std::move(robots)) {}
  double value(const engine::MeasuredWorld& world) override {
    double front = -1e9;
    for (const BodyId id : robots_) front = std::max(front, world.transform(world.row(id)).position.x());
    return front;
  }

 private:
  std::vector<BodyId> robots_;
};

TEST_F(MeasuresOfASimulation, MayBeOnesOwn) {
  engine::Registry registry = make_registry();
  registry.measures.push_back(
      engine::make_measure_kind<Front>("front", engine::Unit::meters, "how far east", "The greatest x."));
  Simulation world = simulation(std::move(registry), R"(["front"])");
  Measures measures(world);
  EXPECT_EQ(measures.value("front_m"), 0);
  world.run_for(1.1);
  EXPECT_NEAR(measures.value("front"), 0.5, 1e-12);
}

TEST_F(MeasuresOfASimulation, ThatAreNotThereAreErrors) {
  engine::Registry registry = make_registry();
  registry.measures.push_back(
      engine::make_measure_kind<Front>("front", engine::Unit::meters, "how far east", "The greatest x."));
  registry.measures.back().make = [](const engine::MeasuredWorld&, const engine::Record&,
                                     std::vector<BodyId>) -> std::unique_ptr<engine::Measure> { return {}; };
  Simulation world = simulation(std::move(registry));
  EXPECT_THAT([&] { Measures(world, {"front"}); },
              testing::ThrowsMessage<InputError>(
                  "measure front: error: front: the function `make` of its kind returned no measure"));
  const Measures measures(world, {"displacement"});
  EXPECT_FALSE(measures.has_memory(0));
  EXPECT_THAT([&] { static_cast<void>(measures.has_memory(1)); },
              testing::ThrowsMessage<std::out_of_range>(
                  "there is no column 1: the measures have 1 columns, counted from 0"));
}

}  // namespace
}  // namespace troupe::measures_test
