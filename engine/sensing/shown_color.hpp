#pragma once

#include "base/color.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace troupe::engine {

/// Name of a field of the state of a device. In this field, the device stores the colour of the part that it
/// is mounted on. Only kinds of devices with DeviceKind::shows_color set such a colour. Blob finders,
/// cameras, pictures and sensors of the ground's colour see this colour in place of the colour that the world
/// file gives the part. Code that reads recordings finds the field by this name.
inline constexpr std::string_view k_shown_color = "shown_color";

/// The first device of a type that sets the colour of the part with this index (DeviceKind::shows_color);
/// null if there is none.
const BodyType::Device* color_device(const BodyType& type, std::uint32_t part);

/// Colour, always opaque, that a device (see color_device()) now gives to a part of the body with this row
/// (index in the state tables); std::nullopt if no device sets the colour of the part. The body must be in
/// the world.
std::optional<Color> shown_color(const CommittedView& view, Row row, std::uint32_t part);

}  // namespace troupe::engine
