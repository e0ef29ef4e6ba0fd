#include "models/devices/led.hpp"

#include "engine/kinds/make_device_kind.hpp"

#include <algorithm>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;

float kept(float part) { return part > 0 ? std::min(part, 1.0f) : 0.0f; }

struct Led {
  struct Params {
    std::array<float, 3> shows{1, 1, 1};

    static constexpr void describe(engine::Description<Params>& d) {
      d.member<&Params::shows>("shows", engine::facts::within(0, 1),
                               "colour at the start: red, green, blue, each from 0 to 1");
    }
  };
  using State = LedState;
  using Command = LedCommand;
  static constexpr bool shows_color = true;

  Params params;

  void start(State& row) const { row.shown_color = params.shows; }

  void act(const DeviceBatch& batch) const {
    for (std::size_t i = 0; i < batch.rows.size(); ++i) {
      const auto& command = batch.commands->as<Command>(batch.slot(i));
      if (command.shows == 0) continue;
      batch.state.as<State>(batch.slot(i)).shown_color = {kept(command.red), kept(command.green),
                                                          kept(command.blue)};
    }
  }
};

}  // namespace

DeviceKind led_kind() {
  return engine::make_device_kind<Led>(
      "led", "gives the part that carries it a colour, which controllers and brushes can change");
}

}  // namespace troupe::models
