#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace troupe::apps {

/// What a viewer is sent for a picture: a text frame, then a binary one.
struct ViewFrames {
  std::string state;
  std::string poses;
};

/// What a server serves. All calls come on the server's thread.
class ViewBackend {
 public:
  virtual ~ViewBackend() = default;
  /// A viewer has shown its token. The result is the first text that it is sent.
  virtual std::string opened(std::uint64_t client, bool may_steer) = 0;
  /// A text that it sent.
  virtual void received(std::uint64_t client, bool may_steer, std::string_view text) = 0;
  virtual void closed(std::uint64_t client) = 0;
  /// The newest picture, as this client needs it; nothing where it has been sent that already.
  virtual std::optional<ViewFrames> picture(std::uint64_t client) = 0;
  /// Something was refused; the text says what.
  virtual void refused(const std::string& what) = 0;
};

/// Serves one page and its WebSocket on 127.0.0.1, on a thread of its own (docs/live.md, "Wire protocol").
class ViewServer {
 public:
  struct Options {
    std::uint16_t port = 0;  ///< 0: any that is free
    std::string page;        ///< the HTML
    std::string token;       ///< that opens everything
    std::string look_token;  ///< that opens looking
  };
  /// Listens when this returns, and accepts nothing before start(). `backend` outlives it. Throws
  /// std::runtime_error where the port cannot be had, and in builds without TROUPE_VIEW.
  ViewServer(const Options& options, ViewBackend& backend);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  /// Accepts connections, and calls the backend from a thread of its own, until stop().
  void start();
  /// Closes every connection; the backend is not called any more when this returns.
  void stop();
  std::uint16_t port() const;
  /// Sends a text, from any thread. A client that does not read is cut off when too many wait.
  void send(std::uint64_t client, std::string text);
  /// There is a new picture; from any thread.
  void offer();
  /// A client has drawn a picture: it may be sent another. On the server's thread.
  void drawn(std::uint64_t client);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace troupe::apps
