#include "worldio/stage/stage_properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <unordered_map>

namespace troupe::worldio {
namespace {

using enum StageSupport;

// One row per property. The table in the documentation, the warnings and the suggestions for misspelt names
// all come from these rows.
constexpr std::string_view k_sensors_today =
    "write a `sensor( pose [0.1 0 0 90] range [0 5] fov 15 )` for each transducer";
constexpr std::string_view k_blocks_today =
    "write a `block( points 3 point[0] [0 0] point[1] [1 0] point[2] [0 1] z [0 1] )` for each polygon";

constexpr auto k_rows = std::to_array<StageRow>({
    {"world", "name", honoured, "title of the world; default: the path of the file"},
    {"world", "interval_sim", honoured, "length of a tick, ms; at least 0.001"},
    {"world", "quit_time", honoured,
     "simulated time, s, at which a run ends unless an option of the run says otherwise"},
    {"world", "unit_length", fixed, "\"m\", \"cm\" or \"mm\"; anything else is an error"},
    {"world", "unit_angle", fixed, "\"degrees\" or \"radians\"; anything else is an error"},
    {"world", "wrap_headings", honoured,
     "added by Troupe: 1 (default) wraps the headings of transducers and bumpers into the range from -180 to "
     "180 degrees, as Stage does; 0 keeps them"},
    {"world", "seed", honoured, "added by Troupe: the seed of all random numbers; default 1"},
    {"world", "resolution", honoured,
     "cell size of the grid ray engine, m, from 0.0001 to 100; the exact ray engine and collisions use no "
     "cells"},
    {"world", "threads", no_effect,
     "the number of threads is an option of the run and never changes a result"},
    {"world", "test", no_effect, "a debugging aid of Stage's parser"},
    {"world", "show_clock", fixed,
     "1: prints the simulated time on standard error, as `--clock` does; in Stage, the option `--clock` "
     "overrides this property"},
    {"world", "show_clock_interval", honoured, "number of ticks from one line of `show_clock` to the next"},
    {"world", "speedup", fixed,
     "speed of a run relative to real time with `troupe run --rate world`; at 0 or without that option, a "
     "run is as fast as possible; Stage uses this property only with a window"},
    {"world", "paused", window_only, "a run starts at once: without a window, nothing could resume it"},
    {"world", "confirm_on_quit", window_only, ""},
    {"world", "size", obsolete, ""},
    {"world", "interval_real", obsolete, "write `speedup 1`, with `troupe run --rate world`"},
    {"world", "gui_interval", obsolete, "write `window( interval 40 )`"},
    {"world", "gui_disable", obsolete, ""},
    {"world", "gui_menu_interval", obsolete, ""},
    {"world", "threadpool", obsolete, ""},

    {"model", "name", honoured,
     "a name that begins with `/` is global: the name of the parent is not put in front of it"},
    {"model", "pose", honoured,
     "[x y z heading] in the parent's frame; the older [x y heading] is read with a warning"},
    {"model", "size", honoured,
     "[x y z], above 0 if the model has a body; with the older form [x y], the height is the default of the "
     "model type, and a warning says so"},
    {"model", "origin", honoured, "offset of the body from `pose`; it does not move the children"},
    {"model", "update_interval", fixed,
     "time between two updates, ms; 0: every tick (with 0, Stage hangs). Stage drops a fraction of a "
     "millisecond"},
    {"model", "color", fixed,
     "X11 name, or \"random\": a random colour, which depends on the seed and on the id of the body (for a "
     "top-level model) or the name of the model (for a child)"},
    {"model", "color_rgba", honoured,
     "[red green blue opacity], each from 0 to 1; used if `color` is not given"},
    {"model", "bitmap", fixed,
     "an image whose solid pixels, stretched to `size`, are the body, or the YAML file of a ROS map; whole "
     "regions are solid, in Stage only their outlines"},
    {"model", "bitmap_margins", honoured,
     "added by Troupe: 1 stretches the whole image to `size`, 0 (default) only the bounding box of its solid "
     "pixels"},
    {"model", "bitmap_unknown", honoured,
     "added by Troupe: 1 makes unknown cells of a ROS map solid; default 0"},
    {"model", "noblocks", honoured, "1: the model type's default body is not added"},
    {"model", "boundary", honoured,
     "1: adds four walls, 0.01 m thick; if the model has blocks but no bitmap, the blocks replace the walls, "
     "with a warning"},
    {"model", "stack_children", honoured,
     "1 (default): children start at the top of the model; 0: at its base"},
    {"model", "obstacle_return", fixed,
     "1: the model blocks other bodies; whole regions block, in Stage only their outlines"},
    {"model", "ranger_return", fixed,
     "intensity that rangers read; below 0: beams pass through. Rangers see bodies of any size, however "
     "small"},
    {"model", "fiducial_return", honoured,
     "number that fiducial finders read; 0: they do not find the model"},
    {"model", "fiducial_key", honoured, "only fiducial finders with the same key find the model"},
    {"model", "gripper_return", fixed,
     "1: grippers sense the model and can hold it. A gripper takes the whole body of which the model is a "
     "part, and holds it where it is; in Stage, the gripped model jumps into the middle of the gripper"},
    {"model", "blob_return", fixed,
     "0: blob finders do not see the colour of the model; Stage never reads this property"},
    {"model", "ctrl", fixed, "names a controller of Troupe with its arguments: `\"expand speed=0.2\"`"},
    {"model", "alwayson", honoured, "1: the sensor of the model runs even if no controller reads it"},
    {"model", "event_queue", no_effect, "Stage overwrites the value"},
    {"model", "friction", no_effect, "Stage stores it and does not use it"},
    {"model", "map_resolution", no_effect, "Stage stores it and does not use it"},
    {"model", "debug", no_effect, "in Stage, the model prints a line"},
    {"model", "mass", fixed,
     "kg; used for a top-level `position`: its drive draws 1 W, plus 10 W times the mass in kg times the sum "
     "of its forward speed and its sideways speed in m/s and its turn rate in rad/s, each without its sign. "
     "These are the speeds within `velocity_bounds`; Stage uses the speeds before the bounds are applied"},
    {"model", "watts", fixed,
     "power that the model draws while it runs, W, whatever the length of a tick. A sensor or device counts "
     "as running if its robot has a controller, even if no controller uses it. No effect for model types "
     "whose power Troupe itself determines: position, ranger (0.2 W per sensor), blobfinder (2 W), bumper "
     "(0.1 W), actuator (2 W), camera (100 W)"},
    {"model", "joules", fixed,
     "gives the model a power pack with this capacity, J, which is full at the start; below 0: the pack "
     "never runs out. An empty pack stops the parts that it supplies: see `when_empty`"},
    {"model", "kjoules", fixed, "as `joules`, in kJ"},
    {"model", "joules_capacity", honoured,
     "capacity of the power pack, J; without `joules`, the pack is empty at the start"},
    {"model", "kjoules_capacity", honoured, "as `joules_capacity`, in kJ"},
    {"model", "when_empty", honoured,
     "added by Troupe: what an empty pack does. \"stop\": sensors keep their readings and drives stand "
     "still; \"nothing\": no effect, as in Stage"},
    {"model", "give_watts", fixed,
     "power, W, that the model gives while it runs to each body that takes energy and touches the model (at "
     "most 0.02 m apart); the whole region of the model counts, not only its outline"},
    {"model", "take_watts", honoured,
     "greatest power, W, that the model takes from each body that gives energy and touches the model"},
    {"model", "say", window_only, ""},
    {"model", "gui_nose", window_only, ""},
    {"model", "gui_outline", window_only, ""},
    {"model", "gui_grid", window_only, ""},
    {"model", "gui_move", window_only, ""},
    {"model", "trail_length", window_only, ""},
    {"model", "trail_interval", window_only, ""},
    {"model", "laser_return", obsolete, "write `ranger_return 1`; below 0: rangers do not see the model"},
    {"model", "blobfinder_return", obsolete, "write `blob_return 1`"},
    {"model", "shape", obsolete, k_blocks_today},
    {"model", "polygons", obsolete, k_blocks_today},
    {"model", "polygon[k]", obsolete, k_blocks_today},
    {"model", "polygon[k].points", obsolete, k_blocks_today},
    {"model", "polygon[k].point[k]", obsolete, k_blocks_today},
    {"model", "polygon[k].filled", obsolete, k_blocks_today},
    {"model", "blocks", obsolete, k_blocks_today},
    {"model", "block[k]", obsolete, k_blocks_today},
    {"model", "block[k].points", obsolete, k_blocks_today},
    {"model", "block[k].point[k]", obsolete, k_blocks_today},
    {"model", "block[k].z", obsolete, k_blocks_today},
    {"model", "block[k].z_range", obsolete, k_blocks_today},
    {"model", "block[k].color", obsolete, ""},
    {"model", "size3", obsolete, "write `size [x y z]`"},
    {"model", "offset", obsolete, "write `origin [x y z heading]`"},
    {"model", "gui_movemask", obsolete, ""},
    {"model", "view", obsolete, "write `range [0 5] fov 180` in a `sensor( )` of a `ranger( )`"},
    {"model", "scount", obsolete, k_sensors_today},
    {"model", "spose[k]", obsolete, k_sensors_today},
    {"model", "ssize", obsolete, k_sensors_today},
    {"model", "ssize[k]", obsolete, k_sensors_today},
    {"model", "sview", obsolete, k_sensors_today},
    {"model", "sview[k]", obsolete, k_sensors_today},
    {"model", "fill_polygons", obsolete, ""},
    {"model", "show_waypoints", obsolete, ""},
    {"model", "rangerdata", obsolete, ""},
    {"model", "ip", obsolete, "write it in a `radio( )`"},
    {"model", "mac", obsolete, "write it in a `radio( )`"},
    {"model", "essid", obsolete, "write it in a `radio( )`"},
    {"model", "model", obsolete, "write it in a `radio( )`"},
    {"model", "range", obsolete, "write it in a `radio( )`"},
    {"model", "power", obsolete, "write it in a `radio( )`"},
    {"model", "sensitivity", obsolete, "write it in a `radio( )`"},
    {"model", "plc", obsolete, "write it in a `radio( )`"},
    {"model", "ple", obsolete, "write it in a `radio( )`"},
    {"model", "wall_factor", obsolete, "write it in a `radio( )`"},
    {"model", "range_db", obsolete, "write `range` in a `radio( )`"},
    {"model", "range3", obsolete, "write `range` in a `radio( )`"},

    {"block", "points", honoured, "number of corners, at least 3"},
    {"block", "point[k]", honoured,
     "[x y] in any scale: all blocks of a model together are stretched to its `size`"},
    {"block", "z", honoured,
     "[min max], in the same scale as the points; a block without `z` has no height, and a warning says so"},

    {"position", "drive", fixed, "\"diff\", \"omni\" or \"car\"; anything else is an error"},
    {"position", "velocity_bounds", fixed,
     "[xmin xmax ymin ymax zmin zmax amin amax]; a is the turn rate, which is not wrapped at 180 degrees per "
     "second"},
    {"position", "wheelbase", honoured, "wheelbase of a car; above 0"},
    {"position", "velocity", fixed,
     "[x y z a]: velocity until the first update of the drive; with the default `update_interval`, that "
     "update comes before the first motion. Turn rates (a) are not wrapped at 180 degrees per second"},
    {"position", "acceleration_bounds", fixed,
     "[xmin xmax ymin ymax zmin zmax amin amax]: lower and upper bounds of the accelerations that a "
     "controller may command, along x, y and z and of the turn rate. Commanded speeds are reached at once, "
     "as in Stage. Differences from Stage: the bounds also apply to a car, and at each update of the "
     "drive the speed changes by the acceleration times the time since the last update"},
    {"position", "localization", fixed,
     "\"gps\" or \"odom\"; anything else is an error. In Troupe, odometry counts the true motion: it does "
     "not change while the robot is stalled, and includes sideways motion and the motion in ticks between "
     "updates"},
    {"position", "localization_origin", honoured,
     "origin of the estimated poses with \"odom\"; \"gps\" ignores it, as in Stage, with a warning, unless "
     "`gps_origin` is 1"},
    {"position", "gps_origin", honoured,
     "added by Troupe: 1 gives the poses of \"gps\" in the frame of `localization_origin`"},
    {"position", "odom_error", fixed,
     "[x y z a]: errors of the odometry, as fractions of the motion forward (x) and sideways (y) and of the "
     "turn (a); z has no effect, and a is converted from `unit_angle`, as in Stage. By default the errors "
     "are random for each robot; they follow from the seed of the world, in Stage from the clock"},
    {"position", "odom_heading", honoured,
     "added by Troupe: the heading along which odometry adds the motion of a tick. \"new\": the heading "
     "after the turn of that tick, as in Stage; \"old\": the heading before the turn, along which robots "
     "really move, so that the estimate is exact if there is no error"},
    {"position", "goal_bounds", honoured,
     "added by Troupe: [v a], the greatest speed and the greatest turn rate on the way to a goal; a is "
     "converted "
     "from `unit_angle`. By default they are 0.4 m/s and 1 rad/s, as in Stage"},
    {"position", "odom", obsolete, "write `localization_origin [x y z heading]`"},

    {"ranger", "intensity", honoured,
     "added by Troupe: 1 also reads the `ranger_return` of the body that each beam hits; Stage always does"},
    {"ranger", "range_max", obsolete, "write `sensor( range [0 8] )`, the minimum and the maximum"},
    {"ranger", "range_min", obsolete, "write `sensor( range [0 8] )`, the minimum and the maximum"},

    {"sensor", "pose", honoured, "[x y z heading] in the frame of the ranger, after its `origin` is applied"},
    {"sensor", "size", honoured, "half of the height is added to the height of the beams"},
    {"sensor", "range", honoured,
     "[min max]; as in Stage, the minimum is stored but not applied, unless `apply_range_min` is 1"},
    {"sensor", "fov", honoured, "angle from the first beam to the last"},
    {"sensor", "samples", honoured,
     "number of beams; a single beam points straight ahead; for cones see `beam_width`"},
    {"sensor", "noise", fixed,
     "[variance share angle], each 0 or above: the variance of the error of a range, the largest additional "
     "error as a fraction of the range, and the largest error of the direction of a beam. Differences from "
     "Stage: readings stay between 0 and the maximum, and the errors follow from the seed"},
    {"sensor", "beam_width", honoured,
     "added by Troupe: opening angle of each beam, which reads the nearest surface within it; default 0"},
    {"sensor", "apply_range_min", honoured,
     "added by Troupe: 1 replaces readings below the minimum by the minimum"},
    {"sensor", "color", window_only, ""},
    {"sensor", "color_rgba", window_only, ""},
    {"sensor", "range_max", obsolete, "write `range [0 8]`, the minimum and the maximum"},
    {"sensor", "range_min", obsolete, "write `range [0 8]`, the minimum and the maximum"},
    {"sensor", "view", obsolete, "write `range [0 5] fov 180`"},

    {"laser", "samples", honoured,
     "number of beams, default 180. A `laser` occurs in older files: it is a ranger with one sensor, whose "
     "properties are written in the `laser` itself, without a `sensor` block"},
    {"laser", "fov", honoured, "default 180 degrees"},
    {"laser", "range", honoured, "[min max], instead of `range_min` and `range_max`"},
    {"laser", "range_min", honoured, "default 0; stored but not applied"},
    {"laser", "range_max", honoured, "default 8 m"},
    {"sonar", "samples", honoured,
     "number of beams, default 1. A `sonar` occurs in older files: it is a ranger with one sensor, whose "
     "properties are written in the `sonar` itself, without a `sensor` block"},
    {"sonar", "fov", honoured, "default 0.1 rad"},
    {"sonar", "range", honoured, "[min max], instead of `range_min` and `range_max`"},
    {"sonar", "range_min", honoured, "default 0; stored but not applied"},
    {"sonar", "range_max", honoured, "default 5 m"},

    {"fiducial", "range_min", honoured,
     "lower limit of the distance; as in Stage, it is stored but not applied, unless `apply_range_min` is 1"},
    {"fiducial", "apply_range_min", honoured,
     "added by Troupe: 1: targets nearer than `range_min` are not found"},
    {"fiducial", "range_max", honoured, "targets whose origins are nearer than this are found"},
    {"fiducial", "range_max_id", honoured, "the numbers of targets nearer than this are read"},
    {"fiducial", "fov", honoured, "opening angle, in `unit_angle`"},
    {"fiducial", "ignore_zloc", fixed,
     "1: targets wholly above or below the finder's height are found too; unlike in Stage, a body behind "
     "such a target does not hide it"},

    {"radio", "essid", honoured,
     "added by Troupe, like all properties of `radio`: radios hear only radios with the same `essid`"},
    {"radio", "model", honoured,
     "propagation law, which says how signals weaken with distance: \"simple\", \"friis\", \"ITU indoor\", "
     "\"log distance\" or \"raytrace\"; \"raytrace\" is \"friis\" with walls that weaken signals"},
    {"radio", "power", honoured, "transmission power, dBm; default 20"},
    {"radio", "sensitivity", honoured, "weakest signal that is heard, dBm; default -80"},
    {"radio", "plc", honoured, "for \"ITU indoor\": loss per tenfold distance, dB; default 30"},
    {"radio", "ple", honoured, "for \"log distance\": path loss exponent; default 4"},
    {"radio", "wall_factor", honoured, "loss at each wall, dB, if `walls` is \"weaken\"; default 10"},
    {"radio", "range", honoured,
     "largest distance at which other radios hear this radio; default 5 m with \"simple\", 1000 m with the "
     "other laws"},
    {"radio", "hears", honoured, "largest distance at which this radio hears others; default: `range`"},
    {"radio", "walls", honoured,
     "effect of walls on signals, \"block\", \"weaken\" or \"pass\"; default \"weaken\" with \"raytrace\", "
     "\"pass\" with the other laws"},
    {"radio", "bodies", honoured, "effect of bodies between two radios on signals, \"block\" or \"pass\""},
    {"radio", "frequency", honoured, "carrier frequency, GHz; default 2.4"},
    {"radio", "payload", honoured, "maximum length of a message, bytes"},
    {"radio", "most_heard", honoured,
     "maximum number of messages heard per tick; of more messages, the nearest are heard"},
    {"radio", "drop_rate", honoured, "fraction of the messages to this radio that are lost at random"},
    {"radio", "beacon", honoured,
     "1: the radio sends an empty message until a controller sends another message"},
    {"radio", "ip", no_effect, "messages go to all radios in range"},
    {"radio", "mac", no_effect, "messages go to all radios in range"},

    {"blobfinder", "image", fixed,
     "[columns rows]; a single column looks straight ahead; in Stage, it causes a division by 0"},
    {"blobfinder", "range", honoured, "largest distance, m, whatever `unit_length` says"},
    {"blobfinder", "fov", fixed,
     "opening angle; Stage skips the column after each blob, even if another blob begins there; Troupe skips "
     "none"},
    {"blobfinder", "pan", honoured, "angle that is added to the heading of the blob finder"},
    {"blobfinder", "colors_count", honoured,
     "number of `colors` that are used; without it, every colour is reported"},
    {"blobfinder", "colors", fixed, "X11 names; an unknown one is an error"},
    {"blobfinder", "range_max", obsolete, "write `range 12`"},
    {"blobfinder", "channel_count", obsolete, "write `colors_count 2 colors [\"red\" \"green\"]`"},
    {"blobfinder", "channels", obsolete, "write `colors_count 2 colors [\"red\" \"green\"]`"},

    {"bumper", "crashes", honoured,
     "added by Troupe: 1: the bumpers also detect blocked motions that would have reached them; 0 (default): "
     "only what touches them, as in Stage"},
    {"bumper", "bcount", honoured, "number of bumpers; without it, the model has no bumpers"},
    {"bumper", "blength", honoured, "length of all bumpers without a `blength[k]`; above 0"},
    {"bumper", "blength[k]", honoured, "length of bumper k; above 0"},
    {"bumper", "bpose[k]", honoured,
     "[x y z heading] of the middle of bumper k, which extends at right angles to its heading and is 0.02 m "
     "thick"},

    {"gripper", "paddle_size", fixed,
     "[x y z], fractions of the gripper's `size`, whatever `unit_length` says (Stage reads them as lengths); "
     "paddles move as solid parts of the body and stop at what they touch; in Stage, they jump"},
    {"gripper", "paddle_state", fixed,
     "[\"open\" or \"closed\" \"up\" or \"down\"]; a held body rises with the paddles and stays where it is "
     "released"},
    {"gripper", "autosnatch", honoured,
     "1: the gripper closes while a body interrupts one of its beams, and opens while none does"},

    {"actuator", "type", fixed,
     "\"linear\" or \"rotational\"; the actuator moves together with its children; in Stage it does not "
     "move"},
    {"actuator", "axis", fixed, "[x y z] in the frame of the model; [0 0 0] means the x axis"},
    {"actuator", "min_position", fixed, "m or rad, whatever the file's units"},
    {"actuator", "max_position", fixed,
     "m or rad, whatever the file's units; at least `min_position`. A linear actuator moves at most 1000 m "
     "horizontally"},
    {"actuator", "max_speed", fixed, "m/s or rad/s, whatever the file's units"},
    {"actuator", "start_position", fixed,
     "position at the start relative to the pose of the model, m or rad; in Stage, it overwrites the pose. A "
     "position outside of the limits is set to the nearer limit"},

    {"camera", "resolution", fixed,
     "[width height], pixels; any size (in Stage, the size of its window is the limit)"},
    {"camera", "range", honoured, "[near far]: nearer and farther surfaces are not drawn"},
    {"camera", "fov", honoured, "[horizontal vertical], degrees, whatever `unit_angle` says"},
    {"camera", "pantilt", fixed,
     "[pan tilt], degrees: pan to the right, tilt upwards, relative to the heading of the camera; in Stage, "
     "relative to that of its parent"},
    {"camera", "width", obsolete, "write `resolution [80 60]`, width and height in pixels"},
    {"camera", "height", obsolete, "write `resolution [80 60]`, width and height in pixels"},
    {"camera", "horizfov", obsolete, "write `fov [70 40]`, horizontal and vertical, in degrees"},
    {"camera", "vertfov", obsolete, "write `fov [70 40]`, horizontal and vertical, in degrees"},
    {"camera", "yaw", obsolete, "write `pantilt [0 0]`, to the right and upwards, in degrees"},
    {"camera", "pitch", obsolete, "write `pantilt [0 0]`, to the right and upwards, in degrees"},

    {"blinkenlight", "period", fixed,
     "time from one flash to the next, ms; in Troupe the light blinks, in Stage it is not drawn"},
    {"blinkenlight", "dutycycle", fixed, "fraction of the period for which the light is lit"},
    {"blinkenlight", "enabled", fixed,
     "0: the light is dark until a controller switches it on; Stage never reads this property"},

    {"window", "size", window_camera,
     "[width height], pixels; a negative number: the whole screen in Stage, the default picture size in "
     "Troupe"},
    {"window", "center", window_camera, "[x y], m, whatever `unit_length` says"},
    {"window", "rotate", window_camera, "[pitch yaw], degrees"},
    {"window", "scale", window_camera, "pixels per metre"},
    {"window", "pcam_loc", window_camera, "[x y z]"},
    {"window", "pcam_angle", window_camera,
     "[pitch yaw], degrees, whatever `unit_angle` says; Stage multiplies the two numbers by pi/180 if "
     "`unit_angle` is \"degrees\""},
    {"window", "pcam_on", window_camera, ""},
    {"window", "interval", window_only, "ms"},
    {"window", "screenshot_skip", window_only, ""},
    {"window", "screenshots", window_only, ""},
    {"window", "follow_model", window_camera, ""},
    {"window", "show_data", window_camera, ""},
    {"window", "show_blocks", window_only, ""},
    {"window", "show_clock", window_camera, ""},
    {"window", "show_flags", window_only, ""},
    {"window", "show_grid", window_camera, ""},
    {"window", "show_follow", window_only, ""},
    {"window", "show_footprints", window_camera, ""},
    {"window", "show_boundingboxes", window_only, ""},
    {"window", "show_occupancy", window_camera, ""},
    {"window", "show_trailarrows", window_only, ""},
    {"window", "show_trailrise", window_only, ""},
    {"window", "show_trailfast", window_only, ""},
    {"window", "show_trailblur", window_only, ""},
    {"window", "show_status", window_only, ""},
    {"window", "show_voxels", window_only, ""},
    {"window", "vis_all", window_only, ""},
    {"window", "show_ranger_ranges", window_camera, ""},
    {"window", "show_ranger_strikes", window_only, ""},
    {"window", "show_ranger_fov", window_only, ""},
    {"window", "show_ranger_transducers", window_only, ""},
    {"window", "show_fiducial", window_camera, ""},
    {"window", "show_fiducial_fov", window_only, ""},
    {"window", "show_gripper_data", window_camera, ""},
    {"window", "show_camera", window_only, ""},
    {"window", "show_blinken", window_only, ""},
    {"window", "show_bumper_hits", window_only, ""},
    {"window", "show_position_waypoints", window_only, ""},
    {"window", "show_position_coords", window_only, ""},
    {"window", "ranger_vis", window_only, ""},
    {"window", "blobfinder_vis", window_camera, ""},
    {"window", "raster_vis", window_only, ""},
    {"window", "energy_dissipation", window_only, ""},
    {"window", "energy_input", window_only, ""},
    {"window", "energy_stored", window_only, ""},

    {"type", "map", obsolete,
     "write `model( bitmap \"map.png\" size [16 16 0.6] boundary 1 )`, or `floorplan( )` after `include "
     "\"map.inc\"`, a file of Stage"},
    {"type", "environment", obsolete, "write `model( bitmap \"map.png\" size [16 16 0.6] boundary 1 )`"},
    {"type", "region", obsolete, "write `model( size [4 4 0.01] obstacle_return 0 ranger_return -1 )`"},
    {"type", "fiducialfinder", obsolete, "write `fiducial( range_max 8 fov 180 )`"},
    {"type", "simple_laser", obsolete, "write `ranger( sensor( range [0 8] fov 180 samples 180 ) )`"},
    {"type", "ptz", obsolete,
     "write `pan 0 fov 60` in the `blobfinder( )`, or `pantilt [0 0]` in a `camera( )`"},
    {"type", "puck", obsolete, "write `model( size [0.2 0.2 0.2] gripper_return 1 )`"},
    {"type", "charger", obsolete, "write `model( give_watts 1000 joules -1 alwayson 1 )`"},
    {"type", "power", obsolete, "write `joules 40000` in the model"},
    {"type", "energy", obsolete, "write `joules 40000` in the model"},
    {"type", "speech", obsolete, "remove it"},
    {"type", "truth", obsolete, "remove it"},
    {"type", "gps", obsolete, "write `localization \"gps\"` in the `position( )`"},
    {"type", "box", obsolete, "write `model( size [1 1 1] )`"},
    {"type", "bitmap", obsolete, "write `model( bitmap \"map.png\" size [16 16 0.6] boundary 1 )`"},
    {"type", "gui", obsolete, "write `window( size [800 600] center [0 0] scale 20 )`"},
    {"type", "player", obsolete, "remove it: a controller, `ctrl`, drives the robot"},
    {"type", "misc", obsolete, "remove it"},
    {"type", "broadcast", obsolete, "write `radio( range 5 )`"},
    {"type", "mcom", obsolete, "write `radio( range 5 )`"},
    {"type", "audio", obsolete, "write `radio( range 5 )`"},
    {"type", "laserbeacon", obsolete, "write `model( size [0.1 0.1 0.5] fiducial_return 1 )`"},
    {"type", "visionbeacon", obsolete, "write `model( size [0.1 0.1 0.5] color \"red\" )`"},
    {"type", "lbd", obsolete, "write `fiducial( range_max 8 fov 180 )`"},
    {"type", "bps", obsolete, "write `localization \"gps\"` in the `position( )`"},
    {"type", "foofinder", obsolete, "write `fiducial( range_max 8 fov 180 )`"},
    {"type", "omniposition", obsolete, "write `position( drive \"omni\" )`"},
});

/// Whether entities of this type are models. Models also have the properties in the rows of "model".
bool is_model(std::string_view type) {
  return type != "world" && type != "block" && type != "sensor" && type != "window" && type != "type";
}

/// Returns a name with each number in brackets replaced by k: `point[k]` for `point[12]`.
std::string without_numbers(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    out += name[i];
    if (name[i] != '[') continue;
    const std::size_t end = std::min(name.size(), name.find_first_not_of("0123456789", i + 1));
    if (end == i + 1) continue;
    out += 'k';
    i = end - 1;
  }
  return out;
}

/// Returns all rows with this property name, for whatever type of entity.
std::span<const StageRow* const> rows_of_name(std::string_view written) {
  using Index = std::unordered_map<std::string_view, std::vector<const StageRow*>>;
  static const Index index_of_rows = [] {
    Index index;
    for (const StageRow& row : k_rows) index[row.name].push_back(&row);
    return index;
  }();
  std::string numberless;
  if (written.find('[') != std::string_view::npos) {
    numberless = without_numbers(written);
    written = numberless;
  }
  const auto it = index_of_rows.find(written);
  if (it == index_of_rows.end()) return {};
  return it->second;
}

/// Returns a heading and the properties that entities of this type can have, without those that have no
/// effect in Troupe; empty if there are none.
std::string properties_text(std::string_view heading, std::string_view type) {
  std::string text;
  for (const StageRow& row : k_rows) {
    if (row.type != type || (row.support != honoured && row.support != fixed)) continue;
    std::string line = fmt::format("  {:<22}  {}", row.name, row.note);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text.empty() ? text : fmt::format("{}\n{}\n", heading, text);
}

}  // namespace

std::span<const StageRow> stage_rows() { return k_rows; }

const StageRow* find_stage_row(std::string_view type, std::string_view written) {
  if (type == "wifi") type = "radio";
  // The lasers and sonars of older files are rangers and also their own sensors.
  const bool is_both = type == "laser" || type == "sonar";
  const auto row_of = [&](std::string_view wanted) -> const StageRow* {
    for (const StageRow* row : rows_of_name(written))
      if (row->type == wanted) return row;
    return nullptr;
  };
  const StageRow* row = row_of(type);
  if (!row && is_both) row = row_of("ranger");
  if (!row && is_model(type)) row = row_of("model");
  if (!row && is_both) row = row_of("sensor");
  return row;
}

std::string old_words_text(std::span<const std::string_view> names, std::string_view example,
                           std::string_view note) {
  std::string today(note);
  std::erase(today, '`');
  if (note == k_sensors_today && !example.empty())
    today = fmt::format("write {} for the first transducer, and so on", example);
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i)
    all += fmt::format("{}\"{}\"", i == 0 ? "" : i + 1 == names.size() ? " and " : ", ", names[i]);
  return fmt::format("old syntax: {} {} ignored, as in Stage: {}", all, names.size() == 1 ? "is" : "are",
                     today);
}

std::string old_type_text(const StageRow& row) {
  std::string today(row.note);
  std::erase(today, '`');
  return fmt::format("\"{}\" is a model type of older versions of Stage: {}", row.name, today);
}

bool is_without_effect(std::string_view name) {
  const std::span<const StageRow* const> rows = rows_of_name(name);
  return !rows.empty() && std::ranges::none_of(rows, [](const StageRow* row) {
    return row->support == honoured || row->support == fixed;
  });
}

std::vector<std::string_view> stage_property_names(std::string_view type) {
  std::vector<std::string_view> names;
  for (const StageRow& row : k_rows)
    if (row.support != obsolete && find_stage_row(type, row.name) == &row) names.push_back(row.name);
  return names;
}

std::string stage_properties_text(std::string_view model) {
  std::string text;
  if (model != "model") text += properties_text("properties in a Stage world", model);
  if (model == "ranger") text += properties_text("properties of each sensor( ) block in a ranger", "sensor");
  return text + properties_text("properties of every model", "model") +
         properties_text("properties of each block( ) in a model", "block");
}

}  // namespace troupe::worldio
