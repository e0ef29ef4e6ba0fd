// Ranks that divide the rows of a world among themselves compute the same bits as one world with all rows
// (engine/ranks/halo.hpp, docs/cluster.md).

#include "engine/ranks/halo.hpp"

#include "base/diagnostics.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/links/effect_views.hpp"
#include "engine/observing/displacement.hpp"
#include "engine/observing/stop_conditions.hpp"
#include "engine/ranks/replica.hpp"
#include "engine/world/world.hpp"
#include "models/devices/actuator.hpp"
#include "partition/job_thread.hpp"
#include "partition/mailboxes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/slow_build.hpp"
#include "troupe/troupe.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <any>
#include <atomic>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::engine::halo_test {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;

const fs::path k_halo_worlds = test::source_dir() / "worlds";

/// How a world is divided.
struct HaloTeam {
  unsigned ranks = 2;
  unsigned threads = 1;
  std::optional<std::uint64_t> seed;  ///< of delays and of random ground
  std::optional<double> skin_m;
  double tile_m = 1;
  std::function<double(unsigned rank)> clock;
};

std::size_t table_bytes_of(const World& world) {
  std::size_t bytes = 0;
  for (const StateTable& table : world.tables()) bytes += table.bytes();
  return bytes;
}

/// The world of a simulation on one rank.
World whole_world(const Simulation& simulation, const WorldOptions& options = {.threads = 1}) {
  Diagnostics diagnostics(simulation.world().spec().files);
  return World(simulation.world().spec(), simulation.registry(), options, diagnostics);
}

/// The world of a simulation on several ranks, distributed, as threads of this process. The calling thread is
/// rank 0. The simulation must outlive this object.
class HaloRanks {
 public:
  HaloRanks(const Simulation& simulation, const HaloTeam& team)
      : spec_(simulation.world().spec()),
        registry_(simulation.registry()),
        options_{.threads = team.threads, .tile_size_m = team.tile_m},
        replica_options_{.cut_seed = team.seed,
                         .verify = true,
                         .keeps_references = false,
                         .is_distributed = true,
                         .skin_m = team.skin_m,
                         .requests = {}},
        counts_(team.ranks),
        table_bytes_(team.ranks),
        mailboxes_(team.ranks, team.seed, team.clock) {
    for (unsigned rank = 1; rank < team.ranks; ++rank) {
      threads_.push_back(std::make_unique<partition::JobThread>(1));
      threads_.back()->add([this, rank] { follow(rank); });
    }
    Diagnostics diagnostics(spec_.files);
    world_ = std::make_unique<World>(spec_, registry_, options_, diagnostics);
    replica_ = std::make_unique<Replica>(*world_, registry_, mailboxes_.of(0), 0, replica_options_);
  }
  ~HaloRanks() { end(); }

  World& world() { return *world_; }
  const Replica& replica() const { return *replica_; }
  /// The counts of all ranks. No tick can follow.
  const std::vector<RankCounts>& counts() {
    end();
    return counts_;
  }
  /// The memory of the state tables of a rank other than 0, bytes. counts() must have been called.
  std::size_t table_bytes(unsigned rank) const { return table_bytes_[rank]; }

 private:
  void end() {
    if (!replica_) return;
    counts_[0] = replica_->halo()->counts();
    mailboxes_.of(0).send_to_all(begin_message(Order::end, 0));
    mailboxes_.close("rank 0 has ended");
    for (const auto& thread : threads_) thread->finish();
    replica_.reset();
  }
  void follow(unsigned rank) {
    try {
      Diagnostics diagnostics(spec_.files);
      World world(spec_, registry_, options_, diagnostics);
      Replica replica(world, registry_, mailboxes_.of(rank), 0, replica_options_);
      while (true) {
        const ReceivedOrder received = receive_order(mailboxes_.of(rank), 0);
        if (received.order == Order::end) break;
        replica.follow(received.order, received.rest);
      }
      counts_[rank] = replica.halo()->counts();
      table_bytes_[rank] = table_bytes_of(world);
    } catch (const std::exception& error) {
      mailboxes_.close("rank " + std::to_string(rank) + " failed: " + error.what());
    }
  }

  WorldSpec spec_;
  const Registry& registry_;
  WorldOptions options_;
  ReplicaOptions replica_options_;
  std::vector<RankCounts> counts_;
  std::vector<std::size_t> table_bytes_;
  partition::Mailboxes mailboxes_;
  std::unique_ptr<World> world_;
  std::unique_ptr<Replica> replica_;
  std::vector<std::unique_ptr<partition::JobThread>> threads_;
};

/// Called before each tick: may change the world.
using HaloProgram = std::function<void(World&)>;

std::vector<Hashes> halo_log(World& world, std::uint64_t ticks, const HaloProgram& program = {}) {
  std::vector<Hashes> log{world.hashes()};
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    if (program) program(world);
    world.step();
    log.push_back(world.hashes());
  }
  return log;
}

void expect_equal_logs(const std::vector<Hashes>& got, const std::vector<Hashes>& expected,
                       const std::string& what) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t tick = 0; tick < got.size(); ++tick) {
    ASSERT_EQ(got[tick].groups, expected[tick].groups) << what << ", tick " << tick;
    ASSERT_EQ(got[tick].state, expected[tick].state) << what << ", tick " << tick;
  }
}

std::string name_of(const HaloTeam& team) {
  return std::to_string(team.ranks) + " ranks, " + std::to_string(team.threads) + " threads, seed " +
         (team.seed ? std::to_string(*team.seed) : "none") + ", skin " +
         (team.skin_m ? std::to_string(*team.skin_m) : "chosen");
}

/// Robots with rangers in a room with a wall. Many are near one another, so that motions depend on others.
/// extra: further keys of the world, each with a comma before it
std::string halo_room(std::size_t robots, double half_m, const std::string& extra = {}) {
  const std::string half = std::to_string(half_m);
  return R"({
  "troupe": 1, "title": "A room",
  "types": {
    "wall": {"size_m": [0.2, 3, 1]},
    "wanderer": {"size_m": [0.31, 0.17, 0.2],
      "drive": {"kind": "diff", "localization": "odom", "odom_error": [0.03, 0.03, 0.05]},
      "controller": {"kind": "wander"}, "sensors": [
      {"name": "eyes", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 1.1, "fov_deg": 170.5, "samples": 9}]}]}
  },
  "models": [{"name": "wall", "type": "wall", "pose": {"x_m": 0.7, "heading_deg": 0.7}}],
  "populations": [
    {"name": "w", "type": "wanderer", "count": )" +
         std::to_string(robots) + R"(,
     "place": {"rule": "uniform", "region_m": [[-)" +
         half + ", -" + half + "], [" + half + ", " + half + R"(]]}}
  ])" + extra +
         "\n}";
}

/// Divisions of a world that the tests of experiments compare with the world on one rank.
const std::vector<HaloTeam> k_experiment_teams{
    {1, 1, {}, {}}, {2, 1, {}, {}}, {3, 2, {}, 0.0}, {7, 1, 2, 0.3}};

/// Expects that all teams compute the ticks of `expected` with these hashes.
void expect_log(const Simulation& simulation, const std::vector<HaloTeam>& teams,
                const std::vector<Hashes>& expected) {
  for (const HaloTeam& team : teams) {
    HaloRanks ranks(simulation, team);
    expect_equal_logs(halo_log(ranks.world(), expected.size() - 1), expected, name_of(team));
    if (::testing::Test::HasFatalFailure()) return;
  }
}

/// Expects that all teams compute a world with the same bits as one rank with all rows, in the ticks from
/// tick 0 on, and also in each further run after World::reset().
void expect_same_bits(const Simulation& simulation, std::uint64_t ticks, const std::vector<HaloTeam>& teams,
                      int runs = 1, const HaloProgram& program = {}) {
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, ticks, program);
  for (const HaloTeam& team : teams) {
    HaloRanks ranks(simulation, team);
    for (int run = 0; run < runs; ++run) {
      if (run > 0) ranks.world().reset();
      expect_equal_logs(halo_log(ranks.world(), ticks, program), expected,
                        name_of(team) + ", run " + std::to_string(run));
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

/// Teams of 5 and 7 ranks with small tiles, each with many random divisions of the ground.
std::vector<HaloTeam> teams_of_random_ground() {
  std::vector<HaloTeam> teams;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const unsigned ranks : {5u, 7u}) teams.push_back({ranks, 1, seed, 0.0, 0.20284491381982728, {}});
  return teams;
}

class HaloOfARoom : public test::ScratchTest {
 protected:
  Simulation load(std::size_t robots, double half_m, const std::string& extra = {}) const {
    SimulationOptions options;
    options.threads = 1;
    return Simulation(write("room.json", halo_room(robots, half_m, extra)), options);
  }
};

// Step (a): rows that are far from all others.
TEST_F(HaloOfARoom, WorldsWithDistantPartsOfTheRowsStepAlone) {
  const Simulation simulation = load(30, 8);
  WorldSpec spec = simulation.world().spec();
  for (std::size_t b = 0; b < spec.bodies.size(); ++b)
    if (simulation.world().view().location(BodyId(b)) == RowLocation::here && b % 2 == 0)
      spec.bodies[b].pose_world_body.x += 100;
  Diagnostics diagnostics(spec.files);
  World whole(spec, simulation.registry(), {.threads = 1}, diagnostics);
  World near(spec, simulation.registry(), {.threads = 1}, diagnostics);
  World far(spec, simulation.registry(), {.threads = 1}, diagnostics);
  std::vector<BodyId> near_bodies;
  std::vector<BodyId> far_bodies;
  for (std::size_t r = 0; r < whole.view().rows(); ++r)
    (whole.view().poses()[r].x < 50 ? near_bodies : far_bodies).push_back(whole.view().body(Row(r)));
  ASSERT_GT(near_bodies.size(), 10u);
  ASSERT_GT(far_bodies.size(), 10u);
  near.remove_rows(far_bodies);
  far.remove_rows(near_bodies);
  for (int tick = 0; tick < 40; ++tick) {
    ASSERT_EQ(near.hashes().state + far.hashes().state, whole.hashes().state) << "tick " << tick;
    for (World* world : {&whole, &near, &far}) world->step();
  }
  EXPECT_EQ(near.view().counts().stalled + far.view().counts().stalled, whole.view().counts().stalled);
}

TEST_F(HaloOfARoom, RanksGiveTheSameBits) {
  constexpr int k_ticks = 80;
  const Simulation simulation = load(150, 4);
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, k_ticks);
  EXPECT_GT(whole.counters().conflict_rounds, 100u) << "no motion depends on another";
  for (const HaloTeam& team : std::vector<HaloTeam>{{1, 1, {}, {}},
                                                    {2, 1, {}, {}},
                                                    {3, 2, {}, 0.0},
                                                    {4, 1, 1, {}},
                                                    {7, 2, 2, 0.3},
                                                    {7, 1, 3, 3.0},
                                                    {2, 2, 4, 0.0}}) {
    HaloRanks ranks(simulation, team);
    expect_equal_logs(halo_log(ranks.world(), k_ticks), expected, name_of(team));
    EXPECT_EQ(ranks.world().counters().beams, whole.counters().beams);
    std::uint64_t migrated = 0;
    std::uint64_t own = 0;
    for (const RankCounts& counts : ranks.counts()) {
      migrated += counts.migrated;
      own += counts.own;
      EXPECT_EQ(counts.ticks, k_ticks);
    }
    EXPECT_EQ(own, k_ticks * whole.view().rows()) << "each row has one owner";
    if (team.ranks > 1) {
      EXPECT_GT(migrated, 0u) << name_of(team);
    }
  }
}

/// All teams of 1, 2, 3, 4 and 7 ranks with 1 and 2 threads, three skins, and without and with three seeds. A
/// seed delays and reorders messages, and divides the ground at random during the run
/// (TileOwners::random_cut()). In slow builds (test::k_slow_build), only a quarter of them: 2 threads, and at
/// most one seed.
std::vector<HaloTeam> all_teams(double tile_m) {
  const std::vector<std::optional<double>> skins_m{std::nullopt, 0.0, 0.4};
  const std::vector<std::optional<std::uint64_t>> seeds{std::nullopt, 1, 2, 3};
  std::vector<HaloTeam> teams;
  for (const unsigned ranks : {1u, 2u, 3u, 4u, 7u})
    for (const unsigned threads : {1u, 2u})
      for (const std::optional<double>& skin_m : skins_m)
        for (const std::optional<std::uint64_t>& seed : seeds)
          if (!test::k_slow_build || (threads == 2 && seed.value_or(1) == 1))
            teams.push_back({ranks, threads, seed, skin_m, tile_m, {}});
  return teams;
}

TEST_F(HaloOfARoom, AllTeamsGiveTheSameBitsInACrowd) {
  const Simulation simulation = load(120, 3.5);
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 16);
  EXPECT_GT(whole.counters().conflict_rounds, 10u) << "no motion depends on another";
  std::uint64_t rounds = 0;
  for (const HaloTeam& team : all_teams(1)) {
    HaloRanks ranks(simulation, team);
    expect_equal_logs(halo_log(ranks.world(), 16), expected, name_of(team));
    if (HasFatalFailure()) return;
    for (const RankCounts& counts : ranks.counts()) rounds += counts.rounds;
  }
  EXPECT_GT(rounds, 0u) << "no motion depends on the outcome of another rank";
}

TEST_F(HaloOfARoom, AllTeamsGiveTheSameBitsInASparseWorld) {
  const Simulation simulation = load(400, 80);
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 10);
  for (const HaloTeam& team : all_teams(4)) {
    HaloRanks ranks(simulation, team);
    expect_equal_logs(halo_log(ranks.world(), 10), expected, name_of(team));
    if (HasFatalFailure()) return;
    std::uint64_t own = 0;
    std::uint64_t ghosts = 0;
    for (const RankCounts& counts : ranks.counts()) {
      own += counts.own;
      ghosts += counts.ghosts;
    }
    EXPECT_EQ(own, 10 * whole.view().rows()) << name_of(team);
    if (team.ranks == 7 && !team.seed) {
      EXPECT_GT(ghosts, 0u) << name_of(team);
      EXPECT_LT(5 * ghosts, own) << name_of(team);
    }
  }
}

TEST_F(HaloOfARoom, APlanHasTheRowsOfTheRanks) {
  const Simulation simulation = load(400, 80);
  World whole = whole_world(simulation, {.threads = 1, .tile_size_m = 4});
  const HaloPlan plan = plan_halo(whole, 7, 0);
  EXPECT_GT(plan.coverage_m, 1.1);
  HaloRanks ranks(simulation, {.ranks = 7, .skin_m = 0.0, .tile_m = 4});
  ranks.world().step();  // all robots stand still in the first tick: the ghosts are those of the plan
  static_cast<void>(ranks.world().hashes());  // waits until all ranks have ended the tick
  const std::vector<RankCounts>& counts = ranks.counts();
  ASSERT_EQ(plan.ranks.size(), 7u);
  std::size_t neighbours = 0;
  for (std::size_t rank = 0; rank < 7; ++rank) {
    EXPECT_EQ(plan.ranks[rank].own, counts[rank].own) << rank;
    EXPECT_EQ(plan.ranks[rank].ghosts, counts[rank].ghosts) << rank;
    EXPECT_EQ(plan.ranks[rank].neighbours, counts[rank].neighbours) << rank;
    neighbours += plan.ranks[rank].neighbours;
  }
  EXPECT_GT(neighbours, 7u);
  EXPECT_GT(plan_halo(whole, 7, 0.1).ranks[3].ghosts, plan.ranks[3].ghosts);
}

TEST_F(HaloOfARoom, GhostsAreFewInASparseWorld) {
  const Simulation simulation = load(400, 80);
  const WorldSpec& spec = simulation.world().spec();
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 20);
  HaloRanks ranks(simulation, {.ranks = 7, .tile_m = 4});
  expect_equal_logs(halo_log(ranks.world(), 20), expected, "sparse");
  EXPECT_LT(ranks.world().view().rows(), spec.bodies.size() / 3);
  std::uint64_t own = 0;
  std::uint64_t ghosts = 0;
  std::uint64_t rebuilds = 0;
  for (const RankCounts& counts : ranks.counts()) {
    own += counts.own;
    ghosts += counts.ghosts;
    rebuilds += counts.distributions;
  }
  for (unsigned rank = 1; rank < 7; ++rank)
    EXPECT_LT(ranks.table_bytes(rank), table_bytes_of(whole) / 3) << "rank " << rank;
  EXPECT_GT(ghosts, 0u);
  EXPECT_LT(5 * ghosts, own);
  EXPECT_LT(rebuilds, 7u * 6) << "the rows are distributed in every tick";
}

TEST_F(HaloOfARoom, ProgramsReadAndChangeAllRows) {
  const Simulation simulation = load(60, 3);
  const BodyId moved = simulation.world().state().names.find("w7");
  const HaloProgram program = [&](World& world) {
    if (world.tick() % 4 == 1) static_cast<void>(world.tables());  // all rows are here
    if (world.tick() == 5) {
      world.gather();
      const World::Placed place{world.view().row(moved), {-2.9, 2.9, 0, 1}};
      world.set_poses({&place, 1});
    }
    if (world.tick() == 9) {
      world.gather();
      world.set_command(world.view().row(moved), Command{});
    }
    if (world.tick() == 12) world.before_tick([&world] { static_cast<void>(world.tables()); });
    if (world.tick() == 15) world.before_tick({});
  };
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 30, program);
  for (const HaloTeam& team : std::vector<HaloTeam>{{3, 1, {}, {}}, {4, 1, 5, {}}, {2, 2, 6, 0.5}}) {
    HaloRanks ranks(simulation, team);
    expect_equal_logs(halo_log(ranks.world(), 30, program), expected, name_of(team));
    ranks.world().gather();
    EXPECT_EQ(ranks.world().view().rows(), whole.view().rows());
    EXPECT_EQ(ranks.world().view().counts().stalled, whole.view().counts().stalled);
    EXPECT_EQ(engine::mean_displacement(ranks.world()), engine::mean_displacement(whole));
    ranks.world().reset();
    ranks.world().before_tick({});
    expect_equal_logs(halo_log(ranks.world(), 30, program), expected, "after reset, " + name_of(team));
    const auto fill = [&](std::span<StateTable> tables) {
      for (std::size_t t = 0; t < tables.size(); ++t)
        for (std::size_t at = 0; at < tables[t].rows(); ++at) {
          const StateTable& from = whole.tables()[t];
          const std::size_t row = whole.view().row_in(from, whole.view().row(tables[t].ids()[at]));
          for (std::size_t f = 0; f < from.fields().size(); ++f) {
            const auto bytes = from.fields()[f].columns * element_size(from.fields()[f].element);
            std::copy_n(from.cell<std::byte>(row, f).data(), bytes, tables[t].cell<std::byte>(at, f).data());
          }
        }
    };
    EXPECT_TRUE(ranks.world().restore(whole.tick(), whole.counters(), whole.hashes().state, fill));
    ranks.world().before_tick({});
    World other = whole_world(simulation);
    ASSERT_TRUE(other.restore(whole.tick(), whole.counters(), whole.hashes().state, fill));
    expect_equal_logs(halo_log(ranks.world(), 10), halo_log(other, 10), "after restore, " + name_of(team));
  }
}

// Some robots start far away from the others, or on corners of the squares of which the ground of ranks
// consists. The wall is elsewhere, too.
TEST_F(HaloOfARoom, ARestartPlacesBodiesOnTheGroundOfAnyRank) {
  const Simulation simulation = load(80, 3);
  std::vector<BodySpec> bodies = simulation.world().spec().bodies;
  const auto place = [&](std::string_view name, const Pose& pose) {
    bodies[simulation.world().state().names.find(name).index()].pose_world_body = pose;
  };
  place("w3", {60, -40, 0, 1});
  place("w4", {60.5, -40, 0, -2});
  place("w5", {-9e4, 9e4, 0, 0});
  place("w6", {1, 1, 0, 0});
  place("w7", {0, -2, 0, 1.5});
  place("wall", {-1.5, 0.5, 0, 1});
  World whole = whole_world(simulation);
  whole.restart(7, bodies, simulation.registry());
  const std::vector<Hashes> expected = halo_log(whole, 30);
  for (const HaloTeam& team : k_experiment_teams) {
    HaloRanks ranks(simulation, team);
    for (int tick = 0; tick < 10; ++tick) ranks.world().step();
    ranks.world().restart(7, bodies, simulation.registry());
    expect_equal_logs(halo_log(ranks.world(), 30), expected, name_of(team));
    ranks.world().reset();
    expect_equal_logs(halo_log(ranks.world(), 30), expected, "after a reset, " + name_of(team));
  }
}

// In the phase move, the other ranks wait for messages of rank 0.
TEST_F(HaloOfARoom, ACallbackOfAPhaseMayThrow) {
  const Simulation simulation = load(60, 2);
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 5);
  HaloRanks ranks(simulation, {3, 1, {}, {}});
  World& world = ranks.world();
  for (int phase = 0; phase <= static_cast<int>(k_phases); ++phase) {
    int calls = 0;
    world.on_phase([&](std::optional<Phase>) {
      if (calls++ == phase) throw std::runtime_error("not now");
    });
    EXPECT_EQ(test::message_of<std::runtime_error>([&] { world.step(); }), "not now") << phase;
    EXPECT_EQ(calls, phase + 1);
    EXPECT_THROW(world.step(), std::logic_error);
    world.on_phase(nullptr);
    world.reset();
    expect_equal_logs(halo_log(world, 5), expected, std::to_string(phase));
    world.reset();
  }
}

TEST_F(HaloOfARoom, AFarMotionIsFollowed) {
  const Simulation simulation = load(60, 3);
  const BodyId fast = simulation.world().state().names.find("w7");
  const HaloProgram program = [&](World& world) {
    if (world.tick() % 10 != 3) return;
    world.gather();
    world.set_command(world.view().row(fast), Command{.x = 40});  // 4 m in a tick
  };
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 30, program);
  HaloRanks ranks(simulation, {.ranks = 5, .tile_m = 0.5});
  expect_equal_logs(halo_log(ranks.world(), 30, program), expected, "far motions");
}

TEST_F(HaloOfARoom, SlowRanksGiveGroundToOthers) {
  const Simulation simulation = load(200, 8);
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 80);
  std::vector<double> now_s(3, 0);
  const auto clock = [&](unsigned rank) { return now_s[rank] += rank == 1 ? 3 : 1; };  // rank 1 is slow
  HaloRanks ranks(simulation, {.ranks = 3, .tile_m = 0.5, .clock = clock});
  expect_equal_logs(halo_log(ranks.world(), 31), {expected.begin(), expected.begin() + 32}, "before");
  const auto rows_of = [&](unsigned rank) { return ranks.replica().work()[rank].rows; };
  const std::uint64_t before = rows_of(1);
  EXPECT_NEAR(static_cast<double>(before), 200.0 / 3, 20);
  for (std::size_t tick = 32; tick <= 80; ++tick) {
    ranks.world().step();
    ASSERT_EQ(ranks.world().hashes().state, expected[tick].state) << "tick " << tick;
  }
  EXPECT_GT(ranks.replica().rebalanced(), 0u);
  EXPECT_LT(3 * rows_of(1), 2 * before);
  EXPECT_GT(rows_of(1), 0u);
  EXPECT_EQ(rows_of(0) + rows_of(1) + rows_of(2), whole.view().rows());
}

/// What the conditions of a world's `stop_when` read after each tick.
struct HaloStops {
  std::vector<std::optional<std::size_t>> holding;
  std::vector<std::vector<double>> values;
  std::vector<std::vector<std::byte>> memories;
};

HaloStops halo_stops(World& world, const Registry& registry, std::uint64_t ticks) {
  Diagnostics diagnostics(world.spec().files);
  const std::vector<StopSpec>& specs = world.spec().experiment.stop_when;
  std::vector<MeasureSpec> measures;
  for (const StopSpec& each : specs) measures.push_back(each.measure);
  StopConditions conditions(world, registry, specs, diagnostics);
  MeasureSet set(world, registry, measures, diagnostics);
  HaloStops stops;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    world.step();
    conditions.see();
    set.see();
    stops.holding.push_back(conditions.holding());
    stops.values.push_back(set.values());
    stops.memories.push_back(conditions.memory());
  }
  return stops;
}

TEST_F(HaloOfARoom, StopConditionsReadTheRobotsOfAllRanks) {
  const Simulation simulation = load(100, 4, R"(,
  "stop_when": ["path_length >= 0.3", "stalls > 1000", "displacement > 1000",
    {"measure": {"kind": "state_mean", "component": "eyes", "field": "ranges", "column": 4, "name": "front"}, "is": "< 0"}],
  "at": [{"time_s": 0.5, "move": {"model": "w7", "pose": {"x_m": -3.5, "y_m": 3.5}}}])");
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const HaloStops expected = halo_stops(whole, simulation.registry(), 20);
  EXPECT_EQ(expected.holding.front(), std::nullopt);
  EXPECT_EQ(expected.holding.back(), std::optional<std::size_t>(0));
  for (const HaloTeam& team : k_experiment_teams) {
    HaloRanks ranks(simulation, team);
    const HaloStops got = halo_stops(ranks.world(), simulation.registry(), 20);
    EXPECT_EQ(got.holding, expected.holding) << name_of(team);
    EXPECT_EQ(got.values, expected.values) << name_of(team);
    EXPECT_EQ(got.memories, expected.memories) << name_of(team);
    EXPECT_EQ(ranks.world().hashes().state, whole.hashes().state) << name_of(team);
  }
}

TEST_F(HaloOfARoom, ARunEndsAtTheSameTick) {
  const fs::path world = write("stops.json", halo_room(60, 3, R"(,
  "stop_when": ["stalls > 1000", "displacement >= 0.25"])"));
  const auto end_of = [](Simulation& simulation) {
    simulation.run_for(20);
    return std::to_string(simulation.tick()) + " " + simulation.stopped().value_or("time") + " " +
           simulation.hash_log_line();
  };
  SimulationOptions options;
  options.threads = 1;
  Simulation whole(world, options);
  const std::string expected = end_of(whole);
  EXPECT_LT(whole.tick(), 200u);
  EXPECT_EQ(whole.stopped(), "displacement >= 0.25");
  options.distribute = true;
  options.tile_size_m = 1;
  const fs::path file = folder_ / "halfway.h5";
  for (const unsigned ranks : {3u, 7u}) {
    options.ranks = ranks;
    options.rank_seed = ranks;
    Simulation simulation(world, options);
    ASSERT_TRUE(simulation.rank_statistics().is_distributed);
    EXPECT_EQ(end_of(simulation), expected) << ranks << " ranks";
    simulation.reset();
    for (int tick = 0; tick < 5; ++tick) simulation.step();
    simulation.world().gather();
    simulation.save(file);
    EXPECT_EQ(end_of(simulation), expected) << ranks << " ranks, after a reset";
    ResumeOptions resume;
    resume.threads = 1;
    resume.ranks = ranks;
    resume.distribute = true;
    Simulation resumed = Simulation::resume(file, resume);
    EXPECT_EQ(end_of(resumed), expected) << ranks << " ranks, resumed";
  }
}

TEST_F(HaloOfARoom, RobotsFailAlikeOnAllRanks) {
  const Simulation simulation = load(150, 4, R"(,
  "faults": [
    {"population": "w", "share": 0.3, "from_s": 0.5, "slow_wheels": {"factor": 0.4}},
    {"population": "w", "count": 25, "from_s": 1, "dead_sensors": {"sensors": "eyes"}},
    {"population": "w", "drop_out": {"rate_per_s": 0.2, "for_s": 0.7}}
  ])");
  const WorldSpec& spec = simulation.world().spec();
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 40);
  const std::size_t impaired = test::count_impaired(whole);
  EXPECT_GT(impaired, 40u);
  EXPECT_LT(impaired, 140u);
  whole.restart(spec.seed + 1, spec.bodies, simulation.registry());
  const std::vector<Hashes> of_other_seed = halo_log(whole, 20);
  for (const HaloTeam& team : k_experiment_teams) {
    HaloRanks ranks(simulation, team);
    expect_equal_logs(halo_log(ranks.world(), 40), expected, name_of(team));
    ranks.world().gather();
    EXPECT_EQ(test::count_impaired(ranks.world()), impaired) << name_of(team);
    ranks.world().restart(spec.seed + 1, spec.bodies, simulation.registry());
    expect_equal_logs(halo_log(ranks.world(), 20), of_other_seed, "another seed, " + name_of(team));
  }
}

TEST_F(HaloOfARoom, ProgramsDisableRobots) {
  const Simulation simulation = load(60, 3, R"(,
  "at": [{"time_s": 1000, "disable": {"model": "w1"}}])");
  const HaloProgram program = [&](World& world) {
    if (world.tick() % 5 != 2) return;
    world.gather();
    for (std::uint64_t b = world.tick(); b < world.tick() + 10; ++b)
      if (const BodyId body(b); world.view().location(body) == RowLocation::here)
        world.set_disabled(world.view().row(body), !world.view().is_disabled(world.view().row(body)));
  };
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 30, program);
  EXPECT_GT(test::count_impaired(whole), 5u);
  for (const HaloTeam& team : k_experiment_teams) {
    HaloRanks ranks(simulation, team);
    expect_equal_logs(halo_log(ranks.world(), 30, program), expected, name_of(team));
  }
}

TEST_F(HaloOfARoom, InterventionsHaveTheSameEffectOnAllRanks) {
  const Simulation simulation = load(150, 4, R"(,
  "at": [
    {"time_s": 0, "disable": {"population": "w", "count": 5}},
    {"time_s": 0.5, "move": {"model": "w7", "pose": {"x_m": -3.5, "y_m": 3.5}}},
    {"time_s": 0.5, "move": {"model": "w8", "pose": {"x_m": 3.5, "y_m": 3.5, "heading_deg": 90}}},
    {"time_s": 1, "disable": {"population": "w", "share": 0.3}},
    {"time_s": 1, "enable": {"population": "w", "count": 20}},
    {"time_s": 1.5, "set": {"type": "wanderer", "device": {"name": "eyes", "transducers": [{"range_max_m": 3.5, "fov_deg": 170.5, "samples": 9}]}}},
    {"time_s": 1.5, "move": {"model": "w7", "pose": {"x_m": 3.6, "y_m": -3.6}}},
    {"time_s": 1.6, "move": {"model": "w7", "pose": {"x_m": -20, "y_m": 15}}},
    {"time_s": 1.8, "remove": {"population": "w", "share": 0.1}},
    {"time_s": 2, "disable": {"model": "w20"}},
    {"time_s": 2.2, "remove": {"model": "w11"}},
    {"time_s": 2, "set": {"type": "wanderer", "controller": {"kind": "wander", "cruise_speed_mps": 0.9}}},
    {"time_s": 3, "enable": {"population": "w", "share": 0.5}},
    {"time_s": 3, "move": {"model": "w7", "pose": {"x_m": 0, "y_m": 0}}},
    {"time_s": 3.5, "set": {"type": "wanderer", "device": {"name": "eyes", "transducers": [{"range_max_m": 0.5, "fov_deg": 170.5, "samples": 9}]}}}
  ])");
  ASSERT_EQ(why_replicated(simulation.world()), "");
  EXPECT_GE(simulation.world().interventions().settings().longest_reach(), 3.5);
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 50);
  EXPECT_LT(whole.robots(), 136u);
  for (const HaloTeam& team : k_experiment_teams) {
    HaloRanks ranks(simulation, team);
    expect_equal_logs(halo_log(ranks.world(), 50), expected, name_of(team));
    EXPECT_EQ(ranks.world().counters().beams, whole.counters().beams) << name_of(team);
    EXPECT_EQ(ranks.world().robots(), whole.robots()) << name_of(team);
    ranks.world().gather();
    EXPECT_EQ(ranks.world().view().absent_count(), whole.view().absent_count()) << name_of(team);
    EXPECT_EQ(engine::mean_displacement(ranks.world()), engine::mean_displacement(whole)) << name_of(team);
    ranks.world().reset();
    expect_equal_logs(halo_log(ranks.world(), 50), expected, "after reset, " + name_of(team));
  }
}

// A rank tests whether a pose is free for a birth. In this tick, other interventions have moved, added and
// removed bodies there, whose rows were on other ranks.
TEST_F(HaloOfARoom, InterventionsOfATickSeeOneAnotherOnAllRanks) {
  std::string text = halo_room(40, 8, R"(,
  "at": [
    {"time_s": 0.2, "move": {"model": "w0", "pose": {"x_m": 7.5, "y_m": 7.5}}},
    {"time_s": 0.2, "add": {"population": "w", "count": 1, "pose": {"x_m": 7.5, "y_m": 7.5}}},
    {"time_s": 0.2, "add": {"population": "w", "count": 1, "pose": {"x_m": -7.5, "y_m": 7.5}}},
    {"time_s": 0.2, "move": {"model": "w0", "pose": {"x_m": -7.5, "y_m": 6.5}}},
    {"time_s": 0.2, "add": {"population": "w", "count": 1, "pose": {"x_m": -7.5, "y_m": 7.5}}},
    {"time_s": 0.5, "add": {"population": "w", "count": 50, "region_m": [[-7.5, -7.5], [7.5, 7.5]]}},
    {"time_s": 0.5, "remove": {"population": "w", "count": 30}},
    {"time_s": 0.5, "add": {"population": "w", "count": 60, "region_m": [[-7.5, -7.5], [7.5, 7.5]]}},
    {"time_s": 0.5, "move": {"model": "w1", "pose": {"x_m": 7.5, "y_m": -7.5}}},
    {"time_s": 0.5, "add": {"population": "w", "count": 70, "region_m": [[-7.5, -7.5], [7.5, 7.5]]}}
  ])");
  const std::string_view count = R"("count": 40)";
  text.replace(text.find(count), count.size(), R"("count": 40, "reserve": 400)");
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("room.json", text), options);
  std::vector<HaloTeam> teams = k_experiment_teams;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) teams.push_back({3, 1, seed, {}});
  expect_same_bits(simulation, 10, teams);
}

// The ranks must have ghosts for the longer reach before the sensors run.
TEST_F(HaloOfARoom, AProgramMakesSensorsReachFarther) {
  const fs::path world = write("room.json", halo_room(100, 6));
  const auto log_of = [](Simulation& simulation) {
    std::string log;
    const auto set = [&](const std::string& range_m) {
      simulation.set("wanderer", R"({"device": {"name": "eyes", "transducers": [{"range_max_m": )" + range_m +
                                     R"(, "fov_deg": 170.5, "samples": 9}]}})");
    };
    for (int tick = 0; tick < 24; ++tick) {
      if (tick == 8) set("5");
      if (tick == 14) set("2");
      simulation.before_tick(tick == 20 ? [&](Simulation&) { set("8"); }
                                        : std::function<void(Simulation&)>());
      simulation.step();
      log += simulation.hash_log_line() + "\n";
    }
    return log;
  };
  SimulationOptions options;
  options.threads = 1;
  Simulation whole(world, options);
  const std::string expected = log_of(whole);
  options.distribute = true;
  options.tile_size_m = 1;
  for (const unsigned ranks : {2u, 5u}) {
    options.ranks = ranks;
    Simulation simulation(world, options);
    ASSERT_TRUE(simulation.rank_statistics().is_distributed);
    EXPECT_EQ(log_of(simulation), expected) << ranks << " ranks";
    simulation.reset();
    EXPECT_EQ(log_of(simulation), expected) << ranks << " ranks, after a reset";
  }
}

/// The room, whose robots have these devices and are no obstacles.
std::string halo_room_with(const std::string& devices, std::size_t robots, double half_m) {
  std::string room = halo_room(robots, half_m);
  const std::string_view before = R"("wanderer": {)";
  room.insert(room.find(before) + before.size(), R"("obstacle": false, "devices": [)" + devices + "], ");
  return room;
}

TEST_F(HaloOfARoom, RobotsChargeOneAnotherAcrossBorders) {
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("room.json", halo_room_with(R"(
        {"name": "pack", "kind": "power_pack", "capacity_J": 9, "stored_J": 5, "draw_W": 0.7},
        {"name": "contact", "kind": "power_contact", "give_W": 20, "take_W": 30})",
                                                                120, 3)),
                              options);
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 40);
  double received = 0;
  for (std::size_t r = 0; r < whole.view().rows(); ++r)
    for (const BodyType::Device& device : whole.view().type(Row(r)).devices)
      if (device.kind->energy)
        received += device.kind->energy(whole.tables()[device.table], whole.view().slot(Row(r))).received_j;
  EXPECT_GT(received, 100);
  expect_log(simulation, k_experiment_teams, expected);
}

/// Robots that hold a puck and give energy to the robot behind them. They drive slowly. Each of their trees
/// has two bodies.
std::string halo_givers() {
  std::string models;
  for (int i = 0; i < 30; ++i) {
    const double x = 1.6 * (i % 5) + 0.03 * (i % 7);
    const double y = 1.1 * (i / 5) + 0.05 * (i % 3);
    models += fmt::format(
        R"({}{{"name": "g{}", "type": "giver", "pose": {{"x_m": {}, "y_m": {}}}}},
    {{"name": "t{}", "type": "taker", "pose": {{"x_m": {}, "y_m": {}}}}},
    {{"name": "p{}", "type": "puck", "pose": {{"x_m": {}, "y_m": {}}}}})",
        i == 0 ? "" : ",\n    ", i, x, y, i, x - 0.3, y, i, x + 0.29, y);
  }
  return R"({
  "troupe": 1, "title": "Givers",
  "types": {
    "giver": {"size_m": [0.3, 0.3, 0.2], "drive": {"kind": "diff"},
      "controller": {"kind": "script", "legs": [{"until_s": 90, "forward_mps": 0.04, "turn_radps": 0.02}]},
      "devices": [
        {"kind": "power_pack", "name": "pack", "capacity_J": 1000, "stored_J": 500},
        {"kind": "gripper", "name": "hand", "pose": {"x_m": 0.25}, "autosnatch": true},
        {"kind": "power_contact", "name": "contact", "give_W": 10}]},
    "taker": {"size_m": [0.3, 0.3, 0.2], "drive": {"kind": "diff"},
      "controller": {"kind": "script", "legs": [{"until_s": 90, "forward_mps": 0.04}]},
      "devices": [
        {"kind": "power_pack", "name": "pack", "capacity_J": 1000, "stored_J": 10},
        {"kind": "power_contact", "name": "contact", "take_W": 7}]},
    "puck": {"disc": {"radius_m": 0.05, "height_m": 0.1}, "gripper_return": true}
  },
  "models": [
    )" + models +
         "]\n}";
}

// An effect needs the present state of all bodies of the trees of its source and target.
TEST_F(HaloOfARoom, CarriersChargeOthersAcrossBorders) {
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("givers.json", halo_givers()), options);
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 30);
  EXPECT_GT(whole.view().counts().carried, 20u);
  double received = 0;
  for (std::size_t r = 0; r < whole.view().rows(); ++r)
    for (const BodyType::Device& device : whole.view().type(Row(r)).devices)
      if (device.kind->energy)
        received += device.kind->energy(whole.tables()[device.table], whole.view().slot(Row(r))).received_j;
  EXPECT_GT(received, 100);
  std::vector<HaloTeam> teams = k_experiment_teams;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) teams.push_back({5, 1, seed, 0.0, 0.3, {}});
  expect_log(simulation, teams, expected);
}

/// A device with this state, reach and largest number of effects, and without parameters.
template <class State>
DeviceKind::Prepared prepared(double reach_m, std::size_t most_effects) {
  return {.data = 0,
          .percepts = memory_fields<State>(),
          .percept_bytes = sizeof(State),
          .reach_m = reach_m,
          .most_effects = most_effects};
}

/// The bodies whose origins are within `reach_m` of that of row i, without its own, in the order of ids.
std::vector<BodyId> bodies_near(const DeviceBatch& batch, std::size_t i, double reach_m) {
  const Vec2 from = batch.view.transform(batch.rows[i]).position;
  std::vector<BodyId> near;
  batch.view.index().for_each_near(Box::around(from, reach_m), [&](const partition::BodyCircle& circle) {
    const Row other(circle.row);
    if (other != batch.rows[i] && (batch.view.transform(other).position - from).norm() <= reach_m)
      near.push_back(batch.view.body(other));
  });
  std::ranges::sort(near);
  return near;
}

/// Changes its own state and that of up to four others, so that the result depends on the order of all
/// changes.
struct Mixer {
  struct State {
    std::uint64_t value = 1;
    TROUPE_FIELDS(value)
  };
  static constexpr double k_reach_m = 0.6;
  static constexpr std::size_t k_most = 4;
  static inline std::uint64_t throws_at = 0;  // tick

  static DeviceKind kind() {
    DeviceKind kind{.name = "mixer", .text = "for this test"};
    kind.scope = ApplyScope::trees;
    kind.prepare = [](const Record&, const Pose&) { return prepared<State>(k_reach_m, k_most); };
    kind.act = [](const DeviceBatch& batch) {
      for (std::size_t i = 0; i < batch.rows.size(); ++i) {
        const std::vector<BodyId> near = bodies_near(batch, i, k_reach_m);
        for (std::uint32_t k = 0; k < std::min(near.size(), k_most); ++k) batch.emit(i, k, 0, near[k]);
      }
    };
    kind.apply = [](const EffectContext& context, const std::any&, const Effect& effect) {
      if (Gripping(context).view().tick() == throws_at && effect.source.value % 7 == 3)
        throw std::runtime_error("spilled");
      mix(context, effect);
    };
    return kind;
  }
  static void mix(const EffectContext& context, const Effect& effect) {
    const DeviceExchange bodies(context);
    std::uint64_t& source = bodies.state<State>().value;
    StateTable& states = bodies.table_of(bodies.target_type().devices.back());
    std::uint64_t& target = states.as<State>(bodies.target_slot()).value;
    target = target * 6364136223846793005u + source;
    source = source * 31 + target + effect.source.value;
  }
};

/// Acts in some ticks on two bodies anywhere in the world, which may be of any type, unborn or dead.
DeviceKind far_mixer_kind() {
  DeviceKind kind = Mixer::kind();
  kind.scope = ApplyScope::any_target;
  kind.act = [](const DeviceBatch& batch) {
    const std::uint64_t bodies = batch.view.spec().bodies.size();
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const std::uint64_t number = batch.view.body(batch.rows[i]).value + batch.view.tick();
      if (number % 11 != 0) continue;
      for (std::uint32_t k = 0; k < 2; ++k)
        batch.emit(i, k, 0, BodyId((number * 7919 + k * 104729) % bodies));
    }
  };
  kind.apply = [](const EffectContext& context, const std::any&, const Effect& effect) {
    const DeviceExchange bodies(context);
    if (Gripping(context).view().location(effect.target) == RowLocation::none) return;  // static
    const std::span<const BodyType::Device> devices = bodies.target_type().devices;
    if (devices.empty() || devices.back().kind->name != "mixer") return;
    if (bodies.has_target())
      Mixer::mix(context, effect);
    else
      bodies.state<Mixer::State>().value ^= 0x5555;
  };
  return kind;
}

class HaloOfMixers : public HaloOfARoom {
 protected:
  Simulation load_mixers(const DeviceKind& kind = Mixer::kind()) const {
    Registry registry = test::registry();
    registry.devices.push_back(kind);
    SimulationOptions options;
    options.threads = 1;
    return Simulation(write("room.json", halo_room_with(R"({"name": "mixer", "kind": "mixer"})", 120, 4)),
                      options, registry);
  }
};

TEST_F(HaloOfMixers, EffectsHaveOneOrderOnAllRanks) {
  expect_same_bits(load_mixers(), 30, k_experiment_teams);
}

/// Advances a world from tick 0 until this tick, in which a hook throws if its `throws_at` is that tick.
/// Returns the text of the error, or "" if there is none.
std::string error_of_tick(std::uint64_t tick, World& world, std::uint64_t& throws_at) {
  halo_log(world, tick - 1);
  throws_at = tick;
  std::string text;
  try {
    world.step();
  } catch (const StepError& error) {
    text = error.what();
  }
  throws_at = 0;
  return text;
}

/// Expects that a hook that throws in this tick (error_of_tick()) ends the tick with the same error, which
/// contains `text`, for any ranks as for one, and that the world then restarts with the same bits.
void expect_same_error(const Simulation& simulation, std::uint64_t tick, std::uint64_t& throws_at,
                       const std::string& text) {
  World whole = whole_world(simulation);
  const std::string expected = error_of_tick(tick, whole, throws_at);
  EXPECT_THAT(expected, HasSubstr(text));
  whole.reset();
  const std::vector<Hashes> log = halo_log(whole, 20);
  for (const HaloTeam& team : k_experiment_teams) {
    HaloRanks ranks(simulation, team);
    EXPECT_EQ(error_of_tick(tick, ranks.world(), throws_at), expected) << name_of(team);
    ranks.world().reset();
    expect_equal_logs(halo_log(ranks.world(), 20), log, "after the error, " + name_of(team));
  }
}

TEST_F(HaloOfMixers, EffectsOnDistantBodiesHaveOneOrderOnAllRanks) {
  expect_same_bits(load_mixers(far_mixer_kind()), 30, all_teams(1));
}

TEST_F(HaloOfMixers, AKindThatCanChangeAnyBodiesIsNotDistributed) {
  DeviceKind kind = Mixer::kind();
  kind.scope = ApplyScope::anything;
  EXPECT_EQ(why_replicated(load_mixers(kind).world()),
            "robots of type \"wanderer\" have the device \"mixer\" of the kind \"mixer\", which can change "
            "any bodies");
}

TEST_F(HaloOfMixers, AnEffectThatThrowsEndsTheTickOnAllRanks) {
  expect_same_error(load_mixers(), 10, Mixer::throws_at, "spilled");
}

/// Drives ahead, with a turn that changes from time to time.
struct Rusher {
  static constexpr bool needs_drive = true;

  void operator()(const DecideBatch& batch) const {
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const std::uint64_t number = std::uint64_t{batch.body(i)} * 7919 + batch.tick / 8 * 104729;
      batch.command(i) = {0.2 + 0.05 * static_cast<double>(number % 7), 0,
                          0.5 * static_cast<double>(number % 3) - 0.5};
    }
  }
};

/// Groups of two or three pucks, with robots around each group that drive towards its centre. Several robots
/// push the same puck in one tick, pucks push further pucks, and other robots are in the way.
std::string halo_shovers() {
  std::string models;
  const auto add = [&](const std::string& type, double x, double y, double heading_deg) {
    models += fmt::format(
        R"(, {{"name": "m{}", "type": "{}", "pose": {{"x_m": {}, "y_m": {}, "heading_deg": {}}}}})",
        models.size(), type, x, y, heading_deg);
  };
  for (int i = 0; i < 49; ++i) {
    const double x = 0.42 * (i % 7);
    const double y = 0.42 * (i / 7);
    for (int k = 0; k < 2 + i % 2; ++k)
      add(k == 1 && i == 0 ? "bar" : "puck", x + 0.07 * k - 0.05, y + 0.02 * (i % 3), 0);
    for (int k = 0; k < 4; ++k) {
      const double angle_deg = 90 * k + i * 29 % 60;
      const Vec2 place = 0.17 * Vec2(std::cos(angle_deg * std::numbers::pi / 180),
                                     std::sin(angle_deg * std::numbers::pi / 180));
      add((i + k) % 6 == 0 ? "walker" : "shover", x + place.x(), y + place.y(),
          angle_deg + 180 + i * 13 % 30 - 15);
    }
  }
  return R"({
  "troupe": 1, "title": "Shovers", "seed": 3, "overlaps": "warn",
  "types": {
    "wall": {"size_m": [0.2, 2, 1]},
    "puck": {"size_m": [0.06, 0.05, 0.2], "pushable": true},
    "bar": {"size_m": [0.05, 0.012, 0.2], "pushable": true},
    "shover": {"size_m": [0.09, 0.08, 0.2], "drive": {"kind": "diff", "pushes": 2, "localization": "odom"}, "controller": {"kind": "rusher"}},
    "walker": {"size_m": [0.08, 0.08, 0.2], "drive": {"kind": "diff"}, "controller": {"kind": "rusher"}}
  },
  "models": [{"name": "wall", "type": "wall", "pose": {"x_m": 5.7}})" +
         models + "]}";
}

TEST_F(HaloOfARoom, RobotsPushBodiesAcrossBorders) {
  Registry registry = test::registry();
  registry.controllers.push_back(make_controller_kind<Rusher>("rusher", ""));
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("shovers.json", halo_shovers()), options, registry);
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Pose> before(whole.view().poses().begin(), whole.view().poses().end());
  const std::vector<Hashes> expected = halo_log(whole, 10);
  std::size_t pushed = 0;
  for (std::size_t r = 0; r < whole.view().rows(); ++r)
    pushed += whole.view().type(Row(r)).pushable && whole.view().poses()[r].x != before[r].x;
  EXPECT_GT(pushed, 50u);
  expect_log(simulation, all_teams(0.2), expected);
}

/// Rows of bars that two robots push towards each other from both ends. Each robot can push half of the bars
/// of its row, so that only one of the two can move when the halves meet, however far away the other robot
/// is.
std::string halo_rows_of_bars() {
  std::string models;
  for (int i = 0; i < 24; ++i) {
    const double x = 0.37 * (i % 8);
    const double y = 0.2 * i;
    for (const int side : {-1, 1}) {
      for (int k = 0; k < 3; ++k)
        models += fmt::format(R"(, {{"name": "b{}", "type": "bar", "pose": {{"x_m": {}, "y_m": {}}}}})",
                              models.size(), x + side * (0.1775 + 0.301 * k), y);
      models += fmt::format(
          R"(, {{"name": "s{}", "type": "shover", "pose": {{"x_m": {}, "y_m": {}, "heading_deg": {}}}}})",
          models.size(), x + side * 0.99, y, side < 0 ? 0 : 180);
    }
  }
  return R"({
  "troupe": 1, "title": "Rows of bars",
  "types": {
    "wall": {"size_m": [0.2, 2, 1]},
    "bar": {"size_m": [0.3, 0.05, 0.2], "pushable": true},
    "shover": {"size_m": [0.09, 0.08, 0.2], "drive": {"kind": "diff", "pushes": 3},
      "controller": {"kind": "script", "legs": [{"until_s": 1000, "forward_mps": 0.1}]}}
  },
  "models": [{"name": "wall", "type": "wall", "pose": {"x_m": 5.7}})" +
         models + "]}";
}

TEST_F(HaloOfARoom, PushersDependOnPushersFarAway) {
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("rows.json", halo_rows_of_bars()), options);
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 20);
  EXPECT_EQ(whole.view().counts().stalled, 48u) << "the halves of all rows have met";
  for (const unsigned ranks : {2u, 3u, 5u, 7u})
    for (const std::optional<std::uint64_t> seed : {std::optional<std::uint64_t>(), {1}, {2}, {3}}) {
      const HaloTeam team{ranks, 1, seed, 0.0, 0.25, {}};
      HaloRanks halo(simulation, team);
      expect_equal_logs(halo_log(halo.world(), 20), expected, name_of(team));
    }
}

struct HaloPlace {
  std::string name;
  Pose pose;  ///< with the heading in degrees
};

/// A world of pucks and of short rods that drive straight ahead, many times their length in a tick. The names
/// of the rods begin with R, those of the pucks with P.
std::string halo_rods(int seed, double speed_mps, const std::vector<HaloPlace>& places) {
  std::string models;
  for (const auto& [name, pose] : places)
    models += fmt::format(
        R"({}{{"name": "{}", "type": "{}", "pose": {{"x_m": {}, "y_m": {}, "heading_deg": {}}}}})",
        models.empty() ? "" : ", ", name, name[0] == 'R' ? "rod" : "puck", pose.x, pose.y, pose.heading);
  return fmt::format(R"({{
  "troupe": 1, "title": "Rods", "seed": {}, "tick_s": 1,
  "types": {{
    "puck": {{"disc": {{"radius_m": 0.1, "height_m": 0.2, "corners": 16}}, "pushable": true}},
    "rod": {{"blocks": [{{"points_m": [[-0.05, -0.02], [0.1, -0.02], [0.1, 0.02], [-0.05, 0.02]], "z_m": [0, 0.2]}}],
      "drive": {{"kind": "diff", "pushes": 1, "velocity_max_x_mps": 100}},
      "controller": {{"kind": "script", "legs": [{{"until_s": 100, "forward_mps": {}}}]}}}}
  }},
  "models": [{}]}})",
                     seed, speed_mps, models);
}

// Found by a search among random worlds: the origin of P2 is outside of the zone of R4, but its circle
// touches the zone. So R4 may push and R3 must wait for it, while R1 and R2 hand on P1 to where R3 drives.
TEST_F(HaloOfARoom, APuckTouchesAZoneFromOutside) {
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(
      write("edge.json", halo_rods(4, 5,
                                   {{"R1", {0.17925912878244077, 0.05110421642723839, 0, 45}},
                                    {"R2", {2.3005794723420836, 5.283694397207691, 0, -45}},
                                    {"R3", {10.951625346270673, 2.9412512503874955, 0, -164.98163936884933}},
                                    {"P1", {0.32209469858212336, 0.193939786226921, 0, 0}},
                                    {"R4", {21.185658169778282, 5.686967373767586, 0, 15.018360631150669}},
                                    {"P2", {26.395395493906612, 7.0847017778020165, 0, 0}}})),
      options);
  expect_same_bits(simulation, 2, teams_of_random_ground());
}

// Found by a search among random worlds: R1 to R4 hand on P1 in one tick, until it lies where R5 drives.
TEST_F(HaloOfARoom, APuckIsHandedOnFromZoneToZone) {
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(
      write("relay.json", halo_rods(62, 1,
                                    {{"R1", {-0.2809094784922, -0.32073404431409736, 0, 45}},
                                     {"R2", {0.4247830891319745, 0.6706296629094424, 0, -45}},
                                     {"R3", {1.130475656756149, -0.3207340443140973, 0, 45}},
                                     {"R4", {1.8361682243803232, 0.6706296629094424, 0, -45}},
                                     {"R5", {4.058898276396545, -0.3042673707297409, 0, 174.74596978215544}},
                                     {"P1", {0.09964253946370416, 0.0598179736418068, 0, 0}},
                                     {"P2", {3.859240679385118, -0.28590725211294893, 0, 0}}})),
      options);
  expect_same_bits(simulation, 2, teams_of_random_ground());
}

/// Robots that doors spawn, and that die at drains or when their packs are empty, and interventions that add
/// and remove robots, some in the same tick and at the same place.
constexpr std::string_view k_turnover = R"({
  "troupe": 1, "title": "Turnover", "seed": 5, "mortal": true,
  "types": {
    "wanderer": {"size_m": [0.31, 0.17, 0.2],
      "drive": {"kind": "diff", "localization": "odom", "odom_error": [0.03, 0.03, 0.05]},
      "controller": {"kind": "wander"}, "sensors": [
      {"name": "eyes", "kind": "ranger", "pose": {"z_m": 0.1}, "transducers": [{"range_max_m": 1.1, "fov_deg": 170.5, "samples": 9}]}],
      "devices": [{"name": "pack", "kind": "power_pack", "capacity_J": 35, "mass_kg": 1, "when_empty": "die"}]},
    "door": {"size_m": [0.2, 0.2, 0.01], "obstacle": false, "ranger_return": -1,
      "devices": [{"name": "spawner", "kind": "spawner", "population": "w", "every_s": 0.3, "within_m": 0.6}]},
    "drain": {"size_m": [0.2, 0.2, 0.01], "obstacle": false, "ranger_return": -1,
      "devices": [{"name": "remover", "kind": "remover", "radius_m": 0.35}]}
  },
  "populations": [
    {"name": "w", "type": "wanderer", "count": 60, "reserve": 150,
     "place": {"rule": "uniform", "region_m": [[-4, -4], [4, 4]]}},
    {"name": "d", "type": "door", "count": 9, "place": {"rule": "grid", "region_m": [[-3, -3], [3, 3]], "pitch_m": 3}},
    {"name": "h", "type": "drain", "count": 4, "place": {"rule": "grid", "region_m": [[-1.5, -1.5], [1.5, 1.5]], "pitch_m": 3}}],
  "at": [
    {"time_s": 0, "add": {"population": "w", "count": 4, "region_m": [[-4, -4], [4, 4]]}},
    {"time_s": 0.5, "add": {"population": "w", "count": 70, "region_m": [[-2, -2], [2, 2]]}},
    {"time_s": 0.5, "remove": {"population": "w", "share": 0.4}},
    {"time_s": 0.5, "add": {"population": "w", "count": 10, "region_m": [[-2, -2], [2, 2]]}},
    {"time_s": 0.8, "add": {"population": "w", "count": 1, "pose": {"x_m": 0.1, "y_m": 0.1}}},
    {"time_s": 0.8, "add": {"population": "w", "count": 1, "pose": {"x_m": 0.2, "y_m": 0.1}}},
    {"time_s": 0.8, "disable": {"population": "w", "share": 0.1}},
    {"time_s": 1.2, "remove": {"population": "w", "count": 5}},
    {"time_s": 1.4, "add": {"population": "w", "count": 100, "region_m": [[-4, -4], [4, 4]]}}
  ]
})";

/// Attaches bodies to its own body and releases them again, in ticks and with bodies that look random.
struct Hook {
  struct State {
    std::uint64_t held = 0;  // 1 plus the id of the body that it carries; 0: none
    std::uint64_t refused = 0;
    TROUPE_FIELDS(held, refused)
  };
  static constexpr double k_reach_m = 0.7;

  static bool holds(const DeviceBatch& batch, std::size_t i, BodyId held) {
    return batch.view.location(held) == RowLocation::here &&
           batch.view.carrier(batch.view.row(held)) == batch.body(i);
  }
  static DeviceKind kind() {
    DeviceKind kind{.name = "hook", .text = "for this test"};
    kind.carries = true;
    kind.scope = ApplyScope::trees;
    kind.prepare = [](const Record&, const Pose&) { return prepared<State>(k_reach_m, 1); };
    kind.act = [](const DeviceBatch& batch) {
      for (std::size_t i = 0; i < batch.rows.size(); ++i) {
        std::uint64_t& held = batch.state.as<State>(batch.slot(i)).held;
        if (held != 0 && !holds(batch, i, BodyId(held - 1))) held = 0;  // the body has died
        const std::uint64_t number = (batch.body(i).value * 7919 + batch.view.tick() * 104729) >> 3;
        if (number % 5 > 1) continue;
        if (held != 0) {
          if (number % 7 < 2) batch.emit(i, 0, 1, BodyId(held - 1));
          continue;
        }
        const std::vector<BodyId> near = bodies_near(batch, i, k_reach_m);
        if (!near.empty()) batch.emit(i, 0, 0, near[number % near.size()]);
      }
    };
    kind.apply = [](const EffectContext& context, const std::any&, const Effect& effect) {
      const Gripping gripping(context);
      auto& state = gripping.state<State>();
      if (effect.verb == 1) {
        if (gripping.view().carrier(gripping.target()) == effect.source) gripping.release();
        state.held = 0;
      } else if (gripping.attach(k_rigid)) {
        state.held = effect.target.value + 1;
      } else {
        ++state.refused;
      }
    };
    return kind;
  }
};

// Robots carry one another: trees of several robots arise across borders, and effects of one tick depend on
// one another across several ranks.
TEST_F(HaloOfARoom, RobotsCarryOneAnotherAcrossBorders) {
  Registry registry = test::registry();
  registry.devices.push_back(Hook::kind());
  SimulationOptions options;
  options.threads = 1;
  std::string room = halo_room(140, 4);
  const std::string_view before = R"("wanderer": {)";
  room.insert(room.find(before) + before.size(), R"("devices": [{"name": "hook", "kind": "hook"}], )");
  const Simulation simulation(write("room.json", room), options, registry);
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 40);
  EXPECT_GT(whole.view().counts().carried, 50u);
  std::size_t deep = 0;
  std::size_t refused = 0;
  for (std::size_t r = 0; r < whole.view().rows(); ++r) {
    const std::optional<BodyId> by = whole.view().carrier(Row(r));
    deep += by && whole.view().carrier(whole.view().row(*by));
    refused += whole.tables()[whole.view().type(Row(r)).devices.back().table]
                   .as<Hook::State>(whole.view().slot(Row(r)))
                   .refused;
  }
  EXPECT_GT(deep, 20u) << "robots that a carried robot carries";
  EXPECT_GT(refused, 100u) << "robots that were already carried, or that carry the robot";
  expect_log(simulation,
             {{2, 1, {}, {}}, {3, 2, 1, 0.0}, {5, 1, 2, {}}, {7, 1, 3, 0.3}, {7, 1, 4, {}, 0.5, {}}},
             expected);
}

// Otherwise, a rank could apply an effect on a tree that another effect of the tick has changed elsewhere.
TEST_F(HaloOfARoom, AKindThatDoesNotDeclareThatItCarriesMustNotAttachOrRelease) {
  std::string room = halo_room(140, 4);
  const std::string_view before = R"("wanderer": {)";
  room.insert(room.find(before) + before.size(), R"("devices": [{"name": "hook", "kind": "hook"}], )");
  SimulationOptions options;
  options.threads = 1;
  for (const bool attaches : {true, false}) {
    DeviceKind hook = Hook::kind();
    hook.carries = false;
    if (!attaches)
      hook.apply = [](const EffectContext& context, const std::any&, const Effect&) {
        Gripping(context).release();
      };
    Registry registry = test::registry();
    registry.devices.push_back(hook);
    const Simulation simulation(write("room.json", room), options, registry);
    const auto error_of = [](World& world) {
      try {
        halo_log(world, 10);
      } catch (const StepError& error) {
        return std::string(error.what());
      }
      return std::string("no error");
    };
    World whole = whole_world(simulation);
    const std::string expected = error_of(whole);
    EXPECT_THAT(expected, HasSubstr("device \"hook\" (hook) of \"w"));
    EXPECT_THAT(expected,
                HasSubstr(fmt::format("threw: Gripping::{} was called by a kind that does not declare "
                                      "that it can carry bodies: set DeviceKind::carries to true",
                                      attaches ? "attach()" : "release()")));
    HaloRanks ranks(simulation, {3, 1, {}, {}});
    EXPECT_EQ(error_of(ranks.world()), expected);
  }
}

class HaloOfHooks : public HaloOfARoom {
 protected:
  /// The room of halo_room(), with further robots in a square that carry others.
  Simulation load(double half_m, std::size_t hooked, std::string_view square) const {
    Registry registry = test::registry();
    registry.devices.push_back(Hook::kind());
    SimulationOptions options;
    options.threads = 1;
    std::string room = halo_room(300, half_m);
    const auto insert_after = [&room](std::string_view place, const std::string& text) {
      room.insert(room.find(place) + place.size(), text);
    };
    insert_after(R"("types": {)",
                 R"("hooked": {"extends": "wanderer", "devices": [{"name": "hook", "kind": "hook"}]},)");
    insert_after(R"("populations": [)", fmt::format(R"({{"name": "h", "type": "hooked", "count": {},
                   "place": {{"rule": "uniform", "region_m": {}}}}},)",
                                                    hooked, square));
    return Simulation(write("room.json", room), options, registry);
  }
};

/// The number of ticks of a world in which its trees change, and the number of ticks in which bodies carry
/// bodies that carry others.
struct TreeTicks {
  std::size_t changes = 0;
  std::size_t deep = 0;
};
TreeTicks tree_ticks(World& world, std::uint64_t ticks) {
  TreeTicks count;
  std::vector<std::optional<BodyId>> before;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    world.step();
    std::vector<std::optional<BodyId>> carriers;
    bool is_deep = false;
    for (std::size_t r = 0; r < world.view().rows(); ++r) {
      carriers.push_back(world.view().carrier(Row(r)));
      is_deep = is_deep || (carriers.back() && world.view().carrier(world.view().row(*carriers.back())));
    }
    count.changes += tick > 0 && carriers != before;
    count.deep += is_deep;
    before = std::move(carriers);
  }
  return count;
}

// Trees that no other rank has as ghosts change on their own rank alone. Only trees that grow beyond the
// largest tree so far cause a distribution.
TEST_F(HaloOfHooks, TreesFarFromBordersNeedNoDistribution) {
  constexpr std::uint64_t k_ticks = 60;
  const Simulation simulation = load(60, 30, "[[50, 50], [53, 53]]");
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, k_ticks);
  whole.reset();
  const TreeTicks trees = tree_ticks(whole, k_ticks);
  EXPECT_GT(trees.changes, k_ticks * 3 / 4);
  EXPECT_GT(trees.deep, k_ticks / 2);
  HaloRanks ranks(simulation, {.ranks = 2});
  expect_equal_logs(halo_log(ranks.world(), k_ticks), expected, "far from the border");
  for (const RankCounts& counts : ranks.counts()) EXPECT_LT(counts.distributions, trees.changes / 2);
  std::vector<HaloTeam> teams = k_experiment_teams;
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    teams.push_back({5, 1, seed, 0.05 * static_cast<double>(seed), 1, {}});
  expect_log(simulation, teams, expected);
}

// The same with few trees everywhere: some of them are ghosts on other ranks, which link them again.
TEST_F(HaloOfHooks, LocalAndSharedTreesChangeInTheSameTicks) {
  constexpr std::uint64_t k_ticks = 60;
  const Simulation simulation = load(16, 24, "[[-14, -14], [14, 14]]");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, k_ticks);
  std::vector<HaloTeam> teams = k_experiment_teams;
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    teams.push_back({4, 1, seed, 0.05 * static_cast<double>(seed), 1, {}});
  expect_log(simulation, teams, expected);
}

// In a small room, all trees are ghosts on the other rank. Few of them have bodies of both ranks.
TEST_F(HaloOfHooks, GhostsOfChangedTreesAreLinkedAgain) {
  constexpr std::uint64_t k_ticks = 60;
  const Simulation simulation = load(7, 4, "[[-6, -6], [6, 6]]");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, k_ticks);
  whole.reset();
  const TreeTicks trees = tree_ticks(whole, k_ticks);
  EXPECT_GT(trees.changes, k_ticks / 3);
  HaloRanks ranks(simulation, {.ranks = 2, .skin_m = 20.0});
  expect_equal_logs(halo_log(ranks.world(), k_ticks), expected, "a small room");
  for (const RankCounts& counts : ranks.counts()) {
    EXPECT_EQ(counts.own + counts.ghosts, whole.view().rows() * counts.ticks) << "all robots are here";
    EXPECT_LT(counts.distributions, trees.changes * 3 / 4);
  }
}

// Robots that carry others die, by interventions and by removers. Their cargo is released.
TEST_F(HaloOfHooks, CarriersDie) {
  Registry registry = test::registry();
  registry.devices.push_back(Hook::kind());
  SimulationOptions options;
  options.threads = 1;
  std::string world(k_turnover);
  const std::string_view pack = R"("when_empty": "die"})";
  world.insert(world.find(pack) + pack.size(), R"(, {"name": "hook", "kind": "hook"})");
  const Simulation simulation(write("turnover.json", world), options, registry);
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  std::size_t dead_carriers = 0;
  std::vector<Hashes> expected{whole.hashes()};
  for (int tick = 0; tick < 20; ++tick) {
    std::vector<BodyId> carriers;
    for (std::size_t r = 0; r < whole.view().rows(); ++r)
      if (const std::optional<BodyId> by = whole.view().carrier(Row(r))) carriers.push_back(*by);
    whole.step();
    expected.push_back(whole.hashes());
    for (const BodyId by : carriers) dead_carriers += !whole.view().is_there(whole.view().row(by));
  }
  EXPECT_GT(dead_carriers, 10u);
  std::vector<HaloTeam> teams = k_experiment_teams;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) teams.push_back({5, 1, seed, 0.0, 0.5, {}});
  expect_log(simulation, teams, expected);
}

/// A crowd of robots that wave arms: one arm slides, another turns and has a third one on it. Some robots
/// also have grippers, which close on pucks and on other robots.
std::string halo_wavers() {
  const auto orders = [](std::string_view device, double low, double high) {
    std::string text;
    for (int k = 0; k < 12; ++k)
      text += fmt::format(R"({}{{"at_s": {}, "device": "{}", "order": "go_to", "value": {}}})",
                          k == 0 ? "" : ", ", 0.3 * k, device, k % 3 == 1 ? low : high);
    return text;
  };
  return fmt::format(
      R"({{
  "troupe": 1, "title": "Wavers", "seed": 9, "overlaps": "warn",
  "types": {{
    "wall": {{"size_m": [0.2, 3, 1]}},
    "puck": {{"size_m": [0.08, 0.08, 0.3], "gripper_return": true, "pushable": true}},
    "slider": {{"size_m": [0.3, 0.17, 0.2], "gripper_return": true,
      "drive": {{"kind": "diff", "pushes": 1}}, "sensors": [
      {{"name": "eyes", "kind": "ranger", "pose": {{"z_m": 0.1}}, "transducers": [{{"range_max_m": 1.1, "fov_deg": 170.5, "samples": 9}}]}}],
      "devices": [{{"name": "arm", "kind": "actuator", "axis": [1, 0, 0], "max_position": 0.25, "max_speed": 0.8,
        "size_m": [0.2, 0.05, 0.1], "pose": {{"x_m": 0.1}}}}],
      "controllers": [{{"kind": "wander"}}, {{"kind": "operate", "orders": [{}]}}]}},
    "swinger": {{"size_m": [0.2, 0.2, 0.2], "gripper_return": true,
      "drive": {{"kind": "diff", "pushes": 0}}, "sensors": [
      {{"name": "eyes", "kind": "ranger", "pose": {{"z_m": 0.1}}, "transducers": [{{"range_max_m": 1.1, "fov_deg": 170.5, "samples": 9}}]}}],
      "parts": [{{"name": "arm", "kind": "actuator", "size_m": [0.3, 0.05, 0.1], "pose": {{"x_m": 0.2, "y_m": 0.1}},
        "device": {{"type": "rotational", "axis": [0, 0, 1], "min_position": -1, "max_position": 1.5, "max_speed": 3}},
        "parts": [{{"name": "finger", "kind": "actuator", "size_m": [0.04, 0.1, 0.08], "pose": {{"x_m": 0.12}},
          "device": {{"axis": [0, 1, 0], "max_position": 0.2, "max_speed": 0.7}}}}]}}],
      "controllers": [{{"kind": "wander"}}, {{"kind": "operate", "orders": [{}, {}]}}]}},
    "gripper": {{"size_m": [0.2, 0.2, 0.2], "gripper_return": true,
      "drive": {{"kind": "diff", "pushes": 0}}, "sensors": [
      {{"name": "eyes", "kind": "ranger", "pose": {{"z_m": 0.1}}, "transducers": [{{"range_max_m": 1.1, "fov_deg": 170.5, "samples": 9}}]}}],
      "devices": [{{"name": "hand", "kind": "gripper", "size_m": [0.2, 0.3, 0.2], "autosnatch": true, "pose": {{"x_m": 0.15}}}}],
      "controllers": [{{"kind": "wander", "min_front_m": 0.1}}]}}
  }},
  "models": [{{"name": "wall", "type": "wall", "pose": {{"x_m": 0.7, "heading_deg": 0.7}}}}],
  "populations": [
    {{"name": "s", "type": "slider", "count": 40, "place": {{"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}}}},
    {{"name": "t", "type": "swinger", "count": 40, "place": {{"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}}}},
    {{"name": "g", "type": "gripper", "count": 60, "place": {{"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}}}},
    {{"name": "p", "type": "puck", "count": 220, "place": {{"rule": "uniform", "region_m": [[-3, -3], [3, 3]]}}}}]
}})",
      orders("arm", 0, 0.25), orders("arm", -1, 1.5), orders("finger", 0, 0.2));
}

// Joints whose motions are blocked by joints of robots on other ranks, and grippers that hold pucks and
// robots of other ranks.
TEST_F(HaloOfARoom, JointsMoveAndGrippersHoldAcrossBorders) {
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("wavers.json", halo_wavers()), options);
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 40);
  EXPECT_GT(whole.view().counts().carried, 8u);
  std::size_t blocked = 0;
  for (std::size_t r = 0; r < whole.view().rows(); ++r)
    for (const BodyType::Device& device : whole.view().type(Row(r)).devices)
      if (device.kind->name == "actuator")
        blocked += whole.tables()[device.table].as<models::ActuatorState>(whole.view().slot(Row(r))).stalled;
  EXPECT_GT(blocked, 8u) << "joints whose motion was blocked in the last tick";
  std::vector<HaloTeam> teams = k_experiment_teams;
  for (HaloTeam& team : teams) team.tile_m = 0.5;
  teams.push_back({5, 1, 3, 0.0, 0.25, {}});
  expect_log(simulation, teams, expected);
}

/// The kind `actuator`, whose hook `joints_moved` throws in one tick for one robot.
struct StuckActuator {
  static inline std::uint64_t throws_at = 0;  // tick
  static inline BodyId throws_for;
  static inline decltype(DeviceKind::joints_moved) joints_moved = nullptr;

  static Registry registry() {
    Registry registry = test::registry();
    DeviceKind& actuator = *std::ranges::find(registry.devices, "actuator", &DeviceKind::name);
    joints_moved = actuator.joints_moved;
    actuator.joints_moved = [](const DeviceBatch& batch) {
      for (std::size_t i = 0; batch.view.tick() == throws_at && i < batch.rows.size(); ++i)
        if (batch.body(i) == throws_for) throw StepError(fmt::format("tick {}: the arm is stuck", throws_at));
      joints_moved(batch);
    };
    return registry;
  }
};

// The robots are sliders at different places, so some ranks have a row of the robot and others have not. In
// these ticks, devices also have effects, for which ranks wait for one another after the hook.
TEST_F(HaloOfARoom, AJointHookThatThrowsEndsTheTickOnAllRanks) {
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("wavers.json", halo_wavers()), options, StuckActuator::registry());
  for (const std::uint32_t robot : {0u, 13u, 26u, 39u}) {
    StuckActuator::throws_for = simulation.world().state().names.find("s" + std::to_string(robot));
    expect_same_error(simulation, 4 + robot % 3, StuckActuator::throws_at, "the arm is stuck");
  }
}

/// Two robots with an arm, far from each other. Only one of them moves its arm.
constexpr std::string_view k_one_waver = R"({"troupe": 1, "types": {
  "still": {"size_m": [0.3, 0.17, 0.2], "drive": {"kind": "diff"}, "devices": [
    {"name": "arm", "kind": "actuator", "axis": [1, 0, 0], "max_position": 0.25, "max_speed": 0.8,
     "size_m": [0.2, 0.05, 0.1], "pose": {"x_m": 0.1}}]},
  "waver": {"extends": "still", "controller":
    {"kind": "operate", "orders": [{"at_s": 0, "device": "arm", "order": "go_to", "value": 0.25}]}}},
  "models": [{"name": "s", "type": "still", "pose": {"x_m": 20}},
             {"name": "w", "type": "waver", "pose": {"x_m": -20}}]})";

// The ranks do not tell one another whether arms move, because no device wants to know which joints moved.
TEST_F(HaloOfARoom, OnlyTheJointsOfOneRankMoveAndNoKindHasTheHook) {
  Registry registry = test::registry();
  std::ranges::find(registry.devices, "actuator", &DeviceKind::name)->joints_moved = nullptr;
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("waver.json", std::string(k_one_waver)), options, registry);
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  halo_log(whole, 4);
  EXPECT_GT(whole.state().joint_state(whole.view().row(whole.state().names.find("w")), 0).x, 0);
  EXPECT_EQ(whole.state().joint_state(whole.view().row(whole.state().names.find("s")), 0).x, 0);
  expect_same_bits(simulation, 4, {{2, 1, {}, {}}, {3, 1, 5, {}}});
}

// The hook also runs for the robot that moves no joint, and that has no ghost on the rank of the other.
TEST_F(HaloOfARoom, OnlyTheJointsOfOneRankMoveAndAllHaveTheHook) {
  Registry registry = test::registry();
  DeviceKind& actuator = *std::ranges::find(registry.devices, "actuator", &DeviceKind::name);
  actuator.joints_moved = [](const DeviceBatch& batch) {
    for (std::size_t i = 0; i < batch.rows.size(); ++i)
      batch.state.as<models::ActuatorState>(batch.slot(i)).velocity = static_cast<double>(batch.view.tick());
  };
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("waver.json", std::string(k_one_waver)), options, registry);
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  halo_log(whole, 4);
  for (const char* robot : {"s", "w"}) {
    const Row row = whole.view().row(whole.state().names.find(robot));
    EXPECT_EQ(whole.tables()[whole.view().type(row).devices[0].table]
                  .as<models::ActuatorState>(whole.view().slot(row))
                  .velocity,
              4);
  }
  expect_same_bits(simulation, 4, {{2, 1, {}, {}}, {3, 1, 5, {}}});
}

/// Robots whose grippers close on pucks, each with a robot that looks at the puck; and far from all of them,
/// a robot that is moved before each tick.
std::string halo_catchers() {
  constexpr int k_catchers = 8;
  std::string models;
  for (int k = 0; k < k_catchers; ++k) {
    const double heading = 0.3 + 0.7 * k;
    const auto pose = [&](double ahead_m, double turned) {
      return fmt::format(R"({{"x_m": {}, "y_m": {}, "heading_rad": {}}})",
                         6 * k + ahead_m * std::cos(heading), ahead_m * std::sin(heading), heading + turned);
    };
    models += fmt::format(
        R"({{"name": "c{0}", "type": "catcher", "pose": {1}}}, {{"name": "p{0}", "type": "puck", "pose": {2}}},
    {{"name": "e{0}", "type": "eye", "pose": {3}}}, )",
        k, pose(0, 0), pose(0.85, 0.1), pose(2, std::numbers::pi));
  }
  std::string moves;
  for (int tick = 0; tick < 30; ++tick)
    moves +=
        fmt::format(R"({}{{"time_s": {}, "move": {{"model": "far", "pose": {{"x_m": {}, "y_m": 90}}}}}})",
                    tick == 0 ? "" : ",\n    ", 0.1 * tick, 0.02 * tick);
  return fmt::format(R"({{"troupe": 1, "title": "Catchers", "types": {{
  "catcher": {{"size_m": [0.2, 0.2, 0.3], "drive": {{"kind": "diff"}}, "devices": [
    {{"name": "hand", "kind": "gripper", "pose": {{"x_m": 0.55, "z_m": 0.02}}, "size_m": [0.9, 1.0, 0.3], "autosnatch": true}}]}},
  "puck": {{"size_m": [0.1, 0.1, 0.1], "gripper_return": true, "fiducial_return": 1}},
  "eye": {{"size_m": [0.2, 0.2, 0.2], "drive": {{"kind": "diff"}}, "sensors": [
    {{"name": "finder", "kind": "fiducial", "active": true, "range_max_m": 3, "pose": {{"z_m": 0.05}}}}]}},
  "bot": {{"size_m": [0.2, 0.2, 0.2], "drive": {{"kind": "diff"}}}}}},
  "models": [{}{{"name": "far", "type": "bot", "pose": {{"y_m": 90}}}}],
  "at": [{}]}})",
                     models, moves);
}

// In the tick in which a robot has gripped a puck, its rank learns that another rank has moved a body: the
// poses of all carried bodies are then computed again.
TEST_F(HaloOfARoom, CargoFollowsAMoveOnAnotherRank) {
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("catchers.json", halo_catchers()), options);
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 30);
  EXPECT_EQ(whole.view().counts().carried, 8u);
  expect_log(simulation, k_experiment_teams, expected);
}

class HaloOfAWorld : public ::testing::TestWithParam<std::string_view> {};

TEST_P(HaloOfAWorld, GivesTheSameBits) {
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(k_halo_worlds / GetParam(), options);
  std::uint64_t ticks = simulation.world().spec().bodies.size() > 500 ? 10 : 40;
  if (GetParam() == "failures.json") ticks = 260;  // its last intervention is at 25 s
  expect_same_bits(simulation, ticks, {{3, 1, {}, {}}, {5, 1, 7, {}}});
}

INSTANTIATE_TEST_SUITE_P(Worlds, HaloOfAWorld,
                         ::testing::Values("crowd.json", "hospital.json", "flock.json", "radios.json",
                                           "fiducial.world", "camera.world", "bumper.world", "blobs.world",
                                           "noise.world", "compass.json", "finders.json", "perception.json",
                                           "door.json", "chain.json", "coverage.json", "beeclust.json",
                                           "failures.json", "energy.json", "foraging.json", "colony.json",
                                           "pushers.json", "clustering.json", "foragers.json", "gate.json",
                                           "gripper.json", "harvest.json", "harvesters.json", "magpies.json",
                                           "pucks.json", "lift.world"),
                         [](const auto& run) {
                           std::string name(run.param);
                           for (char& c : name)
                             if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                           return name;
                         });

class HaloOfATurnover : public test::ScratchTest {
 protected:
  Simulation load(const Registry& registry = test::registry()) const {
    SimulationOptions options;
    options.threads = 1;
    return Simulation(write("turnover.json", std::string(k_turnover)), options, registry);
  }
};

TEST_F(HaloOfATurnover, BirthsAndDeathsAreTheSameOnAllRanks) {
  const Simulation simulation = load();
  ASSERT_EQ(why_replicated(simulation.world()), "");
  World whole = whole_world(simulation);
  const std::vector<Hashes> expected = halo_log(whole, 18);
  EXPECT_EQ(whole.lives().unborn(0), 0u) << "the last births are refused";
  std::size_t dead = 0;
  for (std::size_t r = 0; r < whole.view().rows(); ++r)
    dead += whole.view().presence(Row(r)) == Presence::dead;
  EXPECT_GT(dead, 40u);
  for (const HaloTeam& team : all_teams(1)) {
    HaloRanks ranks(simulation, team);
    expect_equal_logs(halo_log(ranks.world(), 18), expected, name_of(team));
    if (HasFatalFailure()) return;
    EXPECT_EQ(ranks.world().robots(), whole.robots()) << name_of(team);
    EXPECT_EQ(ranks.world().view().absent_count(), whole.view().absent_count()) << name_of(team);
    EXPECT_EQ(ranks.world().lives().unborn(0), 0u) << name_of(team);
  }
}

// Until the packs are empty, which is when the robots die that no drain and no intervention has removed.
TEST_F(HaloOfATurnover, RunsAndResetsGiveTheSameBits) { expect_same_bits(load(), 60, k_experiment_teams, 2); }

// Rank 0 has all rows when the program spawns or removes bodies, and the other ranks follow.
TEST_F(HaloOfATurnover, ProgramsSpawnAndRemoveBodies) {
  const auto program = [](World& world) {
    world.gather();
    const double x = 0.4 * static_cast<double>(world.tick() % 16) - 3;
    static_cast<void>(world.spawn(0, {x, 3.7, 0, 0.3}));
    for (std::size_t r = 0; r < world.view().rows(); ++r)
      if (world.view().body(Row(r)).value == 2 * world.tick()) world.remove(Row(r));
  };
  expect_same_bits(load(), 30, k_experiment_teams, 1, program);
}

// Devices act on bodies that are unborn, alive or dead, and that are born or die in the same tick.
TEST_F(HaloOfATurnover, DevicesActOnDistantBodies) {
  Registry registry = test::registry();
  registry.devices.push_back(far_mixer_kind());
  std::string text(k_turnover);
  const std::string_view before = R"("when_empty": "die"})";
  text.insert(text.find(before) + before.size(), R"(, {"name": "mixer", "kind": "mixer"})");
  SimulationOptions options;
  options.threads = 1;
  const Simulation simulation(write("turnover.json", text), options, registry);
  expect_same_bits(simulation, 40, k_experiment_teams, 2);
}

/// The kind `spawner`, whose hook `born` throws in one tick for every third door. Doors are far from one
/// another, so the hook throws on some ranks and not on others.
struct UnluckySpawner {
  static inline std::uint64_t throws_at = 0;  // tick
  static inline decltype(DeviceKind::born) born = nullptr;

  static Registry registry() {
    Registry registry = test::registry();
    DeviceKind& spawner = *std::ranges::find(registry.devices, "spawner", &DeviceKind::name);
    born = spawner.born;
    spawner.born = [](const EffectContext& context, const std::any& data, const Effect& effect,
                      const Birth& birth) {
      if (Gripping(context).view().tick() == throws_at && effect.source.value % 3 == 1)
        throw std::runtime_error("stillborn");
      born(context, data, effect, birth);
    };
    return registry;
  }
};

// In tick 6, doors request births.
TEST_F(HaloOfATurnover, ABirthThatThrowsEndsTheTickOnAllRanks) {
  expect_same_error(load(UnluckySpawner::registry()), 6, UnluckySpawner::throws_at, "stillborn");
}

/// The kind `power_pack`, whose hook `start` can throw.
struct UnluckyPack {
  static inline std::atomic<bool> throws = false;
  static inline decltype(DeviceKind::start) start = nullptr;

  static Registry registry() {
    Registry registry = test::registry();
    DeviceKind& pack = *std::ranges::find(registry.devices, "power_pack", &DeviceKind::name);
    start = pack.start;
    pack.start = [](const std::any& data, StateTable& state, std::size_t slot) {
      if (throws) throw std::runtime_error("leaking");
      start(data, state, slot);
    };
    return registry;
  }
};

// The intervention of tick 5 spawns robots. Their rows are on one rank, which fails, while the other ranks
// wait for its rows, and rank 0 also has a callback.
TEST_F(HaloOfATurnover, ABirthThatThrowsBeforeTheCallbackEndsTheTickOnAllRanks) {
  const Simulation simulation = load(UnluckyPack::registry());
  const auto error_of = [](World& world) {
    world.before_tick([&world] { world.gather(); });
    halo_log(world, 5);
    UnluckyPack::throws = true;
    std::string text;
    try {
      world.step();
    } catch (const StepError& error) {
      text = error.what();
    }
    UnluckyPack::throws = false;
    world.reset();
    return text;
  };
  World whole = whole_world(simulation);
  const std::string expected = error_of(whole);
  EXPECT_THAT(expected, HasSubstr("threw: leaking"));
  const std::vector<Hashes> log = halo_log(whole, 8);
  std::vector<HaloTeam> teams = k_experiment_teams;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) teams.push_back({3, 1, seed, {}, 1, {}});
  for (const HaloTeam& team : teams) {
    HaloRanks ranks(simulation, team);
    EXPECT_EQ(error_of(ranks.world()), expected) << name_of(team);
    expect_equal_logs(halo_log(ranks.world(), 8), log, "after the error, " + name_of(team));
  }
}

TEST_F(HaloOfARoom, SaysWhyAWorldIsReplicated) {
  const auto reason = [this](const std::string& type, const std::string& reserve = {}) {
    SimulationOptions options;
    options.threads = 1;
    const std::string text = R"({"troupe": 1, "types": {"bot": {"size_m": [0.2, 0.2, 0.2], )" + type + R"(}},
           "populations": [{"name": "p", "type": "bot", "count": 1)" +
                             reserve + R"(, "place": {"rule": "uniform", "region_m": [[0, 0], [1, 1]]}}]})";
    return why_replicated(Simulation(write("why.json", text), options).world());
  };
  const std::string arm =
      R"("devices": [{"name": "arm", "kind": "actuator", "max_position": 1, "size_m": [0.1, 0.1, 0.1]}])";
  EXPECT_EQ(reason(arm), "");
  EXPECT_THAT(reason(arm + R"(, "pushable": true)"), HasSubstr("can be pushed, and have joints"));
  EXPECT_THAT(reason(arm, R"(, "reserve": 1)"), HasSubstr("\"bot\", which have joints, can be born"));
  EXPECT_THAT(reason(R"("devices": [{"name": "feet", "kind": "wheels", "size_m": [0.1, 0.1, 0.1]}])"),
              HasSubstr("which can drive a part of the robot to any distance"));
}

TEST_F(HaloOfMixers, RefusesAWorldThatMustBeReplicated) {
  DeviceKind kind = Mixer::kind();
  kind.scope = ApplyScope::anything;
  const Simulation simulation = load_mixers(kind);
  World world = whole_world(simulation);
  partition::Mailboxes mailboxes(1);
  EXPECT_THROW(Replica(world, simulation.registry(), mailboxes.of(0), 0, {.is_distributed = true}),
               std::logic_error);
  world.step();  // the world computes all rows itself, as before
  EXPECT_EQ(world.tick(), 1u);
}

}  // namespace
}  // namespace troupe::engine::halo_test
