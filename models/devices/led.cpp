#include "models/devices/led.hpp"

#include <algorithm>

namespace troupe::models {
namespace {

using engine::DeviceBatch;
using engine::DeviceKind;
using engine::FieldType;
using engine::Record;

float kept(float part) { return part > 0 ? std::min(part, 1.0f) : 0.0f; }

void act(const DeviceBatch& batch) {
  for (std::size_t i = 0; i < batch.rows.size(); ++i) {
    const auto& command = batch.commands->as<LedCommand>(batch.slot(i));
    if (command.shows == 0) continue;
    batch.state.as<LedState>(batch.slot(i)).shown_color = {kept(command.red), kept(command.green),
                                                           kept(command.blue)};
  }
}

}  // namespace

DeviceKind led_kind() {
  DeviceKind kind{.name = "led", .text = "gives its part a colour that controllers, and brushes, change"};
  kind.params = {{
      {.name = "shows",
       .type = FieldType::numbers,
       .fallback = std::vector<double>{1, 1, 1},
       .min = 0,
       .max = 1,
       .text = "the colour with which it begins: red, green, blue, each from 0 to 1",
       .columns = 3},
  }};
  kind.prepare = [](const Record& params, const Pose&) {
    const std::vector<double>& parts = params[0].numbers();
    const std::array<float, 3> color{static_cast<float>(parts[0]), static_cast<float>(parts[1]),
                                     static_cast<float>(parts[2])};
    std::vector<engine::StateField> state = engine::memory_fields<LedState>();
    state.front().look = true;
    return DeviceKind::Prepared{.data = color,
                                .percepts = std::move(state),
                                .percept_bytes = sizeof(LedState),
                                .commands = engine::memory_fields<LedCommand>(),
                                .command_bytes = sizeof(LedCommand)};
  };
  kind.start = [](const std::any& data, engine::StateTable& state, std::size_t slot) {
    state.as<LedState>(slot).shown_color = *std::any_cast<std::array<float, 3>>(&data);
  };
  kind.act = act;
  kind.shows_color = true;
  return kind;
}

}  // namespace troupe::models
