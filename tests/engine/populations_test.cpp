// Placement of populations in a WorldSpec.

#include "engine/spec/populations.hpp"

#include "base/random.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>

namespace troupe::engine::populations_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Solid square(double side) {
  const double h = 0.5 * side;
  return {{{Vec2(-h, -h), Vec2(h, -h), Vec2(h, h), Vec2(-h, h)}}, {0, 1}};
}

Box area(double x0, double y0, double x1, double y1) {
  Box b;
  b.extend(Vec2(x0, y0));
  b.extend(Vec2(x1, y1));
  return b;
}

/// A world with the ground (type 0), a wall (1) at x = 1, a robot (2) at x = 3, and room around them.
WorldSpec room() {
  WorldSpec spec;
  spec.files = std::make_shared<SourceFiles>();
  spec.files->add("room.txt");
  add_ground(spec);
  TypeSpec wall{.name = "wall"};
  wall.parts.push_back({.kind = "model", .solids = {square(0.5)}, .floor_plan = true});
  spec.types.push_back(wall);
  TypeSpec bot{.name = "bot"};
  bot.parts.push_back({.kind = "model", .solids = {square(0.5)}});
  bot.drive = DriveSpec{.kind = "diff"};
  spec.types.push_back(bot);
  spec.bodies.push_back({.name = spec.names.add("wall"), .type = TypeId(1), .pose_world_body = {1, 0, 0, 0}});
  spec.bodies.push_back(
      {.name = spec.names.add("guard"), .type = TypeId(2), .pose_world_body = {3, 0, 0, 0}});
  return spec;
}

PopulationSpec row_of(std::string name, std::size_t count) {
  PopulationSpec population{.name = std::move(name), .type = TypeId(2), .count = count};
  population.rule = {.region = area(0, 0, 9, 0), .pitch_m = 1, .heading = 0};
  population.where = {0, 7};
  population.where_place = {0, 8};
  return population;
}

std::vector<std::string> errors_of(std::vector<PopulationSpec> populations, WorldSpec spec = room(),
                                   const PlaceOptions& options = {}) {
  Diagnostics diagnostics(spec.files);
  place(populations, spec, diagnostics, options);
  std::vector<std::string> texts;
  for (const Finding& finding : diagnostics.findings()) texts.push_back(diagnostics.text(finding));
  return texts;
}

TEST(Populations, FillTheRoomThatBodiesLeave) {
  WorldSpec spec = room();
  Diagnostics diagnostics(spec.files);
  const std::vector<PopulationSpec> populations{row_of("a", 2), row_of("b", 3)};
  place(populations, spec, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors());
  std::vector<std::pair<std::string, double>> found;
  for (std::size_t b = 3; b < spec.bodies.size(); ++b)
    found.emplace_back(spec.name(BodyId(b)), spec.bodies[b].pose_world_body.x);
  using P = std::pair<std::string, double>;
  EXPECT_THAT(found, ElementsAre(P{"a0", 0}, P{"a1", 2}, P{"b0", 4}, P{"b1", 5}, P{"b2", 6}));
  EXPECT_EQ(spec.bodies[3].type, TypeId(2));
  EXPECT_EQ(spec.bodies[3].where.line, 7u);
}

TEST(Populations, AreThoseOfTheirRule) {
  WorldSpec spec = room();
  PopulationSpec swarm{.name = "s", .type = TypeId(2), .count = 40};
  swarm.rule = {.kind = PlacementRule::Kind::uniform, .region = area(-4, -4, 5, 5)};
  Diagnostics diagnostics;
  place(std::span(&swarm, 1), spec, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors());
  ASSERT_EQ(spec.bodies.size(), 43u);

  const WorldSpec before = room();
  const partition::StaticScene scene({{placed(before.types[1].parts[0].solids[0], {1, 0, 0, 0}), BodyId(1)}},
                                     1);
  const partition::ObstacleShape shape = obstacle_shape(before.types[2]);
  Crowd crowd;
  crowd.add(shape, {3, 0, 0, 0});
  partition::Parallel parallel(1);
  const std::vector<Pose> poses = place(
      {.rule = swarm.rule, .shape = shape, .count = 40, .seed = spec.seed, .population = "s", .scene = scene},
      crowd, parallel);
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(spec.bodies[3 + i].pose_world_body, poses[i]) << i;
}

TEST(Populations, ReservesFollowWithNothingButAHeight) {
  WorldSpec spec = room();
  PopulationSpec some = row_of("a", 2);
  some.reserve = 3;
  some.random_color = true;
  some.rule.z = 2;
  Diagnostics diagnostics;
  place(std::span(&some, 1), spec, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors());
  ASSERT_EQ(spec.bodies.size(), 8u);
  ASSERT_EQ(spec.reserves.size(), 1u);
  EXPECT_EQ(spec.reserves[0].population, "a");
  EXPECT_EQ(spec.reserves[0].first, BodyId(5));
  EXPECT_EQ(spec.reserves[0].count, 3u);
  EXPECT_EQ(spec.name(BodyId(7)), "a4");
  EXPECT_EQ(spec.bodies[7].pose_world_body, (Pose{0, 0, 2, 0}));
  EXPECT_NE(spec.bodies[3].color, spec.bodies[4].color);

  // A body that is yet to be born takes up no room.
  WorldSpec again = spec;
  again.bodies[5].pose_world_body.x = 2;
  PopulationSpec more = row_of("b", 1);
  more.rule.z = 2;
  place(std::span(&more, 1), again, diagnostics);
  EXPECT_EQ(again.bodies[8].pose_world_body.x, 2);
}

// Numbers like these would become indices of cells.
TEST(Populations, OfAProgramHaveLimits) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto error_after = [](auto&& damage) {
    PopulationSpec wrong = row_of("a", 2);
    damage(wrong, wrong.rule);
    return errors_of({wrong});
  };
  using P = PopulationSpec;
  using R = PlacementRule;
  EXPECT_THAT(
      error_after([](P& p, R&) { p.type = TypeId(9); }),
      ElementsAre("room.txt:8: error: populations[0].rule: the world has 3 types, but this population "
                  "has the type 9 (counted from 0)"));
  EXPECT_THAT(error_after([&](P&, R& rule) { rule.pitch_m = nan; }),
              ElementsAre(HasSubstr("populations[0].rule: pitch_m must be from 0 to 1000000, found nan")));
  EXPECT_THAT(error_after([&](P&, R& rule) { rule.pitch_m = 0; }),
              ElementsAre(HasSubstr("pitch_m must not be 0")));
  EXPECT_THAT(error_after([&](P&, R& rule) { rule.pitch_m = -1; }), ElementsAre(HasSubstr("found -1")));
  EXPECT_THAT(error_after([&](P&, R& rule) { rule.region.max.x() = 1e300; }),
              ElementsAre(HasSubstr("region must be from -1000000 to 1000000, found 1e+300")));
  EXPECT_THAT(error_after([&](P&, R& rule) { rule.region.min.y() = nan; }),
              ElementsAre(HasSubstr("region must be from -1000000 to 1000000, found nan")));
  EXPECT_THAT(error_after([&](P&, R& rule) {
                rule.kind = PlacementRule::Kind::poisson_disc;
                rule.distance_m = 0;
              }),
              ElementsAre(HasSubstr("distance_m must be from 0.001 to 1000000, found 0")));
  EXPECT_THAT(error_after([&](P&, R& rule) { rule.z = -HUGE_VAL; }),
              ElementsAre(HasSubstr("z must be from -1000000 to 1000000, found -inf")));
  WorldSpec groundless = room();
  groundless.bodies.erase(groundless.bodies.begin());
  EXPECT_THAT(errors_of({row_of("a", 2)}, groundless),
              ElementsAre(HasSubstr("bodies[0]: must be the ground")));
}

TEST(Populations, ARegionOutsideTheWorldIsTheCause) {
  WorldSpec small = room();
  small.bounds = area(-4, -4, 4, 4);
  PopulationSpec lost = row_of("a", 2);
  lost.rule.region = area(20, 0, 29, 0);
  EXPECT_THAT(
      errors_of({lost}, small),
      ElementsAre(HasSubstr("the region (x 20 to 29, y 0 to 0 m) lies outside the world's bounds (x -4 "
                            "to 4, y -4 to 4 m): check its units and signs")));
}

TEST(Populations, AStartOfTheFloorThatIsBlockedOrOutsideIsTheCause) {
  PopulationSpec lost = row_of("a", 2);
  lost.rule = {.kind = PlacementRule::Kind::free_floor, .region = area(0, -4, 9, 4), .from = Vec2(1, 0)};
  EXPECT_THAT(
      errors_of({lost}),
      ElementsAre(HasSubstr("\"from_m\" [1, 0] is no free floor: a disc as wide as the body overlaps a "
                            "wall there; give a point with more room")));
  lost.rule.from = Vec2(9, 9);
  EXPECT_THAT(errors_of({lost}),
              ElementsAre(HasSubstr("\"from_m\" [9, 9] lies outside the region (x 0 to 9, y -4 "
                                    "to 4 m): give a point in the region")));
  // A free start is not the cause.
  lost.rule.from = Vec2(4, 3);
  lost.count = 1000;
  EXPECT_THAT(errors_of({lost}),
              ElementsAre(HasSubstr("none of 1000 random poses for the next body was free")));
}

TEST(Populations, WithoutBodiesAreKeptByName) {
  WorldSpec spec = room();
  std::vector<PopulationSpec> populations{row_of("a", 1), row_of("b", 0), row_of("c", 0)};
  populations[2].reserve = 1;
  Diagnostics diagnostics;
  place(populations, spec, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors());
  ASSERT_EQ(spec.empty_populations.size(), 1u);
  EXPECT_EQ(spec.empty_populations[0].name, "b");
  EXPECT_EQ(spec.empty_populations[0].type, TypeId(2));
}

TEST(Populations, StaticBodiesOfAReserveTakeUpNoRoom) {
  WorldSpec spec = room();
  TypeSpec beacon{.name = "beacon"};
  beacon.parts.push_back({.kind = "model", .solids = {square(0.5)}});
  spec.types.push_back(beacon);
  PopulationSpec beacons = row_of("s", 0);
  beacons.type = TypeId(3);
  beacons.reserve = 1;
  ASSERT_TRUE(is_static(beacon));
  Diagnostics diagnostics;
  place(std::span(&beacons, 1), spec, diagnostics);
  ASSERT_EQ(spec.bodies.size(), 4u);
  // In a second call, the obstacles are those of the spec.
  const PopulationSpec robots = row_of("a", 1);
  place(std::span(&robots, 1), spec, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors());
  EXPECT_EQ(spec.bodies[4].pose_world_body.x, 0) << "the pose of the body that is not in the world";
}

TEST(Populations, OnlySolidsMakeABodyGrippable) {
  TypeSpec type;
  type.parts = {{.solids = {}, .returns = {.gripper = true}}, {.solids = {square(1)}}};
  EXPECT_FALSE(can_be_gripped(type));
  EXPECT_TRUE(is_static(type));
  type.parts[1].returns.gripper = true;
  EXPECT_TRUE(can_be_gripped(type));
  EXPECT_FALSE(is_static(type));
}

TEST(Populations, ErrorsNameFileLineAndPopulation) {
  EXPECT_THAT(
      errors_of({row_of("a", 1), row_of("b", 9)}),
      ElementsAre("room.txt:8: error: populations[1].rule: placed 7 of 9 bodies: the region has no further "
                  "free cell (it has 10 cells); enlarge the region or lower the count"));
  PopulationSpec named = row_of("b", 9);
  named.path = "/populations/0/place";
  EXPECT_THAT(errors_of({named}),
              ElementsAre("room.txt:8: error: /populations/0/place: placed 8 of 9 bodies: the region has no "
                          "further free cell (it has 10 cells); enlarge the region or lower the count"));
  EXPECT_THAT(errors_of({row_of("a", 3)}, room(), {.most_bodies = 5}),
              ElementsAre("room.txt:7: error: the world would hold 6 bodies; at most 5 are allowed"));
  PopulationSpec dense = row_of("a", 1);
  dense.rule.region = area(0, 0, 9, 9);
  dense.rule.pitch_m = 1e-5;
  EXPECT_THAT(errors_of({dense}),
              ElementsAre("room.txt:8: error: populations[0].rule: the region has 810002 million cells of "
                          "0.00001 m; at most 100 million are allowed: give a larger \"pitch_m\""));
  PopulationSpec floor = row_of("a", 1);
  floor.rule = {.kind = PlacementRule::Kind::free_floor, .region = area(0, 0, 49, 49), .cell_m = 0.01};
  EXPECT_THAT(
      errors_of(std::vector<PopulationSpec>(5, floor)),
      ElementsAre("room.txt:8: error: populations[4].rule: the regions of this population and of the "
                  "free_floor populations before it have 120.1 million cells in total; at most 100 million "
                  "are allowed: give a larger \"cell_m\""));
  PopulationSpec nowhere = row_of("a", 1);
  nowhere.rule.region.min = Vec2(0, 9);
  nowhere.rule.region.max = Vec2(9, 0);
  EXPECT_THAT(
      errors_of({nowhere}),
      ElementsAre("room.txt:8: error: populations[0].rule: the region is empty: x from 0 to 9 m, y from 9 "
                  "to 0 m; x_min must not exceed x_max, and y_min must not exceed y_max"));
}

TEST(SpareBodies, TakeATimeThatIsProportionalToTheNumberOfPopulations) {
  constexpr std::uint32_t k_populations = 200'000;
  WorldSpec spec = room();
  for (std::uint32_t i = 0; i < k_populations; ++i)
    spec.bodies.push_back({.name = spec.names.add(fmt::format("p{}x", i), 0), .type = TypeId(2)});
  add_spare(spec, 1);
  ASSERT_EQ(spec.reserves.size(), k_populations);
  EXPECT_EQ(spec.reserves.front().population, "p0x");
  EXPECT_EQ(spec.name(spec.reserves.front().first), "p0x1");
  add_spare(spec, 1);
  EXPECT_EQ(spec.reserves.size(), k_populations) << "all of them have a reserve";
}

}  // namespace
}  // namespace troupe::engine::populations_test
