#include "live/connections.hpp"

#include "live/page.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <utility>

namespace troupe::live {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t k_spare = 3;  // one picture is being filled, one encoded, and one is the newest
constexpr std::size_t k_most_messages = 1024;  // messages queued for the simulation
// Of these, messages of read-only viewers, so that these viewers cannot take the place of all others.
constexpr std::ptrdiff_t k_most_looking = 256;
constexpr int k_most_depth = 64;  // levels of a message: dump() and copies of the JSON library are recursive
constexpr std::array<std::string_view, 5> k_looking{"inspect", "plot", "color", "layers",
                                                    "parameters"};  // requests of read-only viewers

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

/// Parses a message. Returns a discarded value if the text is not JSON, or is nested deeper than k_most_depth
/// levels.
Json parsed(std::string_view text) {
  bool is_too_deep = false;
  const auto check = [&](int depth, Json::parse_event_t event, const Json&) {
    const bool begins =
        event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start;
    is_too_deep = is_too_deep || (begins && depth >= k_most_depth);
    return !is_too_deep;
  };
  Json json = Json::parse(text, check, false);
  return is_too_deep ? Json(Json::value_t::discarded) : json;
}

std::string hello_of(const std::string& greeting, bool may_steer) {
  return fmt::format(R"({{"type":"hello","may_steer":{},{}}})", may_steer, greeting);
}

}  // namespace

std::string members_of(const Json& json) {
  std::string text = text_of(json);
  return text.substr(1, text.size() - 2);
}

Connections::Connections(const View::Options& options, std::size_t robots, std::string greeting)
    : report_(options.report),
      token_(make_token()),
      look_token_(make_token()),
      robots_(robots),
      greeting_(std::move(greeting)) {
  for (std::size_t i = 0; i < k_spare; ++i) spare_.push_back(std::make_shared<Picture>());
  server_ = std::make_unique<ViewServer>(ViewServer::Options{options.port, options.bind, options.hosts,
                                                             std::string(k_view_page), token_, look_token_},
                                         static_cast<ViewBackend&>(*this));
}

std::string Connections::address_of(const std::string& token) const {
  return fmt::format("http://{}/#{}", server_->authority(), token);
}

// ---- the server's thread

std::string Connections::opened(std::uint64_t client, bool may_steer) {
  sent_[client];
  std::string hello;
  {
    const std::scoped_lock lock(mutex_);
    arrivals_.opened[client] = may_steer;
    hello = hello_of(greeting_, may_steer);
  }
  wake_.notify_one();
  return hello;
}

void Connections::closed(std::uint64_t client) {
  sent_.erase(client);
  {
    const std::scoped_lock lock(mutex_);
    arrivals_.closed.push_back(client);
  }
  wake_.notify_one();
}

void Connections::refused(const std::string& what) {
  if (reported_.insert(what).second && report_) report_(fmt::format("refused: {}", what));
}

void Connections::received(std::uint64_t client, bool may_steer, std::string_view text) {
  const Json json = parsed(text);
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
  const auto id = given.get<std::uint64_t>();
  if (!may_steer && std::ranges::find(k_looking, what.get<std::string>()) == k_looking.end()) {
    refused("a command of a read-only viewer");
    return refuse(client, id, "this address is read-only");
  }
  bool is_full = false;
  {
    const std::scoped_lock lock(mutex_);
    const std::vector<Message>& waiting = arrivals_.messages;
    is_full = waiting.size() >= k_most_messages ||
              (!may_steer && std::ranges::count(waiting, false, &Message::may_steer) >= k_most_looking);
    if (!is_full) arrivals_.messages.push_back({client, may_steer, std::string(text)});
  }
  if (is_full) return refuse(client, id, "too many messages are waiting: send this one again later");
  wake_.notify_one();
}

std::optional<ViewFrames> Connections::picture(std::uint64_t client) {
  SentPicture& sent = sent_[client];
  std::shared_ptr<const Picture> newest;
  {
    const std::scoped_lock lock(mutex_);
    if (!newest_ || newest_->number == sent.number) return {};
    newest = newest_;
  }
  const auto own = newest->own.find(client);
  ViewFrames frames{
      fmt::format(R"({{"type":"state","picture":{},{}{}{}}})", newest->number, newest->state,
                  own == newest->own.end() ? "" : ",", own == newest->own.end() ? "" : own->second),
      encode(*newest, robots_, client, sent)};
  // The pointer is released under the lock, because spare_picture() reads its use count.
  const std::scoped_lock lock(mutex_);
  newest.reset();
  return frames;
}

// ---- the simulation's thread

Connections::Arrivals Connections::take() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(arrivals_, {});
}

void Connections::put_back(Arrivals rest) {
  const std::scoped_lock lock(mutex_);
  arrivals_.messages.insert(arrivals_.messages.begin(), rest.messages.begin(), rest.messages.end());
  arrivals_.closed.insert(arrivals_.closed.begin(), rest.closed.begin(), rest.closed.end());
}

void Connections::wait(std::chrono::steady_clock::time_point end) {
  std::unique_lock lock(mutex_);
  wake_.wait_until(lock, end, [this] {
    return !arrivals_.messages.empty() || !arrivals_.opened.empty() || !arrivals_.closed.empty();
  });
}

void Connections::greet_again(const std::string& greeting, std::map<std::uint64_t, bool> clients) {
  {
    const std::scoped_lock lock(mutex_);
    greeting_ = greeting;
    clients.insert(arrivals_.opened.begin(),
                   arrivals_.opened.end());  // they have received the greeting before
  }
  for (const auto& [id, may_steer] : clients) server_->send(id, hello_of(greeting, may_steer));
}

void Connections::answer(std::uint64_t client, std::uint64_t id, const Json& members) {
  Json json{{"type", "done"}, {"id", id}};
  json.update(members);
  server_->send(client, text_of(json));
}

void Connections::refuse(std::uint64_t client, std::optional<std::uint64_t> id, const std::string& reason) {
  Json json{{"type", "refused"}, {"reason", reason}};
  if (id) json["id"] = *id;
  server_->send(client, text_of(json));
}

std::shared_ptr<Picture> Connections::spare_picture() {
  const std::scoped_lock lock(mutex_);
  for (const std::shared_ptr<Picture>& spare : spare_)
    if (spare.use_count() == 1) return spare;
  return nullptr;
}

void Connections::publish(std::shared_ptr<const Picture> picture) {
  server_->offer([this, picture = std::move(picture)]() mutable {
    const std::scoped_lock lock(mutex_);
    newest_ = std::move(picture);
  });
}

}  // namespace troupe::live
