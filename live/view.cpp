#include "live/view.hpp"

#include "base/diagnostics.hpp"
#include "base/scoped_flag.hpp"
#include "engine/sensing/shown_color.hpp"
#include "engine/world/world.hpp"
#include "live/request.hpp"
#include "live/view_impl.hpp"
#include "troupe/acts.hpp"
#include "worldio/json/session_json.hpp"
#include "worldio/results/replay_header.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <exception>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace troupe::live {
namespace {

namespace fs = std::filesystem;
using engine::Act;
using Json = nlohmann::ordered_json;

constexpr int k_wire = 2;                                          // version of the wire protocol
constexpr std::chrono::nanoseconds k_picture{1'000'000'000 / 30};  // mean time between two pictures, at least
constexpr std::chrono::milliseconds k_nap{50};  // longest wait, so that Ctrl-C takes effect soon

/// Returns the names of the measures that viewers can plot: those that have no required parameters and are
/// not a second name (alias) of another measure.
Json plain_measures(const Simulation& simulation) {
  Json names = Json::array();
  for (const engine::MeasureKind& kind : simulation.registry().measures)
    if (kind.is_usual()) names.push_back(kind.name);
  return names;
}

}  // namespace

View::Impl::Impl(Simulation& simulation, const Options& options)
    : simulation_(simulation.share()),
      is_over_(options.is_over),
      clock_(simulation_, options.rate),
      report_(options.report),
      files_(simulation_, options.folder),
      next_tick_(simulation.tick()),
      line_(simulation.hash_log_line()) {
  if (simulation.has_before_tick())
    throw std::logic_error(
        "the simulation already has a view, or another callback of Simulation::before_tick(): close the "
        "first view (Python: View.close(); C++: destroy the object), or remove the callback with "
        "before_tick(nullptr)");
  simulation_.on_tick([this](Simulation&) { after_tick(); }, alive_);
  engine::World& world = simulation.world();
  world.watch_contacts();  // for the panel of a robot
  worldio::LivePage page = worldio::live_page(world, simulation.registry());
  order_ = std::move(page.order);
  shown_parts_ = std::move(page.shown_parts);
  places_.assign(world.spec().bodies.size(), static_cast<std::uint32_t>(order_.size()));
  for (std::size_t r = 0; r < order_.size(); ++r) places_[order_[r]] = static_cast<std::uint32_t>(r);
  has_colors_ =
      !shown_parts_.empty() || std::ranges::any_of(world.view().types(), [](const engine::BodyType& type) {
        return engine::color_device(type, 0) != nullptr;
      });
  seed_ = simulation.seed();
  connections_ = std::make_unique<Connections>(options, order_.size(), make_greeting(page.header));
  // The session file is created after the server, so that no file is left if the address or the port is not
  // available.
  session_ = std::make_unique<SessionLog>(files_.folder(), simulation_);
  try {
    connections_->start();
  } catch (const std::runtime_error&) {  // for example, the system allows no further thread
    std::error_code ignored;
    fs::remove(session_->file(), ignored);
    throw;
  }
  // Last: if the constructor threw after this, the callbacks would refer to an object that does not exist.
  simulation_.before_step([this](Simulation&) { before_step(); });
  simulation_.before_tick([this](Simulation&) { before_tick(); });
}

View::Impl::~Impl() {
  connections_->stop();
  simulation_.before_step(nullptr);
  simulation_.before_tick(nullptr);
  try {
    while (!holders_.empty()) release_all(holders_.begin()->second.client);
    // Not tick(): after a reset by the program, the session ends where the run before the reset ended. After
    // a step that threw, it ends after this step, so that a run which repeats the session throws as well.
    session_->end(next_tick_);
  } catch (const std::exception&) {  // ignored: the session then has no last line, as after a kill
  }
}

/// Returns the members of the first text to a client, except those that depend on the client. header: the
/// member `header` of worldio::LivePage.
std::string View::Impl::make_greeting(const std::string& header) const {
  const engine::World& world = simulation_.world();
  Json populations = Json::array();  // populations to which bodies can be added
  Json heights = Json::array();      // of the bodies of these populations, m
  for (const engine::ReserveSpec& reserve : world.spec().reserves) {
    populations.push_back(reserve.population);
    heights.push_back(world.spec().bodies[reserve.first.index()].pose_world_body.z);
  }
  // Robots whose name is that of a later body, which requests with this name mean (`same_names` of a world).
  Json namesakes = Json::array();
  for (std::size_t r = 0; r < order_.size(); ++r)
    if (world.state().names.find(world.spec().name(BodyId(order_[r]))) != BodyId(order_[r]))
      namesakes.push_back(r);
  const Json json{{"wire", k_wire},
                  {"version", version_line()},
                  {"tick_s", simulation_.tick_s()},
                  {"colors", has_colors_},
                  {"measures", plain_measures(simulation_)},
                  {"values", color_values(world)},
                  {"layers", layers_of(world)},
                  {"populations", populations},
                  {"heights_m", heights},
                  {"namesakes", namesakes}};
  return fmt::format(R"({},"header":{})", members_of(json), header);
}

void View::Impl::run() {
  // At the end, also if a step throws.
  const std::shared_ptr<void> told(nullptr, [this](void*) {
    try {
      const std::string again = command();
      if (report_ && !again.empty()) report_(fmt::format("this command repeats the session: {}", again));
    } catch (const std::exception&) {  // ignored: the text is lost
    }
  });
  const ScopedFlag running(is_running_);  // also if a step throws, and the program then steps the simulation
  while (!is_over() && !simulation_.stopped()) {
    if (!clock_.is_playing()) {
      {
        const ScopedFlag between_ticks(is_between_ticks_);
        simulation_.world().gather_distributed();  // pictures and answers read the rows of all ranks
        wait();
      }
      if (is_over()) break;
    }
    simulation_.step();
    do_jobs();
  }
}

/// Begins a new session if the program has reset the simulation. The interventions of the next tick are not
/// yet part of the state, as when SessionReplay compares the state with the hash in the session.
void View::Impl::before_step() {
  // At tick 0, only another seed shows that the simulation was reset.
  if (simulation_.tick() != next_tick_ || simulation_.seed() != seed_)
    begin_run(next_tick_, SessionLog::create(files_.folder(), simulation_));
  next_tick_ = simulation_.tick() + 1;
}

void View::Impl::before_tick() {
  // A program that steps the run itself does not wait for the first viewer.
  if (!is_running_ && !std::exchange(has_begun_, true)) clock_.play(0);
  wait();
  clock_.begin_tick();
}

/// Waits until the next tick is due, or, if the world is paused, until a viewer continues the run. Meanwhile
/// the function executes the messages of viewers. It also returns if is_over() is true. Between two ticks it
/// returns at once if the world is not paused, and as soon as a viewer sends an act (a command that changes
/// the world). Acts are applied in before_tick(), after the changes that the world schedules.
void View::Impl::wait() {
  for (;;) {
    const bool all_done = take_messages();
    if (is_between_ticks_) {
      // Also if an act remains: a checkpoint that a viewer requested before the act must not contain the act
      // and the next tick.
      do_jobs();
      if (clock_.is_playing()) return;
    }
    if (!all_done) return;
    const auto now = Clock::now();
    if (is_changed_ || (clock_.is_playing() && now - published_ >= k_picture)) publish();
    if (is_over() || clock_.is_due(now)) return;
    auto until = now + k_nap;
    if (clock_.is_playing()) until = std::min(until, clock_.due());
    if (is_changed_)
      until = std::min(until, now + k_picture / 4);  // publish() found no free picture, so try again soon
    connections_->wait(until);
  }
}

void View::Impl::after_tick() {
  for (auto& [id, client] : clients_) client.selection.see(refuser(id));
  files_.observe();
  if (clock_.end_tick()) is_changed_ = true;
  line_ = clock_.is_playing() ? "" : simulation_.hash_log_line();
  if (!is_running_) do_jobs();
  if (clock_.measure_speed()) files_.limit_recording();
}

/// Executes the messages that have arrived, and returns true. Between two ticks, it returns false at the
/// first act (a command that changes the world), or if a viewer that drives a robot has disconnected, and
/// leaves the remaining messages for before_tick().
bool View::Impl::take_messages() {
  auto [messages, opened, closed] = connections_->take();
  for (const auto& [client, may_steer] : opened) {
    clients_[client].may_steer = may_steer;
    is_changed_ = true;
    if (may_steer && !std::exchange(has_begun_, true)) clock_.play(0);
  }
  const auto changes_world = [this](std::uint64_t client) {
    return std::ranges::any_of(holders_,
                               [client](const auto& holder) { return holder.second.client == client; });
  };
  std::size_t done = 0;
  while (done < messages.size() && (!clients_.contains(messages[done].client) || obey(messages[done])))
    ++done;
  if (done == messages.size() && !(is_between_ticks_ && std::ranges::any_of(closed, changes_world))) {
    for (const std::uint64_t client : closed) {
      release_all(client);
      clients_.erase(client);
    }
    return true;
  }
  messages.erase(messages.begin(), messages.begin() + static_cast<std::ptrdiff_t>(done));
  connections_->put_back({std::move(messages), {}, std::move(closed)});
  return false;
}

Selection::Refuse View::Impl::refuser(std::uint64_t client) {
  return [this, client](std::uint64_t id, const std::string& reason) {
    connections_->refuse(client, id, reason);
  };
}

/// Executes a message and answers it. Returns false, without an answer, for an act that arrives between two
/// ticks.
bool View::Impl::obey(const Connections::Message& message) {
  const Request request(message.text);
  try {
    if (postpone(request, message.client)) return true;  // the answer follows when it is done
    if (obey_question(request, message.client)) return true;
    if (!clock_.obey(request) && !clients_[message.client].selection.obey(request, simulation_)) {
      Diagnostics diagnostics;
      const std::optional<Act> act = worldio::read_act(message.text, {"id"}, {}, diagnostics);
      diagnostics.throw_if_errors();
      if (is_between_ticks_) return false;
      carry_out(message.client, *act);
    }
    is_changed_ = true;
    connections_->answer(message.client, request.id());
  } catch (const ActRefused& refusal) {
    connections_->refuse(message.client, request.id(), refusal.what());
  } catch (const InputError& error) {
    connections_->refuse(message.client, request.id(), error.what());
  }
  return true;
}

/// Answers a request that changes nothing. Returns false if the request is of another sort.
bool View::Impl::obey_question(const Request& request, std::uint64_t client) {
  if (request.what() != "parameters") return false;
  try {
    connections_->answer(client, request.id(),
                         {{"parameters", Json::parse(simulation_.parameters(request.name("type")))}});
  } catch (const std::exception& error) {  // an unknown type, or a text that is not UTF-8
    throw ActRefused(error.what());
  }
  return true;
}

/// Postpones a request that is possible only between two ticks: its work is done when the current tick has
/// ended. If the world is paused within a tick, which is the case after an act, this tick is computed first.
/// Returns false if the request is of another sort.
bool View::Impl::postpone(const Request& request, std::uint64_t client) {
  using What = Job::What;
  Job job{.client = client, .id = request.id()};
  if (request.what() == "restart") {
    check_restart();  // before a tick is computed for it
    if (request.has("seed")) job.seed = request.whole("seed", 0, std::numeric_limits<std::uint64_t>::max());
  } else if (request.what() == "checkpoint") {
    job.what = What::checkpoint;
  } else if (request.what() == "record") {
    job.what = What::record;
  } else if (request.what() == "stop_recording") {
    job.what = What::stop_recording;
  } else {
    return false;
  }
  jobs_.push_back(job);
  if (!clock_.is_playing() && !is_between_ticks_) clock_.play(1);
  return true;
}

void View::Impl::do_jobs() {
  for (const Job& job : std::exchange(jobs_, {})) {
    try {
      const std::string file = do_job(job);
      connections_->answer(job.client, job.id, file.empty() ? Json::object() : Json{{"file", file}});
    } catch (const std::exception& error) {  // the run continues even if the job failed
      connections_->refuse(job.client, job.id, error.what());
    }
    is_changed_ = true;
  }
}

/// Returns the name of the file that the job has created; empty if the job creates none.
std::string View::Impl::do_job(const Job& job) {
  switch (job.what) {
    case Job::What::restart: restart(job.seed); break;
    case Job::What::checkpoint: return files_.save_checkpoint();
    case Job::What::record:
      return files_.start_recording([this, job](const std::string& reason) {
        if (report_) report_(reason);
        connections_->refuse(job.client, job.id, reason);
      });
    case Job::What::stop_recording:
      if (files_.recording().empty())
        throw ActRefused(
            "no viewer has started a recording; a page cannot stop a recording that the command or program "
            "has started");
      files_.stop_recording();
      break;
  }
  return {};
}

/// Throws ActRefused if viewers cannot restart this run.
void View::Impl::check_restart() const {
  if (!is_running_)
    throw ActRefused(
        "the page cannot restart this run: end the command or program that computes it, and start it again");
  if (simulation_.resumed_at_tick())
    throw ActRefused(
        "a run that began at a checkpoint cannot be restarted: end it, and resume the checkpoint again");
}

/// Returns to tick 0 and begins a new session. If `seed` is given, the new run uses this seed.
void View::Impl::restart(std::optional<std::uint64_t> seed) {
  const std::uint64_t end = simulation_.tick();
  // First: if the file cannot be created, the present run continues.
  files_.add_session();
  std::unique_ptr<SessionLog> next = SessionLog::create(files_.folder(), simulation_);
  if (seed)
    simulation_.reset(*seed);
  else
    simulation_.reset();
  begin_run(end, std::move(next));
}

/// Begins a new session, because the simulation has returned to tick 0. end: tick at which the previous run
/// ended. next: the session, whose first line is not yet written.
void View::Impl::begin_run(std::uint64_t end, std::unique_ptr<SessionLog> next) {
  try {
    session_->end(end);
  } catch (const std::exception&) {  // ignored: a session that cannot end, or did not begin, has no last line
  }
  session_ = std::move(next);
  holders_.clear();
  files_.end_with_the_run();
  ++runs_;
  next_tick_ = simulation_.tick();
  line_ = clock_.is_playing() ? "" : simulation_.hash_log_line();
  clock_.restart();
  is_changed_ = true;
  if (simulation_.seed() != std::exchange(seed_, simulation_.seed())) greet_again();
  session_->begin(simulation_);  // last: if it throws, the view has nevertheless left the previous run
}

/// Sends the first text again to all clients, because another seed places the bodies elsewhere.
void View::Impl::greet_again() {
  std::map<std::uint64_t, bool> clients;
  for (const auto& [id, client] : clients_) clients[id] = client.may_steer;
  connections_->greet_again(
      make_greeting(worldio::live_page(simulation_.world(), simulation_.registry()).header),
      std::move(clients));
}

/// Applies an act (a command that changes the world) of a viewer and adds the act to the session. Throws
/// ActRefused if the act is impossible, or if it takes or releases control of a robot that another viewer
/// drives.
void View::Impl::carry_out(std::uint64_t client, const Act& act) {
  const bool is_hold = act.kind == Act::Kind::hold || act.kind == Act::Kind::release;
  // By id, because a robot can have several names (aliases).
  const std::uint32_t robot =
      is_hold ? simulation_.world().state().names.find(act.whom).value : BodyId().value;
  if (const auto holder = holders_.find(robot); holder != holders_.end() && holder->second.client != client)
    throw ActRefused(
        fmt::format("another viewer drives \"{}\": wait until that viewer releases the robot", act.whom));
  simulation_.act(act);
  log(act);
  if (act.kind == Act::Kind::hold) holders_[robot] = {client, act.whom};
  if (act.kind == Act::Kind::release) holders_.erase(robot);
}

/// Adds an act that was applied to the session. If it cannot be written, for example because the disk is
/// full, the run cannot be repeated and must end: tells all viewers why, and throws std::runtime_error.
void View::Impl::log(const Act& act) {
  try {
    session_->add(simulation_, act);
  } catch (const std::runtime_error& error) {
    const std::string_view text = error.what();
    constexpr std::string_view k_mark = ": error: ";
    const std::size_t mark = text.find(k_mark);  // without the path of the file
    connections_->stop(
        fmt::format("the session file {}", mark == text.npos ? text : text.substr(mark + k_mark.size())));
    throw;
  }
}

/// Releases the robots that a disconnected viewer held, as acts of the session.
void View::Impl::release_all(std::uint64_t client) {
  std::erase_if(holders_, [&](const auto& holder) {
    if (holder.second.client != client) return false;
    const Act act{.kind = Act::Kind::release, .whom = holder.second.robot};
    try {
      simulation_.act(act);
      log(act);
    } catch (const ActRefused&) {  // ignored: the robot has left the world, which released it
    }
    return true;
  });
}

/// Returns the part of the state that every client receives.
Json View::Impl::state() const {
  return {{"tick", simulation_.tick()},
          {"time_s", simulation_.time_s()},
          {"playing", clock_.is_playing()},
          {"rate", clock_.rate()},
          {"reached", clock_.speed()},
          {"robots", simulation_.robots()},
          {"viewers", clients_.size()},
          {"run", runs_},
          {"session", session_->file().filename().string()},
          {"recording", files_.recording().filename().string()},
          {"line", clock_.is_playing() ? "" : line_}};
}

void View::Impl::publish() {
  if (clients_.empty()) {
    is_changed_ = false;
    return;
  }
  const auto now = Clock::now();
  if (now - published_ < k_picture) return;
  const std::shared_ptr<Picture> picture = connections_->spare_picture();
  if (!picture) return;  // the server still uses all pictures; before_tick() tries again
  picture->number = ++pictures_;
  simulation_.world().gather_distributed();
  take(simulation_.world(), order_, has_colors_, shown_parts_, *picture);
  picture->state = members_of(state());
  picture->own.clear();
  picture->shades.clear();
  for (auto& [id, client] : clients_) {
    if (ColorValue* color = client.selection.color())
      take_shades(simulation_.world(), places_, order_.size(), *color, picture->shades[id]);
    if (const Json own = client.selection.state(simulation_, refuser(id)); !own.empty())
      picture->own[id] = members_of(own);
  }
  // Pictures that are a little late must not delay the later ones: the mean rate is that of k_picture.
  published_ = now - published_ < 2 * k_picture ? published_ + k_picture : now;
  is_changed_ = false;
  connections_->publish(picture);
}

// ---- the public face

View::View(Simulation& simulation, const Options& options)
    : impl_(std::make_unique<Impl>(simulation, options)) {}
View::View(Simulation& simulation) : View(simulation, Options()) {}
View::~View() = default;

std::string View::address() const { return impl_->address(); }
std::string View::look_address() const { return impl_->look_address(); }
fs::path View::session() const { return impl_->session(); }
std::string View::command() const { return impl_->command(); }
void View::run() { impl_->run(); }

}  // namespace troupe::live
