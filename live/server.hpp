#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace troupe::live {

/// The two WebSocket frames with which the server sends a picture, the state of the world after one tick
/// (live/picture.hpp): first the text frame, then the binary frame.
struct ViewFrames {
  std::string state;  ///< text frame: a JSON object
  std::string poses;  ///< binary frame: see encode() in live/picture.hpp
};

/// Receives the events of a ViewServer, which calls all functions on its own thread, one at a time. client:
/// number that identifies a connection. may_steer: true if the token of the connection grants full control,
/// false if it grants read access only.
class ViewBackend {
 public:
  virtual ~ViewBackend() = default;
  /// Called when a client has sent a valid token. Returns the first text that the server sends to the client.
  /// If 16 clients are connected already, the server disconnects the new client and does not call this
  /// function.
  virtual std::string opened(std::uint64_t client, bool may_steer) = 0;
  /// Called when a client has sent a text after its token.
  virtual void received(std::uint64_t client, bool may_steer, std::string_view text) = 0;
  /// Called when a client has disconnected, also because the server stops. No function is called for this
  /// client afterwards.
  virtual void closed(std::uint64_t client) = 0;
  /// Returns the newest picture, encoded for this client; nothing if that picture was already sent to the
  /// client, or if there is no picture yet.
  virtual std::optional<ViewFrames> picture(std::uint64_t client) = 0;
  /// Called when the server has refused a request, a connection or a message. The reason may be the Host or
  /// Origin header, the token, the size or the type of the message, or the number of connections. Not called
  /// for an HTTP request with an unknown path or method. what: a description of what was refused, such as "a
  /// binary message".
  virtual void refused(const std::string& what) = 0;
};

/// Serves one HTML page and its WebSocket, on a separate thread (docs/live.md, "Wire protocol").
class ViewServer {
 public:
  struct Options {
    std::uint16_t port = 0;  ///< TCP port; 0: any free port
    /// IP address on which the server listens. Empty: 127.0.0.1, and ::1 if the machine has it.
    std::string bind;
    /// Host names of proxies through which browsers reach the server. The server accepts only requests whose
    /// header `Host` names this machine or one of these proxies.
    std::vector<std::string> hosts;
    std::string page;        ///< HTML text of the page
    std::string token;       ///< the text that a client must send first for full control
    std::string look_token;  ///< the text that a client must send first for read-only access
  };
  /// Opens the port. Connections wait until start(). `backend` must outlive the server. Throws
  /// std::runtime_error if Options::bind is not an IP address, if the address or the port is not available,
  /// and in builds without TROUPE_VIEW.
  ViewServer(const Options& options, ViewBackend& backend);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  /// Accepts connections, and calls the backend from a thread of its own, until stop(). Call it only once: a
  /// stopped server cannot be started again.
  void start();
  /// Closes every connection and ends the thread. When stop() returns, the backend is not called any more.
  /// The destructor also stops the server.
  void stop();
  /// Host and port under which programs on this machine reach the server, as in a URL: "127.0.0.1:34567".
  std::string authority() const;
  /// Sends a text frame to a client; does nothing if the client has disconnected. May be called on any
  /// thread. If 256 texts are already queued because the client does not read them, the client is
  /// disconnected instead.
  void send(std::uint64_t client, std::string text);
  /// Announces a new picture. The server then calls ViewBackend::picture() for each client that can receive
  /// one. May be called on any thread.
  void offer();
  /// Tells the server that a client has drawn a picture. While two pictures that the server has sent to a
  /// client are not drawn yet, the server sends this client no further picture. Does nothing if the client
  /// has disconnected. Call it from functions of ViewBackend only, because it must run on the server's
  /// thread.
  void drawn(std::uint64_t client);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::live
