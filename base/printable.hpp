#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace troupe {

/// Returns the number of bytes of the UTF-8 character with which a text begins; 0 if these bytes are not
/// valid UTF-8 (RFC 3629). The text must not be empty.
std::size_t utf8_length(std::string_view text);

/// Returns a text in which control characters are escaped: `\r`, `\x1b` (also for single bytes that terminals
/// without UTF-8 obey), `\u009b`. Names, titles and keys of a world of unknown origin may contain them, and a
/// terminal would obey them. Tabs and line breaks are kept, because messages may have several lines.
std::string printable(std::string_view text);
/// As printable(), but also escapes line breaks, as `\n`, for a name or a text that is part of a line.
std::string printable_line(std::string_view text);

}  // namespace troupe
