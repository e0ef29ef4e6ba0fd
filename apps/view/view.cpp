#include "apps/view/view.hpp"

#include "apps/view_page.hpp"
#include "base/diagnostics.hpp"
#include "engine/shown_color.hpp"
#include "engine/world.hpp"
#include "troupe/acts.hpp"
#include "worldio/json/session_json.hpp"
#include "worldio/results/hdf5_file.hpp"
#include "worldio/results/replay_header.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace troupe::apps {
namespace {

using engine::Act;
using Json = nlohmann::ordered_json;

constexpr int k_wire = 1;  // version of the wire protocol
constexpr std::chrono::milliseconds k_picture{33};
constexpr std::chrono::milliseconds k_nap{50};  // longest wait, so that Ctrl-C takes effect soon
constexpr std::chrono::seconds k_most_behind{1};
constexpr std::size_t k_spare = 3;  // one picture is being filled, one encoded, and one is the newest
constexpr std::size_t k_most_messages = 1024;  // messages queued for the simulation
constexpr std::uint64_t k_most_steps = 1000000000;

/// Returns a token: 128 random bits as 32 hexadecimal digits.
std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("troupe view: error: no random numbers for a token (getrandom failed)");
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

/// Returns the names of all measures that have no required parameters, which viewers can plot.
Json plain_measures(const Simulation& simulation) {
  Json names = Json::array();
  for (const engine::MeasureKind& kind : simulation.registry().measures)
    if (std::ranges::all_of(kind.params.defaults(), &engine::Value::given)) names.push_back(kind.name);
  return names;
}

double number_in(const engine::StateField& field, const std::byte* at) {
  const auto as = [at]<class T>(T value) {
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  };
  switch (field.element) {
    case engine::Element::f64: return as(double());
    case engine::Element::f32: return as(float());
    case engine::Element::i64: return as(std::int64_t());
    case engine::Element::i32: return as(std::int32_t());
    case engine::Element::u64: return as(std::uint64_t());
    case engine::Element::u32: return as(std::uint32_t());
    case engine::Element::u8: break;
  }
  return as(std::uint8_t());
}

}  // namespace

View::View(Simulation& simulation, const Options& options, std::function<bool()> is_over)
    : simulation_(simulation),
      is_over_(std::move(is_over)),
      token_(make_token()),
      look_token_(make_token()),
      session_(options.folder, simulation),
      rate_(options.rate),
      line_(simulation.hash_log_line()) {
  const engine::World& world = simulation.world();
  worldio::LivePage page = worldio::live_page(world, simulation.registry());
  order_ = std::move(page.order);
  has_z_ = page.has_z;
  has_colors_ = std::ranges::any_of(
      world.types(), [](const engine::BodyType& type) { return engine::color_device(type, 0) != nullptr; });
  Json populations = Json::array();  // populations to which bodies can be added
  for (const engine::ReserveSpec& reserve : world.spec().reserves) populations.push_back(reserve.population);
  greeting_ = fmt::format(
      R"("wire":{},"version":{},"tick_s":{},"colors":{},"measures":{},"populations":{},"header":{})", k_wire,
      text_of(version_line()), simulation.tick_s(), has_colors_, text_of(plain_measures(simulation)),
      text_of(populations), page.header);
  for (std::size_t i = 0; i < k_spare; ++i) spare_.push_back(std::make_shared<Picture>());
  server_ = std::make_unique<ViewServer>(
      ViewServer::Options{options.port, std::string(k_view_page), token_, look_token_},
      static_cast<ViewBackend&>(*this));
  simulation_.before_tick([this](Simulation&) { before_tick(); });
  server_->start();  // not in the constructor of the server, because the functions that it calls use server_
}

View::~View() {
  server_->stop();
  simulation_.before_tick(nullptr);
}

std::string View::address_of(const std::string& token) const {
  return fmt::format("http://127.0.0.1:{}/#{}", server_->port(), token);
}

// ---- the server's thread

std::string View::opened(std::uint64_t client, bool may_steer) {
  known_[client];
  {
    const std::scoped_lock lock(mutex_);
    arrived_[client] = may_steer;
  }
  wake_.notify_one();
  return fmt::format(R"({{"type":"hello","may_steer":{},{}}})", may_steer, greeting_);
}

void View::closed(std::uint64_t client) {
  known_.erase(client);
  {
    const std::scoped_lock lock(mutex_);
    gone_.push_back(client);
  }
  wake_.notify_one();
}

void View::refused(const std::string& what) {
  if (told_.insert(what).second) fmt::print(stderr, "troupe view: refused: {}\n", what);
}

void View::received(std::uint64_t client, bool may_steer, std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  const auto what = json.is_object() ? json.value("do", Json()) : Json();
  if (!what.is_string()) {
    refused("a message without \"do\"");
    return server_->send(client, R"({"type":"refused","reason":"a message must be an object with \"do\""})");
  }
  if (what == "drawn") return server_->drawn(client);
  const auto id = json.value("id", Json());
  const std::string said = id.is_number_unsigned() ? fmt::format(R"("id":{},)", id.get<std::uint64_t>()) : "";
  if (!may_steer && what != "inspect" && what != "plot") {
    refused("an act of a read-only viewer");
    return server_->send(client,
                         fmt::format(R"({{"type":"refused",{}"reason":"this address is read-only"}})", said));
  }
  bool is_full = false;
  {
    const std::scoped_lock lock(mutex_);
    is_full = messages_.size() >= k_most_messages;
    if (!is_full) messages_.push_back({client, std::string(text)});
  }
  if (is_full)
    return server_->send(
        client, fmt::format(R"({{"type":"refused",{}"reason":"too many messages are waiting"}})", said));
  wake_.notify_one();
}

std::optional<ViewFrames> View::picture(std::uint64_t client) {
  std::shared_ptr<const Picture> newest;
  {
    const std::scoped_lock lock(mutex_);
    newest = newest_;
  }
  Known& known = known_[client];
  if (!newest || newest->number == known.number) return {};
  known.number = newest->number;
  const auto own = newest->own.find(client);
  ViewFrames frames{
      fmt::format(R"({{"type":"state","picture":{},{}{}{}}})", newest->number, newest->state,
                  own == newest->own.end() ? "" : ",", own == newest->own.end() ? "" : own->second),
      encode(*newest, order_.size(), known.poses, known.colors)};
  // The pointer is released under the lock, because publish() reads its use count.
  const std::scoped_lock lock(mutex_);
  newest.reset();
  return frames;
}

// ---- the simulation's thread

void View::run() {
  while (!is_over_() && !simulation_.stopped()) {
    simulation_.step();
    after_tick();
  }
  session_.end(simulation_);
}

/// Waits until the next tick is due, or, if the world is paused, until a viewer continues it. Meanwhile it
/// executes the messages of viewers.
void View::before_tick() {
  for (;;) {
    take_messages();
    const auto now = Clock::now();
    if (is_changed_ || (playing_ && now - published_ >= k_picture)) publish();
    if (is_over_() || (playing_ && (rate_ == 0 || now >= due_))) break;
    auto until = now + k_nap;
    if (playing_) until = std::min(until, due_);
    if (is_changed_)
      until = std::min(until, now + k_picture / 4);  // publish() found no free picture, so try again soon
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, until,
                     [this] { return !messages_.empty() || !arrived_.empty() || !gone_.empty(); });
  }
  if (rate_ > 0) {
    const auto now = Clock::now();
    const auto tick = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(simulation_.tick_s() / rate_));
    due_ = due_ + k_most_behind < now ? now + tick : due_ + tick;
  }
}

void View::after_tick() {
  for (auto& [id, client] : clients_)
    if (client.measures) client.measures->see();
  if (steps_ > 0 && --steps_ == 0) {
    playing_ = false;
    is_changed_ = true;
  }
  line_ = playing_ ? "" : simulation_.hash_log_line();
  const std::chrono::duration<double> since = Clock::now() - measured_;
  if (since.count() < 0.5) return;
  reached_ = (simulation_.time_s() - measured_s_) / since.count();
  measured_ = Clock::now();
  measured_s_ = simulation_.time_s();
}

void View::take_messages() {
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
    if (may_steer && !std::exchange(has_begun_, true)) {
      playing_ = true;
      line_.clear();
      due_ = measured_ = Clock::now();
      measured_s_ = simulation_.time_s();
    }
  }
  for (const Message& message : messages)
    if (clients_.contains(message.client)) obey(message);
  for (const std::uint64_t client : gone) {
    release_all(client);
    clients_.erase(client);
  }
}

void View::answer(std::uint64_t client, std::uint64_t id, const std::string& refusal) {
  Json json{{"type", refusal.empty() ? "done" : "refused"}, {"id", id}};
  if (!refusal.empty()) json["reason"] = refusal;
  server_->send(client, text_of(json));
}

void View::obey(const Message& message) {
  const Json json = Json::parse(message.text);
  const std::string what = json["do"];
  const Json said = json.value("id", Json());
  const std::uint64_t id = said.is_number_unsigned() ? said.get<std::uint64_t>() : 0;
  Client& client = clients_[message.client];
  try {
    const auto number = [&](const char* key, double least, double most) {
      const Json value = json.value(key, Json());
      if (!value.is_number() || !(value.get<double>() >= least && value.get<double>() <= most))
        throw ActRefused(fmt::format("\"{}\" must be a number from {:g} to {:g}", key, least, most));
      return value.get<double>();
    };
    const auto name = [&](const char* key) {
      const Json value = json.value(key, Json());
      if (value.is_null()) return std::string();
      if (!value.is_string()) throw ActRefused(fmt::format("\"{}\" must be a name", key));
      return value.get<std::string>();
    };
    if (what == "play") {
      if (!playing_) due_ = measured_ = Clock::now();
      if (!playing_) measured_s_ = simulation_.time_s();
      playing_ = true;
      steps_ = 0;
      line_.clear();
    } else if (what == "pause") {
      if (playing_) steps_ = 1;  // pauses after the next tick, because the hash log line is computed then
    } else if (what == "step") {
      steps_ = json.contains("ticks")
                   ? static_cast<std::uint64_t>(number("ticks", 1, static_cast<double>(k_most_steps)))
                   : 1;
      if (!playing_) due_ = Clock::now();
      playing_ = true;
    } else if (what == "rate") {
      const double rate = number("rate", 0, k_most_rate);
      if (rate > 0 && rate < k_least_rate)
        throw ActRefused(fmt::format("\"rate\" must be 0 (as fast as possible) or from {:g} to {:g}",
                                     k_least_rate, k_most_rate));
      rate_ = rate;
      due_ = Clock::now();
    } else if (what == "inspect") {
      const std::string robot = name("robot");
      const BodyId body = robot.empty() ? BodyId() : simulation_.world().find(robot);
      if (!robot.empty() && !body.valid()) throw ActRefused(fmt::format("there is no body \"{}\"", robot));
      client.inspected = body.valid() ? std::optional(body) : std::nullopt;
    } else if (what == "plot") {
      const std::string measure = name("measure");
      try {
        client.measures = measure.empty()
                              ? nullptr
                              : std::make_unique<Measures>(simulation_, std::vector<std::string>{measure});
        client.plotted = measure;
      } catch (const InputError& error) {
        throw ActRefused(error.what());
      }
    } else {
      Diagnostics diagnostics;
      const std::optional<Act> act = worldio::read_act(message.text, {"id"}, {}, diagnostics);
      try {
        diagnostics.throw_if_errors();
      } catch (const InputError& error) {
        throw ActRefused(error.what());
      }
      carry_out(message.client, *act);
    }
    is_changed_ = true;
    answer(message.client, id);
  } catch (const ActRefused& refusal) {
    answer(message.client, id, refusal.what());
  }
}

/// Applies an act of a viewer and adds it to the session. Throws ActRefused if it is impossible, or if
/// another viewer holds the robot.
void View::carry_out(std::uint64_t client, const Act& act) {
  const bool is_hold = act.kind == Act::Kind::hold || act.kind == Act::Kind::release;
  if (const auto holder = holders_.find(act.whom);
      is_hold && holder != holders_.end() && holder->second != client)
    throw ActRefused(fmt::format("another viewer drives \"{}\"", act.whom));
  simulation_.act(act);
  session_.add(simulation_, act);
  if (act.kind == Act::Kind::hold) holders_[act.whom] = client;
  if (act.kind == Act::Kind::release) holders_.erase(act.whom);
}

/// Releases the robots that a disconnected viewer held, as acts of the session.
void View::release_all(std::uint64_t client) {
  std::erase_if(holders_, [&](const auto& holder) {
    if (holder.second != client) return false;
    const Act act{.kind = Act::Kind::release, .whom = holder.first};
    try {
      simulation_.act(act);
      session_.add(simulation_, act);
    } catch (const ActRefused&) {  // ignored: the robot has left the world, which released it
    }
    return true;
  });
}

std::string View::state_members() const {
  return members_of({{"tick", simulation_.tick()},
                     {"time_s", simulation_.time_s()},
                     {"playing", playing_},
                     {"rate", rate_},
                     {"reached", playing_ ? std::round(reached_ * 100) / 100 : 0},
                     {"robots", simulation_.robots()},
                     {"viewers", clients_.size()},
                     {"line", playing_ ? "" : line_}});
}

std::string View::inspection(BodyId id) {
  const engine::World& world = simulation_.world();
  Model model = simulation_.model(id);
  const Row row = world.row(id);
  Json json{{"robot", model.name()}, {"alive", model.is_alive()}, {"components", Json::array()}};
  if (!row.valid()) return members_of({{"inspected", json}});
  const Pose pose = world.pose(id);
  json["pose"] = {pose.x, pose.y, pose.z, pose.heading};
  for (const engine::StateTable& table : world.tables()) {
    const std::size_t at = table.rows() == world.rows() ? row.index() : world.slot(row);
    if (at >= table.rows() || table.ids()[at] != id || table.component() == "pose") continue;
    Json fields = Json::array();
    for (std::size_t f = 0; f < table.fields().size(); ++f) {
      const engine::StateField& field = table.fields()[f];
      Json values = Json::array();
      const std::byte* cell = table.cell<std::byte>(at, f).data();
      constexpr std::uint32_t k_most_values = 2048;  // the many numbers of a camera image are of no use here
      for (std::uint32_t c = 0; c < std::min(field.columns, k_most_values); ++c)
        values.push_back(number_in(field, cell + c * engine::element_size(field.element)));
      fields.push_back(
          {{"name", field.name}, {"unit", field.unit}, {"text", field.text}, {"values", values}});
    }
    json["components"].push_back({{"name", table.component()}, {"fields", std::move(fields)}});
  }
  json["eyes"] = Json::object();
  std::map<std::string, int>
      met;  // number of devices with each name; repeated names get suffixes, as in the header of the page
  for (const engine::BodyType::Device& device : world.type(row).devices) {
    std::string name = worldio::hdf5_name(device.name);
    if (const int n = ++met[name]; n > 1) name += fmt::format("~{}", n);
    if (device.prepared.transducers.empty() || !world.senses(row, device)) continue;
    json["eyes"][name] = world.percepts(device).cell<float>(world.slot(row), 0);
  }
  return members_of({{"inspected", json}});
}

std::string View::own_members(Client& client) {
  std::string members;
  if (client.inspected) members = inspection(*client.inspected);
  if (client.measures) {
    const std::vector<double> values = client.measures->values();
    members += (members.empty() ? "" : ",") +
               members_of({{"plot",
                            {{"measure", client.plotted},
                             {"column", std::string(client.measures->columns().front())},
                             {"value", values.front()}}}});
  }
  return members;
}

void View::publish() {
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
  take(simulation_.world(), order_, has_z_, has_colors_, *picture);
  picture->state = state_members();
  picture->own.clear();
  for (auto& [id, client] : clients_)
    if (std::string members = own_members(client); !members.empty()) picture->own[id] = std::move(members);
  published_ = now;
  is_changed_ = false;
  {
    const std::scoped_lock lock(mutex_);
    newest_ = picture;
  }
  server_->offer();
}

}  // namespace troupe::apps
