#include "apps/run/world_run.hpp"

#include "apps/messages.hpp"
#include "apps/numbers.hpp"
#include "apps/observers/clock.hpp"
#include "apps/observers/pacer.hpp"
#include "apps/run/dry_run.hpp"
#include "base/diagnostics.hpp"
#include "base/number_text.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace troupe::apps {
namespace {

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

/// Returns the time of a clock that never goes back, s, for SimulationOptions::rank_clock.
double rank_clock(unsigned) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Simulation load(const RunOptions& options) {
  const SimulationOptions& simulation = options.simulation;
  const unsigned ranks = options.dry_run ? 1 : simulation.ranks;  // a dry run needs no other ranks
  // Without a clock, the ranks cannot compare their times.
  const auto clock = options.balances_ranks ? rank_clock : nullptr;
  if (options.is_checkpoint) {
    ResumeOptions resume = resume_options(options);
    resume.ranks = ranks;
    resume.rank_seed = simulation.rank_seed;
    resume.rank_clock = clock;
    resume.processes = simulation.processes;
    resume.distribute = simulation.distribute;
    return Simulation::resume(options.world, resume);
  }
  SimulationOptions given = with_environment(simulation);
  given.mortal = !options.session.empty() || options.view;
  given.contacts = std::ranges::find(options.recording.fields, "contact") != options.recording.fields.end();
  given.rank_clock = clock;
  given.ranks = ranks;
  return Simulation(options.world, given);
}

/// Returns the simulated time at which the run ends, s: without --for, the end of the repeated session, if
/// there is a session; else the result of end_of(). If the file of the session does not state its end, prints
/// a warning.
double end_of_run(const RunOptions& options, const Simulation& simulation, const SessionReplay* session) {
  if (options.for_s || !session) return end_of(options, simulation);
  const std::optional<std::uint64_t> end = session->end_tick();
  const double end_s = static_cast<double>(end.value_or(session->least_end_tick())) * simulation.tick_s();
  if (!end && !options.quiet)
    print_message(fmt::format(
        "{}: warning: the session does not state when it ended, because its program was killed: the run ends "
        "after the last action, at {:.10g} s; --for gives another end\n",
        options.session.string(), end_s));
  return end_s;
}

bool commands_nothing(const engine::Command& command) {
  return command.mode == engine::ControlMode::velocity && command.x == 0 && command.y == 0 &&
         command.turn == 0;
}

/// Returns the controllers of a type as text: "the controller \"wander\"", or "the controllers \"avoid\" and
/// \"sing\"".
std::string controllers_text(const engine::TypeSpec& type) {
  std::string names;
  for (std::size_t c = 0; c < type.controllers.size(); ++c)
    names += fmt::format("{}\"{}\"",
                         c == 0                            ? ""
                         : c + 1 < type.controllers.size() ? ", "
                                                           : " and ",
                         type.controllers[c].kind);
  return fmt::format("the controller{} {}", type.controllers.size() == 1 ? "" : "s", names);
}

/// Numbers of robots of one type that have a drive and are in the world.
struct Robots {
  std::size_t all = 0;
  std::size_t still = 0;  ///< robots at the position where they started
  /// `still` robots that are not disabled, have not turned (not checked if born during the run), and whose
  /// command is not to move.
  std::size_t uncommanded = 0;
};

/// Returns the numbers of robots (Robots) of each type, by TypeId.
std::vector<Robots> robots_by_type(const engine::World& world) {
  std::vector<Robots> of_type(world.spec().types.size());
  for (std::size_t r = 0; r < world.view().rows(); ++r) {
    const Row row(r);
    if (!world.view().type(row).drive || !world.view().is_there(row)) continue;
    const engine::BodySpec& body = world.spec().bodies[world.view().body(row).index()];
    Robots& robots = of_type[body.type.index()];
    ++robots.all;
    if (world.view().transform(row).position != world.view().origin(row)) continue;
    ++robots.still;
    const bool was_born = world.view().birth_tick(row) > 0;  // with a heading that the spec does not state
    const bool has_turned = !was_born && world.view().poses()[r].heading != body.pose_world_body.heading;
    robots.uncommanded +=
        commands_nothing(world.view().commands()[r]) && !has_turned && !world.view().is_disabled(row);
  }
  return of_type;
}

/// Returns warnings about robots that are at their start position at the end of a run. Usually their type
/// lacks a controller, or the controller never commands the drive. Robots of a type with a controller are
/// reported only if all of them stand still without a command, because single robots may have to wait.
std::vector<std::string> standstill_warnings(const Simulation& simulation, const std::string& name) {
  const engine::World& world = simulation.world();
  const engine::WorldSpec& spec = world.spec();
  const std::vector<Robots> of_type = robots_by_type(world);
  std::vector<std::string> warnings;
  std::size_t all = 0, still = 0;
  for (std::size_t t = 0; t < of_type.size(); ++t) {
    const Robots& robots = of_type[t];
    all += robots.all;
    still += robots.still;
    const engine::TypeSpec& type = spec.types[t];
    const auto warn = [&](Where where, std::string_view reason) {
      Diagnostics place(spec.files);
      place.warning(
          where, fmt::format("{} of type \"{}\" did not move, because {}",
                             robots.still == 1 ? "1 robot" : fmt::format("{} robots", grouped(robots.still)),
                             type.name, reason));
      warnings.push_back(place.warnings().front());
    };
    const char* const them = robots.still == 1 ? "it" : "them";
    if (type.controllers.empty() && robots.still > 0)
      warn(type.parts.front().where,
           fmt::format("the type has no controller that commands {}: give the type a controller, or a script "
                       "with --controller",
                       them));
    else if (robots.all > 0 && robots.uncommanded == robots.all)
      warn(type.controllers.front().where,
           fmt::format("{} did not command {} to move: check the controller and its parameters",
                       controllers_text(type), them));
  }
  if (warnings.empty() && all > 0 && still == all)
    warnings.push_back(fmt::format(
        "{}: warning: no robot moved: the mean displacement is 0 m, and {} of {} "
        "robot{} stalled",
        name, grouped(simulation.statistics().stalled), grouped(all), all == 1 ? " is" : "s are"));
  return warnings;
}

/// Returns the limit of the speed, in multiples of real time; 0: no limit.
double rate_of(const RunOptions& options, const Simulation& simulation) {
  return options.world_rate ? simulation.world().spec().watch.rate : options.rate;
}

}  // namespace

WorldRun::WorldRun(RunOptions options) : options_(std::move(options)), simulation_(load(options_)) {
  report_.load_s = std::chrono::duration<double>(Clock::now() - start_).count();
  if (!options_.quiet) print_lines(simulation_.warnings());
  if (!options_.session.empty()) {
    session_ = std::make_unique<SessionReplay>(options_.session, simulation_);
    simulation_.before_tick([this](Simulation& simulation) { session_->act(simulation); });
    if (!options_.quiet) print_lines(session_->warnings());
  }
  report_.options = simulation_.effective_options();
  report_.world = report_.options.front().second;
  report_.first_tick = simulation_.tick();
  report_.title = simulation_.title();
  report_.tick_s = simulation_.tick_s();
  report_.end_s = end_of_run(options_, simulation_, session_.get());
  report_.rate = rate_of(options_, simulation_);
  check_end(options_, simulation_, report_.end_s);
  ticks_ = engine::ticks_until(report_.end_s, report_.tick_s);
  report_.threads = simulation_.threads();
  report_.checkpoint = options_.checkpoint.string();
}

WorldRun::~WorldRun() = default;

const RunOptions& WorldRun::take_names_from_world() {
  options_.outputs.take_names_from_world(options_, simulation_);
  return options_;
}

void WorldRun::rehearse() {
  // Outputs look up the robots that they observe. Without outputs, rank 0 need not have memory for all
  // robots.
  const auto is_given = [](const std::filesystem::path* name) { return !name->empty(); };
  if (std::ranges::any_of(options_.outputs.names(options_), is_given)) fetch_robots();
  prepared_ = options_.outputs.prepare(options_, simulation_, ticks_);
}

bool WorldRun::tells_time() const {
  return !options_.quiet && (options_.clock || simulation_.world().spec().watch.clock);
}

void WorldRun::open_outputs(std::function<bool()> is_over) {
  for (const OpenOutput& open : prepared_) open(observers_);
  for (const auto& observer : observers_)
    if (TickWatcher* watcher = observer->tick_watcher()) watchers_.push_back(watcher);
  // Observers that write no file come after those that do.
  if (tells_time())
    observers_.push_back(
        std::make_unique<ClockLines>(simulation_.world().spec().watch.clock_ticks, simulation_));
  if (report_.rate > 0) {
    auto pacer = std::make_unique<Pacer>(report_.rate, std::move(is_over));
    pacer_ = pacer.get();
    observers_.push_back(std::move(pacer));
  }
}

void WorldRun::open_view(const std::function<bool()>& is_over) {
  view_ = std::make_unique<live::View>(simulation_,
                                       live::View::Options{.rate = 0,  // --rate limits the run
                                                           .is_over = is_over,
                                                           .report = [](const std::string& text) {
                                                             print_message(fmt::format("view: {}\n", text));
                                                           }});
  print_message(fmt::format("view       {}\nread-only  {}\nsession    {}\n", view_->address(),
                            view_->look_address(), view_->session().string()));
}

void WorldRun::print_options() const {
  std::string text = options_.dry_run ? "options\n" : "running\n";
  const auto add = [&text](std::string_view key, const std::string& value) {
    text += fmt::format("  {:<18} {}\n", key, printable_line(value));
  };
  for (const auto& [key, value] : report_.options)
    add(key, key == "tile_m" ? four_digits(number_of<double>(value).value_or(0)) : value);
  if (options_.simulation.rank_seed && simulation_.ranks() > 1)
    add("rank_seed",
        fmt::format("{} (random {}division of the robots)", *options_.simulation.rank_seed,
                    options_.simulation.processes ? "" : "delays and order of messages, random "));
  if (report_.rate > 0) add("rate", fmt::format("{:.10g} x real time", report_.rate));
  add("until_s", fmt::format("{:.10g}", report_.end_s));
  // An error ends the run only after its last output: print_summary() fails as well then.
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stdout));
  std::fflush(stdout);
}

void WorldRun::print_dry_run() const {
  const SimulationOptions& given = options_.simulation;
  const DryRun run = dry_run_of(simulation_, report_, given.ranks, given.distribute);
  fmt::print("{}", options_.json ? dry_run_json(run) : printable(dry_run_text(run)));
}

void WorldRun::begin() {
  report_.rank_counts = simulation_.rank_counts();  // first: waiting for the answers is no part of the run
  report_.ranks = simulation_.rank_statistics();
  simulation_.on_phase([this](std::optional<Phase> phase) {
    phases_(phase);
    load_.tick(phase && phase != Phase::intervene);  // interventions may wait for a user
    for (TickWatcher* watcher : watchers_) watcher->phase(phase);
  });
  simulation_.on_loop([this](bool begins) { load_.loop(begins); });
  simulation_.on_task([this](std::size_t task, bool begins) {
    load_.task(begins);
    for (TickWatcher* watcher : watchers_) watcher->task(task, begins);
  });
  observe();
}

/// Fetches the robots of the other ranks, if this rank does not have them.
void WorldRun::fetch_robots() {
  if (simulation_.rank_statistics().is_distributed) simulation_.world().gather();
}

/// Notifies the observers of the present tick. If some of them throw, notifies all others before the first
/// exception is thrown again, because a checkpoint of this tick may follow (save_at_least()).
void WorldRun::observe() {
  if (std::ranges::any_of(observers_, [](const auto& observer) { return observer->reads_robots(); }))
    fetch_robots();
  std::exception_ptr first;
  for (const auto& observer : observers_) try {
      observer->observe(simulation_);
    } catch (const std::runtime_error&) {
      if (!first) first = std::current_exception();
    }
  if (first) std::rethrow_exception(first);
}

void WorldRun::step() {
  const auto start = Clock::now();
  is_intact_ = false;
  simulation_.step();
  is_intact_ = true;
  observe();
  if (options_.checkpoint.empty() && requests_.has_new(simulation_) && !options_.quiet)
    print_message(fmt::format(
        "{}: warning: SIGUSR1 requests a checkpoint, but the run has no checkpoint file: give one with "
        "--checkpoint FILE.h5\n",
        options_.world.string()));
  report_.wall_s += std::chrono::duration<double>(Clock::now() - start).count();
}

void WorldRun::finish() {
  const RankStatistics before = std::exchange(report_.ranks, simulation_.rank_statistics());
  report_.ranks.messages -= before.messages;
  report_.ranks.bytes -= before.bytes;
  report_.ranks.waited_s -= before.waited_s;
  report_.ranks.rebalanced -= before.rebalanced;
  report_.ranks.distributions -= before.distributions;
  const std::vector<RankCounts> counted = std::exchange(report_.rank_counts, simulation_.rank_counts());
  report_.subtract_counts(counted);
  if (is_intact_) fetch_robots();  // observers and the summary read all robots
  for (const auto& observer : observers_) observer->finish(simulation_);
  simulation_.on_phase(nullptr);
  simulation_.on_loop(nullptr);
  simulation_.on_task(nullptr);
  report_.phase_s = phases_.seconds();
  report_.serial_share = load_.serial_share();
  report_.imbalance = load_.imbalance(report_.threads);
  report_.stopped = !is_done();
  report_.stopped_by = simulation_.stopped().value_or("");
  report_.statistics = simulation_.statistics();
  report_.hashes = simulation_.hashes();
  report_.waited_s = pacer_ ? pacer_->waited_s() : 0;
  report_.peak_rss_bytes = peak_rss_bytes();
}

void WorldRun::save_at_least() const {
  try {
    if (is_intact_)
      for (const auto& observer : observers_) observer->save_at_least(simulation_);
  } catch (const std::runtime_error&) {  // ignored, because the caller reports the first error
  }
}

void WorldRun::print_summary(bool is_one_of_several) const {
  for (const auto& observer : observers_)
    if (const std::string warning = observer->warning(); !warning.empty() && !options_.quiet)
      print_line(warning);
  if (!options_.quiet && report_.ticks_here() > 1)  // the first commands take effect in the second tick
    print_lines(standstill_warnings(simulation_, report_.world));
  if (session_ && session_->left() > 0 && !options_.quiet)
    print_message(fmt::format(
        "{}: warning: the run ended before all actions of the session were applied: {} remained\n",
        options_.session.string(), session_->left()));
  std::string text;
  if (options_.json) {
    text = summary_json(report_);
  } else if (!options_.quiet) {
    text = printable((is_one_of_several ? report_.world + ": " : "") + summary_text(report_));
    for (const auto& observer : observers_)
      if (const std::string result = observer->result(); !result.empty())
        text += fmt::format("  {:<18} {}\n", "written", printable_line(result));
  }
  // A stream without a buffer fails here, any other one in fflush().
  const bool is_written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!is_written || std::fflush(stdout) != 0)
    throw std::runtime_error(
        fmt::format("cannot write to standard output: {}", std::generic_category().message(errno)));
}

void WorldRun::after_summary() const {
  for (const auto& observer : observers_) observer->after_summary(simulation_);
}

}  // namespace troupe::apps
