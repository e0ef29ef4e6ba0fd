#include "worldio/stage_devices.hpp"

#include <array>

namespace troupe::worldio {
namespace {

using enum StageUnit;

constexpr auto k_parameters = std::to_array<StageParameter>({
    {"blinkenlight", "period", "period", milliseconds},
    {"blinkenlight", "dutycycle", "dutycycle"},
    {"blinkenlight", "enabled", "enabled"},
});

}  // namespace

std::span<const StageParameter> stage_parameters() { return k_parameters; }

}  // namespace troupe::worldio
