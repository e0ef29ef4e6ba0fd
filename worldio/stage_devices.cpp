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
    {"blobfinder", "image", "image_width", plain, 0},
    {"blobfinder", "image", "image_height", plain, 1},
    {"blobfinder", "range", "range"},
    {"blobfinder", "fov", "fov", angle},
    {"blobfinder", "pan", "pan", angle},
    {"camera", "resolution", "width", plain, 0},
    {"camera", "resolution", "height", plain, 1},
    {"camera", "range", "range_near", length, 0},
    {"camera", "range", "range_far", length, 1},
    {"camera", "fov", "fov_horizontal", degrees, 0},
    {"camera", "fov", "fov_vertical", degrees, 1},
    {"camera", "pantilt", "pan", degrees, 0},
    {"camera", "pantilt", "tilt", degrees, 1},
    {"fiducial", "range_min", "range_min", length},
    {"fiducial", "apply_range_min", "apply_range_min"},
    {"fiducial", "range_max", "range_max", length},
    {"fiducial", "range_max_id", "range_max_id", length},
    {"fiducial", "fov", "fov", angle},
    {"fiducial", "ignore_zloc", "ignore_zloc"},
    {"fiducial", "fiducial_key", "key"},
});

}  // namespace

std::span<const StageParameter> stage_parameters() { return k_parameters; }

}  // namespace troupe::worldio
