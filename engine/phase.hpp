#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace troupe::engine {

/// The phases of a tick, in their order.
enum class Phase : std::uint8_t { sense, decide, move, index };
inline constexpr std::size_t k_phases = 4;
std::string_view phase_name(Phase phase);

}  // namespace troupe::engine
