#include "worldio/results/replay_codec.hpp"

#include "base/assert.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <stdexcept>

namespace troupe::worldio {
void append_series(std::span<const std::int32_t> values, Expected expected, std::string& out) {
  std::int64_t last = 0;
  std::int64_t before = 0;
  bool begins = true;
  for (const std::int32_t value : values) {
    if (value == k_absent) {
      append_number(0, out);
      before = last;
      begins = true;
      continue;
    }
    TROUPE_ASSERT(value >= -k_most_in_series && value <= k_most_in_series);
    const std::int64_t off = value - (expected == Expected::line ? 2 * last - before : last);
    append_number(1 + static_cast<std::uint64_t>(off >= 0 ? 2 * off : -2 * off - 1), out);
    before = begins ? value : last;
    last = value;
    begins = false;
  }
}

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION) != Z_OK)
    throw std::runtime_error(
        fmt::format("out of memory: zlib cannot compress {} bytes of the recording", bytes.size()));
  out.resize(size);
  return out;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view k_letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  const auto byte = [bytes](std::size_t i) {
    return i < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) : 0u;
  };
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    out += k_letters[three >> 18];
    out += k_letters[three >> 12 & 63];
    out += i + 1 < bytes.size() ? k_letters[three >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? k_letters[three & 63] : '=';
  }
  return out;
}

}  // namespace troupe::worldio
