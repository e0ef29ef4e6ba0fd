#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

/// How numbers lie in a replay page (docs/replay.md); apps/replay_page/src/series.js reads it.
namespace troupe::worldio {

/// No value: a body that is not there, a number that is none.
inline constexpr std::int32_t k_absent = std::numeric_limits<std::int32_t>::min();
/// The largest magnitude that a series may hold: what is left of 31 bits when a line is drawn on.
inline constexpr std::int32_t k_most_in_series = 130000000;

/// What a value is expected to be, so that what is written is small.
enum class Expected : std::uint8_t {
  same,  ///< as the value before
  line,  ///< as far from the value before as that from the one before it
};

/// Appends a series: of each value how far it is from what was expected, as an unsigned number of 7 bits a
/// byte, the low ones first: 0 where the value is absent, else 1 more than 2 d (d >= 0) or -2 d - 1 (d < 0).
/// The first value is expected to be 0; behind a gap it is the last that was there.
void append_series(std::span<const std::int32_t> values, Expected expected, std::string& out);

/// Compressed by zlib, in its own format: what browsers call "deflate".
std::string deflated(std::string_view bytes);
/// RFC 4648, section 4, with padding.
std::string base64(std::string_view bytes);

}  // namespace troupe::worldio
