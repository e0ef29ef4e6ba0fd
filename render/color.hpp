#pragma once

#include <array>
#include <cstdint>

namespace troupe::render {

/// Red, green, blue and opacity, each from 0 to 255.
using Rgba = std::array<std::uint8_t, 4>;

}  // namespace troupe::render
