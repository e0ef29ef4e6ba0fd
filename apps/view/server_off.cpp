// This file replaces server.cpp in builds without TROUPE_VIEW.

#include "apps/view/server.hpp"

#include <stdexcept>

namespace troupe::apps {

struct ViewServer::Impl {};

ViewServer::ViewServer(const Options&, ViewBackend&) {
  throw std::runtime_error(
      "troupe view: error: this program was built without the live view: configure it with -DTROUPE_VIEW=ON");
}
ViewServer::~ViewServer() = default;
void ViewServer::start() {}
void ViewServer::stop() {}
std::uint16_t ViewServer::port() const { return 0; }
// NOLINTNEXTLINE(performance-unnecessary-value-param): server.cpp keeps it
void ViewServer::send(std::uint64_t, std::string) {}
void ViewServer::offer() {}
void ViewServer::drawn(std::uint64_t) {}

}  // namespace troupe::apps
