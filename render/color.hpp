#pragma once

#include <array>
#include <cstdint>

namespace troupe::render {

/// Red, green, blue, opacity.
using Rgba = std::array<std::uint8_t, 4>;

}  // namespace troupe::render
