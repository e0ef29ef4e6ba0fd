#include "live/view.hpp"

#include "base/diagnostics.hpp"
#include "engine/sensing/shown_color.hpp"
#include "engine/spec/ticks.hpp"
#include "engine/world/world.hpp"
#include "live/page.hpp"
#include "live/request.hpp"
#include "live/view_impl.hpp"
#include "troupe/acts.hpp"
#include "worldio/json/session_json.hpp"
#include "worldio/results/replay_header.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cmath>
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
constexpr std::chrono::milliseconds k_nap{50};    // longest wait, so that Ctrl-C takes effect soon
constexpr std::chrono::seconds k_most_behind{1};  // a run that is later than this does not catch up
constexpr std::size_t k_spare = 3;  // one picture is being filled, one encoded, and one is the newest
constexpr std::size_t k_most_messages = 1024;  // messages queued for the simulation
constexpr std::uint64_t k_most_steps = 1000000000;
constexpr std::uint64_t k_most_columns = 1000000000;
constexpr std::uintmax_t k_bytes_gb = 1'000'000'000;
constexpr std::uintmax_t k_most_file_bytes = 10 * k_bytes_gb;  // of all files that viewers request
constexpr std::array<std::string_view, 5> k_looking{"inspect", "plot", "color", "layers",
                                                    "parameters"};  // requests of read-only viewers
constexpr int k_most_files = 100000;  // largest number of files of one kind in a folder

/// Returns a token: 128 random bits as 32 hexadecimal digits.
std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error(
        "troupe view: error: the system gave no random numbers (getrandom) for the token that protects the "
        "page: start the view again");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Returns the JSON text of an object without the outer braces, so that it can be inserted into another
/// object.
std::string members_of(const Json& json) {
  std::string text = text_of(json);
  return text.substr(1, text.size() - 2);
}

std::string hello_of(const std::string& greeting, bool may_steer) {
  return fmt::format(R"({{"type":"hello","may_steer":{},{}}})", may_steer, greeting);
}

/// Sets a flag while an object of this class exists.
class Raised {
 public:
  explicit Raised(bool& flag) : flag_(flag) { flag_ = true; }
  ~Raised() { flag_ = false; }
  Raised(const Raised&) = delete;
  Raised& operator=(const Raised&) = delete;

 private:
  bool& flag_;
};

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
    : simulation_(simulation),
      is_over_(options.is_over),
      report_(options.report),
      token_(make_token()),
      look_token_(make_token()),
      folder_(options.folder),
      next_tick_(simulation.tick()),
      rate_(options.rate),
      line_(simulation.hash_log_line()) {
  if (simulation.has_before_tick())
    throw std::logic_error(
        "the simulation already has a view, or another callback of Simulation::before_tick(): close the "
        "first view (Python: View.close(); C++: destroy the object), or remove the callback with "
        "before_tick(nullptr)");
  const engine::World& world = simulation.world();
  worldio::LivePage page = worldio::live_page(world, simulation.registry());
  order_ = std::move(page.order);
  shown_parts_ = std::move(page.shown_parts);
  places_.assign(world.spec().bodies.size(), static_cast<std::uint32_t>(order_.size()));
  for (std::size_t r = 0; r < order_.size(); ++r) places_[order_[r]] = static_cast<std::uint32_t>(r);
  has_colors_ = !shown_parts_.empty() || std::ranges::any_of(world.types(), [](const engine::BodyType& type) {
    return engine::color_device(type, 0) != nullptr;
  });
  greeting_ = make_greeting(page.header);
  seed_ = simulation.seed();
  for (std::size_t i = 0; i < k_spare; ++i) spare_.push_back(std::make_shared<Picture>());
  server_ = std::make_unique<ViewServer>(ViewServer::Options{options.port, options.bind, options.hosts,
                                                             std::string(k_view_page), token_, look_token_},
                                         static_cast<ViewBackend&>(*this));
  // The session file is created after the server, so that no file is left if the address or the port is not
  // available.
  session_ = std::make_unique<SessionLog>(folder_, simulation);
  self_ = std::make_shared<Impl*>(this);
  simulation_.on_tick([self = std::weak_ptr<Impl*>(self_)](Simulation&) {
    if (const auto found = self.lock()) (*found)->after_tick();
  });
  server_->start();  // not in the constructor of the server, because the functions that it calls use server_
  // Last: if the constructor threw after this, the callback would refer to an object that does not exist.
  simulation_.before_tick([this](Simulation&) { before_tick(); });
}

View::Impl::~Impl() {
  server_->stop();
  simulation_.before_tick(nullptr);
  try {
    session_->end(simulation_.tick());
  } catch (const std::exception&) {  // ignored: the session then has no last line, as after a kill
  }
}

/// Returns the members of the first text to a client, except those that depend on the client. header: the
/// member `header` of worldio::LivePage.
std::string View::Impl::make_greeting(const std::string& header) const {
  const engine::World& world = simulation_.world();
  Json populations = Json::array();  // populations to which bodies can be added
  for (const engine::ReserveSpec& reserve : world.spec().reserves) populations.push_back(reserve.population);
  const Json json{{"wire", k_wire},
                  {"version", version_line()},
                  {"tick_s", simulation_.tick_s()},
                  {"colors", has_colors_},
                  {"measures", plain_measures(simulation_)},
                  {"values", color_values(world)},
                  {"layers", layers_of(world)},
                  {"populations", populations}};
  return fmt::format(R"({},"header":{})", members_of(json), header);
}

std::string View::Impl::address_of(const std::string& token) const {
  return fmt::format("http://{}/#{}", server_->authority(), token);
}

// ---- the server's thread

std::string View::Impl::opened(std::uint64_t client, bool may_steer) {
  sent_[client];
  std::string hello;
  {
    const std::scoped_lock lock(mutex_);
    arrived_[client] = may_steer;
    hello = hello_of(greeting_, may_steer);
  }
  wake_.notify_one();
  return hello;
}

void View::Impl::closed(std::uint64_t client) {
  sent_.erase(client);
  {
    const std::scoped_lock lock(mutex_);
    gone_.push_back(client);
  }
  wake_.notify_one();
}

void View::Impl::refused(const std::string& what) {
  if (told_.insert(what).second && report_) report_(fmt::format("refused: {}", what));
}

void View::Impl::received(std::uint64_t client, bool may_steer, std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  const auto what = json.is_object() ? json.value("do", Json()) : Json();
  if (!what.is_string()) {
    refused("a message that is not a JSON object with a text under the key \"do\"");
    return refuse(client, {}, "a message must be a JSON object with a text under the key \"do\"");
  }
  if (what == "drawn") return server_->drawn(client);
  const auto given = json.value("id", Json(0U));
  if (!given.is_number_unsigned()) {
    refused("a message with an invalid \"id\"");
    return refuse(client, {}, "\"id\" must be a whole number from 0 to 2^64 - 1");
  }
  const auto id = json.contains("id") ? std::optional(given.get<std::uint64_t>()) : std::nullopt;
  if (!may_steer && std::ranges::find(k_looking, what.get<std::string>()) == k_looking.end()) {
    refused("a command of a read-only viewer");
    return refuse(client, id, "this address is read-only");
  }
  bool is_full = false;
  {
    const std::scoped_lock lock(mutex_);
    is_full = messages_.size() >= k_most_messages;
    if (!is_full) messages_.push_back({client, std::string(text)});
  }
  if (is_full) return refuse(client, id, "too many messages are waiting: send this one again later");
  wake_.notify_one();
}

std::optional<ViewFrames> View::Impl::picture(std::uint64_t client) {
  std::shared_ptr<const Picture> newest;
  {
    const std::scoped_lock lock(mutex_);
    newest = newest_;
  }
  SentPicture& sent = sent_[client];
  if (!newest || newest->number == sent.number) return {};
  const auto own = newest->own.find(client);
  ViewFrames frames{
      fmt::format(R"({{"type":"state","picture":{},{}{}{}}})", newest->number, newest->state,
                  own == newest->own.end() ? "" : ",", own == newest->own.end() ? "" : own->second),
      encode(*newest, order_.size(), client, sent)};
  // The pointer is released under the lock, because publish() reads its use count.
  const std::scoped_lock lock(mutex_);
  newest.reset();
  return frames;
}

// ---- the simulation's thread

void View::Impl::run() {
  const Raised running(is_running_);  // also if a step throws, and the program then steps the simulation
  while (!is_over() && !simulation_.stopped()) {
    if (!playing_) {
      {
        const Raised between_ticks(is_between_ticks_);
        wait();
      }
      if (is_over()) break;
    }
    simulation_.step();
    do_jobs();
  }
}

void View::Impl::before_tick() {
  // A program that steps the run itself does not wait for the first viewer.
  if (!is_running_ && !std::exchange(has_begun_, true)) play(0);
  // The program has reset the simulation. At tick 0, only another seed shows that.
  if (simulation_.tick() != next_tick_ || simulation_.seed() != seed_) begin_run(next_tick_);
  next_tick_ = simulation_.tick() + 1;
  wait();
  if (rate_ == 0) return;
  const auto now = Clock::now();
  const auto tick = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(simulation_.tick_s() / rate_));
  due_ = due_ + k_most_behind < now ? now + tick : due_ + tick;
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
      if (playing_) return;
    }
    if (!all_done) return;
    const auto now = Clock::now();
    if (is_changed_ || (playing_ && now - published_ >= k_picture)) publish();
    if (is_over() || (playing_ && (rate_ == 0 || now >= due_))) return;
    auto until = now + k_nap;
    if (playing_) until = std::min(until, due_);
    if (is_changed_)
      until = std::min(until, now + k_picture / 4);  // publish() found no free picture, so try again soon
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, until,
                     [this] { return !messages_.empty() || !arrived_.empty() || !gone_.empty(); });
  }
}

void View::Impl::after_tick() {
  for (auto& [id, client] : clients_) use_plot(id, client, [](Measures& measures) { measures.see(); });
  if (steps_ > 0 && --steps_ == 0) {
    playing_ = false;
    is_changed_ = true;
  }
  line_ = playing_ ? "" : simulation_.hash_log_line();
  if (!is_running_) do_jobs();
  const std::chrono::duration<double> since = Clock::now() - measured_;
  if (since.count() < 0.5) return;
  reached_ = (simulation_.time_s() - measured_s_) / since.count();
  measured_ = Clock::now();
  measured_s_ = simulation_.time_s();
  limit_recording();
}

/// Executes the messages that have arrived, and returns true. Between two ticks, it returns false at the
/// first act (a command that changes the world), or if a viewer that drives a robot has disconnected, and
/// leaves the remaining messages for before_tick().
bool View::Impl::take_messages() {
  std::vector<Message> messages;
  std::map<std::uint64_t, bool> arrived;
  std::vector<std::uint64_t> gone;
  {
    const std::scoped_lock lock(mutex_);
    messages.swap(messages_);
    arrived.swap(arrived_);
    gone.swap(gone_);
  }
  for (const auto& [client, may_steer] : arrived) {
    clients_[client].may_steer = may_steer;
    is_changed_ = true;
    if (may_steer && !std::exchange(has_begun_, true)) play(0);
  }
  const auto changes_world = [this](std::uint64_t client) {
    return std::ranges::any_of(holders_, [client](const auto& holder) { return holder.second == client; });
  };
  std::size_t done = 0;
  while (done < messages.size() && (!clients_.contains(messages[done].client) || obey(messages[done])))
    ++done;
  if (done == messages.size() && !(is_between_ticks_ && std::ranges::any_of(gone, changes_world))) {
    for (const std::uint64_t client : gone) {
      release_all(client);
      clients_.erase(client);
    }
    return true;
  }
  const std::scoped_lock lock(mutex_);
  messages_.insert(messages_.begin(), messages.begin() + static_cast<std::ptrdiff_t>(done), messages.end());
  gone_.insert(gone_.begin(), gone.begin(), gone.end());
  return false;
}

/// Answers that a request has been obeyed. members: further members of the answer.
void View::Impl::answer(std::uint64_t client, std::uint64_t id, const Json& members) {
  Json json{{"type", "done"}, {"id", id}};
  json.update(members);
  server_->send(client, text_of(json));
}

/// Answers that a message cannot be obeyed. id: the number that the message gives itself, if any.
void View::Impl::refuse(std::uint64_t client, std::optional<std::uint64_t> id, const std::string& reason) {
  Json json{{"type", "refused"}, {"reason", reason}};
  if (id) json["id"] = *id;
  server_->send(client, text_of(json));
}

/// Executes a message and answers it. Returns false, without an answer, for an act that arrives between two
/// ticks.
bool View::Impl::obey(const Message& message) {
  const Request request(message.text);
  try {
    if (postpone(request, message.client)) return true;  // the answer follows when it is done
    if (obey_question(request, message.client)) return true;
    if (!obey_clock(request) && !obey_watch(request, clients_[message.client])) {
      Diagnostics diagnostics;
      const std::optional<Act> act = worldio::read_act(message.text, {"id"}, {}, diagnostics);
      diagnostics.throw_if_errors();
      if (is_between_ticks_) return false;
      carry_out(message.client, *act);
    }
    is_changed_ = true;
    answer(message.client, request.id());
  } catch (const ActRefused& refusal) {
    refuse(message.client, request.id(), refusal.what());
  } catch (const InputError& error) {
    refuse(message.client, request.id(), error.what());
  }
  return true;
}

/// Answers a request that changes nothing. Returns false if the request is of another sort.
bool View::Impl::obey_question(const Request& request, std::uint64_t client) {
  if (request.what() != "parameters") return false;
  try {
    answer(client, request.id(), {{"parameters", Json::parse(simulation_.parameters(request.name("type")))}});
  } catch (const std::out_of_range& error) {
    throw ActRefused(error.what());
  }
  return true;
}

/// Begins to measure the speed of the run, and the time of its next tick, from now.
void View::Impl::restart_clock() {
  due_ = measured_ = Clock::now();
  measured_s_ = simulation_.time_s();
}

/// Lets the world run, and pauses it after `ticks` ticks; 0: does not pause it.
void View::Impl::play(std::uint64_t ticks) {
  if (!playing_) restart_clock();
  playing_ = true;
  steps_ = ticks;
  line_.clear();
}

/// Obeys a request that runs or pauses the world, or limits its speed. Returns false if the request is of
/// another sort.
bool View::Impl::obey_clock(const Request& request) {
  if (request.what() == "play") {
    play(0);
  } else if (request.what() == "pause") {
    if (playing_) steps_ = 1;  // pauses after the next tick, because the hash log line is computed then
  } else if (request.what() == "step") {
    const std::uint64_t ticks = request.has("ticks") ? request.whole("ticks", 1, k_most_steps) : 1;
    play(steps_ + ticks);  // in addition to the ticks that remain of an earlier request
  } else if (request.what() == "until") {
    const double time_s = request.number("time_s", 0, engine::k_most_seconds);
    const std::uint64_t end = engine::ticks_until(time_s, simulation_.tick_s());
    if (end <= simulation_.tick())
      throw ActRefused(
          fmt::format("\"time_s\" is {:.10g} s, but the world is already at {:.10g} s: give a later time",
                      time_s, simulation_.time_s()));
    play(end - simulation_.tick());
  } else if (request.what() == "rate") {
    const double rate = request.number("rate", 0, k_most_rate);
    if (rate > 0 && rate < k_least_rate)
      throw ActRefused(fmt::format("\"rate\" must be 0 (as fast as possible) or from {} to {}, found {}",
                                   k_least_rate, k_most_rate, rate));
    rate_ = rate;
    due_ = Clock::now();
  } else {
    return false;
  }
  return true;
}

/// Obeys a request that changes what a viewer sees. Returns false if the request is of another sort.
bool View::Impl::obey_watch(const Request& request, Client& client) {
  const engine::World& world = simulation_.world();
  if (request.what() == "inspect") {
    const std::string robot = request.name("robot");
    const BodyId body = robot.empty() ? BodyId() : world.find(robot);
    if (!robot.empty() && !body.valid()) throw ActRefused(fmt::format("there is no body \"{}\"", robot));
    client.inspected = body.valid() ? std::optional(body) : std::nullopt;
  } else if (request.what() == "plot") {
    const std::string measure = request.name("measure");
    try {
      client.measures = measure.empty()
                            ? nullptr
                            : std::make_unique<Measures>(simulation_, std::vector<std::string>{measure});
    } catch (const std::exception& error) {  // a measure of a plug-in or script may throw anything
      throw ActRefused(error.what());
    }
    client.plotted = measure;
    client.plot_request = request.id();
  } else if (request.what() == "color") {
    if (!request.has("component")) {
      client.color.reset();
      return true;
    }
    ColorValue color{.component = request.name("component"), .field = request.name("field"), .column = {}};
    if (request.has("column"))
      color.column = static_cast<std::uint32_t>(request.whole("column", 0, k_most_columns));
    if (!has_value(world, color))
      throw ActRefused(fmt::format("there is no field \"{}\"{} in the component \"{}\"", color.field,
                                   color.column ? fmt::format(" with a column {}", *color.column) : "",
                                   color.component));
    client.color = std::move(color);
  } else if (request.what() == "layers") {
    client.layers = request.layers("layers", layers_of(world));
  } else {
    return false;
  }
  return true;
}

/// Calls `use` with the plotted measure of a client. If the measure throws, the plot ends and the client
/// learns why: an error in a measure that a viewer has chosen must not end the run.
void View::Impl::use_plot(std::uint64_t id, Client& client, const std::function<void(Measures&)>& use) {
  if (!client.measures) return;
  try {
    use(*client.measures);
  } catch (const std::exception& error) {
    client.measures.reset();
    client.plotted.clear();
    refuse(id, client.plot_request, error.what());
  }
}

/// Postpones a request that is possible only between two ticks: its work is done when the current tick has
/// ended. If the world is paused within a tick, which is the case after an act, this tick is computed first.
/// Returns false if the request is of another sort.
bool View::Impl::postpone(const Request& request, std::uint64_t client) {
  using What = Job::What;
  Job job{.client = client, .id = request.id(), .seed = {}};
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
  if (!playing_ && !is_between_ticks_) play(1);
  return true;
}

void View::Impl::do_jobs() {
  for (const Job& job : std::exchange(jobs_, {})) {
    try {
      const std::string file = do_job(job);
      answer(job.client, job.id, file.empty() ? Json::object() : Json{{"file", file}});
    } catch (const std::exception& error) {  // the run continues even if the job failed
      refuse(job.client, job.id, error.what());
    }
    is_changed_ = true;
  }
}

/// Returns the name of the file that the job has created; empty if the job creates none.
std::string View::Impl::do_job(const Job& job) {
  switch (job.what) {
    case Job::What::restart: restart(job.seed); break;
    case Job::What::checkpoint: return save_checkpoint();
    case Job::What::record: return start_recording();
    case Job::What::stop_recording:
      if (recording_.empty())
        throw ActRefused(
            "no viewer has started a recording; a page cannot stop a recording that the command or program "
            "has started");
      stop_recording();
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
  stop_recording();  // reset() also closes a recording that the program has started
  if (seed)
    simulation_.reset(*seed);
  else
    simulation_.reset();
  begin_run(end);
}

/// Begins a new session, because the simulation has returned to tick 0. end: tick at which the previous run
/// ended.
void View::Impl::begin_run(std::uint64_t end) {
  session_->end(end);
  session_ = std::make_unique<SessionLog>(folder_, simulation_);
  holders_.clear();
  recording_.clear();
  ++runs_;
  next_tick_ = simulation_.tick();
  line_ = playing_ ? "" : simulation_.hash_log_line();
  restart_clock();
  is_changed_ = true;
  if (simulation_.seed() != std::exchange(seed_, simulation_.seed())) greet_again();
}

/// Sends the first text again to all clients, because another seed places the bodies elsewhere.
void View::Impl::greet_again() {
  const std::string greeting =
      make_greeting(worldio::live_page(simulation_.world(), simulation_.registry()).header);
  std::map<std::uint64_t, bool> clients;
  {
    const std::scoped_lock lock(mutex_);
    greeting_ = greeting;
    clients = arrived_;  // they have received the greeting before
  }
  for (const auto& [id, client] : clients_) clients[id] = client.may_steer;
  for (const auto& [id, may_steer] : clients) server_->send(id, hello_of(greeting, may_steer));
}

/// Returns the name of a file that does not exist: WORLD.WHAT.h5, else WORLD.WHAT-2.h5, and so on.
fs::path View::Impl::new_file(std::string_view what) const {
  if (file_bytes_ >= k_most_file_bytes)
    throw ActRefused(fmt::format(
        "the files that viewers requested have reached {} GB, the limit of a view: end this view, and start "
        "another one",
        k_most_file_bytes / k_bytes_gb));
  const std::string stem = fs::path(simulation_.effective_options().front().second).stem().string();
  for (int i = 1; i <= k_most_files; ++i) {
    fs::path file =
        folder_ / (i == 1 ? fmt::format("{}.{}.h5", stem, what) : fmt::format("{}.{}-{}.h5", stem, what, i));
    if (!fs::exists(file)) return file;
  }
  throw ActRefused(fmt::format(
      "the folder of the view already has the {0} files {1}.{2}.h5 to {1}.{2}-{0}.h5: move some of them to "
      "another folder",
      k_most_files, stem, what));
}

std::string View::Impl::save_checkpoint() {
  const fs::path file = new_file("checkpoint");
  simulation_.save(file);
  file_bytes_ += fs::file_size(file);
  return file.filename().string();
}

std::string View::Impl::start_recording() {
  if (!recording_.empty()) throw ActRefused("the run is being recorded already: stop this recording first");
  const fs::path file = new_file("recording");
  simulation_.record(file);
  recording_ = file;
  return file.filename().string();
}

/// Ends the recording that a viewer has started. Does nothing without one.
void View::Impl::stop_recording() {
  if (recording_.empty()) return;
  simulation_.stop_recording();
  std::error_code ignored;
  file_bytes_ += fs::file_size(recording_, ignored);
  recording_.clear();
}

/// Ends the recording when the files of viewers have reached their limit.
void View::Impl::limit_recording() {
  if (recording_.empty()) return;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(recording_, error);
  if (error || file_bytes_ + size < k_most_file_bytes) return;
  if (report_)
    report_(fmt::format("{}: the recording ends, because the files that viewers requested have reached {} GB",
                        recording_.string(), k_most_file_bytes / k_bytes_gb));
  stop_recording();
}

/// Applies an act (a command that changes the world) of a viewer and adds the act to the session. Throws
/// ActRefused if the act is impossible, or if it takes or releases control of a robot that another viewer
/// drives.
void View::Impl::carry_out(std::uint64_t client, const Act& act) {
  const bool is_hold = act.kind == Act::Kind::hold || act.kind == Act::Kind::release;
  if (const auto holder = holders_.find(act.whom);
      is_hold && holder != holders_.end() && holder->second != client)
    throw ActRefused(
        fmt::format("another viewer drives \"{}\": wait until that viewer releases the robot", act.whom));
  simulation_.act(act);
  session_->add(simulation_, act);
  if (act.kind == Act::Kind::hold) holders_[act.whom] = client;
  if (act.kind == Act::Kind::release) holders_.erase(act.whom);
}

/// Releases the robots that a disconnected viewer held, as acts of the session.
void View::Impl::release_all(std::uint64_t client) {
  std::erase_if(holders_, [&](const auto& holder) {
    if (holder.second != client) return false;
    const Act act{.kind = Act::Kind::release, .whom = holder.first};
    try {
      simulation_.act(act);
      session_->add(simulation_, act);
    } catch (const ActRefused&) {  // ignored: the robot has left the world, which released it
    }
    return true;
  });
}

/// Returns the part of the state that every client receives.
Json View::Impl::state() const {
  return {{"tick", simulation_.tick()},
          {"time_s", simulation_.time_s()},
          {"playing", playing_},
          {"rate", rate_},
          {"reached", playing_ ? std::round(reached_ * 100) / 100 : 0},
          {"robots", simulation_.robots()},
          {"viewers", clients_.size()},
          {"run", runs_},
          {"session", session_->file().filename().string()},
          {"recording", recording_.filename().string()},
          {"line", playing_ ? "" : line_}};
}

/// Returns the part of the state that only this client receives.
Json View::Impl::own_state(std::uint64_t id, Client& client) {
  Json json = Json::object();
  if (client.inspected) json["inspected"] = inspection(simulation_, *client.inspected);
  use_plot(id, client, [&](Measures& measures) {
    json["plot"] = {{"measure", client.plotted},
                    {"column", std::string(measures.columns().front())},
                    {"value", measures.values().front()}};
  });
  if (client.color && client.color->least <= client.color->most)
    json["shades"] = {{"least", client.color->least}, {"most", client.color->most}};
  if (!client.layers.empty()) json["lines"] = lines_of(simulation_.world(), client.layers);
  return json;
}

void View::Impl::publish() {
  if (clients_.empty()) {
    is_changed_ = false;
    return;
  }
  const auto now = Clock::now();
  if (now - published_ < k_picture) return;
  std::shared_ptr<Picture> picture;
  {
    const std::scoped_lock lock(mutex_);
    for (const std::shared_ptr<Picture>& spare : spare_)
      if (spare.use_count() == 1) picture = spare;
  }
  if (!picture) return;  // the server still uses all pictures; before_tick() tries again
  picture->number = ++pictures_;
  take(simulation_.world(), order_, has_colors_, shown_parts_, *picture);
  picture->state = members_of(state());
  picture->own.clear();
  picture->shades.clear();
  for (auto& [id, client] : clients_) {
    if (client.color)
      take_shades(simulation_.world(), places_, order_.size(), *client.color, picture->shades[id]);
    if (const Json own = own_state(id, client); !own.empty()) picture->own[id] = members_of(own);
  }
  // Pictures that are a little late must not delay the later ones: the mean rate is that of k_picture.
  published_ = now - published_ < 2 * k_picture ? published_ + k_picture : now;
  is_changed_ = false;
  {
    const std::scoped_lock lock(mutex_);
    newest_ = picture;
  }
  server_->offer();
}

// ---- the public face

View::View(Simulation& simulation, const Options& options)
    : impl_(std::make_unique<Impl>(simulation, options)) {}
View::View(Simulation& simulation) : View(simulation, Options()) {}
View::~View() = default;

std::string View::address() const { return impl_->address(); }
std::string View::look_address() const { return impl_->look_address(); }
fs::path View::session() const { return impl_->session(); }
void View::run() { impl_->run(); }

}  // namespace troupe::live
