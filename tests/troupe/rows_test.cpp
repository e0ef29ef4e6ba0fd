// Nothing that a simulation computes or reports depends on the rows of its bodies, even if bodies change
// their rows during the run (World::shuffle_rows()), or leave the world and come back (World::remove_rows()).

#include "base/random.hpp"
#include "engine/observing/events.hpp"
#include "engine/observing/remade_world.hpp"
#include "engine/world/world.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paths.hpp"
#include "troupe/troupe.hpp"
#include "worldio/results/recording_fields.hpp"

#include <gtest/gtest.h>

#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace troupe::rows_test {
namespace {

namespace fs = std::filesystem;

const fs::path k_shipped = test::source_dir() / "worlds";

/// A shipped world, and measures of what only this world has.
struct Observed {
  std::string world;
  std::uint64_t ticks;
  std::vector<std::string> measures;
};

std::vector<std::string> measures_of(const Observed& observed) {
  std::vector<std::string> measures{"alive",
                                    "stalls",
                                    "held",
                                    "displacement",
                                    "path_length",
                                    "mean_speed",
                                    "order",
                                    "spread",
                                    "coverage",
                                    "mean_nearest_distance",
                                    "neighbours",
                                    R"({"kind": "clusters", "distance_m": 0.5, "bodies": "robots"})",
                                    R"({"kind": "largest_cluster", "distance_m": 0.5, "bodies": "robots"})",
                                    R"({"kind": "share_within", "center_m": [0, 0], "radius_m": 3})",
                                    R"({"kind": "rank_errors", "center_m": [0, 0]})",
                                    R"({"kind": "state_mean", "component": "pose", "field": "x"})",
                                    R"({"kind": "state_variance", "component": "velocity", "field": "x"})"};
  measures.insert(measures.end(), observed.measures.begin(), observed.measures.end());
  return measures;
}

template <class T>
std::string bytes_in(std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What happens to the rows of a world between two ticks.
enum class Rows {
  stay,
  are_shuffled,
  leave,  ///< a third of the bodies leaves the world and comes back, in another order
};

/// The root of the tree of bodies that carry `id`.
BodyId root_of(const engine::World& world, BodyId id) {
  while (const auto carrier = world.view().carrier(world.view().row(id))) id = *carrier;
  return id;
}

/// The sum of the hashes of the rows that a body has in the tables of a world.
std::uint64_t hash_of(const engine::World& world, BodyId id) {
  std::uint64_t sum = 0;
  for (const engine::StateTable& table : world.tables())
    if (const std::size_t at = world.view().row_in(table, world.view().row(id));
        at < table.rows() && table.ids()[at] == id)
      sum += table.hash_row(at);
  return sum;
}

void leave_and_come_back(engine::World& world, std::uint64_t seed) {
  Random random(seed, stream_id("test", "leave"), 0, static_cast<std::uint32_t>(world.tick()));
  const std::uint32_t third = random.below(3);
  std::vector<BodyId> leaving;
  for (std::size_t r = 0; r < world.view().rows(); ++r)
    if (const BodyId id = world.view().body(Row(r)); root_of(world, id).value % 3 == third)
      leaving.push_back(id);
  random.shuffle(leaving);
  const std::size_t rows = world.view().rows();
  const std::uint64_t hash = world.hashes().state;
  std::uint64_t of_leaving = 0;
  for (const BodyId id : leaving) of_leaving += hash_of(world, id);
  std::vector<engine::RowState> states = world.remove_rows(leaving);
  EXPECT_EQ(world.view().rows(), rows - leaving.size());
  EXPECT_EQ(world.hashes().state, hash - of_leaving);
  for (const BodyId id : leaving) EXPECT_EQ(world.view().location(id), engine::RowLocation::elsewhere);
  if (!leaving.empty()) {
    EXPECT_THROW(static_cast<void>(world.view().row(leaving.front())), std::logic_error);
  }
  random.shuffle(states);
  world.add_rows(states);
  EXPECT_EQ(world.view().rows(), rows);
  EXPECT_EQ(world.hashes().state, hash);
}

/// A run of a world with everything that keeps data about bodies from tick to tick.
class Observers {
 public:
  Observers(const Observed& observed, unsigned threads, Rows rows)
      : simulation_(k_shipped / observed.world, options(threads)),
        measures_(simulation_, measures_of(observed)),
        events_(simulation_.world()),
        components_(worldio::recorded_components(simulation_.world(), std::vector<std::string>{"all"})),
        swarm_(simulation_.swarm()),
        rows_(rows) {
    simulation_.before_tick([this](Simulation&) { change_rows(2); });
    change_rows(1);
  }
  const Simulation& simulation() const { return simulation_; }

  void step() {
    simulation_.step();
    change_rows(1);
    measures_.see();
    seen_ = events_.see(simulation_.world());
    place_one();
    change_rows(3);  // the list of the bodies that were placed refers to rows
  }

  /// What is reported of the present state, as bytes, by what reports it.
  std::map<std::string, std::string> reports() {
    engine::World& world = simulation_.world();
    std::map<std::string, std::string> reports{{"hashes", simulation_.hash_log_line()}};
    const std::vector<double> values = measures_.values();
    for (std::size_t m = 0; m < values.size(); ++m)
      reports["measure " + measures_.columns()[m]] = bytes_in(std::span(&values[m], 1));
    for (const engine::Event& event : seen_)
      reports["events"] += std::string(engine::event_name(event.type)) + ' ' +
                           std::to_string(event.body.value) + ' ' + std::to_string(event.other.value) + '\n';
    for (const worldio::RecordedComponent& component : components_) {
      std::vector<std::vector<std::byte>> fields;
      for (std::size_t f = 0; f < component.fields.size(); ++f) fields.emplace_back(component.bytes(f));
      std::vector<std::span<std::byte>> spans(fields.begin(), fields.end());
      worldio::gather(world, component, spans);
      for (const std::vector<std::byte>& field : fields)
        reports["recorded " + component.name] += bytes_in(std::span<const std::byte>(field));
    }
    std::vector<Pose> poses(swarm_.size());
    std::vector<Pose> estimates(swarm_.size());
    std::vector<Model::Speed> speeds(swarm_.size());
    std::vector<std::uint8_t> alive(swarm_.size());
    swarm_.poses(poses);
    swarm_.estimates(estimates);
    swarm_.speeds(speeds);
    swarm_.alive(alive);
    reports["swarm"] = bytes_in(std::span<const Pose>(poses)) + bytes_in(std::span<const Pose>(estimates)) +
                       bytes_in(std::span<const Model::Speed>(speeds)) +
                       bytes_in(std::span<const std::uint8_t>(alive));
    return reports;
  }

 private:
  static SimulationOptions options(unsigned threads) {
    SimulationOptions options;
    options.threads = threads;
    return options;
  }
  void change_rows(std::uint64_t seed) {
    if (rows_ == Rows::are_shuffled) simulation_.world().shuffle_rows(seed);
    if (rows_ == Rows::leave) leave_and_come_back(simulation_.world(), seed);
  }
  /// Places one robot nearer to the origin, in every fifth tick.
  void place_one() {
    engine::World& world = simulation_.world();
    if (world.tick() % 5 != 0 || swarm_.size() == 0) return;
    const BodyId id = swarm_.ids()[world.tick() % swarm_.size()];
    const Row row = world.view().row(id);
    if (!world.view().is_there(row) || world.view().carrier(row)) return;
    Pose pose = world.view().pose(id);
    pose.x *= 0.99;
    pose.y *= 0.99;
    simulation_.set_poses(std::vector<std::pair<Model, Pose>>{{simulation_.model(id), pose}});
  }

  Simulation simulation_;
  Measures measures_;
  engine::EventWatch events_;
  std::vector<worldio::RecordedComponent> components_;
  Swarm swarm_;
  Rows rows_;
  std::span<const engine::Event> seen_;
};

class RowsThatChange : public ::testing::TestWithParam<std::tuple<Observed, Rows>> {};

TEST_P(RowsThatChange, ChangeNothingThatIsReported) {
  const auto& [observed, rows] = GetParam();
  Observers plain(observed, 1, Rows::stay);
  Observers changing(observed, 2, rows);
  while (plain.simulation().tick() < observed.ticks) {
    plain.step();
    changing.step();
    const std::map<std::string, std::string> expected = plain.reports();
    const std::map<std::string, std::string> got = changing.reports();
    ASSERT_EQ(got.size(), expected.size()) << "tick " << plain.simulation().tick();
    for (const auto& [name, bytes] : expected) {
      const auto found = got.find(name);
      ASSERT_TRUE(found != got.end() && found->second == bytes)
          << name << " at tick " << plain.simulation().tick();
    }
  }
}

const std::vector<Observed> k_observed{
    // interventions and faults
    {"failures.json",
     220,
     {R"({"kind": "state_mean", "component": "laser", "field": "ranges", "name": "range"})"}},
    {"colony.json", 60, {R"({"kind": "deaths", "type": "ant"})"}},  // births and deaths
    {"magpies.json", 60, {}},                                       // carried bodies
    {"lift.world", 60, {}},                                         // joints
    {"pucks.json", 60, {}},
    {"crowd.json", 10, {}}};

INSTANTIATE_TEST_SUITE_P(Worlds, RowsThatChange,
                         ::testing::Combine(::testing::ValuesIn(k_observed),
                                            ::testing::Values(Rows::are_shuffled, Rows::leave)),
                         [](const auto& run) {
                           std::string name = std::get<0>(run.param).world;
                           for (char& c : name)
                             if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                           return name + (std::get<1>(run.param) == Rows::leave ? "_leave" : "_shuffled");
                         });

TEST(RowOrder, GivesBodiesOtherRowsAndSlots) {
  Simulation simulation(k_shipped / "failures.json");
  simulation.run_for(1);
  engine::World& world = simulation.world();
  std::vector<BodyId> bodies;
  std::vector<std::size_t> slots;  // by body
  std::vector<Vec2> vertices;      // the first of each body
  for (std::size_t b = 0; b < world.spec().bodies.size(); ++b) {
    const Row row = world.view().row(BodyId(b));
    slots.push_back(row.valid() ? world.view().slot(row) : 0);
    vertices.push_back(row.valid() ? world.view().outline(row).front() : Vec2::Zero());
  }
  for (std::size_t r = 0; r < world.view().rows(); ++r) bodies.push_back(world.view().body(Row(r)));
  world.shuffle_rows(1);
  std::size_t same_rows = 0;
  std::size_t same_slots = 0;
  for (std::size_t r = 0; r < world.view().rows(); ++r) {
    const BodyId id = world.view().body(Row(r));
    EXPECT_EQ(world.view().row(id), Row(r));
    EXPECT_EQ(world.view().outline(Row(r)).front(), vertices[id.index()]);
    EXPECT_EQ(&world.view().type(Row(r)),
              &world.view().types()[world.spec().bodies[id.index()].type.index()]);
    same_rows += bodies[r] == id;
    same_slots += slots[id.index()] == world.view().slot(Row(r));
  }
  for (const engine::StateTable& table : world.tables())
    for (std::size_t at = 0; at < table.rows(); ++at)
      EXPECT_EQ(world.view().row_in(table, world.view().row(table.ids()[at])), at) << table.component();
  EXPECT_LT(same_rows, world.view().rows() / 4);
  EXPECT_LT(same_slots, world.view().rows() / 2);
}

TEST(RowOrder, DoesNotMatterToAWorldThatIsRebuilt) {
  Simulation simulation(k_shipped / "colony.json");
  engine::World& world = simulation.world();
  for (int tick = 0; tick < 10; ++tick) {
    world.step();
    world.shuffle_rows(1);
    const auto remade = engine::remade_world(world, simulation.registry(), {.threads = 1});
    EXPECT_EQ(remade->hashes().state, world.hashes().state);
  }
  world.reset();
  EXPECT_EQ(world.hashes().state, Simulation(k_shipped / "colony.json").world().hashes().state);
}

TEST(RowOrder, TreesLeaveTogetherAndNoRowTwice) {
  Simulation simulation(k_shipped / "magpies.json");
  engine::World& world = simulation.world();
  while (world.view().counts().carried == 0 && simulation.time_s() < 60) simulation.step();
  ASSERT_GT(world.view().counts().carried, 0u);
  BodyId cargo;
  for (std::size_t r = 0; r < world.view().rows(); ++r)
    if (world.view().carrier(Row(r))) cargo = world.view().body(Row(r));
  std::vector<BodyId> tree;
  for (std::size_t r = 0; r < world.view().rows(); ++r)
    if (const BodyId id = world.view().body(Row(r)); root_of(world, id) == root_of(world, cargo))
      tree.push_back(id);
  EXPECT_THROW(world.remove_rows(std::vector{cargo}), std::invalid_argument);
  EXPECT_THROW(world.remove_rows(std::vector{root_of(world, cargo)}), std::invalid_argument);
  EXPECT_THROW(world.remove_rows(std::vector{BodyId(0)}), std::invalid_argument) << "the ground has no row";
  std::vector<BodyId> twice = tree;
  twice.push_back(cargo);
  EXPECT_THROW(world.remove_rows(twice), std::invalid_argument);
  const std::uint64_t hash = world.hashes().state;
  const auto removed = world.remove_rows(tree);
  EXPECT_THROW(world.remove_rows(tree), std::invalid_argument);
  auto removed_twice = removed;
  removed_twice.push_back(removed.front());
  EXPECT_THROW(world.add_rows(removed_twice), std::invalid_argument);
  world.add_rows(removed);
  EXPECT_THROW(world.add_rows(removed), std::invalid_argument);
  EXPECT_EQ(world.hashes().state, hash);
}

std::size_t table_bytes(const engine::World& world) {
  std::size_t bytes = 0;
  for (const engine::StateTable& table : world.tables()) bytes += table.bytes();
  return bytes;
}

TEST(RowOrder, MemoryFollowsTheRows) {
  for (const char* name : {"hospital.json", "magpies.json", "failures.json", "pushers.json"}) {
    SCOPED_TRACE(name);
    Simulation undisturbed(k_shipped / name);
    Simulation simulation(k_shipped / name);
    engine::World& world = simulation.world();
    const std::size_t bytes = table_bytes(world);
    for (int round = 0; round < 3; ++round) {
      for (Simulation* each : {&undisturbed, &simulation}) each->run_for(1);
      std::vector<BodyId> leaving;
      for (std::size_t r = 0; r < world.view().rows(); ++r)
        if (const BodyId id = world.view().body(Row(r)); root_of(world, id).value % 8 != 0)
          leaving.push_back(id);
      const auto states = world.remove_rows(leaving);
      EXPECT_LT(world.view().rows(), states.size() / 4);
      EXPECT_LT(table_bytes(world), bytes / 4);
      world.add_rows(states);
      EXPECT_LT(table_bytes(world), bytes + bytes / 16);
      EXPECT_EQ(world.hashes().state, undisturbed.world().hashes().state);
    }
  }
}

TEST(RowOrder, CannotBeShuffledOnSeveralRanks) {
  SimulationOptions options;
  options.ranks = 2;
  Simulation simulation(k_shipped / "colony.json", options);
  EXPECT_EQ(test::message_of<std::logic_error>([&] { simulation.world().shuffle_rows(1); }),
            "the rows of a world that several ranks compute cannot be shuffled");
}

}  // namespace
}  // namespace troupe::rows_test
