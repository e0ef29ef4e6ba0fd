#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

/// The encoding of numbers in a replay page (docs/replay.md); apps/replay_page/src/series.js decodes it.
namespace troupe::worldio {

/// Stands for no value: an absent body, or a number that is not finite.
inline constexpr std::int32_t k_absent = std::numeric_limits<std::int32_t>::min();
/// The largest magnitude in a series: with it, a line that is continued still fits 31 bits.
inline constexpr std::int32_t k_most_in_series = 130000000;

/// How a value is predicted from those before it: only the small difference is stored.
enum class Expected : std::uint8_t {
  same,  ///< equals the previous value
  line,  ///< continues the line through the previous two values
};

/// Appends a series: for each value its difference d from the prediction, as an unsigned number of 7 bits per
/// byte, low bits first: 0 if the value is absent, else 1 + 2 d (d >= 0) or -2 d (d < 0). The prediction of
/// the first value is 0; after absent values it is the last value before them.
void append_series(std::span<const std::int32_t> values, Expected expected, std::string& out);

/// Compresses with zlib, in its own format, which browsers call "deflate".
std::string deflated(std::string_view bytes);
/// Encodes as base64 (RFC 4648, section 4), with padding.
std::string base64(std::string_view bytes);

}  // namespace troupe::worldio
