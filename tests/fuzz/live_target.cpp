#include "live/view.hpp"
#include "tests/fuzz/targets.hpp"
#include "troupe/simulation.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>

namespace troupe::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_world = R"({"troupe": 1, "title": "yard", "bounds_m": [[-3, -3], [3, 3]],
  "types": {"bot": {"size_m": [0.4, 0.3, 0.2], "drive": {"kind": "diff"},
    "sensors": [{"name": "eye", "kind": "ranger", "transducers": [{"range_max_m": 2, "samples": 9, "fov_deg": 180}]}],
    "devices": [{"name": "lamp", "kind": "led"}], "controller": {"kind": "wander"}}},
  "populations": [{"name": "b", "type": "bot", "count": 3, "reserve": 3, "place": {"rule": "uniform"}}]})";
constexpr std::string_view k_handshake =
    "GET /live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n";
constexpr double k_rate = 20;
constexpr int k_inputs = 64;     // after this many inputs, the files that the view has written are removed
constexpr time_t k_hang_s = 20;  // a connection that stays open and silent for this time counts as hanging

/// A small world and a View that shows it until the process ends. The View writes into a scratch folder.
class Shown {
 public:
  Shown() {
    std::string name = (fs::temp_directory_path() / "troupe-fuzz-live-XXXXXX").string();
    if (!mkdtemp(name.data())) std::abort();
    folder_ = name;
    const live::View::Options options{
        .bind = "127.0.0.1", .rate = k_rate, .folder = folder_, .is_over = [this] { return stops_.load(); }};
    try {
      view_.emplace(simulation_, options);
    } catch (const std::runtime_error&) {  // a build without TROUPE_VIEW
      return;
    }
    const std::string address = view_->address();
    const std::size_t colon = address.rfind(':');
    port_ = static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1)));
    token_ = address.substr(address.find('#') + 1);
    thread_ = std::thread([this] { view_->run(); });
  }
  ~Shown() {
    stops_ = true;
    if (thread_.joinable()) thread_.join();
    view_.reset();
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;

  bool runs() const { return thread_.joinable(); }
  std::uint16_t port() const { return port_; }
  const std::string& token() const { return token_; }
  void clean() {
    if (++inputs_ % k_inputs != 0) return;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder_, ignored)) fs::remove(entry.path(), ignored);
  }

 private:
  fs::path folder_;
  Simulation simulation_ = Simulation::from_text(k_world, "yard.json", {.threads = 1, .mortal = true});
  std::atomic<bool> stops_ = false;
  std::optional<live::View> view_;
  std::thread thread_;
  std::uint16_t port_ = 0;
  std::string token_;
  int inputs_ = 0;
};

/// The bytes of a WebSocket text frame, as a client sends it, with the mask 0.
std::string frame(std::string_view text) {
  std::string bytes = "\x81";
  if (text.size() < 126) {
    bytes += static_cast<char>(0x80 | text.size());
  } else {
    bytes += '\xfe';
    bytes += static_cast<char>(text.size() >> 8 & 255);
    bytes += static_cast<char>(text.size() & 255);
  }
  return bytes.append(4, '\0').append(text);
}

class Connection {
 public:
  explicit Connection(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval most{k_hang_s, 0};
    if (socket_ < 0 || setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof most) != 0) std::abort();
    while (::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
      if (errno != EINTR) std::abort();  // the program no longer listens; EINTR: a timer of libFuzzer
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0) return;  // the program has closed the connection
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  /// Tells the program that nothing more will be sent, and reads until the program closes the connection.
  /// Aborts the process if this takes longer than k_hang_s.
  void finish() const {
    ::shutdown(socket_, SHUT_WR);
    std::array<char, 65536> bytes{};
    for (;;) {
      const ssize_t got = ::recv(socket_, bytes.data(), bytes.size(), 0);
      if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) std::abort();  // the program hangs
      if (got <= 0) return;
    }
  }

 private:
  int socket_;
};

}  // namespace

void talk_to_view(std::string_view input) {
  static Shown shown;
  if (!shown.runs() || input.empty()) return;
  const int step = input.front() % 4;
  input.remove_prefix(1);
  const Connection connection(shown.port());
  if (step >= 1) connection.send(k_handshake);
  if (step >= 2) connection.send(frame(shown.token()));
  if (step < 3) connection.send(input);
  while (step == 3 && !input.empty()) {
    const std::size_t end = std::min(input.find('\n'), input.size());
    connection.send(frame(input.substr(0, std::min<std::size_t>(end, 65535))));
    input.remove_prefix(std::min(end + 1, input.size()));
  }
  connection.finish();
  shown.clean();
}

}  // namespace troupe::fuzz
