#include "worldio/stage/stage_devices.hpp"

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
    {"radio", "hears", "hears", length},
    {"radio", "essid", "channel"},
    {"radio", "payload", "payload"},
    {"radio", "most_heard", "most_heard"},
    {"radio", "drop_rate", "drop_rate"},
    {"radio", "bodies", "bodies"},
    {"radio", "power", "power_dBm"},
    {"radio", "sensitivity", "sensitivity_dBm"},
    {"radio", "frequency", "frequency_GHz"},
    {"radio", "plc", "power_loss_coefficient"},
    {"radio", "ple", "path_loss_exponent"},
    {"radio", "wall_factor", "wall_loss_dB"},
    {"radio", "beacon", "beacon"},
});

// If two rows have the same law, the writer uses the name in the first row.
constexpr auto k_radio_laws = std::to_array<StageRadioLaw>({
    {"simple", "disc", "pass"},
    {"friis", "friis", "pass"},
    {"ITU indoor", "itu_indoor", "pass"},
    {"log distance", "log_distance", "pass"},
    {"raytrace", "friis", "weaken"},
});

}  // namespace

std::span<const StageRadioLaw> stage_radio_laws() { return k_radio_laws; }

std::span<const StageParameter> stage_parameters() { return k_parameters; }

}  // namespace troupe::worldio
