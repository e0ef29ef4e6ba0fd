#include "engine/world/activities.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace troupe::engine {

Activity Activities::enter(Activity activity) { return std::exchange(now_, activity); }

void Activities::leave(Activity before) {
  const bool has_failed = now_ == Activity::failed || now_ == Activity::failed_in_callback;
  now_ = before;
  if (has_failed) fail();
}

void Activities::fail() {
  const bool is_in_callback = now_ == Activity::callback || now_ == Activity::failed_in_callback;
  now_ = is_in_callback ? Activity::failed_in_callback : Activity::failed;
}

void Activities::refuse(Refusal why, std::string_view call) const {
  switch (why) {
    case Refusal::in_step:
      throw std::logic_error(fmt::format(
          "{} is not allowed during a step, for example in a callback of on_phase() or in a controller: call "
          "it between two steps",
          call));
    case Refusal::in_callback:
      throw std::logic_error(fmt::format(
          "{} is not allowed in a callback of before_tick(): call it outside the callback", call));
    case Refusal::in_measure:
      throw std::logic_error(
          "a measure must not change the world, for example with step(), reset() or set_poses(): measures "
          "only read");
    case Refusal::in_apply:
      throw std::logic_error(
          fmt::format("World::{} was called by a kind that does not declare that it can carry bodies: set "
                      "DeviceKind::carries to true",
                      call));
    case Refusal::none:
    case Refusal::incomplete: break;
  }
  throw std::logic_error(fmt::format(
      "tick {}: a step, a birth or a reset failed and left an incomplete state: call reset() before anything "
      "else",
      tick_));
}

}  // namespace troupe::engine
