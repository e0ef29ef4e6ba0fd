#pragma once

#include "base/color.hpp"
#include "engine/world.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace troupe::engine {

/// Name of the field in which a device sets the colour of its part (DeviceKind::shows_color). For blob
/// finders, cameras and pictures, and where robots sense the colour of the ground, this colour replaces that
/// of the world file. Recordings find the field by this name.
inline constexpr std::string_view k_shown_color = "shown_color";

/// The first device that sets the colour of a part; null if there is none.
const BodyType::Device* color_device(const BodyType& type, std::uint32_t part);

/// Present colour of a part of a row's body, if a device sets it; otherwise std::nullopt.
std::optional<Color> shown_color(const World& world, Row row, std::uint32_t part);

}  // namespace troupe::engine
