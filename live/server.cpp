// This is the only file that includes Boost.Beast.

#include "live/server.hpp"
#include "base/diagnostics.hpp"
#include "live/host_name.hpp"
#include "partition/job_thread.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace troupe::live {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;

constexpr std::size_t k_most_connections = 128;  // without a token; a further connection replaces the oldest
constexpr std::size_t k_most_clients = 16;       // connections with a token
constexpr std::size_t k_most_header = 8192;      // bytes of a request
constexpr std::size_t k_most_message = 65536;    // bytes of a text from a client
constexpr std::size_t k_most_waiting = 256;      // texts queued for a client
constexpr int k_most_in_flight = 2;  // pictures that were sent to a client and that it has not drawn yet
constexpr std::chrono::seconds k_handshake{5};  // time from the connection until the token must arrive
constexpr std::chrono::seconds k_response{60};  // time to send the page, about 600 kB, over a slow link
constexpr std::chrono::milliseconds k_accept_again{
    100};  // time until accept() is called again after an error
constexpr std::chrono::seconds k_idle{
    30};  // a client from which no frame, not even ping or pong, arrives for this time is disconnected
constexpr std::size_t k_slowest = 8000;  // bytes/s: a slower link may be too slow for the frame that is sent

/// Returns the timeouts of a WebSocket while a frame of this size is being sent. No ping can be sent before
/// the end of the frame, so that the client may be silent meanwhile. Beast sends a ping after half of the
/// idle time, and closes the connection if no answer arrives in the other half.
websocket::stream_base::timeout timeouts_of(std::size_t bytes) {
  return {k_handshake, k_idle + std::chrono::seconds(2 * bytes / k_slowest), true};
}

/// Closes a socket in programs that this process starts. Asio 1.74 does not set this flag.
template <class Socket>
void close_on_exec(Socket& socket) {
  static_cast<void>(::fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC));
}

/// Returns the Content-Security-Policy header of the page, which allows the page to connect only to its own
/// server, or to the proxy in front of it. host: the Host header of the request, which must satisfy
/// Impl::is_allowed().
std::string policy(std::string_view host, bool is_proxy) {
  // The header has no syntax for IPv6 addresses. 'self' includes WebSockets, but not in browsers before 2022.
  const std::string server = host.starts_with('[') ? "'self'"
                             : is_proxy            ? fmt::format("ws://{0} wss://{0}", host)
                                                   : fmt::format("ws://{}", host);
  return fmt::format(
      "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
      "connect-src {}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
      server);
}

/// Returns an IP address as it is written in a URL.
std::string url_text(const asio::ip::address& address) {
  return address.is_v6() ? fmt::format("[{}]", address.to_string()) : address.to_string();
}

/// Compares two tokens in a time that does not depend on the characters, so that timing does not reveal how
/// many of them match.
bool same_token(std::string_view a, std::string_view b) {
  unsigned differs = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    differs |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return differs == 0;
}

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

}  // namespace

struct ViewServer::Impl {
  class Connection;
  /// A port on which the server accepts connections.
  struct Listener {
    explicit Listener(asio::io_context& context) : acceptor(context), accept_again(context) {}
    tcp::acceptor acceptor;
    asio::steady_timer accept_again;  // runs after accept() has failed
  };

  Options options;
  ViewBackend& backend;
  asio::io_context context{1};
  std::vector<std::unique_ptr<Listener>> listeners;
  std::map<std::uint64_t, std::shared_ptr<Connection>> connections;  // by client, the oldest first
  std::uint64_t last_client = 0;
  std::size_t clients = 0;             // connections that have sent a valid token
  std::function<void()> on_no_client;  // called once, when the last client is gone; null: not wanted
  std::thread thread;

  Impl(const Options& given, ViewBackend& to) : options(given), backend(to) {
    for (std::string& host : options.hosts)
      if (const std::string given_host = std::exchange(host, host_name(host)); host.empty())
        throw std::invalid_argument(
            fmt::format("--allow-host \"{}\": error: expected a host name, such as example.org (in C++ and "
                        "Python: hosts)",
                        given_host));
  }
  void listen(const asio::ip::address& address, std::uint16_t port);
  void accept(Listener& listener);
  void accept_later(Listener& listener);
  void run();
  void begin_again(const std::exception& error);
  void close_connections();
  void change_capacity();
  void say_goodbye(const std::string& reason);
  /// Whether a Host header names this machine: as a loopback name, as the address that the client has
  /// connected to, or with a name that Options::hosts lists. No other name is accepted, because another site
  /// can make its own host name refer to the address of this machine (DNS rebinding).
  bool is_allowed(std::string_view host, const tcp::socket& socket) const;
  /// Whether a Host header names a proxy, which may serve the page with TLS.
  bool is_proxy(std::string_view host) const {
    return std::ranges::find(options.hosts, host_name(host)) != options.hosts.end();
  }
};

/// A connection to a browser or program. It begins with an HTTP request, which may be upgraded to a
/// WebSocket.
class ViewServer::Impl::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Impl& server, std::uint64_t id, tcp::socket socket)
      : server_(server), id_(id), socket_(std::move(socket)), timer_(server.context) {}

  void begin() {
    close_after(k_handshake);  // unless the token arrives, or the page is sent
    read_request();
  }

  bool is_client() const { return is_client_; }

  void send(std::string text) {
    if (!is_client_ || is_closed_) return;
    if (texts_.size() >= k_most_waiting) return close();
    texts_.push_back(std::move(text));
    write();
  }
  void drawn() {
    in_flight_ = std::max(0, in_flight_ - 1);
    write();
  }

  /// Starts writing the next frame, if there is one, unless a write is in progress. Queued texts come before
  /// the next picture.
  void write() {
    if (is_writing_ || is_closing_ || is_closed_ || !is_client_) return;
    if (texts_.empty() && in_flight_ < k_most_in_flight) {
      if (std::optional<ViewFrames> frames = server_.backend.picture(id_)) {
        ++in_flight_;
        texts_.push_back(std::move(frames->state));
        poses_ = std::move(frames->poses);
      }
    }
    if (!texts_.empty()) {
      outgoing_ = std::move(texts_.front());
      texts_.pop_front();
      write_frame(true);
    } else if (!poses_.empty()) {
      outgoing_ = std::exchange(poses_, {});
      write_frame(false);
    }
  }

  void close() {
    if (std::exchange(is_closed_, true)) return;
    const auto self = shared_from_this();
    error_code ignored;
    timer_.cancel();
    tcp::socket& socket = socket_ws_ ? socket_ws_->next_layer() : socket_;
    socket.shutdown(tcp::socket::shutdown_both, ignored);
    socket.close(ignored);
    if (is_client_) {
      --server_.clients;
      server_.backend.closed(id_);
      if (server_.clients == 0 && server_.on_no_client) std::exchange(server_.on_no_client, nullptr)();
    }
    server_.connections.erase(id_);
  }

  /// Closes the WebSocket with a code and a reason of at most 123 bytes, which the client can show.
  void close_with(websocket::close_code code, const std::string& reason) {
    if (std::exchange(is_closing_, true)) return;
    socket_ws_->async_close(websocket::close_reason(code, reason),
                            [self = shared_from_this()](error_code) { self->close(); });
  }

 private:
  /// Closes the connection after this time, unless the client has sent its token before. Replaces the time of
  /// an earlier call.
  void close_after(std::chrono::seconds time) {
    timer_.expires_after(time);
    timer_.async_wait([self = shared_from_this()](error_code error) {
      if (!error && !self->is_client_) self->close();
    });
  }

  // Neither compression (false) nor beast::tcp_stream, whose timeouts are not needed: with them, this file
  // takes half as long again to compile.
  using WebSocket = websocket::stream<tcp::socket, false>;

  void read_request() {
    parser_.emplace();
    parser_->header_limit(k_most_header);
    parser_->body_limit(0);
    http::async_read(socket_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      // A body, such as that of a POST request, is not read. The parser has the header by then.
      if (error && error != http::error::body_limit) return self->close();
      self->answer(self->parser_->get());
    });
  }

  void answer(const http::request<http::empty_body>& request) {
    host_ = view_of(request[http::field::host]);
    if (!server_.is_allowed(host_, socket_)) {
      server_.backend.refused(
          "a request whose Host header names neither this machine nor a host given with --allow-host");
      return respond(
          http::status::forbidden,
          "The Host header of this request names neither this machine nor a host given with --allow-host (in "
          "Python: hosts): to allow this host, give it with this option.\n");
    }
    if (websocket::is_upgrade(request)) {
      const std::string_view origin = view_of(request[http::field::origin]);
      if (!origin.empty() && origin != "http://" + host_ &&
          !(server_.is_proxy(host_) && origin == "https://" + host_)) {
        server_.backend.refused("a WebSocket opened by a page of another origin");
        return respond(
            http::status::forbidden,
            "The Origin header of this request names another site: connect from the page that this program "
            "serves.\n");
      }
      if (request.target() != "/live")
        return respond(http::status::not_found, "Unknown path: the WebSocket is at /live.\n");
      return upgrade(request);
    }
    if (request.method() != http::verb::get)
      return respond(http::status::method_not_allowed, "Only GET is supported.\n");
    if (request.target() != "/")
      return respond(http::status::not_found, "Unknown path: the only page is /.\n");
    respond(http::status::ok, server_.options.page, "text/html; charset=utf-8");
  }

  void respond(http::status status, std::string body, const char* type = "text/plain") {
    response_.emplace(status, 11);
    response_->set(http::field::content_type, type);
    response_->set(http::field::cache_control, "no-store");
    response_->set(http::field::connection, "close");
    if (status == http::status::method_not_allowed) response_->set(http::field::allow, "GET");
    if (status == http::status::ok)
      response_->set("Content-Security-Policy", policy(host_, server_.is_proxy(host_)));
    response_->set("Referrer-Policy", "no-referrer");
    response_->set("X-Content-Type-Options", "nosniff");
    response_->body() = std::move(body);
    response_->prepare_payload();
    close_after(k_response);
    http::async_write(socket_, *response_,
                      [self = shared_from_this()](error_code, std::size_t) { self->close(); });
  }

  void upgrade(const http::request<http::empty_body>& request) {
    socket_ws_.emplace(std::move(socket_));
    socket_ws_->set_option(timeouts_of(0));
    socket_ws_->read_message_max(k_most_message);
    // Each message is one frame, so that programs that read messages are simple.
    socket_ws_->auto_fragment(false);
    socket_ws_->async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return self->close();
      self->read();
    });
  }

  void read() {
    incoming_.clear();
    socket_ws_->async_read(incoming_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error == websocket::error::message_too_big)
        self->server_.backend.refused("a message longer than 64 kB");
      if (error || self->is_closed_) return self->close();
      if (!self->socket_ws_->got_text()) {
        self->server_.backend.refused("a binary message");
        return self->close();
      }
      self->take(beast::buffers_to_string(self->incoming_.data()));
      if (!self->is_closed_ && !self->is_closing_) self->read();
    });
  }

  void take(const std::string& text) {
    if (is_client_) return server_.backend.received(id_, may_steer_, text);
    may_steer_ = same_token(text, server_.options.token);
    if (!may_steer_ && !same_token(text, server_.options.look_token)) {
      server_.backend.refused("a WebSocket without a valid token");
      return close();
    }
    if (server_.clients >= k_most_clients) {
      server_.backend.refused(
          fmt::format("a viewer, because at most {} viewers can be connected", k_most_clients));
      return close_with(websocket::close_code::try_again_later,
                        fmt::format("{} viewers are connected, the most that are allowed: close another page "
                                    "of this view, then load this page again",
                                    k_most_clients));
    }
    is_client_ = true;
    ++server_.clients;
    timer_.cancel();
    texts_.push_back(server_.backend.opened(id_, may_steer_));
    write();
  }

  void write_frame(bool is_text) {
    is_writing_ = true;
    socket_ws_->text(is_text);
    socket_ws_->set_option(timeouts_of(outgoing_.size()));
    socket_ws_->async_write(asio::buffer(outgoing_),
                            [self = shared_from_this()](error_code error, std::size_t) {
                              self->is_writing_ = false;
                              self->socket_ws_->set_option(timeouts_of(0));
                              if (error || self->is_closed_) return self->close();
                              self->write();
                            });
  }

  Impl& server_;
  std::uint64_t id_;
  tcp::socket socket_;
  std::optional<WebSocket> socket_ws_;
  asio::steady_timer timer_;
  beast::flat_buffer buffer_;
  beast::flat_buffer incoming_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<http::response<http::string_body>> response_;
  std::string host_;
  std::deque<std::string> texts_;  // queued texts, sent before the poses
  std::string poses_;              // queued frame of poses; empty: none
  std::string outgoing_;
  bool is_writing_ = false;
  bool is_client_ = false;  // has sent a valid token
  bool may_steer_ = false;
  bool is_closing_ = false;  // the close frame is being sent
  bool is_closed_ = false;
  int in_flight_ = 0;
};

void ViewServer::Impl::change_capacity() {
  const std::size_t strangers = connections.size() - clients;
  if (strangers < k_most_connections) return;
  const auto oldest =
      std::ranges::find_if(connections, [](const auto& each) { return !each.second->is_client(); });
  const std::shared_ptr<Connection> connection = oldest->second;
  backend.refused(fmt::format("more than {} connections without a token", k_most_connections));
  connection->close();
}

bool ViewServer::Impl::is_allowed(std::string_view host, const tcp::socket& socket) const {
  const std::string name = host_name(host);
  if (name == "127.0.0.1" || name == "localhost" || name == "[::1]" || is_proxy(host)) return true;
  error_code error;
  const tcp::endpoint own = socket.local_endpoint(error);
  return !error && name == url_text(own.address());
}

void ViewServer::Impl::accept(Listener& listener) {
  listener.acceptor.async_accept([this, &listener](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) {
      backend.refused(fmt::format(
          "a connection, until the system can accept it: {}; for example, close other connections "
          "or raise the limit of open files (ulimit -n)",
          error.message()));
      return accept_later(listener);
    }
    change_capacity();
    close_on_exec(socket);
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    const auto connection = std::make_shared<Connection>(*this, ++last_client, std::move(socket));
    connections.emplace(last_client, connection);
    connection->begin();
    accept(listener);
  });
}

/// Accepts connections again after a pause. Without free file descriptors, the waiting connection stays in
/// the queue of the port, so that accept() without a pause would fail again at once, in a busy loop.
void ViewServer::Impl::accept_later(Listener& listener) {
  listener.accept_again.expires_after(k_accept_again);
  listener.accept_again.async_wait([this, &listener](error_code error) {
    if (!error) accept(listener);
  });
}

/// Serves until stop() is called. A function of the server or of the backend throws only in an emergency,
/// such as too little memory. The run must not end with its view then, so the server begins again.
void ViewServer::Impl::run() {
  while (!context.stopped()) try {
      context.run();
    } catch (const std::exception& error) {
      try {
        begin_again(error);
      } catch (const std::exception&) {  // ignored: the server accepts no further connection
      }
    }
}

/// Closes all connections and accepts new ones. error: the reason
void ViewServer::Impl::begin_again(const std::exception& error) {
  close_connections();
  for (const auto& listener : listeners) {
    listener->acceptor.cancel();
    accept_later(*listener);
  }
  backend.refused(fmt::format("all connections, until browsers load the page again, because of an error: {}",
                              exception_text(error)));
}

void ViewServer::Impl::close_connections() {
  const auto all = connections;  // a copy, because close() erases from the map
  for (const auto& [client, connection] : all) connection->close();
}

/// Listens on a port of an address. Throws boost::system::system_error if the address or the port is not
/// available.
void ViewServer::Impl::listen(const asio::ip::address& address, std::uint16_t port) {
  const tcp::endpoint here(address, port);
  auto listener = std::make_unique<Listener>(context);
  tcp::acceptor& acceptor = listener->acceptor;
  acceptor.open(here.protocol());
  close_on_exec(acceptor);
  acceptor.set_option(tcp::acceptor::reuse_address(true));
  if (address.is_v6()) acceptor.set_option(asio::ip::v6_only(true));
  acceptor.bind(here);
  acceptor.listen();
  listeners.push_back(std::move(listener));
}

ViewServer::ViewServer(const Options& options, ViewBackend& backend)
    : impl_(std::make_unique<Impl>(options, backend)) {
  error_code error;
  const asio::ip::address address =
      options.bind.empty() ? asio::ip::address_v4::loopback() : asio::ip::make_address(options.bind, error);
  if (error)
    throw std::runtime_error(
        fmt::format("--bind {}: error: expected an IP address, such as 127.0.0.1", options.bind));
  try {
    impl_->listen(address, options.port);
  } catch (const boost::system::system_error& failure) {
    throw std::runtime_error(
        fmt::format("{}:{}: error: cannot listen on this port: {}; give another --port or "
                    "--bind (in C++ and Python: port, bind)",
                    url_text(address), options.port, failure.code().message()));
  }
  if (!options.bind.empty()) return;
  try {
    impl_->listen(asio::ip::address_v6::loopback(),
                  impl_->listeners.front()->acceptor.local_endpoint().port());
  } catch (const boost::system::system_error&) {  // ignored: the machine has no IPv6, or the port is in use
  }
}

/// Closes the WebSockets of all clients with a reason, and waits until they are closed, for up to 2 s.
void ViewServer::Impl::say_goodbye(const std::string& reason) {
  constexpr std::chrono::seconds k_farewell(2);
  constexpr std::size_t k_most_reason = 123;  // RFC 6455, section 5.5
  const auto all_gone = std::make_shared<std::promise<void>>();
  std::future<void> gone = all_gone->get_future();
  asio::post(context, [this, all_gone, text = reason.substr(0, k_most_reason)] {
    on_no_client = [all_gone] { all_gone->set_value(); };
    const auto all = connections;
    for (const auto& [client, connection] : all)
      if (connection->is_client()) connection->close_with(websocket::close_code::internal_error, text);
    if (clients == 0) std::exchange(on_no_client, nullptr)();
  });
  gone.wait_for(k_farewell);
}

ViewServer::~ViewServer() { stop(); }

void ViewServer::start() {
  for (const auto& listener : impl_->listeners) impl_->accept(*listener);
  try {
    impl_->thread = std::thread([this] { impl_->run(); });
  } catch (const std::system_error& error) {
    partition::throw_no_thread(error);
  }
}

void ViewServer::stop(const std::string& reason) {
  if (!impl_->thread.joinable()) return;
  if (!reason.empty()) impl_->say_goodbye(reason);
  asio::post(impl_->context, [this] {
    impl_->context.stop();  // first: run() ends even if something below throws
    for (const auto& listener : impl_->listeners) {
      listener->acceptor.close();
      listener->accept_again.cancel();
    }
    impl_->close_connections();
  });
  impl_->thread.join();
}

std::string ViewServer::authority() const {
  const tcp::endpoint here = impl_->listeners.front()->acceptor.local_endpoint();
  asio::ip::address address = here.address();
  if (address.is_unspecified())
    address = address.is_v6() ? asio::ip::address(asio::ip::address_v6::loopback())
                              : asio::ip::address(asio::ip::address_v4::loopback());
  return fmt::format("{}:{}", url_text(address), here.port());
}

void ViewServer::send(std::uint64_t client, std::string text) {
  asio::post(impl_->context, [this, client, text = std::move(text)]() mutable {
    if (const auto found = impl_->connections.find(client); found != impl_->connections.end())
      found->second->send(std::move(text));
  });
}

void ViewServer::offer(std::function<void()> show) {
  asio::post(impl_->context, [this, show = std::move(show)] {
    show();
    const auto all = impl_->connections;
    for (const auto& [client, connection] : all) connection->write();
  });
}

void ViewServer::drawn(std::uint64_t client) {
  if (const auto found = impl_->connections.find(client); found != impl_->connections.end())
    found->second->drawn();
}

}  // namespace troupe::live
