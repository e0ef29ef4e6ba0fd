#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

/// The encoding of numbers in a replay page, an HTML file that shows a recording (docs/replay.md);
/// apps/replay_page/src/series.js decodes it.
namespace troupe::worldio {

/// The value that means "no value" in a series. A series is one number of a body, such as its x, in
/// consecutive frames. It has no value in frames in which the body is absent or the number is not finite.
inline constexpr std::int32_t k_absent = std::numeric_limits<std::int32_t>::min();
/// The largest absolute value in a series. With this limit, every number that append_series() stores fits in
/// 31 bits, for all predictions (Expected).
inline constexpr std::int32_t k_most_in_series = 130000000;

/// How a value of a series is predicted from the values before it. Only the difference from the prediction,
/// which is usually small, is stored.
enum class Expected : std::uint8_t {
  same,  ///< equals the last value that is not absent
  line,  ///< continues the line through the previous two values; like `same` if one is missing or absent
};

/// Appends a number with 7 bits per byte, low bits first. Bit 7 is set in every byte except the last.
/// Pictures of the live view have the same encoding.
inline void append_number(std::uint64_t number, std::string& out) {
  for (; number > 127; number >>= 7) out += static_cast<char>(128 | (number & 127));
  out += static_cast<char>(number);
}

/// Appends a series to `out`. Each value must be k_absent, or from -k_most_in_series to k_most_in_series.
///
/// Each value is converted to an unsigned number n. For k_absent, n is 0. For any other value, let d be the
/// value minus its prediction: n is 1 + 2 d if d >= 0, else -2 d. The prediction of the first value that is
/// not absent is 0. For example, the series 5, 7, 6 with Expected::same gives the numbers 11, 5, 2.
///
/// Each number is then stored with append_number().
void append_series(std::span<const std::int32_t> values, Expected expected, std::string& out);

/// Compresses bytes in the format of zlib (RFC 1950), which browsers call "deflate". Throws
/// std::runtime_error if zlib has not enough memory.
std::string deflated(std::string_view bytes);
/// Encodes bytes as base64 (RFC 4648, section 4), with padding.
std::string base64(std::string_view bytes);

}  // namespace troupe::worldio
