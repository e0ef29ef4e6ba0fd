#pragma once

#include "base/color.hpp"
#include "engine/sensing/sensing_view.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace troupe::engine {

/// Name of the field in which a device stores the colour that it gives to the part on which it is mounted.
/// The field belongs to the state of devices whose kind sets DeviceKind::shows_color. Blob finders, cameras,
/// pictures and sensors of the ground's colour see this colour in place of the colour of the part in the
/// world file. Code that reads recordings finds the field by this name.
inline constexpr std::string_view k_shown_color = "shown_color";

/// The device that sets the colour of a part (DeviceKind::shows_color): the first such device of the type.
/// Null if there is none. `part` is an index into TypeSpec::parts.
const BodyType::Device* color_device(const BodyType& type, std::uint32_t part);

/// The colour that a device (color_device()) now gives to a part of a body. It is always opaque. Returns
/// std::nullopt if no device sets the colour of the part. The body must be in the world.
///
/// row: index of the body in the state tables
/// part: index into TypeSpec::parts
std::optional<Color> shown_color(const CommittedView& view, Row row, std::uint32_t part);

}  // namespace troupe::engine
