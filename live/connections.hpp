#pragma once

#include "live/picture.hpp"
#include "live/server.hpp"
#include "live/view.hpp"

#include <nlohmann/json.hpp>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::live {

/// Returns the JSON text of an object without the outer braces, so that it can be inserted into another
/// object.
std::string members_of(const nlohmann::ordered_json& json);

/// The connections to the viewers of a view: the server, the messages that wait for the simulation, and the
/// pictures that wait for the server. The public functions are for the thread of the simulation; answer() and
/// refuse() may be called on any thread.
class Connections : private ViewBackend {
 public:
  struct Message {
    std::uint64_t client;
    bool may_steer;
    std::string text;
  };
  /// What has happened since the last call of take().
  struct Arrivals {
    std::vector<Message> messages;
    std::map<std::uint64_t, bool> opened;  ///< new clients and whether they may steer
    std::vector<std::uint64_t> closed;     ///< clients that have disconnected
  };

  /// Opens the port, but accepts no connection before start(). Throws the exceptions of ViewServer.
  ///
  /// robots: number of bodies in each picture
  /// greeting: JSON members of the first text to each client
  Connections(const View::Options& options, std::size_t robots, std::string greeting);
  void start() { server_->start(); }
  /// Ends all connections; the clients get the reason, unless it is empty.
  void stop(const std::string& reason = {}) { server_->stop(reason); }

  std::string address() const { return address_of(token_); }            ///< URL for full control
  std::string look_address() const { return address_of(look_token_); }  ///< URL for read-only access

  Arrivals take();
  /// Returns messages and closed clients to the front of the queue, for the next call of take().
  void put_back(Arrivals rest);
  /// Waits until something has arrived, but not longer than until the time `end`.
  void wait(std::chrono::steady_clock::time_point end);
  /// Replaces the greeting, and sends it again to `clients` and to the clients that take() has yet to return.
  void greet_again(const std::string& greeting, std::map<std::uint64_t, bool> clients);
  /// Answers that a request has been obeyed. members: further members of the answer.
  void answer(std::uint64_t client, std::uint64_t id,
              const nlohmann::ordered_json& members = nlohmann::ordered_json::object());
  /// Answers that a message cannot be obeyed. id: the number that the message gives itself, 0 if it gives
  /// none; not set if the message has no valid number.
  void refuse(std::uint64_t client, std::optional<std::uint64_t> id, const std::string& reason);

  /// Returns a picture to fill; null while the server uses all of them.
  std::shared_ptr<Picture> spare_picture();
  /// Sends a picture to all clients, after the answers that were given before.
  void publish(std::shared_ptr<const Picture> picture);

 private:
  // Called on the server's thread.
  std::string opened(std::uint64_t client, bool may_steer) override;
  void received(std::uint64_t client, bool may_steer, std::string_view text) override;
  void closed(std::uint64_t client) override;
  std::optional<ViewFrames> picture(std::uint64_t client) override;
  void refused(const std::string& what) override;

  std::string address_of(const std::string& token) const;

  std::function<void(const std::string&)> report_;
  std::string token_;
  std::string look_token_;
  std::size_t robots_;

  // Shared by both threads, guarded by mutex_.
  std::mutex mutex_;
  std::condition_variable wake_;
  Arrivals arrivals_;
  std::vector<std::shared_ptr<Picture>> spare_;  // all pictures; those without another owner can be filled
  std::shared_ptr<const Picture> newest_;
  std::string greeting_;

  // Used only by the server's thread.
  std::map<std::uint64_t, SentPicture> sent_;
  std::set<std::string> reported_;  // refusals that have been reported, so that each is reported once

  std::unique_ptr<ViewServer> server_;  // last, because its thread uses the members above
};

}  // namespace troupe::live
