#include "worldio/results/hdf5_checksum.hpp"

#include "worldio/results/little_endian.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace troupe::worldio {

std::uint32_t metadata_checksum(std::span<const std::uint8_t> bytes) {
  const auto word = [&](std::size_t at) {
    return at >= bytes.size() ? 0u
                              : static_cast<std::uint32_t>(little_endian(
                                    bytes.subspan(at, std::min<std::size_t>(4, bytes.size() - at))));
  };
  std::uint32_t a = 0xdeadbeef + static_cast<std::uint32_t>(bytes.size());
  std::uint32_t b = a;
  std::uint32_t c = a;
  std::size_t at = 0;
  const auto add = [&] { a += word(at), b += word(at + 4), c += word(at + 8); };
  for (; bytes.size() - at > 12; at += 12) {
    add();
    a -= c, a ^= std::rotl(c, 4), c += b;
    b -= a, b ^= std::rotl(a, 6), a += c;
    c -= b, c ^= std::rotl(b, 8), b += a;
    a -= c, a ^= std::rotl(c, 16), c += b;
    b -= a, b ^= std::rotl(a, 19), a += c;
    c -= b, c ^= std::rotl(b, 4), b += a;
  }
  add();
  c ^= b, c -= std::rotl(b, 14);
  a ^= c, a -= std::rotl(c, 11);
  b ^= a, b -= std::rotl(a, 25);
  c ^= b, c -= std::rotl(b, 16);
  a ^= c, a -= std::rotl(c, 4);
  b ^= a, b -= std::rotl(a, 14);
  c ^= b, c -= std::rotl(b, 24);
  return c;
}

}  // namespace troupe::worldio
