#include "engine/sensing/shown_color.hpp"

namespace troupe::engine {

const BodyType::Device* color_device(const BodyType& type, std::uint32_t part) {
  for (const BodyType::Device& device : type.devices)
    if (device.part == part && device.kind->shows_color) return &device;
  return nullptr;
}

std::optional<Color> shown_color(const CommittedView& view, Row row, std::uint32_t part) {
  const BodyType::Device* device = color_device(view.type(row), part);
  if (device == nullptr) return {};
  const std::span<const float> parts = view.percepts(*device).cell<float>(view.slot(row), 0);
  return Color{parts[0], parts[1], parts[2], 1};
}

}  // namespace troupe::engine
