#pragma once

#include "base/color.hpp"
#include "engine/spec/world_spec.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace troupe::worldio {

/// Default colour of walls, dark grey: of floor plans (bodies that consist of walls), and of the types that
/// default_colors() treats as walls.
inline constexpr Color k_wall_color{0.3f, 0.3f, 0.3f, 1};

/// Returns the opaque colour of an X11 colour name, such as "red", "DarkSlateGray", "dark slate grey",
/// "SteelBlue3" or "gray30". Names are case-sensitive: "Red" is unknown. There is one exception: in a name
/// with blanks, each word may begin with an upper-case or a lower-case letter. The spellings "grey" and
/// "gray" mean the same. Returns nothing for an unknown name.
std::optional<Color> color_by_name(std::string_view name);

/// Returns the names of all colours, without numbered shades ("SteelBlue3") and without alternative
/// spellings. The names are sorted by their bytes: names that begin with an upper-case letter come first.
/// Error messages suggest these names.
std::span<const std::string_view> color_names();

/// Returns the default colours of the types of a JSON world, one per type. A type describes bodies of the
/// same construction. A type is treated as a wall, and gets k_wall_color, if it has no drive, no device, no
/// controller, and no part that can be pushed or gripped. The other types get the colours of a
/// colour-blind-safe palette (Okabe and Ito, "Color Universal Design", 2008). The first of them is blue; the
/// next ones are orange, green, vermilion, sky blue, purple and yellow. The eighth is blue again, and so on.
std::vector<Color> default_colors(std::span<const engine::TypeSpec> types);

}  // namespace troupe::worldio
