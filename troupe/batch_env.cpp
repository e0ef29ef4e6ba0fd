#include "troupe/batch_env.hpp"

#include "base/diagnostics.hpp"
#include "base/hash.hpp"
#include "base/random.hpp"
#include "engine/controller.hpp"
#include "engine/ticks.hpp"
#include "engine/world.hpp"
#include "partition/parallel.hpp"
#include "troupe/measures.hpp"
#include "troupe/swarm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <utility>

namespace troupe {
namespace {

using Of = BatchPart::Of;

constexpr std::size_t k_most_copies = 1'000'000;
constexpr std::size_t k_most_neighbours = 1000;
constexpr double k_longest_episode_s = 1e12;
constexpr std::size_t k_drive = 3;  // a command of a drive has three numbers: forward, left, turn

/// Returns the seed of an episode: derived from the seed of the copy's first episode and the number of the
/// episode.
std::uint64_t episode_seed(std::uint64_t first, std::uint64_t episode) {
  return episode == 0 ? first : mix(first, hash_text("episode"), episode);
}

double number_at(const std::byte* at, engine::Element element) {
  const auto read = [&]<class T>(T value) {
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  };
  switch (element) {
    case engine::Element::f64: return read(double());
    case engine::Element::f32: return read(float());
    case engine::Element::i64: return read(std::int64_t());
    case engine::Element::i32: return read(std::int32_t());
    case engine::Element::u64: return read(std::uint64_t());
    case engine::Element::u32: return read(std::uint32_t());
    case engine::Element::u8: break;
  }
  return read(std::uint8_t());
}

/// Stores a number as an element at the address `at`. For integer elements it is rounded to the nearest
/// integer and clamped to the range of the element type.
void put_number(std::byte* at, engine::Element element, double value) {
  const auto write = [&]<class T>(T) {
    T own;
    if constexpr (std::is_floating_point_v<T>) {
      own = static_cast<T>(value);
    } else {
      const double least = static_cast<double>(std::numeric_limits<T>::min());
      const double most = static_cast<double>(std::numeric_limits<T>::max());
      const double whole = std::floor(value + 0.5);
      own = whole <= least  ? std::numeric_limits<T>::min()
            : whole >= most ? std::numeric_limits<T>::max()
                            : static_cast<T>(whole);
    }
    std::memcpy(at, &own, sizeof own);
  };
  switch (element) {
    case engine::Element::f64: return write(double());
    case engine::Element::f32: return write(float());
    case engine::Element::i64: return write(std::int64_t());
    case engine::Element::i32: return write(std::int32_t());
    case engine::Element::u64: return write(std::uint64_t());
    case engine::Element::u32: return write(std::uint32_t());
    case engine::Element::u8: return write(std::uint8_t());
  }
}

[[noreturn]] void refuse(const std::string& text) { throw std::invalid_argument(text); }

template <class Named>
const Named& named(const std::vector<Named>& all, std::string_view what, std::string_view name) {
  const auto found = std::ranges::find(all, name, &Named::name);
  if (found != all.end()) return *found;
  std::vector<std::string_view> known;
  for (const Named& each : all) known.push_back(each.name);
  throw std::out_of_range(unknown_name(what, name, std::move(known)));
}

template <class Named>
void check_names(const std::vector<Named>& all, std::string_view what) {
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (all[i].name == all[j].name)
        refuse(fmt::format("{} \"{}\" occurs twice: names must be unique", what, all[i].name));
}

/// Position of a body in the frame of a robot, m.
struct Seen {
  double x = 0;
  double y = 0;
};

Seen seen_from(const Transform& own, double dx, double dy) {
  const Rotation& r = own.rotation;
  return {dx * r.cos + dy * r.sin, dy * r.cos - dx * r.sin};
}

}  // namespace

struct BatchEnv::Impl {
  /// How the columns of one part of an array are computed. plan() creates it at the start, so that no step
  /// has to look up names.
  struct Part {
    const BatchPart* spec = nullptr;
    std::size_t columns = 0;
    engine::Element element = engine::Element::f32;  // of a reading
    std::size_t of_kind = 0;  // index among the readings, the groups or the targets of TeamCopy
  };
  struct ArrayData {
    std::string name;
    engine::Element element = engine::Element::f32;
    std::size_t columns = 0;
    std::vector<Part> parts;
    std::vector<std::byte> bytes;  // copies x robots x columns

    std::size_t row_bytes() const { return columns * engine::element_size(element); }
  };
  /// A BatchColumn whose names have been looked up: indices instead of names.
  struct Column {
    std::size_t array = 0;
    std::size_t column = 0;
    bool of_measure = false;
  };
  struct Action {
    std::size_t command = 0;  // 0 to 2: drive; from 3 on: devices, see TeamCopy::commands
    engine::Element element = engine::Element::f64;
    double low = 0;
    double span = 0;
  };
  struct TeamData {
    const BatchTeam* spec = nullptr;
    std::size_t robots = 0;
    std::vector<std::string> names;
    std::vector<ArrayData> arrays;
    std::vector<Action> actions_plan;
    bool drives = false;
    std::vector<Column> rewards_of;
    std::vector<Column> ends_of;
    std::vector<double> actions;  // copies x robots x actions
    std::vector<double> rewards;  // copies x robots, as are terminated and alive
    std::vector<std::uint8_t> terminated;
    std::vector<std::uint8_t> alive;
  };
  /// The data of a team in one copy of the world.
  struct TeamCopy {
    std::vector<Row> rows;
    std::vector<const std::byte*> readings;    // readings x robots
    std::vector<std::vector<Row>> groups;      // the possible neighbours, for each part `nearest`
    std::vector<std::vector<BodyId>> targets;  // for each part `target`: one for all robots, or one per robot
    std::vector<std::byte*> commands;          // commands of devices x robots
    std::vector<double> before;                // rewards x robots: the rewarded numbers of the previous step
    std::vector<std::uint8_t> was_terminated;  // per robot: `terminated` before the step
    std::vector<std::uint8_t> was_alive;       // per robot: `alive` after the previous step
  };
  struct Copy {
    explicit Copy(Simulation&& s) : simulation(std::move(s)) {}
    Simulation simulation;
    std::optional<Measures> measures;
    std::vector<std::uint8_t> learns;  // per row: 1 if its robot is in a team
    std::vector<TeamCopy> teams;
    std::uint64_t first_seed = 0;
    std::uint64_t episode = 0;
    bool has_begun = false;
    std::uint64_t last_tick = 0;
  };

  BatchSpec spec;
  partition::Parallel parallel;
  std::uint64_t episode_ticks = 1;
  std::vector<TeamData> teams;
  std::vector<std::unique_ptr<Copy>> copies;
  std::vector<std::string> measure_columns;
  std::vector<double> measures;  // copies x columns
  std::vector<std::uint8_t> truncated;
  std::vector<std::uint8_t> over;
  std::vector<std::uint64_t> seeds;
  bool was_reset = false;

  Impl(const Simulation& world, const BatchSpec& wanted);
  void check_spec() const;
  void add_copy(const Simulation& world, std::size_t c);
  void plan(TeamData& team, Copy& first);
  Part plan(const BatchPart& part, Simulation& simulation, BodyId robot) const;
  void plan_actions(TeamData& team, Simulation& simulation, BodyId robot) const;
  Column find(const TeamData& team, const BatchColumn& column, std::string_view what) const;
  void bind(const TeamData& team, Copy& copy, TeamCopy& bound) const;

  template <class Work>
  void for_copies(Work&& work);
  void begin(std::size_t c);
  void act(std::size_t c);
  void read_outputs(std::size_t c);
  void observe(std::size_t c);
  void judge(std::size_t c, bool has_stepped);
  void read(const TeamCopy& team, const Copy& copy, const ArrayData& array, std::size_t i,
            std::byte* out) const;
  double value(const TeamData& team, const Column& column, std::size_t c, std::size_t i) const;
};

// ---- construction

BatchEnv::Impl::Impl(const Simulation& world, const BatchSpec& wanted)
    : spec(wanted), parallel(wanted.threads) {
  check_spec();
  episode_ticks = std::max<std::uint64_t>(engine::ticks_until(spec.seconds, world.tick_s()), 1);
  teams.resize(spec.teams.size());
  copies.reserve(spec.copies);
  for (std::size_t c = 0; c < spec.copies; ++c) add_copy(world, c);
  measures.resize(spec.copies * measure_columns.size());
  truncated.resize(spec.copies);
  over.resize(spec.copies, 1);
}

void BatchEnv::Impl::check_spec() const {
  if (spec.copies < 1 || spec.copies > k_most_copies)
    refuse(fmt::format("{} copies of the world: give 1 to {}", spec.copies, k_most_copies));
  if (spec.ticks < 1) refuse("0 ticks per step: give 1 or more");
  if (!(spec.seconds > 0 && spec.seconds <= k_longest_episode_s))
    refuse(fmt::format("episodes of {} s: give a length above 0 s, at most {:g} s", spec.seconds,
                       k_longest_episode_s));
  if (spec.teams.empty()) refuse("the batch has no teams: give one or more");
  check_names(spec.teams, "team");
  for (const BatchTeam& team : spec.teams) {
    check_names(team.arrays, fmt::format("array (team \"{}\")", team.name));
    for (const BatchArraySpec& array : team.arrays) {
      if (array.parts.empty())
        refuse(
            fmt::format("array \"{}\" of team \"{}\" has no parts: give one or more", array.name, team.name));
      if (array.raw && (array.parts.size() != 1 || array.parts.front().of != Of::reading))
        refuse(
            fmt::format("array \"{}\" of team \"{}\": an array with \"raw\" must have exactly one part, "
                        "whose source is reading",
                        array.name, team.name));
      for (const BatchPart& part : array.parts) {
        if (part.of == Of::nearest && (part.count < 1 || part.count > k_most_neighbours))
          refuse(fmt::format("array \"{}\" of team \"{}\": count is {} nearest robots: give 1 to {}",
                             array.name, team.name, part.count, k_most_neighbours));
        if (!(part.range_m > 0))
          refuse(fmt::format("array \"{}\" of team \"{}\": range_m is {}: give a distance above 0",
                             array.name, team.name, part.range_m));
        if (!std::isfinite(part.scale))
          refuse(fmt::format("array \"{}\" of team \"{}\": scale is {}: give a finite number", array.name,
                             team.name, part.scale));
      }
    }
    for (const BatchAction& action : team.actions)
      if (!std::isfinite(action.low) || !std::isfinite(action.high))
        refuse(fmt::format("action \"{}\" of team \"{}\": low is {}, high is {}: give finite numbers",
                           action.command, team.name, action.low, action.high));
  }
}

void BatchEnv::Impl::add_copy(const Simulation& world, std::size_t c) {
  const std::uint64_t seed = world.seed() + c;
  copies.push_back(std::make_unique<Copy>(world.another(seed, 1)));
  seeds.push_back(seed);
  Copy& copy = *copies.back();
  copy.first_seed = seed;
  engine::World& engine = copy.simulation.world();
  copy.learns.resize(engine.rows());
  if (!spec.measures.empty()) {
    copy.measures.emplace(copy.simulation, spec.measures);
    if (c == 0) measure_columns.assign(copy.measures->columns().begin(), copy.measures->columns().end());
  }
  for (std::size_t t = 0; t < teams.size(); ++t) {
    Swarm swarm = copy.simulation.swarm(spec.teams[t].robots);
    swarm.subscribe();
    TeamCopy& bound = copy.teams.emplace_back();
    for (const BodyId id : swarm.ids()) {
      const Row row = engine.row(id);
      bound.rows.push_back(row);
      if (std::exchange(copy.learns[row.index()], std::uint8_t{1}) != 0)
        refuse(fmt::format("robot \"{}\" is in two teams: a robot can be in only one team",
                           engine.spec().name(id)));
    }
    if (c == 0) {
      TeamData& team = teams[t];
      team.spec = &spec.teams[t];
      team.robots = swarm.size();
      team.names = swarm.names();
      if (team.robots == 0)
        refuse(fmt::format(
            "team \"{}\" has no robots: its member \"robots\" must name a type, a population or a robot",
            team.spec->name));
      plan(team, copy);
    }
    bind(teams[t], copy, bound);
  }
  // Commands of teams come from the policy, so the controllers of their robots are skipped.
  engine.on_decide([&learns = copy.learns](const engine::BodyType&,
                                           const engine::BodyType::Controller& controller,
                                           const engine::DecideBatch& batch) {
    std::array<Row, 64> others;
    engine::DecideBatch some = batch;
    std::size_t count = 0;
    const auto decide = [&] {
      if (count == 0) return;
      some.rows = {others.data(), count};
      controller.kind->decide(controller.data, some);
      count = 0;
    };
    for (const Row row : batch.rows) {
      if (learns[row.index()] != 0) continue;
      if (count == others.size()) decide();
      others[count++] = row;
    }
    decide();
  });
}

/// Determines the columns, actions, rewards and ends of a team from its first robot. `first` is the first
/// copy. The other robots may have other types if their observed fields and commands are the same; bind()
/// checks this.
void BatchEnv::Impl::plan(TeamData& team, Copy& first) {
  const BatchTeam& own = *team.spec;
  Simulation& simulation = first.simulation;
  const BodyId robot = simulation.world().body(first.teams.back().rows.front());
  std::array<std::size_t, 3> of_kind{};
  for (const BatchArraySpec& wanted : own.arrays) {
    ArrayData& array = team.arrays.emplace_back();
    array.name = wanted.name;
    for (const BatchPart& each : wanted.parts) {
      Part part = plan(each, simulation, robot);
      if (each.of == Of::reading) part.of_kind = of_kind[0]++;
      if (each.of == Of::nearest) part.of_kind = of_kind[1]++;
      if (each.of == Of::target) part.of_kind = of_kind[2]++;
      array.columns += part.columns;
      if (wanted.raw) array.element = part.element;
      array.parts.push_back(part);
    }
    array.bytes.resize(spec.copies * team.robots * array.row_bytes());
  }
  plan_actions(team, simulation, robot);
  for (const BatchReward& reward : own.rewards) team.rewards_of.push_back(find(team, reward.of, "reward"));
  for (const BatchEnd& end : own.ends) team.ends_of.push_back(find(team, end.of, "end"));
  const std::size_t robots = spec.copies * team.robots;
  team.actions.resize(robots * own.actions.size());
  team.rewards.resize(robots);
  team.terminated.resize(robots);
  team.alive.resize(robots);
}

BatchEnv::Impl::Part BatchEnv::Impl::plan(const BatchPart& part, Simulation& simulation, BodyId robot) const {
  Part out{.spec = &part};
  switch (part.of) {
    case Of::reading: {
      const engine::StateField& field = *simulation.model(robot).reading(part.field, part.device).field;
      out.columns = field.columns;
      out.element = field.element;
      break;
    }
    case Of::pose:
    case Of::estimate: out.columns = 4; break;
    case Of::speed: out.columns = 3; break;
    case Of::stalled:
    case Of::time_left: out.columns = 1; break;
    case Of::nearest: out.columns = BatchPart::k_neighbour * part.count; break;
    case Of::target: out.columns = 3; break;
  }
  return out;
}

void BatchEnv::Impl::plan_actions(TeamData& team, Simulation& simulation, BodyId robot) const {
  constexpr std::array<std::string_view, k_drive> k_commands{"forward", "left", "turn"};
  std::size_t of_devices = k_drive;
  for (const BatchAction& action : team.spec->actions) {
    Action out{.low = action.low, .span = action.high - action.low};
    if (action.device.empty()) {
      const auto found = std::ranges::find(k_commands, action.command);
      if (found == k_commands.end())
        throw std::out_of_range(
            unknown_name("command of a drive", action.command, {k_commands.begin(), k_commands.end()}));
      if (!simulation.world().type(simulation.world().row(robot)).drive)
        refuse(
            fmt::format("team \"{}\": an action without a device commands the drive, but the robots have "
                        "no drive",
                        team.spec->name));
      out.command = static_cast<std::size_t>(found - k_commands.begin());
      team.drives = true;
    } else {
      const Model::Asked asked = simulation.model(robot).asked(action.device);
      const auto field = std::ranges::find(asked.fields, action.command, &engine::StateField::name);
      if (field == asked.fields.end()) {
        std::vector<std::string_view> known;
        for (const engine::StateField& each : asked.fields) known.push_back(each.name);
        throw std::out_of_range(unknown_name(fmt::format("command (device \"{}\")", action.device),
                                             action.command, std::move(known)));
      }
      if (field->columns != 1)
        refuse(fmt::format("command \"{}\" of device \"{}\" has {} numbers, but an action sets only one",
                           action.command, action.device, field->columns));
      out.command = of_devices++;
      out.element = field->element;
    }
    team.actions_plan.push_back(out);
  }
}

BatchEnv::Impl::Column BatchEnv::Impl::find(const TeamData& team, const BatchColumn& column,
                                            std::string_view what) const {
  if (column.array.empty()) {
    for (std::size_t m = 0; m < measure_columns.size(); ++m) {
      const std::string& name = measure_columns[m];
      const bool has_unit = name.starts_with(column.measure + "_");  // displacement, displacement_m
      if (name == column.measure || has_unit) return {.column = m, .of_measure = true};
    }
    throw std::out_of_range(fmt::format(
        "{} of team \"{}\": {}", what, team.spec->name,
        unknown_name("measure", column.measure, {measure_columns.begin(), measure_columns.end()})));
  }
  const ArrayData& array =
      named(team.arrays, fmt::format("array (team \"{}\")", team.spec->name), column.array);
  if (column.column >= array.columns)
    refuse(fmt::format(
        "{} of team \"{}\": there is no column {} in array \"{}\", which has {} columns, counted from 0",
        what, team.spec->name, column.column, column.array, array.columns));
  return {static_cast<std::size_t>(&array - team.arrays.data()), column.column, false};
}

/// Looks up, in one copy of the world, what the columns and actions of a team refer to, and stores it in
/// `bound`: the addresses of readings and commands, the rows of possible neighbours, and the ids of targets.
/// Throws if the robots of the team differ.
void BatchEnv::Impl::bind(const TeamData& team, Copy& copy, TeamCopy& bound) const {
  engine::World& world = copy.simulation.world();
  std::vector<Model> robots;
  for (const Row row : bound.rows) robots.push_back(copy.simulation.model(world.body(row)));
  for (const ArrayData& array : team.arrays)
    for (const Part& part : array.parts) {
      const BatchPart& wanted = *part.spec;
      if (wanted.of == Of::reading)
        for (const Model& robot : robots) {
          const Model::Reading reading = robot.reading(wanted.field, wanted.device);
          if (reading.field->columns != part.columns || reading.field->element != part.element)
            refuse(
                fmt::format("robots of team \"{0}\" differ in field \"{1}\": \"{4}\" has {2} values of type "
                            "{3}, \"{7}\" has {5} of type {6}; make two teams",
                            team.spec->name, wanted.field, part.columns, engine::element_name(part.element),
                            team.names.front(), reading.field->columns,
                            engine::element_name(reading.field->element), robot.name()));
          bound.readings.push_back(reading.bytes.data());
        }
      if (wanted.of == Of::nearest) {
        std::vector<Row>& group = bound.groups.emplace_back();
        const Swarm swarm = copy.simulation.swarm(wanted.name);  // throws for an unknown name
        for (const BodyId id : swarm.ids()) group.push_back(world.row(id));
      }
      if (wanted.of == Of::target) {
        std::vector<BodyId>& targets = bound.targets.emplace_back();
        if (const BodyId one = world.find(wanted.name); one.valid()) {
          targets.push_back(one);
          continue;
        }
        for (const Model& robot : robots) {
          const std::string& name = robot.name();
          const std::size_t digits = name.find_last_not_of("0123456789") + 1;
          const std::string target = wanted.name + name.substr(digits);
          const BodyId own = digits < name.size() ? world.find(target) : BodyId();
          if (!own.valid())
            throw std::out_of_range(fmt::format(
                "team \"{}\": there is no model \"{}\", which would be the target of robot \"{}\"; give the "
                "name of one model for all robots, or the name without its number, such as \"goal\" if robot "
                "0 has the target goal0, robot 1 the target goal1, ...",
                team.spec->name, target, name));
          targets.push_back(own);
        }
      }
    }
  for (std::size_t a = 0; a < team.actions_plan.size(); ++a) {
    const BatchAction& action = team.spec->actions[a];
    if (team.actions_plan[a].command < k_drive) continue;
    for (Model& robot : robots) {
      const Model::Asked asked = robot.asked(action.device);
      const auto field = std::ranges::find(asked.fields, action.command, &engine::StateField::name);
      if (field == asked.fields.end() || field->element != team.actions_plan[a].element)
        refuse(
            fmt::format("robots of team \"{}\" differ: not all have command \"{}\" of device \"{}\" with the "
                        "same type of number; make two teams",
                        team.spec->name, action.command, action.device));
      bound.commands.push_back(asked.bytes.data() + field->offset);
    }
  }
  if (team.drives)
    for (const Row row : bound.rows)
      if (!world.type(row).drive)
        refuse(
            fmt::format("robot \"{}\" of team \"{}\" has no drive, but an action of the team commands the "
                        "drive",
                        world.spec().name(world.body(row)), team.spec->name));
  bound.before.resize(team.rewards_of.size() * robots.size());
  bound.was_terminated.resize(robots.size());
  bound.was_alive.resize(robots.size());
}

// ---- steps

/// Calls work(c) for each copy c, in parallel. A task is a block of copies, and each copy runs on one thread,
/// so that its state stays in the caches of that thread. If work() throws for some copies, it is still called
/// for all others; for_copies() then rethrows the exception of the first of these copies.
template <class Work>
void BatchEnv::Impl::for_copies(Work&& work) {
  constexpr std::size_t k_most = 32;           // copies per task
  constexpr std::size_t k_tasks_a_thread = 8;  // enough that all threads end at about the same time
  const std::size_t n = copies.size();
  const std::size_t block = std::clamp<std::size_t>(n / (k_tasks_a_thread * parallel.threads()), 1, k_most);
  parallel.for_each((n + block - 1) / block, [&](std::size_t b) {
    std::exception_ptr error;
    for (std::size_t c = b * block; c < std::min(n, (b + 1) * block); ++c) try {
        work(c);
      } catch (...) {
        if (!error) error = std::current_exception();
      }
    if (error) std::rethrow_exception(error);
  });
}

void BatchEnv::Impl::begin(std::size_t c) {
  Copy& copy = *copies[c];
  if (std::exchange(copy.has_begun, true)) ++copy.episode;
  seeds[c] = episode_seed(copy.first_seed, copy.episode);
  if (seeds[c] == copy.simulation.seed())
    copy.simulation.reset();
  else
    copy.simulation.reset(seeds[c]);
  if (copy.measures) copy.measures->see();
  copy.simulation.step();
  if (copy.measures) copy.measures->see();
  copy.last_tick = copy.simulation.tick() + episode_ticks;
  truncated[c] = 0;
  read_outputs(c);
  judge(c, false);
}

void BatchEnv::Impl::act(std::size_t c) {
  Copy& copy = *copies[c];
  engine::World& world = copy.simulation.world();
  for (std::size_t t = 0; t < teams.size(); ++t) {
    const TeamData& team = teams[t];
    TeamCopy& bound = copy.teams[t];
    const std::size_t columns = team.actions_plan.size();
    for (std::size_t i = 0; i < team.robots; ++i) {
      const std::size_t at = c * team.robots + i;
      const bool is_finished = team.terminated[at] != 0;
      bound.was_terminated[i] = is_finished;
      if (!world.is_there(bound.rows[i])) continue;
      std::array<double, k_drive> drive{};
      for (std::size_t a = 0; a < columns && !is_finished; ++a) {
        const Action& action = team.actions_plan[a];
        const double given = std::clamp(team.actions[at * columns + a], -1.0, 1.0);
        const double asked = action.low + (given + 1) * 0.5 * action.span;
        if (action.command < k_drive)
          drive[action.command] = asked;
        else
          put_number(bound.commands[(action.command - k_drive) * team.robots + i], action.element, asked);
      }
      if (team.drives)
        world.set_command(bound.rows[i], {drive[0], drive[1], drive[2], engine::ControlMode::velocity});
    }
  }
}

void BatchEnv::Impl::read_outputs(std::size_t c) {
  Copy& copy = *copies[c];
  if (copy.measures)
    std::ranges::copy(copy.measures->values(),
                      measures.begin() + static_cast<std::ptrdiff_t>(c * measure_columns.size()));
  observe(c);
}

void BatchEnv::Impl::observe(std::size_t c) {
  const Copy& copy = *copies[c];
  const engine::World& world = copy.simulation.world();
  for (std::size_t t = 0; t < teams.size(); ++t) {
    TeamData& team = teams[t];
    for (std::size_t i = 0; i < team.robots; ++i) {
      const std::size_t at = c * team.robots + i;
      team.alive[at] = world.is_there(copy.teams[t].rows[i]);
      for (ArrayData& array : team.arrays) {
        std::byte* out = array.bytes.data() + at * array.row_bytes();
        if (team.alive[at] != 0)
          read(copy.teams[t], copy, array, i, out);
        else
          std::fill_n(out, array.row_bytes(), std::byte{0});
      }
    }
  }
}

void BatchEnv::Impl::read(const TeamCopy& team, const Copy& copy, const ArrayData& array, std::size_t i,
                          std::byte* bytes) const {
  const engine::World& world = copy.simulation.world();
  const std::size_t robots = team.rows.size();
  const Row own = team.rows[i];
  const Transform& here = world.transform(own);
  float* out = reinterpret_cast<float*>(bytes);
  const auto add = [&out](double value) { *out++ = static_cast<float>(value); };
  const auto add_pose = [&](const Pose& pose, const Rotation& rotation, double scale) {
    add(pose.x * scale);
    add(pose.y * scale);
    add(rotation.cos);
    add(rotation.sin);
  };
  for (const Part& part : array.parts) {
    const BatchPart& wanted = *part.spec;
    switch (wanted.of) {
      case Of::reading: {
        const std::byte* from = team.readings[part.of_kind * robots + i];
        const std::size_t size = engine::element_size(part.element);
        if (array.element != engine::Element::f32 ||
            (part.element == engine::Element::f32 && wanted.scale == 1)) {
          std::memcpy(out, from, part.columns * size);
          out += part.columns;
          break;
        }
        for (std::size_t k = 0; k < part.columns; ++k)
          add(number_at(from + k * size, part.element) * wanted.scale);
        break;
      }
      case Of::pose: add_pose(world.poses()[own.index()], here.rotation, wanted.scale); break;
      case Of::estimate: {
        const Pose pose = world.estimate(own);
        add_pose(pose, Rotation(pose.heading), wanted.scale);
        break;
      }
      case Of::speed: {
        const engine::Velocity& v = world.velocities()[own.index()];
        add(v.x * wanted.scale);
        add(v.y * wanted.scale);
        add(v.turn * wanted.scale);
        break;
      }
      case Of::stalled: add(world.stalled(own) ? 1 : 0); break;
      case Of::time_left:
        add(static_cast<double>(copy.last_tick - std::min(copy.last_tick, world.tick())) /
            static_cast<double>(episode_ticks));
        break;
      case Of::nearest: {
        struct Near {
          double distance2;
          Row row;
        };
        thread_local std::vector<Near> nearest;
        nearest.clear();
        const double range2 = wanted.range_m * wanted.range_m;
        for (const Row other : team.groups[part.of_kind]) {  // in order of ids, so that of two robots at the
                                                             // same distance the lower id comes first
          if (other == own || !world.is_there(other)) continue;
          const Vec2 way = world.transform(other).position - here.position;
          const double distance2 = way.x() * way.x() + way.y() * way.y();
          if (distance2 > range2 || (nearest.size() == wanted.count && distance2 >= nearest.back().distance2))
            continue;
          if (nearest.size() == wanted.count) nearest.pop_back();
          auto at = nearest.end();
          while (at != nearest.begin() && distance2 < std::prev(at)->distance2) --at;
          nearest.insert(at, {distance2, other});
        }
        for (const Near& near : nearest) {
          const Transform& there = world.transform(near.row);
          const Seen seen =
              seen_from(here, there.position.x() - here.position.x(), there.position.y() - here.position.y());
          const Rotation& a = here.rotation;
          const Rotation& b = there.rotation;
          add(seen.x * wanted.scale);
          add(seen.y * wanted.scale);
          add(a.cos * b.cos + a.sin * b.sin);
          add(a.cos * b.sin - a.sin * b.cos);
          add(1);
        }
        for (std::size_t k = BatchPart::k_neighbour * nearest.size(); k < part.columns; ++k) add(0);
        break;
      }
      case Of::target: {
        const std::vector<BodyId>& targets = team.targets[part.of_kind];
        const BodyId body = targets[targets.size() == 1 ? 0 : i];
        const Row row = world.row(body);
        if (row.valid() && !world.is_there(row)) {
          for (std::size_t k = 0; k < part.columns; ++k) add(0);
          break;
        }
        const Pose pose = world.pose(body);
        const double dx = pose.x - here.position.x();
        const double dy = pose.y - here.position.y();
        const Seen seen = seen_from(here, dx, dy);
        add(seen.x * wanted.scale);
        add(seen.y * wanted.scale);
        add(std::sqrt(dx * dx + dy * dy) * wanted.scale);
        break;
      }
    }
  }
}

double BatchEnv::Impl::value(const TeamData& team, const Column& column, std::size_t c, std::size_t i) const {
  if (column.of_measure) return measures[c * measure_columns.size() + column.column];
  const ArrayData& array = team.arrays[column.array];
  const std::byte* row = array.bytes.data() + (c * team.robots + i) * array.row_bytes();
  return number_at(row + column.column * engine::element_size(array.element), array.element);
}

/// Computes the rewards of copy c, and which of its robots are finished, from the arrays that observe() has
/// filled. has_stepped: false at the beginning of an episode; the rewards are then 0 and no end is tested.
void BatchEnv::Impl::judge(std::size_t c, bool has_stepped) {
  Copy& copy = *copies[c];
  const bool has_stopped = has_stepped && copy.simulation.stopped().has_value();
  for (std::size_t t = 0; t < teams.size(); ++t) {
    TeamData& team = teams[t];
    TeamCopy& bound = copy.teams[t];
    for (std::size_t i = 0; i < team.robots; ++i) {
      const std::size_t at = c * team.robots + i;
      double reward = 0;
      for (std::size_t r = 0; r < team.rewards_of.size(); ++r) {
        const BatchReward& term = team.spec->rewards[r];
        const double now = value(team, team.rewards_of[r], c, i);
        double& before = bound.before[r * team.robots + i];
        const double change = bound.was_alive[i] != 0 ? now - before : 0;
        reward += term.weight * (term.change ? change : now);
        before = now;
      }
      const bool is_alive = team.alive[at] != 0;
      bool is_finished =
          has_stopped || copy.simulation.world().presence(bound.rows[i]) == engine::Presence::dead;
      for (std::size_t e = 0; e < team.ends_of.size() && has_stepped && is_alive; ++e) {
        const BatchEnd& end = team.spec->ends[e];
        const double now = value(team, team.ends_of[e], c, i);
        if (!(end.is_above ? now > end.below : now < end.below)) continue;
        is_finished = true;
        reward += end.reward;
      }
      const bool was_finished = has_stepped && bound.was_terminated[i] != 0;
      team.rewards[at] = has_stepped && is_alive && !was_finished ? reward : 0;
      team.terminated[at] = is_finished || was_finished;
      bound.was_alive[i] = is_alive;
    }
  }
  truncated[c] = copy.simulation.tick() >= copy.last_tick;
}

// ---- public functions

BatchEnv::BatchEnv(const std::filesystem::path& world, const BatchSpec& spec,
                   const SimulationOptions& options)
    : BatchEnv(
          [&] {
            SimulationOptions own = options;
            own.threads = 1;
            return Simulation(world, own);
          }(),
          spec) {}

BatchEnv::BatchEnv(const Simulation& world, const BatchSpec& spec)
    : impl_(std::make_unique<Impl>(world, spec)) {}

BatchEnv::~BatchEnv() = default;
BatchEnv::BatchEnv(BatchEnv&&) noexcept = default;
BatchEnv& BatchEnv::operator=(BatchEnv&&) noexcept = default;

const BatchSpec& BatchEnv::spec() const { return impl_->spec; }
std::size_t BatchEnv::copies() const { return impl_->copies.size(); }
std::size_t BatchEnv::robots(std::size_t team) const { return impl_->teams.at(team).robots; }
std::vector<std::string> BatchEnv::names(std::size_t team) const { return impl_->teams.at(team).names; }
const Simulation& BatchEnv::simulation(std::size_t copy) const { return impl_->copies.at(copy)->simulation; }
Simulation& BatchEnv::simulation(std::size_t copy) { return impl_->copies.at(copy)->simulation; }
unsigned BatchEnv::threads() const { return impl_->parallel.threads(); }

BatchEnv::Array BatchEnv::array(std::size_t team, std::string_view name) const {
  Impl::TeamData& of = impl_->teams.at(team);
  const auto& found = named(of.arrays, fmt::format("array (team \"{}\")", of.spec->name), name);
  Impl::ArrayData& array = of.arrays[static_cast<std::size_t>(&found - of.arrays.data())];
  return {array.element, array.columns, array.bytes};
}

std::span<const float> BatchEnv::floats(std::size_t team, std::string_view name) const {
  const Array found = array(team, name);
  if (found.element != engine::Element::f32)
    refuse(fmt::format("array \"{}\" has the type {}, not float32: use array()", name,
                       engine::element_name(found.element)));
  return {reinterpret_cast<const float*>(found.bytes.data()), found.bytes.size() / sizeof(float)};
}

std::span<double> BatchEnv::actions(std::size_t team) { return impl_->teams.at(team).actions; }
std::span<double> BatchEnv::rewards(std::size_t team) { return impl_->teams.at(team).rewards; }
std::span<std::uint8_t> BatchEnv::terminated(std::size_t team) { return impl_->teams.at(team).terminated; }
std::span<const std::uint8_t> BatchEnv::alive(std::size_t team) const { return impl_->teams.at(team).alive; }
std::span<const std::uint8_t> BatchEnv::truncated() const { return impl_->truncated; }

std::span<const std::uint8_t> BatchEnv::over() {
  for (std::size_t c = 0; c < copies(); ++c) {
    bool is_one_going = false;
    bool is_one_finished = false;
    for (const Impl::TeamData& team : impl_->teams)
      for (std::size_t at = c * team.robots; at < (c + 1) * team.robots; ++at) {
        is_one_finished = is_one_finished || team.terminated[at] != 0;
        is_one_going = is_one_going || (team.terminated[at] == 0 && team.alive[at] != 0);
      }
    impl_->over[c] = (is_one_finished && !is_one_going) || impl_->truncated[c] != 0;
  }
  return impl_->over;
}

std::vector<std::string> BatchEnv::measure_columns() const { return impl_->measure_columns; }
std::span<const double> BatchEnv::measures() const { return impl_->measures; }
std::span<const std::uint64_t> BatchEnv::seeds() const { return impl_->seeds; }

void BatchEnv::reset(std::span<const std::uint8_t> which,
                     std::span<const std::optional<std::uint64_t>> seeds) {
  if (!which.empty() && which.size() != copies())
    refuse(fmt::format("reset(): `which` has {} elements: give {}, one per copy", which.size(), copies()));
  if (!seeds.empty() && seeds.size() != copies())
    refuse(fmt::format("reset(): `seeds` has {} elements: give {}, one per copy", seeds.size(), copies()));
  const auto is_meant = [&](std::size_t c) { return which.empty() || which[c] != 0; };
  for (std::size_t c = 0; c < copies(); ++c)
    if (!is_meant(c) && !impl_->copies[c]->has_begun)
      throw std::logic_error(
          fmt::format("reset(): copy {} has not begun an episode: reset all copies first", c));
  for (std::size_t c = 0; c < copies() && !seeds.empty(); ++c)
    if (is_meant(c) && seeds[c]) {
      Impl::Copy& copy = *impl_->copies[c];
      copy.first_seed = *seeds[c];
      copy.episode = 0;
      copy.has_begun = false;
    }
  impl_->for_copies([&](std::size_t c) {
    if (is_meant(c)) impl_->begin(c);
  });
  impl_->was_reset = true;
}

void BatchEnv::step(std::span<const std::uint8_t> begins) {
  if (!impl_->was_reset) throw std::logic_error("step(): call reset() before the first step");
  if (!begins.empty() && begins.size() != copies())
    refuse(fmt::format("step(): `begins` has {} elements: give {}, one per copy", begins.size(), copies()));
  const auto does_begin = [&](std::size_t c) { return !begins.empty() && begins[c] != 0; };
  for (const Impl::TeamData& team : impl_->teams) {
    const std::size_t row = team.actions_plan.size();
    for (std::size_t k = 0; k < team.actions.size(); ++k) {
      if (std::isfinite(team.actions[k])) continue;
      const std::size_t robot = k / row;
      if (does_begin(robot / team.robots)) continue;
      refuse(fmt::format("action {} of \"{}\" in copy {} is {}: give finite numbers", k % row,
                         team.names[robot % team.robots], robot / team.robots, team.actions[k]));
    }
  }
  impl_->for_copies([&](std::size_t c) {
    if (does_begin(c)) return impl_->begin(c);
    Impl::Copy& copy = *impl_->copies[c];
    impl_->act(c);
    for (std::size_t tick = 0; tick < impl_->spec.ticks; ++tick) {
      copy.simulation.step();
      if (copy.measures) copy.measures->see();
    }
    impl_->read_outputs(c);
    impl_->judge(c, true);
  });
}

}  // namespace troupe
