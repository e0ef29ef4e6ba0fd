#include "troupe/batch_env.hpp"

#include "base/hash.hpp"
#include "base/random.hpp"
#include "base/scoped_flag.hpp"
#include "engine/kinds/controller.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "troupe/batch_impl.hpp"
#include "troupe/swarm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>
#include <utility>

namespace troupe {
namespace {

/// Returns the seed of an episode, which is derived from the seed of the first episode of the copy, `first`,
/// and the number of the episode.
std::uint64_t episode_seed(std::uint64_t first, std::uint64_t episode) {
  return episode == 0 ? first : mix(first, hash_text("episode"), episode);
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
  engine::visit_element(element, write);
}

/// Returns the element of `all` with this index. Throws std::out_of_range if there is none. what: name of an
/// element, for the error text.
template <class T>
T& element_at(std::vector<T>& all, std::size_t index, std::string_view what) {
  if (index < all.size()) return all[index];
  throw std::out_of_range(
      fmt::format("{} {} does not exist: give a number from 0 to {}", what, index, all.size() - 1));
}

/// Makes the world skip the controllers of the robots for which `learns`, by BodyId, is not 0: the policy
/// commands these robots. `learns` must outlive the world.
void skip_controllers(engine::World& world, const std::vector<std::uint8_t>& learns) {
  world.on_decide([&learns](const engine::BodyType&, const engine::BodyType::Controller& controller,
                            const engine::DecideBatch& batch) {
    const auto decide = [&](std::span<const Row> rows) {
      if (rows.empty()) return;
      engine::DecideBatch some = batch;
      some.rows = rows;
      controller.kind->decide(controller.data, some);
    };
    const auto learns_in = [&](Row row) { return learns[batch.ids[row.index()].index()] != 0; };
    // The decisions of a collective controller may depend on all robots of its batch.
    if (controller.kind->is_collective) {
      thread_local std::vector<Row> others;  // keeps its memory, because this is called in every tick
      others.clear();
      for (const Row row : batch.rows)
        if (!learns_in(row)) others.push_back(row);
      return decide(others);
    }
    std::array<Row, 64> others;
    std::size_t count = 0;
    for (const Row row : batch.rows) {
      if (learns_in(row)) continue;
      if (count == others.size()) {
        decide(others);
        count = 0;
      }
      others[count++] = row;
    }
    decide({others.data(), count});
  });
}

}  // namespace

// ---- construction

BatchEnv::Impl::Impl(const Simulation& world, const BatchSpec& wanted)
    : spec(wanted), parallel(wanted.threads) {
  check_spec();
  episode_ticks = std::max<std::uint64_t>(engine::ticks_until(spec.seconds, world.tick_s()), 1);
  teams.resize(spec.teams.size());
  copies.reserve(spec.copies);
  plan_starts(world.world());
  for (std::size_t c = 0; c < spec.copies; ++c) add_copy(world, c);
  measures.resize(spec.copies * measure_columns.size());
  truncated.resize(spec.copies);
  over.resize(spec.copies, 1);
}

void BatchEnv::Impl::add_copy(const Simulation& world, std::size_t c) {
  const std::uint64_t seed = world.seed() + c;
  copies.push_back(std::make_unique<Copy>(world.another(seed, 1)));
  seeds.push_back(seed);
  Copy& copy = *copies.back();
  copy.first_seed = seed;
  engine::World& engine = copy.simulation.world();
  copy.learns.resize(engine.spec().bodies.size());
  if (!spec.measures.empty()) {
    copy.measures.emplace(copy.simulation, spec.measures);
    if (c == 0) measure_columns.assign(copy.measures->columns().begin(), copy.measures->columns().end());
  }
  for (std::size_t t = 0; t < teams.size(); ++t) {
    const BatchTeam& own = spec.teams[t];
    Swarm swarm = own.robot.empty() ? copy.simulation.swarm(own.robots)
                                    : copy.simulation.swarm(copy.simulation.find(own.robot));
    swarm.subscribe();
    TeamCopy& bound = copy.teams.emplace_back();
    for (const BodyId id : swarm.ids()) {
      bound.ids.push_back(id);
      if (std::exchange(copy.learns[id.index()], std::uint8_t{1}) != 0)
        refuse(fmt::format("robot \"{}\" is in two teams: a robot can be in only one team",
                           engine.spec().name(id)));
    }
    if (c == 0) {
      TeamData& team = teams[t];
      team.spec = &spec.teams[t];
      team.robots = swarm.size();
      team.names = swarm.names();
      if (team.robots == 0)
        refuse(fmt::format("team \"{}\" has no robots: {}", team.spec->name,
                           own.robots.empty() ? "no body of the world has a drive"
                                              : "the world has no robot of \"" + own.robots + "\""));
      plan(team, copy);
    }
    bind(teams[t], copy, bound);
  }
  skip_controllers(engine, copy.learns);
}

// ---- steps

/// Calls work(c) for each copy c, in parallel. A task is a block of copies, and each copy runs on one thread,
/// so that its state stays in the caches of that thread. If work() throws for some copies, it is still called
/// for all others; for_copies() then rethrows the exception of the first of these copies.
template <class Work>
void BatchEnv::Impl::for_copies(Work&& work) {
  const ScopedFlag running(is_running);
  constexpr std::size_t k_most = 32;           // copies per task
  constexpr std::size_t k_tasks_a_thread = 8;  // enough that all threads end at about the same time
  const std::size_t n = copies.size();
  const std::size_t block = std::clamp<std::size_t>(n / (k_tasks_a_thread * parallel.threads()), 1, k_most);
  parallel.for_batches(n, block, [&](std::size_t first, std::size_t end) {
    std::exception_ptr error;
    for (std::size_t c = first; c < end; ++c) try {
        work(c);
      } catch (...) {
        if (!error) error = std::current_exception();
      }
    if (error) std::rethrow_exception(error);
  });
}

/// Throws std::logic_error in callbacks of the simulations of the copies, which for_copies() runs: a worker
/// thread must not start another loop. call: name of the calling function, for the error
void BatchEnv::Impl::refuse_in_callbacks(std::string_view call) const {
  if (is_running)
    throw std::logic_error(fmt::format(
        "{} of a batch is not allowed in a callback of one of its simulations: call it outside the "
        "callback",
        call));
}

std::uint64_t BatchEnv::Impl::next_seed(std::size_t c) const {
  const Copy& copy = *copies[c];
  return episode_seed(copy.first_seed, copy.episode + (copy.has_begun ? 1 : 0));
}

/// Throws std::invalid_argument if a row of starts() of a copy is neither a pose nor NaN.
void BatchEnv::Impl::check_starts(std::size_t c) const {
  for (const StartData& start : starts)
    for (std::size_t b = 0; b < start.bodies.size(); ++b) {
      const auto row = start.row(c, b);
      if (std::ranges::all_of(row, [](double x) { return std::isfinite(x); }) ||
          std::ranges::all_of(row, [](double x) { return std::isnan(x); }))
        continue;
      refuse(
          fmt::format("the start of \"{}\" in copy {} (counted from 0) is x {}, y {} (m), heading {} (rad): "
                      "give finite numbers, or NaN for all three",
                      copies[c]->simulation.world().spec().name(start.bodies[b]), c, row[0], row[1], row[2]));
    }
}

/// Returns the poses at which the program lets bodies of a copy begin the next episode.
std::vector<std::pair<Model, Pose>> BatchEnv::Impl::starts_of(std::size_t c) {
  Simulation& simulation = copies[c]->simulation;
  std::vector<std::pair<Model, Pose>> placed;
  for (const StartData& start : starts)
    for (std::size_t b = 0; b < start.bodies.size(); ++b) {
      const auto row = start.row(c, b);
      if (std::isnan(row[0])) continue;
      const double z = simulation.world().spec().bodies[start.bodies[b].index()].pose_world_body.z;
      placed.emplace_back(simulation.model(start.bodies[b]), Pose{row[0], row[1], z, row[2]});
    }
  return placed;
}

void BatchEnv::Impl::begin(std::size_t c) {
  Copy& copy = *copies[c];
  copy.has_failed = true;
  seeds[c] = next_seed(c);
  if (std::exchange(copy.has_begun, true)) ++copy.episode;
  const std::vector<std::pair<Model, Pose>> placed = starts_of(c);
  if (seeds[c] == copy.simulation.seed() && placed.empty() && !copy.has_starts) {
    copy.simulation.reset();
  } else {
    copy.has_starts = true;  // also if the reset throws: the bodies may have moved
    copy.simulation.reset(seeds[c], placed);
    copy.has_starts = !placed.empty();
  }
  if (copy.measures) copy.measures->see();
  copy.simulation.step();
  if (copy.measures) copy.measures->see();
  copy.last_tick = copy.simulation.tick() + episode_ticks;
  truncated[c] = 0;
  read_outputs(c);
  judge(c, false);
  copy.has_failed = false;
}

/// Throws std::invalid_argument if an action of a copy c that makes a step (begins[c] is 0) is not finite.
void BatchEnv::Impl::check_actions(std::span<const std::uint8_t> begins) const {
  for (const TeamData& team : teams) {
    const std::size_t row = team.actions_plan.size();
    for (std::size_t k = 0; k < team.actions.size(); ++k) {
      if (std::isfinite(team.actions[k])) continue;
      const std::size_t robot = k / row;
      const std::size_t c = robot / team.robots;
      if (!begins.empty() && begins[c] != 0) continue;
      refuse(fmt::format("action {} of \"{}\" in copy {} (both counted from 0) is {}: give finite numbers",
                         k % row, team.names[robot % team.robots], c, team.actions[k]));
    }
  }
}

void BatchEnv::Impl::act(std::size_t c) {
  Copy& copy = *copies[c];
  for (std::size_t t = 0; t < teams.size(); ++t) {
    const TeamData& team = teams[t];
    TeamCopy& bound = copy.teams[t];
    const std::size_t columns = team.actions_plan.size();
    for (std::size_t i = 0; i < team.robots; ++i) {
      const std::size_t at = c * team.robots + i;
      const bool is_finished = team.terminated[at] != 0;
      bound.was_terminated[i] = is_finished;
      const std::span<const double> all = team.actions;
      command(copy.simulation.world(), team, bound, i, all.subspan(at * columns, is_finished ? 0 : columns));
    }
  }
}

/// Commands robot i of a team with its actions, numbers from -1 to 1; without actions, stops its drive.
void BatchEnv::Impl::command(engine::World& world, const TeamData& team, const TeamCopy& bound, std::size_t i,
                             std::span<const double> given) {
  const Row row = world.view().row(bound.ids[i]);
  if (!world.view().is_there(row)) return;
  std::array<double, k_drive> drive{};
  for (std::size_t a = 0; a < given.size(); ++a) {
    const Action& action = team.actions_plan[a];
    const double asked = action.low + (std::clamp(given[a], -1.0, 1.0) + 1) * 0.5 * action.span;
    if (action.command < k_drive) {
      drive[action.command] = asked;
    } else {
      const DeviceField& field = bound.commands[(action.command - k_drive) * team.robots + i];
      put_number(world.device_command(row, *field.device) + field.field, action.element,
                 action.is_bool ? std::clamp(asked, 0.0, 1.0) : asked);
    }
  }
  if (team.drives) world.set_command(row, {drive[0], drive[1], drive[2], engine::ControlMode::velocity});
}

void BatchEnv::Impl::read_outputs(std::size_t c) {
  Copy& copy = *copies[c];
  if (copy.measures)
    std::ranges::copy(copy.measures->values(),
                      measures.begin() + static_cast<std::ptrdiff_t>(c * measure_columns.size()));
  observe(c);
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
std::size_t BatchEnv::robots(std::size_t team) const { return element_at(impl_->teams, team, "team").robots; }
std::vector<std::string> BatchEnv::names(std::size_t team) const {
  return element_at(impl_->teams, team, "team").names;
}
const Simulation& BatchEnv::simulation(std::size_t copy) const {
  return element_at(impl_->copies, copy, "copy")->simulation;
}
Simulation& BatchEnv::simulation(std::size_t copy) {
  return element_at(impl_->copies, copy, "copy")->simulation;
}
unsigned BatchEnv::threads() const { return impl_->parallel.threads(); }

BatchEnv::Array BatchEnv::array(std::size_t team, std::string_view name) const {
  Impl::TeamData& of = element_at(impl_->teams, team, "team");
  Impl::ArrayData& array = of.arrays[Impl::array_index(of, name)];
  return {array.element, array.columns, array.bytes};
}

std::span<const float> BatchEnv::floats(std::size_t team, std::string_view name) const {
  const Array found = array(team, name);
  if (found.element != engine::Element::f32)
    Impl::refuse(fmt::format("array \"{}\" has the type {}, not float32: use array()", name,
                             engine::element_name(found.element)));
  return {reinterpret_cast<const float*>(found.bytes.data()), found.bytes.size() / sizeof(float)};
}

std::span<double> BatchEnv::actions(std::size_t team) {
  return element_at(impl_->teams, team, "team").actions;
}
std::span<double> BatchEnv::rewards(std::size_t team) {
  return element_at(impl_->teams, team, "team").rewards;
}
std::span<std::uint8_t> BatchEnv::terminated(std::size_t team) {
  return element_at(impl_->teams, team, "team").terminated;
}
std::span<const std::uint8_t> BatchEnv::alive(std::size_t team) const {
  return element_at(impl_->teams, team, "team").alive;
}
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

std::span<double> BatchEnv::starts(std::string_view name) {
  const auto found = std::ranges::find(impl_->starts, name, &Impl::StartData::name);
  if (found == impl_->starts.end())
    throw std::out_of_range(unknown_name("entry of `starts`", name, name_list(impl_->starts)));
  return found->poses;
}

std::vector<std::uint64_t> BatchEnv::next_seeds() const {
  std::vector<std::uint64_t> next;
  for (std::size_t c = 0; c < copies(); ++c) next.push_back(impl_->next_seed(c));
  return next;
}

void BatchEnv::reset(std::span<const std::uint8_t> which,
                     std::span<const std::optional<std::uint64_t>> seeds) {
  impl_->refuse_in_callbacks("reset()");
  if (!which.empty() && which.size() != copies())
    Impl::refuse(
        fmt::format("reset(): `which` has {} elements: give {}, one per copy", which.size(), copies()));
  if (!seeds.empty() && seeds.size() != copies())
    Impl::refuse(
        fmt::format("reset(): `seeds` has {} elements: give {}, one per copy", seeds.size(), copies()));
  const auto is_meant = [&](std::size_t c) { return which.empty() || which[c] != 0; };
  for (std::size_t c = 0; c < copies(); ++c)
    if (!is_meant(c) && !impl_->copies[c]->has_begun)
      throw std::logic_error(fmt::format(
          "reset(): copy {} (counted from 0) has not begun an episode: reset all copies first", c));
  for (std::size_t c = 0; c < copies(); ++c)
    if (is_meant(c)) impl_->check_starts(c);
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
  impl_->refuse_in_callbacks("step()");
  if (!impl_->was_reset) throw std::logic_error("step(): call reset() before the first step");
  if (!begins.empty() && begins.size() != copies())
    Impl::refuse(
        fmt::format("step(): `begins` has {} elements: give {}, one per copy", begins.size(), copies()));
  const auto does_begin = [&](std::size_t c) { return !begins.empty() && begins[c] != 0; };
  impl_->check_actions(begins);
  for (std::size_t c = 0; c < copies(); ++c)
    if (does_begin(c)) impl_->check_starts(c);
  for (std::size_t c = 0; c < copies(); ++c)
    if (!does_begin(c) && impl_->copies[c]->has_failed)
      throw std::logic_error(fmt::format(
          "step(): the last step or reset of copy {} (counted from 0) failed: reset this copy first", c));
  impl_->for_copies([&](std::size_t c) {
    if (does_begin(c)) return impl_->begin(c);
    Impl::Copy& copy = *impl_->copies[c];
    copy.has_failed = true;
    impl_->act(c);
    for (std::size_t tick = 0; tick < impl_->spec.ticks; ++tick) {
      copy.simulation.step();
      if (copy.measures) copy.measures->see();
    }
    impl_->read_outputs(c);
    impl_->judge(c, true);
    copy.has_failed = false;
  });
}

}  // namespace troupe
