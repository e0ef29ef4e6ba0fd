#include "worldio/stage_devices.hpp"

#include <array>

namespace troupe::worldio {
namespace {

using enum StageUnit;

constexpr auto k_parameters = std::to_array<StageParameter>({
    {"actuator", "type", "type"},
    {"actuator", "axis", "axis"},
    {"actuator", "min_position", "min_position"},
    {"actuator", "max_position", "max_position"},
    {"actuator", "max_speed", "max_speed"},
    {"actuator", "start_position", "start_position"},
    {"gripper", "autosnatch", "autosnatch"},
    {"blinkenlight", "period", "period", milliseconds},
    {"blinkenlight", "dutycycle", "dutycycle"},
    {"blinkenlight", "enabled", "enabled"},
});

}  // namespace

std::span<const StageParameter> stage_parameters() { return k_parameters; }

}  // namespace troupe::worldio
