// This file replaces server.cpp in builds without TROUPE_VIEW.

#include "live/server.hpp"

#include <stdexcept>

namespace troupe::live {

struct ViewServer::Impl {};

ViewServer::ViewServer(const Options&, ViewBackend&) {
  throw std::runtime_error(
      "the live view is not available: Troupe was built without it; build it with the CMake option "
      "-DTROUPE_VIEW=ON");
}
ViewServer::~ViewServer() = default;
void ViewServer::start() {}
void ViewServer::stop(const std::string&) {}
std::string ViewServer::authority() const { return {}; }
// NOLINTNEXTLINE(performance-unnecessary-value-param): server.cpp keeps it
void ViewServer::send(std::uint64_t, std::string) {}
// NOLINTNEXTLINE(performance-unnecessary-value-param): as above
void ViewServer::offer(std::function<void()>) {}
void ViewServer::drawn(std::uint64_t) {}

}  // namespace troupe::live
