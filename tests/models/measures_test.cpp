#include "engine/observing/measures.hpp"

#include "tests/support/devices.hpp"
#include "tests/support/draw.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/slow_build.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <utility>

namespace troupe::models::measures_test {
namespace {

using engine::MeasureSet;
using engine::MeasureSpec;
using engine::World;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t k_minibots = test::k_slow_build ? 60 : 1500;  // several blocks of a sum
constexpr double k_edge_m = test::k_slow_build ? 6 : 20;

Ring turned_box(double x, double y, double size_x, double size_y, double angle) {
  Ring ring = test::box_ring(size_x, size_y);
  for (Vec2& v : ring)
    v = Vec2(x + std::cos(angle) * v.x() - std::sin(angle) * v.y(),
             y + std::sin(angle) * v.x() + std::cos(angle) * v.y());
  return ring;
}

/// Minibots and some trucks that drive about at random among two crates that stand askew; they start
/// anywhere, so that some overlap.
test::SceneBuilder crowd(bool bounded = true) {
  test::SceneBuilder scene;
  test::Draw draw(5);
  const double half = k_edge_m / 2;
  const TypeId crate = scene.type("crate", {Solid{{turned_box(0, 0, k_edge_m / 4, 0.7, 0.3)}, {0, 1}}});
  scene.body("crate0", crate, {0.2 * k_edge_m, 1, 0, 0});
  scene.body("crate1", crate, {-0.2 * k_edge_m, -1, 0, 1});
  const TypeId minibot = scene.robot("minibot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}}, "omni");
  const TypeId truck = scene.robot("truck", {Solid{{test::box_ring(2.5, 0.8)}, {0, 1}}});
  const auto anywhere = [&] {
    return Pose{draw.real(-half, half), draw.real(-half, half), 0, draw.real(-3, 3)};
  };
  for (std::size_t i = 0; i < k_minibots; ++i) scene.body(fmt::format("m{}", i), minibot, anywhere());
  for (std::size_t i = 0; i < 10; ++i) scene.body(fmt::format("t{}", i), truck, anywhere());
  if (bounded) scene.spec.bounds = Box::around(Vec2::Zero(), half);
  return scene;
}

void step_at_random(World& world, test::Draw& draw) {
  for (std::size_t b = 0; b < world.spec().bodies.size(); ++b) {
    const Row row = world.view().row(BodyId(b));
    if (row.valid() && draw.below(4) != 0)
      world.set_command(row, {draw.real(-1, 1), draw.real(-1, 1), draw.real(-2, 2)});
  }
  world.step();
}

MeasureSpec spec(std::string kind, std::string of = {},
                 std::initializer_list<std::pair<std::string_view, engine::Value>> values = {}) {
  const engine::MeasureKind* known = test::registry().measure(kind);
  return {.kind = std::move(kind),
          .of = std::move(of),
          .params = known ? test::record(known->params, values) : engine::Record{}};
}

bool needs_nothing(const engine::MeasureKind& kind) { return kind.is_usual(); }

std::vector<double> origin() { return {0, 0}; }

/// The same of all, of the minibots and of the trucks; those that need no parameters first. Then one of all.
std::vector<MeasureSpec> all_specs() {
  std::vector<MeasureSpec> specs;
  for (const char* of : {"", "minibot", "t"}) {
    for (const engine::MeasureKind& kind : test::registry().measures) {
      if (!needs_nothing(kind)) continue;
      specs.push_back(spec(std::string(kind.name), of));
      if (kind.name == "coverage") specs.back().params = test::record(kind.params, {{"cell", 0.37}});
    }
    specs.push_back(spec("share_within", of, {{"center", origin()}, {"radius", k_edge_m / 4}}));
    specs.push_back(spec("state_mean", of, {{"component", "velocity"}, {"field", "turn"}}));
  }
  specs.push_back(spec("rank_errors", "", {{"center", origin()}}));  // of one type alone there are none
  return specs;
}

MeasureSet measures(World& world, const std::vector<MeasureSpec>& specs) {
  Diagnostics diagnostics;
  MeasureSet set(world, test::registry(), specs, diagnostics);
  diagnostics.throw_if_errors();
  return set;
}

double value(World& world, const MeasureSpec& one) { return measures(world, {one}).value(0); }

/// What the definitions say, all robots against all, from poses alone.
class Oracle {
 public:
  Oracle(const World& world, std::string prefix) : prefix_(std::move(prefix)), start_(poses(world)) {
    see(world);
  }

  void see(const World& world) {
    const std::vector<Pose> now = poses(world);
    for (std::size_t i = 0; i < now.size(); ++i) {
      way_ += std::hypot(now[i].x - last(i).x, now[i].y - last(i).y);
      visited_.insert({std::floor(now[i].x / k_cell_m), std::floor(now[i].y / k_cell_m)});
    }
    before_ = now_;
    now_ = now;
  }

  double mean_nearest_distance() const {
    double sum = 0;
    for (const Pose& a : now_) {
      double nearest = 1e9;
      for (const Pose& b : now_)
        if (&a != &b) nearest = std::min(nearest, std::hypot(a.x - b.x, a.y - b.y));
      sum += nearest;
    }
    return sum / size();
  }
  double neighbours() const {
    std::size_t count = 0;
    for (const Pose& a : now_)
      for (const Pose& b : now_) count += &a != &b && std::hypot(a.x - b.x, a.y - b.y) <= 1;
    return static_cast<double>(count) / size();
  }
  double displacement() const {
    double sum = 0;
    for (std::size_t i = 0; i < now_.size(); ++i)
      sum += std::hypot(now_[i].x - start_[i].x, now_[i].y - start_[i].y);
    return sum / size();
  }
  double path_length() const { return way_ / size(); }
  double mean_speed(double tick_s) const {
    double sum = 0;
    for (std::size_t i = 0; i < before_.size(); ++i)
      sum += std::hypot(now_[i].x - before_[i].x, now_[i].y - before_[i].y) / tick_s;
    return sum / size();
  }
  double order() const {
    double x = 0;
    double y = 0;
    for (const Pose& pose : now_) {
      x += std::cos(pose.heading);
      y += std::sin(pose.heading);
    }
    return std::hypot(x, y) / size();
  }
  double spread() const {
    double x = 0;
    double y = 0;
    for (const Pose& pose : now_) {
      x += pose.x / size();
      y += pose.y / size();
    }
    double sum = 0;
    for (const Pose& pose : now_) sum += std::hypot(pose.x - x, pose.y - y);
    return sum / size();
  }
  double share_within(double radius) const {
    const auto inside = [&](const Pose& pose) { return std::hypot(pose.x, pose.y) <= radius; };
    return static_cast<double>(std::ranges::count_if(now_, inside)) / size();
  }
  /// All pairs of the first `lower` robots and the others.
  double rank_errors(std::size_t lower) const {
    double wrong = 0;
    for (std::size_t a = 0; a < lower; ++a)
      for (std::size_t b = lower; b < now_.size(); ++b)
        wrong += std::hypot(now_[b].x, now_[b].y) < std::hypot(now_[a].x, now_[a].y);
    return wrong / static_cast<double>(lower * (now_.size() - lower));
  }
  double coverage(const World& world) const {
    std::size_t free = 0;
    std::size_t visited = 0;
    const Box& ground = *world.spec().bounds;
    for (double x = std::floor(ground.min.x() / k_cell_m); x <= ground.max.x() / k_cell_m; ++x)
      for (double y = std::floor(ground.min.y() / k_cell_m); y <= ground.max.y() / k_cell_m; ++y) {
        const Vec2 centre((x + 0.5) * k_cell_m, (y + 0.5) * k_cell_m);
        bool is_free = ground.contains(centre);
        for (const partition::FixedSolid& solid : world.view().scene().solids())
          is_free = is_free && !contains(solid.solid, centre);
        free += is_free;
        visited += is_free && visited_.contains({x, y});
      }
    return static_cast<double>(visited) / static_cast<double>(free);
  }

 private:
  static constexpr double k_cell_m = 0.37;

  std::vector<Pose> poses(const World& world) const {
    std::vector<Pose> poses;
    for (std::size_t b = 0; b < world.spec().bodies.size(); ++b)
      if (world.view().row(BodyId(b)).valid() && world.spec().name(BodyId(b)).starts_with(prefix_))
        poses.push_back(world.view().pose(BodyId(b)));
    return poses;
  }
  const Pose& last(std::size_t i) const { return now_.empty() ? start_[i] : now_[i]; }
  double size() const { return static_cast<double>(now_.size()); }

  std::string prefix_;
  std::vector<Pose> start_, before_, now_;
  double way_ = 0;
  std::set<std::pair<double, double>> visited_;
};

TEST(Measures, AreWhatTheirDefinitionsSay) {
  World world = crowd().world();
  const std::vector<MeasureSpec> specs = all_specs();
  MeasureSet set = measures(world, specs);
  std::vector<Oracle> oracles{{world, ""}, {world, "m"}, {world, "t"}};
  test::Draw draw(6);
  std::size_t stalls = 0;
  std::size_t held = 0;
  for (int tick = 0; tick <= 6; ++tick) {
    const std::vector<double> values = set.values();
    const std::size_t kinds = values.size() / oracles.size();
    for (std::size_t o = 0; tick % 3 == 0 && o < oracles.size(); ++o) {
      const double* v = &values[o * kinds];
      SCOPED_TRACE(fmt::format("tick {}, of \"{}\"", tick, specs[o * kinds].of));
      EXPECT_EQ(v[0], oracles[o].coverage(world));
      EXPECT_NEAR(v[1], oracles[o].mean_nearest_distance(), 1e-9);
      EXPECT_EQ(v[2], oracles[o].neighbours());
      EXPECT_NEAR(v[5], oracles[o].displacement(), 1e-9);
      EXPECT_NEAR(v[6], oracles[o].path_length(), 1e-9);
      EXPECT_NEAR(v[7], oracles[o].mean_speed(world.view().tick_s()), 1e-9);
      EXPECT_NEAR(v[8], oracles[o].order(), 1e-9);
      EXPECT_NEAR(v[9], oracles[o].spread(), 1e-9);
      EXPECT_EQ(v[11], oracles[o].share_within(k_edge_m / 4));
    }
    EXPECT_NEAR(values.back(), oracles[0].rank_errors(k_minibots), 1e-9);
    EXPECT_EQ(values[3], static_cast<double>(world.view().counts().stalled));
    EXPECT_EQ(values[4], static_cast<double>(world.view().counts().out_of_bounds));
    EXPECT_EQ(values[3], values[kinds + 3] + values[2 * kinds + 3]);
    stalls += world.view().counts().stalled;
    held += world.view().counts().out_of_bounds;
    step_at_random(world, draw);
    set.see();
    for (Oracle& oracle : oracles) oracle.see(world);
  }
  EXPECT_GT(stalls, held);
  EXPECT_GT(held, 0u);
}

TEST(Measures, ToBePutElsewhereIsNoWay) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.4, 0.4)});
  const BodyId a = scene.body("a", bot);
  scene.body("b", bot, {0, 3, 0, 0});
  World world = scene.world();
  const std::vector<MeasureSpec> specs{spec("path_length", "a"), spec("path_length"),
                                       spec("displacement", "a")};
  MeasureSet set = measures(world, specs);
  const Row row = world.view().row(a);
  world.set_command(row, {0.5, 0, 0});
  const auto step = [&] {
    world.step();
    set.see();
  };
  const auto put = [&](const Pose& pose) {
    const World::Placed there{row, pose};
    world.set_poses({&there, 1});
  };
  step();
  EXPECT_NEAR(set.value(0), 0.05, 1e-12);
  put({-5, 5, 0, 0});
  put({7, 2, 0, 1});  // of several the last one counts
  step();
  EXPECT_NEAR(set.value(0), 0.10, 1e-12);
  EXPECT_NEAR(set.value(1), 0.05, 1e-12) << "mean of both";
  EXPECT_NEAR(set.value(2), std::hypot(7 + 0.05 * std::cos(1), 2 + 0.05 * std::sin(1)), 1e-12);
  MeasureSet later = measures(world, specs);
  EXPECT_EQ(later.value(0), 0);
  step();
  later.see();
  EXPECT_NEAR(set.value(0), 0.15, 1e-12);
  EXPECT_NEAR(later.value(0), 0.05, 1e-12);
  put({0, 0, 0, 0});
  world.reset();
  step();
  set.see();
  EXPECT_NEAR(measures(world, specs).value(0), 0, 1e-12);
}

TEST(Measures, AResetBeforeTheFirstStepBeginsThemAgain) {
  test::SceneBuilder scene;
  const BodyId a = scene.body("a", scene.robot("bot", {test::box(0.4, 0.4)}));
  scene.spec.bounds = Box::around(Vec2::Zero(), 10);
  World world = scene.world();
  const World::Placed there{world.view().row(a), {-5, 5, 0, 0}};
  world.set_poses({&there, 1});
  const std::vector<MeasureSpec> specs{spec("coverage")};
  MeasureSet set = measures(world, specs);
  world.reset();
  set.see();
  EXPECT_EQ(set.values(), measures(world, specs).values());
  const double at_start = set.value(0);
  world.step();
  set.see();
  EXPECT_EQ(set.value(0), at_start) << "the robot has never been anywhere else";
}

TEST(Measures, AreTheSameBitsOnAnyThreadsAndTiles) {
  std::vector<std::vector<std::uint64_t>> runs;
  for (const engine::WorldOptions& options : {engine::WorldOptions{1, 0}, engine::WorldOptions{2, 0},
                                              engine::WorldOptions{8, 1.1}, engine::WorldOptions{3, 40}}) {
    World world = crowd().world(options);
    MeasureSet set = measures(world, all_specs());
    test::Draw draw(7);
    std::vector<std::uint64_t> bits;
    for (int tick = 0; tick < 5; ++tick) {
      step_at_random(world, draw);
      set.see();
      for (const double v : set.values()) bits.push_back(std::bit_cast<std::uint64_t>(v));
    }
    runs.push_back(bits);
  }
  EXPECT_THAT(runs, ::testing::Each(runs.front()));
}

/// A measure that calls `change` instead of only reading.
class Changing : public engine::Measure {
 public:
  Changing(const engine::MeasuredWorld&, std::vector<BodyId>) {}
  double value(const engine::MeasuredWorld& world) override {
    change(engine::whole_world(world));
    return 0;
  }
  static inline void (*change)(World& world) = nullptr;
};

TEST(Measures, ThatChangeTheWorldThrow) {
  engine::Registry registry = test::registry();
  registry.measures.push_back(
      engine::make_measure_kind<Changing>("changing", engine::Unit::none, "changes the world", ""));
  World world = crowd().world();
  Diagnostics diagnostics;
  MeasureSet set(world, registry, std::vector<MeasureSpec>{{.kind = "changing"}}, diagnostics);
  const std::uint64_t before = world.hashes().state;
  constexpr void (*k_changes[])(World&) = {[](World& w) { w.step(); }, [](World& w) { w.reset(); },
                                           [](World& w) { static_cast<void>(w.set({}, test::registry())); },
                                           [](World& w) {
                                             w.set_command(Row(0), {1, 0, 0});
                                           },
                                           [](World& w) {
                                             w.set_poses(std::vector<World::Placed>{{Row(0), {1, 1, 0, 0}}});
                                           }};
  for (const auto change : k_changes) {
    Changing::change = change;
    EXPECT_THAT(test::message_of<std::runtime_error>([&] { set.value(0); }),
                HasSubstr("tick 0: measure \"changing\" threw: a measure must not change the world"));
    EXPECT_EQ(world.hashes().state, before);
  }
  EXPECT_NO_THROW(world.step());
}

TEST(Measures, ChangeNoState) {
  World watched = crowd().world();
  World plain = crowd().world();
  MeasureSet set = measures(watched, all_specs());
  test::Draw watched_draw(8);
  test::Draw plain_draw(8);
  for (int tick = 0; tick < 3; ++tick) {
    step_at_random(watched, watched_draw);
    set.see();
    set.values();
    step_at_random(plain, plain_draw);
    EXPECT_EQ(watched.hashes().state, plain.hashes().state);
  }
}

TEST(Measures, GoOnWithWhatTheyRememberedAsIfTheyHadNeverStopped) {
  World world = crowd().world();
  MeasureSet whole = measures(world, all_specs());
  test::Draw draw(9);
  for (int tick = 0; tick < 3; ++tick) {
    step_at_random(world, draw);
    whole.see();
  }
  const std::vector<std::byte> memory = whole.memory();
  MeasureSet resumed = measures(world, all_specs());
  EXPECT_NE(resumed.values(), whole.values());
  EXPECT_THAT(resumed.remember(memory), IsEmpty());
  for (int tick = 0; tick < 3; ++tick) {
    EXPECT_EQ(resumed.values(), whole.values());
    step_at_random(world, draw);
    whole.see();
    resumed.see();
  }
}

TEST(Measures, AreRecognisedByTheirKindRobotsAndParameters) {
  World world = crowd().world();
  const auto covered = [&](double cell, const char* of) {
    MeasureSpec measure = spec("coverage", of);
    measure.params = test::record(test::registry().measure("coverage")->params, {{"cell", cell}});
    return measure;
  };
  const MeasureSet saved = measures(world, {spec("stalls"), covered(0.5, ""), covered(1, "minibot")});
  const std::vector<std::byte> memory = saved.memory();
  MeasureSpec named = covered(1, "minibot");
  named.name = "seen";
  MeasureSpec fine = covered(0.5, "");
  fine.name = "fine";
  MeasureSet others =
      measures(world, {named, covered(1, ""), covered(0.5, "minibot"), spec("stalls"), spec("order"), fine});
  EXPECT_THAT(others.remember(memory), ElementsAre(1, 2, 4));
  EXPECT_TRUE(others.has_memory(1));
  EXPECT_FALSE(others.has_memory(4)) << "order";
  MeasureSet of_part = measures(world, {spec("stalls"), covered(1, "minibot")});
  EXPECT_THAT(of_part.remember(std::span(memory).first(memory.size() - 1)), ElementsAre(1)) << "cut off";
  EXPECT_THAT(of_part.remember({}), ElementsAre(0, 1));
}

TEST(Measures, DoNotRememberTheCellsOfOtherBounds) {
  const auto world_at = [](double x) {
    test::SceneBuilder scene;
    scene.body("r", scene.robot("bot", {test::box(0.2, 0.2)}), {2.5, 0.5, 0, 0});
    scene.spec.bounds = Box{Vec2(x, 0), Vec2(x + 4, 1)};
    return scene.world();
  };
  World saved_world = world_at(0);
  const MeasureSet saved = measures(saved_world, {spec("coverage"), spec("path_length")});
  World same = world_at(0);
  World shifted = world_at(2);
  MeasureSet of_same = measures(same, {spec("coverage"), spec("path_length")});
  MeasureSet of_shifted = measures(shifted, {spec("coverage"), spec("path_length")});
  const double begun = of_shifted.value(0);
  EXPECT_EQ(begun, 0.25) << "one of four cells";
  EXPECT_THAT(of_same.remember(saved.memory()), IsEmpty());
  EXPECT_THAT(of_shifted.remember(saved.memory()), ElementsAre(0)) << "as many cells, but others";
  const World::Placed next{shifted.view().row(shifted.state().names.find("r")), {4.5, 0.5, 0, 0}};
  EXPECT_EQ(of_shifted.value(0), begun);
  shifted.set_poses({&next, 1});
  shifted.step();
  of_shifted.see();
  EXPECT_EQ(of_shifted.value(0), 0.5) << "it goes on from the cell in which it began";
}

/// A measure whose memory grows by one number per tick, which a measure must not do.
class Growing : public engine::Measure {
 public:
  Growing(const engine::MeasuredWorld&, std::vector<BodyId>) {}
  void see(const engine::MeasuredWorld&) override { numbers_.push_back(0); }
  double value(const engine::MeasuredWorld&) override { return 0; }
  std::span<std::byte> memory() override { return std::as_writable_bytes(std::span(numbers_)); }

 private:
  std::vector<double> numbers_;
};

TEST(Measures, WhoseMemoryGrowsCannotBeSaved) {
  engine::Registry registry = test::registry();
  registry.measures.push_back(
      engine::make_measure_kind<Growing>("growing", engine::Unit::none, "stores a number in each tick", ""));
  World world = crowd().world();
  Diagnostics diagnostics;
  const MeasureSet set(world, registry, std::vector<MeasureSpec>{{.kind = "growing"}}, diagnostics);
  EXPECT_THAT(test::message_of<std::runtime_error>([&] { static_cast<void>(set.memory()); }),
              HasSubstr("the memory of the measure \"growing\" has 8 bytes, but had 0"));
}

/// A measure whose memory() throws in the call with the number `throws_in`, counted from 1.
class Forgetting : public engine::Measure {
 public:
  static inline int throws_in = 0;

  Forgetting(const engine::MeasuredWorld&, std::vector<BodyId>) {}
  double value(const engine::MeasuredWorld&) override { return 0; }
  std::span<std::byte> memory() override {
    if (--throws_in == 0) throw std::runtime_error("forgotten");
    return {};
  }
};

TEST(Measures, WhoseMemoryThrowsAreNamed) {
  engine::Registry registry = test::registry();
  registry.measures.push_back(engine::make_measure_kind<Forgetting>("forgetting", engine::Unit::none,
                                                                    "has a memory that throws", ""));
  World world = crowd().world();
  const std::vector<MeasureSpec> specs{{.kind = "forgetting"}};
  Diagnostics diagnostics;
  Forgetting::throws_in = 1;
  const MeasureSet none(world, registry, specs, diagnostics);
  ASSERT_EQ(diagnostics.findings().size(), 1u);
  EXPECT_EQ(diagnostics.findings()[0].message, "measure \"forgetting\" threw: forgotten");
  Forgetting::throws_in = 0;
  MeasureSet set(world, registry, specs, diagnostics);
  const auto error_of = [](auto&& call) -> std::string {
    Forgetting::throws_in = 1;
    try {
      call();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(error_of([&] { static_cast<void>(set.memory()); }),
            "tick 0: measure \"forgetting\" threw: forgotten");
  EXPECT_EQ(error_of([&] { set.remember({}); }), "tick 0: measure \"forgetting\" threw: forgotten");
}

TEST(Measures, BeginAgainAfterAReset) {
  World world = crowd().world();
  MeasureSet set = measures(world, all_specs());
  const std::vector<double> start = set.values();
  test::Draw draw(10);
  for (int tick = 0; tick < 3; ++tick) {
    step_at_random(world, draw);
    set.see();
  }
  EXPECT_NE(set.values(), start);
  world.reset();
  set.see();
  EXPECT_EQ(set.values(), start);
}

TEST(Measures, TheNearestIsFoundHoweverFarItIs) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}});
  scene.body("a", bot, {-90000, 3, 0, 0});
  scene.body("b", bot, {90000, 3, 0, 0});
  scene.body("c", bot, {90000.25, 3, 0, 0});
  World world = scene.world();
  EXPECT_DOUBLE_EQ(value(world, spec("mean_nearest_distance")), (180000 + 0.25 + 0.25) / 3);
  EXPECT_DOUBLE_EQ(value(world, spec("neighbours", "", {{"radius", 0.25}})), 2.0 / 3);
  EXPECT_DOUBLE_EQ(value(world, spec("neighbours", "", {{"radius", 0.2499}})), 0);
}

TEST(Measures, OfFewRobotsAreNumbersOrNone) {
  test::SceneBuilder scene;
  World empty = scene.world();
  for (const engine::MeasureKind& kind : test::registry().measures) {
    if (!needs_nothing(kind)) continue;
    const double v = value(empty, spec(std::string(kind.name)));
    if (kind.name == "stalls" || kind.name == "held" || kind.name == "alive")
      EXPECT_EQ(v, 0) << kind.name;
    else
      EXPECT_TRUE(std::isnan(v)) << kind.name;
  }
  scene.body("lone", scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}}), {5, 5, 0, 1});
  World one = scene.world();
  EXPECT_TRUE(std::isnan(value(one, spec("mean_nearest_distance"))));
  EXPECT_EQ(value(one, spec("neighbours")), 0);
  EXPECT_DOUBLE_EQ(value(one, spec("order")), 1);
  EXPECT_EQ(value(one, spec("spread")), 0);
}

TEST(Measures, AreOfThoseWhoAreInTheWorld) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}}, "omni");
  scene.body("bot0", bot, {1, 0, 0, 0});
  scene.body("bot1", bot, {2, 0, 0, 0});
  scene.spec.reserves = {{"bot", BodyId(3), 2}};
  scene.body("bot2", bot);
  scene.body("bot3", bot);
  World world = scene.world();
  MeasureSet set = measures(world, {spec("alive"), spec("displacement"), spec("path_length"),
                                    spec("mean_nearest_distance"), spec("spread"), spec("neighbours")});
  using ::testing::DoubleNear;
  const auto near = [](double x) { return DoubleNear(x, 1e-12); };
  EXPECT_THAT(set.values(), ElementsAre(2, 0, 0, near(1), near(0.5), 2 / 2));
  world.spawn(0, {5, 0, 0, 0});
  for (const char* name : {"bot0", "bot2"})
    world.set_command(world.view().row(world.state().names.find(name)), {0, 1, 0});
  for (int tick = 0; tick < 10; ++tick) {
    world.step();
    set.see();
  }
  // Those at x = 1 and x = 5 have gone a metre; the one at x = 2 stands.
  const double to_first = std::hypot(1, 1), to_last = std::hypot(3, 1);
  EXPECT_THAT(set.values(), ElementsAre(3, near(2.0 / 3), near(2.0 / 3), near((2 * to_first + to_last) / 3),
                                        ::testing::_, 0));
  world.remove(world.view().row(world.state().names.find("bot1")));
  for (int tick = 0; tick < 5; ++tick) {
    world.step();
    set.see();
  }
  EXPECT_THAT(set.values(), ElementsAre(2, near(1.5), near(1.5), near(4), near(2), 0));
  world.remove(world.view().row(world.state().names.find("bot2")));
  world.step();
  set.see();
  EXPECT_THAT(set.values()[0], 1);
  EXPECT_TRUE(std::isnan(set.values()[3])) << "there is no other";
}

TEST(Measures, ToBeMovedRightAfterBirthIsNoWay) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)}, "omni");
  scene.spec.reserves = {{"bot", BodyId(1), 1}};
  scene.body("bot0", bot);
  World world = scene.world();
  MeasureSet set = measures(world, {spec("path_length")});
  const BodyId born = world.spawn(0, {0, 50, 0, 0}).body;
  const World::Placed there{world.view().row(born), {0, 80, 0, 0}};
  world.set_poses({&there, 1});
  world.set_command(world.view().row(born), {0, 1, 0});
  for (int tick = 1; tick <= 3; ++tick) {
    world.step();
    set.see();
    EXPECT_NEAR(set.value(0), 0.1 * tick, 1e-12);
  }
}

TEST(Measures, APathThatBeginsAfterARobotWasBornAndMovedLacksThisWay) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)}, "omni");
  scene.spec.reserves = {{"bot", BodyId(1), 1}};
  scene.body("bot0", bot);
  World world = scene.world();
  MeasureSet whole = measures(world, {spec("path_length")});
  world.step();
  whole.see();
  const BodyId born = world.spawn(0, {0, 50, 0, 0}).body;
  const World::Placed there{world.view().row(born), {0, 80, 0, 0}};
  world.set_poses({&there, 1});
  MeasureSet fresh = measures(world, {spec("path_length")});
  EXPECT_EQ(fresh.value(0), 0);
  // A run that is resumed here does not know that a program has moved the robot.
  std::vector<engine::StateTable> saved(world.tables().begin(), world.tables().end());
  const std::uint64_t hash = world.hashes().state;
  World resumed = scene.world();
  ASSERT_TRUE(
      resumed.restore(world.tick(), world.counters(), hash, [&](std::span<engine::StateTable> tables) {
        for (std::size_t t = 0; t < tables.size(); ++t)
          std::ranges::copy(saved[t].data(), tables[t].data().begin());
      }));
  MeasureSet remembered = measures(resumed, {spec("path_length")});
  EXPECT_THAT(remembered.remember(whole.memory()), IsEmpty());
  for (World* const each : {&world, &resumed}) {
    each->set_command(each->view().row(born), {0, 1, 0});
    each->step();
  }
  for (MeasureSet* const set : {&whole, &fresh, &remembered}) {
    set->see();
    EXPECT_NEAR(set->value(0), 0.1, 1e-12);
  }
}

TEST(Measures, ACarriedRobotHasTheSpeedZero) {
  test::SceneBuilder scene;
  const TypeId grabber = scene.robot("grabber", {test::box(0.3, 0.3, 0.2)});
  test::add_device(scene[grabber], "hand", "gripper", {0.25, 0, 0, 0});
  scene[grabber].controllers = {test::operate({test::order(0.1, "hand", "close")})};
  const TypeId prey = scene.robot("prey", {test::box(0.09, 0.09, 0.1)});
  scene[prey].parts[0].returns.gripper = true;
  const BodyId a = scene.body("a", grabber);
  const BodyId b = scene.body("b", prey, {0.27, 0, 0, 0});
  World world = scene.world();
  for (int tick = 0; tick < 40; ++tick) world.step();
  ASSERT_EQ(world.view().carrier(world.view().row(b)), a);
  world.set_command(world.view().row(a), {-0.1, 0, 0});
  world.set_command(world.view().row(b), {0.3, 0, 0});
  world.step();
  EXPECT_NE(world.view().velocities()[world.view().row(b).index()].x, 0);
  EXPECT_EQ(value(world, spec("mean_speed", "b")), 0);
  EXPECT_DOUBLE_EQ(value(world, spec("mean_speed")), 0.05);
}

TEST(Measures, DeathsAreOfTheBodiesOfAType) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)});
  const TypeId puck = scene.robot("puck", {test::box(0.1, 0.1)});
  scene[puck].drive.reset();
  scene[puck].parts[0].returns.gripper = true;
  scene.body("a", bot);
  scene.body("p0", puck, {1, 0, 0, 0});
  scene.body("p1", puck, {2, 0, 0, 0});
  scene.body("p2", puck, {3, 0, 0, 0});
  scene.spec.reserves = {{"p", BodyId(5), 1}};
  scene.body("p3", puck);
  World world = scene.world();
  const MeasureSpec pucks = spec("deaths", "", {{"type", "puck"}});
  const MeasureSpec bots = spec("deaths", "", {{"type", "bot"}});
  EXPECT_EQ(value(world, pucks), 0) << "an unborn body has not died";
  world.remove(world.view().row(world.state().names.find("p0")));
  world.remove(world.view().row(world.state().names.find("p2")));
  world.remove(world.view().row(world.state().names.find("a")));
  EXPECT_EQ(value(world, pucks), 2);
  EXPECT_EQ(value(world, bots), 1);
  Diagnostics diagnostics;
  const MeasureSpec wrong = spec("deaths", "", {{"type", "pucks"}});
  const MeasureSet set(world, test::registry(), {&wrong, 1}, diagnostics);
  ASSERT_EQ(diagnostics.findings().size(), 1u);
  EXPECT_THAT(
      diagnostics.text(diagnostics.findings()[0]),
      HasSubstr("deaths: unknown type of bodies that may die \"pucks\"; known: bot, puck (did you mean "
                "\"puck\"?)"));
}

TEST(Measures, RankErrorsAreThePairsThatStandTheWrongWayRound) {
  test::SceneBuilder scene;
  const TypeId small = scene.robot("small", {test::box(0.2, 0.2)});
  const TypeId large = scene.robot("large", {test::box(0.4, 0.4)});
  const TypeId huge = scene.robot("huge", {test::box(0.6, 0.6)});
  // From the centre (1, 0) on: small, large, small, huge at 0 to 6 m, and a large one beside the huge one.
  scene.body("s0", small, {1, 0, 0, 0});
  scene.body("l0", large, {1, 2, 0, 0});
  scene.body("s1", small, {-3, 0, 0, 0});
  scene.body("h0", huge, {7, 0, 0, 0});
  scene.body("l1", large, {-5, 0, 0, 0});
  World world = scene.world();
  const MeasureSpec errors = spec("rank_errors", "", {{"center", std::vector<double>{1, 0}}});
  // Of 8 pairs of unlike robots (10, less s0 s1 and l0 l1) one: s1 is farther than l0. l1 and h0 are equally
  // far.
  EXPECT_DOUBLE_EQ(value(world, errors), 1.0 / 8);
  EXPECT_DOUBLE_EQ(
      value(world, spec("share_within", "", {{"center", std::vector<double>{1, 0}}, {"radius", 4.0}})),
      3.0 / 5);
}

TEST(Measures, ThoseOfTheLiteratureNameTheirSource) {
  for (const char* name : {"coverage", "mean_nearest_distance", "neighbours", "order", "polarisation",
                           "spread", "rank_errors", "clusters", "largest_cluster"}) {
    const auto kind = std::ranges::find(test::registry().measures, name, &engine::MeasureKind::name);
    ASSERT_NE(kind, test::registry().measures.end()) << name;
    EXPECT_THAT(std::string(kind->definition),
                ::testing::ContainsRegex("(Source|Related).* (19|20)[0-9][0-9][.,]"))
        << name;
  }
}

TEST(Measures, StateMeanIsOfTheRobotsThatHaveTheField) {
  test::SceneBuilder scene;
  const TypeId wanderer = scene.robot("wanderer", {test::box(0.2, 0.2)});
  scene[wanderer].devices.push_back(test::ranger("eye", {{{}, 5, 3, 9}}));
  const TypeId other = scene.robot("other", {test::box(0.4, 0.4)});
  scene[other].devices.push_back(test::ranger("eye", {{{}, 2, 3, 9}}));
  scene.robot("blind", {test::box(0.2, 0.2)});
  scene.body("w0", wanderer, {0, 0, 0, 0});
  scene.body("w1", wanderer, {0, 50, 0, 0});
  scene.body("o0", other, {0, 90, 0, 0});
  scene.body("b0", TypeId(scene.spec.types.size() - 1), {0, -50, 0, 0});
  World world = scene.world();
  world.step();
  const auto ranges = [](int column, std::string of = {}) {
    return spec("state_mean", std::move(of),
                {{"component", "ranger/eye"}, {"field", "ranges"}, {"column", column}});
  };
  EXPECT_DOUBLE_EQ(value(world, ranges(0)), (5 + 5 + 2) / 3.0) << "two tables of one component";
  EXPECT_DOUBLE_EQ(value(world, ranges(8, "w")), 5);
  EXPECT_TRUE(std::isnan(value(world, ranges(0, "b")))) << "it has none";
  EXPECT_DOUBLE_EQ(value(world, spec("state_mean", "", {{"component", "eye"}, {"field", "ranges"}})),
                   (5 + 5 + 2) / 3.0)
      << "the name of the device";
  const auto error = [&](const MeasureSpec& one) {
    Diagnostics diagnostics;
    const MeasureSet set(world, test::registry(), {&one, 1}, diagnostics);
    return diagnostics.findings().empty() ? std::string() : diagnostics.text(diagnostics.findings()[0]);
  };
  EXPECT_THAT(
      error(ranges(9)),
      HasSubstr(
          "state_mean: there is no column 9: the last column of the field \"ranges\" is 8 (counted from 0)"));
  EXPECT_THAT(error(spec("state_mean", "", {{"component", "ranger/ear"}, {"field", "ranges"}})),
              HasSubstr("state_mean: unknown component \"ranger/ear\"; known: command, eye, pose, "));
  EXPECT_THAT(error(spec("state_mean", "", {{"component", "ranger/eye"}, {"field", "range"}})),
              HasSubstr("state_mean: unknown field \"range\"; known: ranges"));
}

TEST(Measures, AComponentOfStateMeanMayStandForSeveralTables) {
  test::SceneBuilder scene;
  const TypeId seer = scene.robot("seer", {test::box(0.2, 0.2)});
  scene[seer].devices.push_back(test::ranger("eye", {{{}, 5, 3, 9}}));
  const TypeId turner = scene.robot("turner", {test::box(0.2, 0.2)});
  scene[turner].devices.push_back({.name = "eye", .kind = "compass"});
  scene.body("s0", seer, {0, 0, 0, 0});
  scene.body("t0", turner, {0, 50, 0, 2});
  World world = scene.world();
  world.subscribe(world.state().names.find("t0"));
  world.subscribe(world.state().names.find("s0"));
  world.step();
  const auto of_eye = [](const char* field) {
    return spec("state_mean", "", {{"component", "eye"}, {"field", field}});
  };
  EXPECT_DOUBLE_EQ(value(world, of_eye("ranges")), 5);
  EXPECT_NEAR(value(world, of_eye("heading")), 2, 1e-6);
  const MeasureSpec wrong = of_eye("head");
  Diagnostics diagnostics;
  const MeasureSet set(world, test::registry(), {&wrong, 1}, diagnostics);
  ASSERT_EQ(diagnostics.findings().size(), 1u);
  EXPECT_THAT(diagnostics.text(diagnostics.findings()[0]),
              HasSubstr("state_mean: unknown field \"head\"; known: heading, ranges"));
}

TEST(Measures, StateMeanLeavesOutSensorsThatDoNotRun) {
  test::SceneBuilder scene;
  const TypeId near = scene.robot("near", {test::box(0.2, 0.2)});
  scene[near].devices.push_back(test::ranger("eye", {{{}, 2, 3, 9}}));
  const TypeId far = scene.robot("far", {test::box(0.2, 0.2)});
  scene[far].devices.push_back(test::ranger("eye", {{{}, 5, 3, 9}}));
  scene[far].devices.back().active = false;
  scene.body("n0", near, {0, 0, 0, 0});
  scene.body("f0", far, {0, 50, 0, 0});
  scene.body("f1", far, {0, 90, 0, 0});
  World world = scene.world();
  const auto ranges = [](const char* kind, std::string of = {}) {
    return spec(kind, std::move(of), {{"component", "eye"}, {"field", "ranges"}});
  };
  MeasureSet means = measures(world, {ranges("state_mean"), ranges("state_mean", "f")});
  world.subscribe(world.state().names.find("f1"));
  world.step();
  EXPECT_EQ(means.values()[0], (2 + 5) / 2.0) << "f0 has no reading";
  EXPECT_EQ(means.values()[1], 5);
  EXPECT_EQ(value(world, ranges("state_variance")), 1.5 * 1.5);
  World resting = scene.world();
  resting.step();
  EXPECT_TRUE(std::isnan(value(resting, ranges("state_mean", "f"))));
  EXPECT_TRUE(std::isnan(value(resting, ranges("state_variance", "f"))));
}

// A search through all types for the table of each type would take minutes.
TEST(Measures, AStateMeanOfThousandsOfTypesIsMadeQuickly) {
  constexpr int k_types = test::k_slow_build ? 2'000 : 20'000;
  test::SceneBuilder scene;
  for (int i = 0; i < k_types; ++i) {
    const TypeId type = scene.robot(fmt::format("t{}", i), {test::box(0.2, 0.2)});
    scene[type].devices.push_back({.name = "eye", .kind = "compass"});
    scene.body(fmt::format("r{}", i), type, {0, 1.0 * i, 0, 0});
  }
  World world = scene.world();
  const MeasureSpec heading = spec("state_mean", "", {{"component", "eye"}, {"field", "heading"}});
  for (int i = 0; i < 50; ++i) ASSERT_EQ(value(world, heading), 0);
}

TEST(Measures, TheMeanOfEqualValuesIsTheirValueAndTheirVarianceIs0) {
  test::SceneBuilder scene;
  const TypeId robot = scene.robot("robot", {test::box(0.2, 0.2)});
  for (int i = 0; i < 3; ++i) scene.body(fmt::format("r{}", i), robot, {0.1, 2.0 * i, 0, 0});
  World world = scene.world();  // the mean of three times 0.1, rounded, is 0.10000000000000002
  const auto of_x = [](const char* kind) { return spec(kind, "", {{"component", "pose"}, {"field", "x"}}); };
  EXPECT_EQ(value(world, of_x("state_mean")), 0.1);
  EXPECT_EQ(value(world, of_x("state_variance")), 0);
}

TEST(Measures, CoverageOfAWorldWithoutBoundsIsOfTheGroundAtTheStart) {
  test::SceneBuilder scene;
  scene.wall(0, 0, 2, 1);  // two cells of eight
  scene.body("bot", scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}}, "omni"),
             {3.75, 1.75, 0, 0});
  World world = scene.world();
  MeasureSet set = measures(world, {spec("coverage")});
  EXPECT_EQ(set.value(0), 1.0 / 6);
  world.set_command(Row(0), {-1, 0, 0});
  for (int tick = 0; tick < 9; ++tick) {
    world.step();
    set.see();
  }
  EXPECT_EQ(set.value(0), 2.0 / 6);
  world.set_command(Row(0), {0, 1, 0});  // leaves that ground, and nothing more is covered
  for (int tick = 0; tick < 9; ++tick) {
    world.step();
    set.see();
  }
  EXPECT_EQ(set.value(0), 2.0 / 6);
}

// If each obstacle took memory and time for all lines of cells, this would take minutes.
TEST(Measures, CoverageAmongManyObstaclesIsMadeQuickly) {
  constexpr int k_posts = 2'000;
  test::SceneBuilder scene;
  const TypeId post = scene.type("post", {test::box(0.1, 0.01)});  // wider than the ground
  for (int i = 0; i < k_posts; ++i) scene.body(fmt::format("p{}", i), post, {0, 4.0 * i + 2, 0, 0});
  scene.body("bot", scene.robot("bot", {test::box(0.2, 0.2)}), {0.0005, 0.5, 0, 0});
  scene.spec.bounds.emplace();
  scene.spec.bounds->extend(Vec2::Zero());
  scene.spec.bounds->extend(Vec2(0.001, 4.0 * k_posts));
  World world = scene.world();
  constexpr double k_cells = 8'000'000 - 10 * k_posts;  // a column of cells; a post takes ten of them
  EXPECT_DOUBLE_EQ(value(world, spec("coverage", "", {{"cell", 0.001}})), 1 / k_cells);
}

TEST(Measures, ColumnsCarryUnitsAndWhoIsMeasured) {
  World world = crowd().world();
  std::vector<MeasureSpec> specs{spec("stalls"), spec("displacement"), spec("displacement", "truck"),
                                 spec("mean_speed", "m"), spec("coverage")};
  specs.back().name = "fine";
  EXPECT_THAT(measures(world, specs).columns(),
              ElementsAre("stalls", "displacement_m", "displacement_m:truck", "mean_speed_mps:m", "fine"));
  EXPECT_EQ(engine::robots_of(world, "truck").size(), 10u);
  EXPECT_EQ(engine::robots_of(world, "t").size(), 10u);
  EXPECT_EQ(engine::robots_of(world, "t1").size(), 1u);
  EXPECT_EQ(engine::robots_of(world, "").size(), world.robots());
}

TEST(Measures, ARobotWhoseNumberBeginsOtherNumbersIsMeasuredAlone) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {Solid{{test::box_ring(0.2, 0.2)}, {0, 0.3}}});
  for (int i = 0; i < 12; ++i) scene.body(fmt::format("r{}", i), bot, {static_cast<double>(i), 0, 0, 0});
  const World world = scene.world();
  EXPECT_EQ(engine::robots_of(world, "r1").size(), 1u) << "not r10 and r11";
  EXPECT_EQ(engine::robots_of(world, "r").size(), 12u);
}

TEST(Measures, ManyUnknownNamesAmongManyRobotsAreReportedQuickly) {
  constexpr int k_robots = test::k_slow_build ? 20'000 : 250'000;
  constexpr int k_names = 990;  // Diagnostics throws at 1000 errors
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)});
  for (int i = 0; i < k_robots; ++i)
    scene.body(fmt::format("r{}", i), bot, {i % 500 * 1.0, i / 500 * 1.0, 0, 0});
  scene.body("lamp7", scene.type("post", {test::box(0.2, 0.2)}), {-5, 0, 0, 0});
  World world = scene.world();
  std::vector<MeasureSpec> specs;
  for (int i = 0; i < k_names; ++i) specs.push_back(spec("stalls", fmt::format("r{}", k_robots + i)));
  for (const char* known : {"r99", "r9999", "bot"}) specs.push_back(spec("stalls", known));
  for (const char* other : {"lamp", "post", "lamp7", "lamp8"}) specs.push_back(spec("stalls", other));
  Diagnostics diagnostics;
  const MeasureSet set(world, test::registry(), specs, diagnostics);
  EXPECT_THAT(set.columns(), ElementsAre("stalls:r99", "stalls:r9999", "stalls:bot"));
  const std::span<const Finding> found = diagnostics.findings();
  ASSERT_EQ(found.size(), k_names + 4u);
  EXPECT_EQ(found[0].message,
            fmt::format("unknown type or population of robots \"r{}\"; known: bot, r", k_robots));
  for (const std::size_t i : {0u, 1u, 2u})
    EXPECT_THAT(found[k_names + i].message, HasSubstr("has no drive: robots are bodies with a drive"));
  EXPECT_EQ(found[k_names + 3].message, "unknown type or population of robots \"lamp8\"; known: bot, r");
}

TEST(Measures, ClustersOfRobotsAreThoseThatAreMeasured) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)});
  const TypeId puck = scene.type("puck", {test::box(0.1, 0.1)}, {.pushable = true});
  // Three robots in a chain, one beside them that is not measured, one apart; two pucks that touch.
  for (const double x : {0.0, 1.0, 2.0, 9.0}) scene.body(fmt::format("r{}", x), bot, {x, 0, 0, 0});
  scene.body("other", bot, {1, 1, 0, 0});
  scene.body("p0", puck, {5, 0, 0, 0});
  scene.body("p1", puck, {5.5, 0, 0, 0});
  World world = scene.world();
  const auto value = [&](const char* kind, const char* bodies, const char* of = "") {
    Diagnostics diagnostics;
    const std::vector<MeasureSpec> specs{spec(kind, of, {{"distance", 1.0}, {"bodies", bodies}})};
    MeasureSet set(world, test::registry(), specs, diagnostics);
    EXPECT_FALSE(diagnostics.has_errors());
    return set.values().front();
  };
  EXPECT_EQ(value("clusters", "robots"), 2);
  EXPECT_EQ(value("largest_cluster", "robots"), 4 / 5.0);
  EXPECT_EQ(value("clusters", "robots", "r"), 2);
  EXPECT_EQ(value("largest_cluster", "robots", "r"), 3 / 4.0);
  EXPECT_EQ(value("clusters", "pushable"), 1);
  EXPECT_EQ(value("largest_cluster", "pushable"), 1);
}

TEST(Measures, ClustersNeedBodiesThatCanFormThem) {
  test::SceneBuilder scene;
  scene.body("r0", scene.robot("bot", {test::box(0.2, 0.2)}));
  World world = scene.world();
  for (const char* kind : {"clusters", "largest_cluster"}) {
    Diagnostics diagnostics;
    const MeasureSpec pucks = spec(kind, "r0", {{"distance", 1.0}});
    const MeasureSet set(world, test::registry(), {&pucks, 1}, diagnostics);
    ASSERT_EQ(diagnostics.findings().size(), 1u);
    EXPECT_EQ(diagnostics.findings().front().message,
              fmt::format("{}: the world has no pushable bodies: for clusters of robots, give \"bodies\": "
                          "\"robots\"",
                          kind));
  }
}

TEST(Measures, VarianceIsTheMeanSquareAboutTheMean) {
  test::SceneBuilder scene;
  const TypeId bot = scene.robot("bot", {test::box(0.2, 0.2)});
  for (int i = 0; i < 4; ++i) scene.body(fmt::format("r{}", i), bot, {1e8 + i * i, 0, 0, 0});
  World world = scene.world();
  Diagnostics diagnostics;
  const std::vector<MeasureSpec> specs{spec("state_variance", "", {{"component", "pose"}, {"field", "x"}}),
                                       spec("state_mean", "", {{"component", "pose"}, {"field", "x"}})};
  MeasureSet set(world, test::registry(), specs, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors());
  EXPECT_EQ(set.values()[1], 1e8 + 3.5);
  EXPECT_EQ(set.values()[0], (3.5 * 3.5 + 2.5 * 2.5 + 0.5 * 0.5 + 5.5 * 5.5) / 4);
}

TEST(Measures, PolarisationIsOrderAndNotAmongTheUsualOnes) {
  World world = crowd().world();
  Diagnostics diagnostics;
  const std::vector<MeasureSpec> specs{spec("order"), spec("polarisation")};
  MeasureSet set(world, test::registry(), specs, diagnostics);
  EXPECT_EQ(set.values()[0], set.values()[1]);
  EXPECT_THAT(set.columns(), ElementsAre("order", "polarisation"));
  EXPECT_TRUE(test::registry().measure("order")->is_usual());
  EXPECT_FALSE(test::registry().measure("polarisation")->is_usual());
  for (const engine::MeasureKind& kind : test::registry().measures) EXPECT_NE(kind.formula, "") << kind.name;
}

TEST(Measures, MayBeOfATypeWithoutRobots) {
  test::SceneBuilder scene;
  scene.robot("idle", {test::box(0.4, 0.4)});
  scene.body("r", scene.robot("bot", {test::box(0.4, 0.4)}));
  World world = scene.world();
  Diagnostics diagnostics;
  const std::vector<MeasureSpec> specs{
      spec("stalls", "idle"), spec("alive", "idle"), spec("alive", "bot"),
      spec("deaths", "", {{"type", "idle"}}),
      spec("state_mean", "idle", {{"component", "of_idle_robots"}, {"field", "x"}})};
  MeasureSet set(world, test::registry(), specs, diagnostics);
  EXPECT_TRUE(diagnostics.findings().empty());
  EXPECT_THAT(set.values(), ElementsAre(0, 0, 1, 0, testing::IsNan()));
}

TEST(Measures, SayWhatIsWrongWithThem) {
  World world = crowd().world();
  Diagnostics diagnostics;
  std::vector<MeasureSpec> specs{spec("stals"), spec("stalls", "trucks"),
                                 spec("order"), spec("order"),
                                 spec("order"), spec("coverage", "", {{"cell", 0.001}})};
  specs[4].name = "tick";
  const MeasureSet set(world, test::registry(), specs, diagnostics);
  std::vector<std::string> texts;
  for (const Finding& finding : diagnostics.findings()) texts.push_back(diagnostics.text(finding));
  EXPECT_THAT(
      texts,
      ElementsAre(
          AllOf(HasSubstr("error: unknown measure \"stals\"; known: alive, clusters, coverage, "),
                HasSubstr("(did you mean \"stalls\"?)")),
          "error: unknown type or population of robots \"trucks\"; known: m, minibot, t, truck (did you mean "
          "\"truck\"?)",
          "error: two measures have the column \"order\": give one of them another \"name\"",
          "error: a measure cannot have the column \"tick\", which contains the time in tables of measures: "
          "give the measure another \"name\"",
          AllOf(HasSubstr("error: coverage: "), HasSubstr(" million cells of 0.001 m, but at most 25 million "
                                                          "are allowed: give a larger \"cell_m\""))));
}

}  // namespace
}  // namespace troupe::models::measures_test
