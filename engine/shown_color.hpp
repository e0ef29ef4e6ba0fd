#pragma once

#include "base/color.hpp"
#include "engine/world.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace troupe::engine {

/// The field of a device that gives the part that carries it a colour (DeviceKind::shows_color), whatever the
/// world says: to blob finders and cameras, on the ground, and in pictures. Recordings find it by this name.
inline constexpr std::string_view k_shown_color = "shown_color";

/// The device of a part that gives it its colour; null where none does. Of several the first.
const BodyType::Device* color_device(const BodyType& type, std::uint32_t part);

/// The colour that a part of a row's body has now, where a device gives it one.
std::optional<Color> shown_color(const World& world, Row row, std::uint32_t part);

}  // namespace troupe::engine
