#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::live {

/// The two WebSocket messages that make up a picture (the state of the world at one instant, see
/// live/picture.hpp), encoded for one client. The server sends the text message first.
struct ViewFrames {
  std::string state;  ///< text message: a JSON object
  std::string poses;  ///< binary message: see encode() in live/picture.hpp
};

/// The interface through which a ViewServer reports events and asks for pictures. A client is a connection
/// (of a page or program) that has sent a valid token: one of the two secret texts in ViewServer::Options.
/// The server calls all functions on its own thread, one at a time. If a function throws, for example because
/// there is not enough memory, the server closes all connections and continues with new ones.
///
/// Arguments of the functions:
/// client: number of the client; the server uses each number only once
/// may_steer: true if the token of the client grants full control; false if it grants read access only
class ViewBackend {
 public:
  virtual ~ViewBackend() = default;
  /// Called when a connection has sent a valid token and so becomes a client. Returns the first text that the
  /// server sends to the client. If there are already 16 clients, the server closes the connection with
  /// the WebSocket code 1013 (try again later) and a reason, and does not call this function.
  virtual std::string opened(std::uint64_t client, bool may_steer) = 0;
  /// Called for each text that a client sends after its token.
  virtual void received(std::uint64_t client, bool may_steer, std::string_view text) = 0;
  /// Called when the connection of a client has ended, either because the client has disconnected or because
  /// the server has closed the connection. No function is called for this client afterwards.
  virtual void closed(std::uint64_t client) = 0;
  /// Returns the newest picture, encoded for this client. Returns nothing if there is no picture yet, or if
  /// the newest picture was already sent to this client.
  virtual std::optional<ViewFrames> picture(std::uint64_t client) = 0;
  /// Called when the server refuses something: an HTTP request because of its Host or Origin header, a
  /// connection because its token is wrong or there are too many connections, or a message because it is too
  /// long or binary. Also called when the system cannot accept a connection, for example because there is no
  /// free file descriptor; the server then tries again every 0.1 s. Not called for HTTP requests with an
  /// unknown path or method.
  ///
  /// what: what the server refused, for example "a binary message"
  virtual void refused(const std::string& what) = 0;
};

/// The server of a live view. Over HTTP, it serves one HTML page. Over a WebSocket, the page or another
/// program receives pictures of the running world and sends commands (docs/live-protocol.md). The
/// server runs on a thread of its own.
class ViewServer {
 public:
  struct Options {
    std::uint16_t port = 0;  ///< TCP port; 0: any free port
    /// IP address on which the server listens. Empty: 127.0.0.1, and ::1 if the machine has it.
    std::string bind;
    /// Host names of proxies through which browsers reach the server, such as "example.org". The server
    /// accepts a request only if its `Host` header has one of these names, "localhost" or an IP address at
    /// which this machine is reached. Upper and lower case, and ports, make no difference.
    std::vector<std::string> hosts;
    std::string page;        ///< HTML text of the page
    std::string token;       ///< the text that a client must send first for full control
    std::string look_token;  ///< the text that a client must send first for read-only access
  };
  /// Opens the port. Connections that arrive before start() get no answer until then. `backend` must outlive
  /// the server. Throws std::runtime_error if Options::bind is not an IP address, or if the address or the
  /// port is not available, and std::invalid_argument if an entry of Options::hosts is not a host name
  /// (live/host_name.hpp). If the CMake option TROUPE_VIEW is off, always throws std::runtime_error.
  ViewServer(const Options& options, ViewBackend& backend);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  /// Starts the thread of the server, which accepts connections and calls the backend until stop() is called.
  /// Call start() only once: a stopped server cannot be started again.
  void start();
  /// Closes all connections and ends the thread of the server. When stop() has returned, the backend is not
  /// called any more. The destructor calls stop().
  ///
  /// reason: if not empty, clients get it with the WebSocket code 1011; at most 123 bytes are sent. The
  /// function then waits until they have answered, for up to 2 s
  void stop(const std::string& reason = {});
  /// Host and port under which programs on this machine reach the server, as in a URL: "127.0.0.1:34567".
  std::string authority() const;
  /// Sends a text to a client. Does nothing if the client has disconnected. If 256 texts for this client are
  /// already waiting, because the client does not read them, the server disconnects the client instead. May
  /// be called on any thread.
  void send(std::uint64_t client, std::string text);
  /// Announces a new picture. After all earlier calls of send(), the thread of the server calls show(), which
  /// makes ViewBackend::picture() return the picture, and then ViewBackend::picture() for each client: at
  /// once, or as soon as all texts for this client have been sent, and the client has yet to draw at most one
  /// of the earlier pictures (see drawn()). A client thus receives a picture after the texts that were sent
  /// before it. May be called on any thread.
  void offer(std::function<void()> show);
  /// Tells the server that a client has drawn one of the pictures that were sent to it. While a client has
  /// not yet drawn two of the pictures that were sent to it, the server sends it no further picture. Does
  /// nothing if the client has disconnected. Not thread-safe: call it only from functions of ViewBackend,
  /// because the server calls these on its own thread.
  void drawn(std::uint64_t client);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::live
