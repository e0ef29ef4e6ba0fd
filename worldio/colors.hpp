#pragma once

#include "base/color.hpp"
#include "engine/spec/world_spec.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Default colour, dark grey, of floor plans (bodies that consist of walls) and of body types that cannot
/// move, sense or be moved, such as walls: see default_colors().
inline constexpr Color k_wall_color{0.3f, 0.3f, 0.3f, 1};

/// Returns the opaque colour of an X11 colour name, such as "red", "DarkSlateGray", "dark slate grey",
/// "SteelBlue3" or "gray30". Names are case-sensitive: "Red" is unknown. In a name with blanks, however, each
/// word may begin with an upper-case or a lower-case letter. The spellings "grey" and "gray" mean the same.
/// Returns nothing for an unknown name.
std::optional<Color> color_by_name(std::string_view name);

/// Returns the names of all colours, without numbered shades ("SteelBlue3") and without alternative
/// spellings. The names are sorted by their bytes: names that begin with an upper-case letter come first.
/// Error messages suggest these names.
std::span<const std::string_view> color_names();

/// Returns the default colours of the types of a JSON world, one per type. A type describes bodies of the
/// same construction. Types that have a drive, a device, a controller, or a part that can be pushed or
/// gripped get a colour of the colour-blind-safe palette of Okabe and Ito, "Color Universal Design" (2008).
/// The first of these types is blue, the next ones are orange, green, vermilion, sky blue, purple and yellow.
/// The eighth is blue again, and so on. Each of the other types, such as a wall, gets k_wall_color.
std::vector<Color> default_colors(std::span<const engine::TypeSpec> types);

}  // namespace troupe::worldio
