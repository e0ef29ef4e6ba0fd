#pragma once

#include "base/color.hpp"
#include "engine/world_spec.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// The opaque colour of an X11 name: "red", "DarkSlateGray", "dark slate grey", "SteelBlue3", "gray30".
/// Names are case-sensitive, as in X11's list; "grey" is "gray". Empty when there is no such name.
std::optional<Color> color_by_name(std::string_view name);

/// The names without their numbered shades and second spellings, for suggestions.
std::span<const std::string_view> color_names();

/// What bodies of each type of a JSON world have where it gives no color. Robots, and whatever else carries a
/// device or can be moved, have by type the colours of Okabe and Ito, "Color Universal Design" (2008), which
/// the colour-blind can tell apart: blue, orange, green, vermilion, sky blue, purple, yellow, and again.
/// Everything else is gray30.
std::vector<Color> default_colors(std::span<const engine::TypeSpec> types);

}  // namespace troupe::worldio
