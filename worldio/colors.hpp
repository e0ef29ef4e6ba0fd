#pragma once

#include "base/color.hpp"

#include <optional>
#include <span>
#include <string_view>

namespace troupe::worldio {

/// The opaque colour of an X11 name: "red", "DarkSlateGray", "dark slate grey", "SteelBlue3", "gray30".
/// Names are case-sensitive, as in X11's list; "grey" is "gray". Empty when there is no such name.
std::optional<Color> color_by_name(std::string_view name);

/// The names without their numbered shades and second spellings, for suggestions.
std::span<const std::string_view> color_names();

}  // namespace troupe::worldio
